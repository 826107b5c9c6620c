"""A short string with fluid in and around it, in a random moving state: for the contract tests of the fluid
components."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from drillpetsc.fem.component import Component, Field
from drillpetsc.fem.discrete_system import DiscreteSystem
from drillpetsc.fem.string_mesh import RigidItem, StringMesh
from drillpetsc.geometry.frames import transported_frames
from drillpetsc.geometry.growing_hole import GrowingHole
from drillpetsc.geometry.well import Well
from drillpetsc.physics.beam import AncfBeam
from drillpetsc.physics.end_conditions import EndPlace, TopDrive
from drillpetsc.physics.fluid.annulus_flow import AnnulusFlow, FlowLine, HoleAround, LateralCoefficients
from drillpetsc.physics.fluid.bit_flow import BitEnd, BitFlow
from drillpetsc.physics.fluid.bore_flow import BoreFlow
from drillpetsc.physics.fluid.channel_flow import FluidConstants
from drillpetsc.physics.fluid.channels import Annulus, Bore
from drillpetsc.physics.fluid.rheology import Rheology
from drillpetsc.time_function import Constant, Ramp
from tests.helpers.component_models import GRAVITY, SECTION, SHIFT
from tests.helpers.uniform_string import uniform_string

KINDS = (
    "pipe", "pipe_junction", "annulus", "annulus_junction", "pipe_annulus_bit",
    "pipe_annulus_bit_junction_topdrive", "pipe_bit", "annulus_bit", "pipe_pump", "pipe_annulus_bit_held",
    "pipe_bit_held", "annulus_bit_held", "annulus_widening", "annulus_junction_widening", "annulus_swirl",
    "annulus_junction_swirl", "annulus_aside", "annulus_junction_swirl_aside", "pipe_annulus_bit_drilled",
    "annulus_bit_drilled",
)  # fmt: skip


MUD = FluidConstants(
    3.0,
    60.0,
    GRAVITY,
    Rheology(
        "power_law", law="blend", consistency=0.8, index=0.7, yield_stress=0.0, shear_rate_eps=1.0
    ).parameters(),
    0.4,
)
ONE = np.ones(4)
#: tool joints in two of the elements
BORE = Bore(
    np.array([0.07, 0.07, 0.05, 0.05]),
    1e-3 * ONE,
    0.06 * ONE,
    0.05 * ONE,
    np.array([0.0, 0.06, 0.0, 0.2]),
    0.03 * ONE,
)
ANNULUS = Annulus(
    0.126 * ONE, np.array([0.28, 0.28, 0.3, 0.3]), 2e-3 * ONE, 0.15 * ONE, 0.12 * ONE, np.array([0.0, 0.06, 0.0, 0.2]),
    0.2 * ONE,
)  # fmt: skip


def curved_hole() -> Well:
    inclination = np.array([0.0, 0.05, 0.15, 0.3, 0.4, 0.5])
    return Well.from_survey(np.arange(6.0), inclination, 0.3 * np.ones(6), [10.0], [0.3], [0.3], max_step=1.0)


def mesh_of(kind: str) -> StringMesh:
    """Four elements of 1 m; with a stabilizer above the second one in a junction."""
    mesh = uniform_string(4.0, 4, **SECTION, inner_diameter=0.3)
    if "junction" not in kind:
        return mesh
    body = RigidItem("stabiliser", "stabilizer", 1, 0.0, 0.3, 1.3, 0.15, (0.0, 0.0), 0.2, 0.4, 0.25)
    junction, above = np.array([0, 1, 0, 0, 0], bool), np.array([0, 0.3, 0, 0.0])
    return replace(mesh, junction=junction, rigid_above=above, bodies=(body,))


def bit_end(well: Well, pipe: bool, annulus: bool, cut: float = 0.0) -> BitEnd:
    end, axis, _ = map(np.asarray, well.at(np.array([4.6])))
    return BitEnd(
        bore=0.05 if pipe else 0.0, nozzle=0.03, discharge_coefficient=0.9, check_valve=False, ambient=Constant(0.2),
        hole=0.3 if annulus else 0.0, open=0.17, outer=0.126, elasticity=1e-3, volume=0.05, face=0.2, added=1.5, metal=0.02,
        end=end[0], axis=axis[0], cut=cut,
    )  # fmt: skip


def set_string(system: DiscreteSystem, rng: np.random.Generator, kind: str, noise: float = 0.05) -> None:
    """The string at random beside the axis of the hole."""
    position, tangents, _ = map(np.asarray, curved_hole().at(np.arange(5.0)))
    system.set_field("string.position", position + noise * rng.standard_normal((5, 3)))
    system.set_field("string.tangent", tangents + 2 * noise * rng.standard_normal((5, 3)))
    system.set_field("string.spin", rng.standard_normal((5, 1)))
    if "junction" in kind:
        system.set_field("string.ratio", np.full((5, 1), 1.05))


def set_rates(system: DiscreteSystem, rng: np.random.Generator) -> None:
    """Random rates, and what condensation with SHIFT makes of them."""
    asm, size = system.assembly, system.layout.size
    asm.y[:-1] = 0.2 * rng.standard_normal(size)
    asm.v0[:] = asm.y[:-1] - SHIFT * asm.x[:-1]
    asm.v1[:] = 0.3 * rng.standard_normal(size)


class Drilled(Component):
    """The unknowns of a growing hole without a bit."""

    def fields(self) -> tuple[Field, ...]:
        return tuple(
            Field(f"hole.{name}", size, region="bottom", second_order=False)
            for name, size in (("end", 3), ("drilled", 1))
        )


def build(
    kind: str, seed: int = 5, fluid: FluidConstants | None = None, noise: float = 0.05
) -> DiscreteSystem:
    """DiscreteSystem of ``kind`` (words joined by _): fluid of density 3, bulk modulus 60, power law, in a
    curved hole.

    aside: an added mass by the place in the hole; widening: elements that move into sections of other areas; swirl: of the mud about the string; drilled: the end of the hole moves, cuttings
    returned.
    """
    rng = np.random.default_rng(seed)
    mesh, well, n = mesh_of(kind), curved_hole(), ONE
    position, tangents, _ = map(np.asarray, well.at(np.arange(5.0)))
    frames = transported_frames(tangents)
    fluid = fluid or MUD
    held = position if "held" in kind else None
    components: list = [] if held is not None else [AncfBeam(mesh, frames, GRAVITY)]
    if "topdrive" in kind:
        components.append(TopDrive(EndPlace(position[0], tangents[0]), Ramp(1.0, 2.0), Constant(0.3)))
    poisson = 0.3 * n
    if "pipe" in kind:
        pressure = Ramp(0.5, 1.0) if "pump" in kind else None
        components.append(
            BoreFlow(mesh, BORE, fluid, poisson, None if pressure else Ramp(0.03, 1.0), pressure, held)
        )
    if "annulus" in kind:
        by_place = (
            (lambda outer, hole: np.tile([0.3, 1.8, -0.9, 0.4, -0.2], (len(outer), 1)))
            if "aside" in kind
            else None
        )
        side = LateralCoefficients(
            np.array([2.0, 2.0, 1.5, 1.5]), 0.3 * n, 0.2 * n, 0.0 * n, by_place=by_place
        )
        components.append(
            AnnulusFlow(
                mesh, HoleAround(ANNULUS, well), fluid, poisson, side, FlowLine(Constant(0.4), 0.1), held
            )
        )
    if "bit" in kind:
        end = bit_end(well, "pipe" in kind, "annulus" in kind, 0.29 if "drilled" in kind else 0.0)
        hole = GrowingHole(well.cut(4.6), 0.1, 0.3, 0.3) if "drilled" in kind else None
        components += [Drilled()] if hole is not None else []
        components.append(BitFlow(4, end, fluid, held, None, hole))
    system = DiscreteSystem(mesh, frames, components)
    if "widening" in kind:
        for block in components[-1]._blocks:
            block.named["widening"] = np.linspace(0.1, -0.2, len(block.points))
    if "swirl" in kind:
        give_swirl(components[-1])
    if held is None:
        set_string(system, rng, kind, noise)
    for f in system.layout.fields:
        if not f.second_order:
            scale = 0.02 if f.name.endswith("flow") or f.name.startswith("hole") else 2.0
            system.set_field(f.name, scale * rng.standard_normal((5, f.size)))
    set_rates(system, rng)
    if "widening" in kind:
        read_hole(system, components[-1])
    return system


def give_swirl(annulus) -> None:
    """Let the mud in the annulus swirl, at another rate about each element; one element has mud that stands."""
    for block in annulus._blocks:
        k = np.arange(len(block.points))
        block.named["share"] = np.where(k == 1, 0.0, 0.3 + 0.05 * k)
        block.named["swirl"], block.named["swirl_rate"] = (
            np.where(k == 1, 0.0, s * (1.0 + k)) for s in (0.9, -0.4)
        )
        block.named["spin_rate"] = 0.5


def read_hole(system, annulus) -> None:
    """Let the hole be read where the nodes are now: its length between them is that along the elements' mean directions."""
    position, tangent = system.field("string.position"), system.field("string.tangent")
    for block in annulus._blocks:
        p, e = block.named, block.points
        mean = p["tangent1"] + p["tangent2"]
        mean /= np.linalg.norm(mean, axis=1, keepdims=True)
        item = tangent[e] / np.linalg.norm(tangent[e], axis=1, keepdims=True) * p["rigid"][:, None]
        first = p["tangent0"] if "junction" in block.kernel else p["tangent1"]
        p["bent"] = (
            np.sum(position[e] * (first - mean), axis=1)
            - np.sum(position[e + 1] * (p["tangent2"] - mean), axis=1)
            - np.sum(item * mean, axis=1)
        )


def give_shoulders(system) -> None:
    """Let the string have shoulders of some size at the upper ends of all elements of its annulus."""
    for component in system.components:
        if component.name == "annulus":
            for number, block in enumerate(component._blocks):
                block.named["shoulder"][:] = 3.0 + 2.0 * number
