"""Strings with joints for the tests: rigid bodies in a chain, and beams in random states."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from drillpetsc.fem.discrete_system import DiscreteSystem
from drillpetsc.fem.string_mesh import RigidItem, StringJoint, StringMesh, plain_sizes
from drillpetsc.geometry.frames import transported_frames
from drillpetsc.physics.beam import AncfBeam
from drillpetsc.physics.end_conditions import EndPlace, FixedEnd
from drillpetsc.physics.joints import Joints
from drillpetsc.physics.rigid_bodies import RigidBodies
from tests.helpers.uniform_string import uniform_string

AXES = ((0.0, 0.6, 0.8), (0.0, -0.8, 0.6), (1.0, 0.0, 0.0))
NO_GRAVITY = np.zeros(3)


def body(
    node: int, length: float, mass: float, axial: float, transverse: float, center: float | None = None
) -> RigidItem:
    """A rigid body that hangs on ``node``; SI, inertia about its centre of gravity (by default at half its
    length)."""
    return RigidItem(
        f"body {node}",
        "body",
        node,
        0.0,
        length,
        mass,
        0.5 * length if center is None else center,
        (0.0, 0.0),
        axial,
        transverse,
        0.0,
    )


def chain_of_bodies(bodies: tuple[RigidItem, ...], joints: tuple[StringJoint, ...]) -> StringMesh:
    """RigidBodies, one on each node, with a joint at the lower end of each but the last; no elements."""
    n, nodes = len(joints), len(joints) + 1
    zero, one = np.zeros(n), np.ones(n)
    return StringMesh(
        upper=zero,
        lower=zero,
        node_depth=np.zeros(nodes),
        axial_stiffness=one,
        bending_stiffness=one,
        torsional_stiffness=one,
        mass=zero,
        polar_inertia=zero,
        **plain_sizes(zero, zero),
        stiffness_damping=zero,
        mass_damping=zero,
        rigid_above=np.array([b.length for b in bodies[:-1]]),
        eccentricity=np.zeros((n, 2)),
        curvature=np.zeros((n, 2)),
        item=np.zeros(n, dtype=int),
        friction=np.full(n, np.nan),
        bodies=bodies,
        junction=np.zeros(nodes, dtype=bool),
        joints=joints,
    )


def place(
    mesh: StringMesh, position: np.ndarray, tangent: np.ndarray, components=(), gravity=NO_GRAVITY
) -> DiscreteSystem:
    """DiscreteSystem of ``mesh`` along ``tangent`` (3,) from ``position`` (nodes, 3), at rest; each of
    ``components`` is called with its frames."""
    frames = transported_frames(np.tile(tangent, (mesh.nodes, 1)))
    g = np.array(gravity, dtype=float)
    system = DiscreteSystem(
        mesh,
        frames,
        [
            AncfBeam(mesh, frames, g),
            *([RigidBodies(mesh, frames, g)] if mesh.bodies else []),
            Joints(mesh, frames),
            *(component(frames) for component in components),
        ],
    )
    system.set_field("string.position", position)
    system.set_field("string.tangent", np.tile(tangent, (mesh.nodes, 1)))
    return system


def joint_component(system: DiscreteSystem) -> Joints:
    return next(component for component in system.components if isinstance(component, Joints))


def random_state(
    kind: str, stabilised: bool = False, held: bool = False, seed: int = 5, arm: float = 0.3
) -> DiscreteSystem:
    """Beam, joint with a rigid arm above it, beam; in a random moving state that violates the constraints of
    the joint. held: the node before the joint is clamped."""
    mesh = uniform_string(
        4.0,
        4,
        axial_stiffness=1e3,
        bending_stiffness=10.0,
        torsional_stiffness=8.0,
        mass=2.0,
        polar_inertia=0.3,
    )
    slider = (
        {"spring": 50.0, "damping": 3.0, "stroke": (-0.1, 0.05), "stop_stiffness": 400.0}
        if "slider" in kind
        else {}
    )
    if kind == "torsion_slider":
        slider |= {"preload": 2.0, "torsion_spring": 3.0}
    axes = AXES if kind in ("revolute", "universal") else ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    if kind == "universal":
        axes = (AXES[0], (0.0, -0.8, 0.6), (1.0, 0.0, 0.0))
    mesh = replace(
        mesh,
        upper=np.array([0, 1, 2, 2.0]),
        lower=np.array([1, 2 - arm, 2, 3]),
        node_depth=np.array([0, 1, 2 - arm, 2, 3]),
        rigid_above=np.array([0, 0, arm, 0]),
        joints=(StringJoint(2.0, kind, 2, axes, stabilised, **slider),),
    )
    rng = np.random.default_rng(seed)
    tangents = np.array([[np.sin(0.2 * i), 0.1 * i, np.cos(0.2 * i)] for i in range(5)])
    tangents /= np.linalg.norm(tangents, axis=1)[:, None]
    frames = transported_frames(tangents)
    ends = [FixedEnd(EndPlace(np.array([0, 0.1, 1.0]), tangents[1], 1), "clamped")] if held else []
    system = DiscreteSystem(
        mesh, frames, [AncfBeam(mesh, frames, np.array([1.0, 2.0, 9.0])), Joints(mesh, frames), *ends]
    )
    system.set_field(
        "string.position",
        np.array([[0, 0, 0], [0, 0.1, 1], [0, 0.2, 1.7], [0.1, 0.2, 2], [0.2, 0.3, 3]])
        + 0.05 * rng.standard_normal((5, 3)),
    )
    system.set_field("string.tangent", tangents + 0.2 * rng.standard_normal((5, 3)))
    system.set_field("string.spin", 2 * rng.standard_normal((5, 1)))
    for name in system.layout.dofs:
        if name.startswith("joint."):  # multipliers in units of 1e6 N: loads of a few newtons
            system.set_field(name, (1e-6 if name == "joint.load" else 0.1) * rng.standard_normal((5, 6)))
    asm = system.assembly
    asm.v0[:], asm.v1[:] = rng.standard_normal(len(asm.v0)), rng.standard_normal(len(asm.v1))
    return system
