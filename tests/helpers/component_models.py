"""Small strings in random, strained, moving states: one for every component, for the contract tests."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from drillpetsc.fem.discrete_system import DiscreteSystem
from drillpetsc.fem.string_mesh import RigidItem
from drillpetsc.geometry.frames import transported_frames
from drillpetsc.geometry.well import Well
from drillpetsc.physics.beam import AncfBeam
from drillpetsc.physics.bit.bit_on_bottom import BitOnBottom
from drillpetsc.physics.contact import Contact, ContactLaw
from drillpetsc.physics.end_conditions import EndPlace, FixedEnd, Loads, NodeLoad, RotaryDrive, TopDrive
from drillpetsc.physics.fluid.mud_items import MudItem, MudItems
from drillpetsc.physics.own_law import FRICTION, OwnLaw
from drillpetsc.physics.precurvature import Precurvature
from drillpetsc.physics.rigid_bodies import RigidBodies
from drillpetsc.physics.tools.steering import PointTool, PushTool, Steer
from drillpetsc.physics.top.control import Law, Motor
from drillpetsc.physics.top.hoist import STATES as HOIST_STATES
from drillpetsc.physics.top.hoist import HoistedTop, HoistLine
from drillpetsc.physics.top.hoisting import Autodriller, Heave, Hoisting, Line, Loop
from drillpetsc.physics.top.top_drive import RESULTS, STATES, MotorDrive
from drillpetsc.time_function import Constant, Ramp
from tests.helpers.uniform_string import uniform_string

SHIFT = 2.3
GRAVITY = np.array([1.0, 2.0, 9.0])
SECTION = {
    "axial_stiffness": 1e3,
    "bending_stiffness": 10.0,
    "torsional_stiffness": 8.0,
    "mass": 2.0,
    "polar_inertia": 0.3,
    "outer_diameter": 0.4,
}


def curved_tangents(nodes: int) -> np.ndarray:
    t = np.array([[np.sin(0.2 * i), 0.1 * i, np.cos(0.2 * i)] for i in range(nodes)])
    return t / np.linalg.norm(t, axis=1)[:, None]


def mesh_for(kind: str):
    mesh = uniform_string(4.0, 4, **SECTION)
    if "damped" in kind:
        mesh = replace(mesh, stiffness_damping=np.full(4, 0.05), mass_damping=np.full(4, 0.1))
    if "junction" in kind:
        mesh = replace(mesh, junction=np.array([0, 1, 0, 0, 0], bool), rigid_above=np.array([0, 0.3, 0, 0.0]))
    if "bodies" in kind:
        body = RigidItem("stabiliser", "stabilizer", 1, 0.0, 0.3, 1.3, 0.15, (0.05, -0.02), 0.2, 0.4, 0.25,
                         guided="guided" in kind)  # fmt: skip
        mesh = replace(mesh, bodies=(body,), eccentricity=np.tile([0.0, 0.03], (4, 1)))
    if "curvature" in kind:
        mesh = replace(mesh, curvature=np.tile([0.1, -0.2], (4, 1)))
    return mesh


def motor_drive(kind: str) -> MotorDrive:
    """The drive of ``kind``: law, filters, lag, delay and limits by words; sizes of order one."""
    law = {"p": 1.7, "i": 2.1, "delay": 0.6 if "delay" in kind else 0.0}
    if "soft" in kind:
        law |= {"compensation": 0.25}
    if "ztorque" in kind:
        law |= {"coupling": 0.4, "high_pass": 0.9, "low_pass": 0.0 if "direct" in kind else 0.3}
        law |= {"estimated": "estimated" in kind}
    limits = {
        "upper": {"max_torque": 0.4, "min_torque": -0.4},
        "lower": {"max_torque": 50.0, "min_torque": 0.0},
        "power": {"max_torque": 40.0, "min_torque": -30.0, "power": 0.6},
    }.get(kind.split("_")[1], {})
    limits |= {"torque_rate": 0.5, "lag": 0.2} if "rate" in kind else {}
    limits |= {"lag": 0.2} if "lag" in kind else {}
    torque = Ramp(1.0, 2.0) if "given" in kind else None
    laws = () if torque is not None else (Law("pi", **law),)
    rotation = Constant(-9.0) if "lower" in kind else Ramp(1.0, 8.0)
    return MotorDrive(rotation, torque, laws, Motor(0.4, **limits), 1.0, 5)


def hoist_line(kind: str, position: np.ndarray, tangent: np.ndarray) -> HoistLine:
    """The hoist of ``kind``: heave, damping, loops and limits by words; sizes of order one, free of the top's guide."""
    loops = [
        Loop(name, Constant(goal), 1.3, 0.9) for name, goal in (("wob", 5.0), ("torque", 4.0)) if name in kind
    ]
    most = 0.02 if "upper" in kind else 50.0
    drill = Autodriller(
        tuple(loops), Constant(0.7) if "rop" in kind else None, 0.0, 0.0 if "lower" in kind else -50.0, most,
        filter=0.3 if "filter" in kind else 0.0, sample=1.0 if "sample" in kind else 0.0,
    )  # fmt: skip
    line = Line(4, 3.0, 5.0, 2.0, 1.0, 0.6 if "damped" in kind else 0.0)
    heave = Heave(Ramp(2.0, 0.3), 3.0, 0.4, 0.2) if "heave" in kind else None
    top = HoistedTop(EndPlace(position, tangent), None)
    hoist = HoistLine(
        Hoisting(1.7, line, 4, 9.0, 20.0, heave=heave),
        top,
        Ramp(1.0, 0.4),
        GRAVITY,
        5,
        drill if loops or drill.rate else None,
    )
    numbers = np.array(
        [
            float(top.anchor[0]) - 0.3, 0.8, {"upper": -60.0, "lower": 60.0}.get(kind.split("_")[-1], 3.0),
            0.2, 0.1, 1.0, np.nan, 0.0, 0.0,
        ]
    )  # fmt: skip
    hoist.set_state({"numbers": numbers, "last": np.arange(9.0), "samples": np.ones((2, 9))})
    return hoist


def own_friction(s):
    """A friction coefficient of every field of the state."""
    return (
        s.given
        * (1 + 0.4 * np.exp(-s.slip_speed) + 0.1 * np.sin(s.axial + 2 * s.around + s.depth))
        / (1 + 1e-3 * s.normal)
    )


def build(kind: str, seed: int = 3) -> DiscreteSystem:
    """DiscreteSystem of ``kind`` (words joined by _) in a random state with random rates and history."""
    rng = np.random.default_rng(seed)
    mesh, tangents = mesh_for(kind), curved_tangents(5)
    frames = transported_frames(tangents)
    components = [AncfBeam(mesh, frames, GRAVITY)]
    position = np.cumsum(np.vstack([[0, 0, 0], tangents[:-1]]), axis=0)
    noise = 0.02 if "contact" in kind else 0.1
    if "bodies" in kind:
        components.append(RigidBodies(mesh, frames, GRAVITY))
    if "curvature" in kind:
        components.append(Precurvature(mesh, frames))
    if "loads" in kind:
        components.append(
            Loads(
                (
                    NodeLoad(2, force=(1.0, -2.0, 3.0), moment=(0.5, 0.2, -0.7)),
                    NodeLoad(
                        4, force=(4.0, 1.0, 2.0), moment=(0.3, 2.0, 1.0), section=True, factor=lambda t: 1 + t
                    ),
                ),
                frames,
            )
        )
    if "hoist" in kind:
        components.append(hoist_line(kind, position[0], tangents[0]))
    if "drive" in kind:
        components.append(RotaryDrive(Ramp(1.0, 2.0), 3.0, 0.7, 0.4))
    if "motor" in kind:
        components.append(motor_drive(kind))
    if "topdrive" in kind:
        components.append(TopDrive(EndPlace(position[0], tangents[0]), Ramp(1.0, 2.0), Constant(0.3)))
    steer = Steer(Ramp(1.0, 0.9), Ramp(2.0, 2.0))
    if "pads" in kind:
        components.append(PushTool(steer, 2, tangents[2], None, 5.0, "turning" in kind, frames))
    if "tilt" in kind:
        cells = np.array([1, 2])
        components.append(PointTool(steer, tangents[1], None, 0.7, cells, np.array([0.4, 0.6]), mesh))
    if "clamped" in kind:
        components.append(FixedEnd(EndPlace(position[4], tangents[4], 4), "clamped"))
    if "mud_items" in kind:
        well = Well.from_survey(
            np.arange(5.0), 0.1 * np.arange(5.0), np.full(5, 0.2), [10.0], [0.6], [0.3], max_step=1.0
        )
        components.append(
            MudItems((MudItem(1, 0.4, 1.7, 0.6, 0.0), MudItem(4, 0.0, 0.8, 0.3, 0.0)), lambda: well)
        )
    if "contact" in kind:
        inclination = np.arccos(tangents[:, 2])
        azimuth = np.arctan2(tangents[:, 1], tangents[:, 0])
        well = Well.from_survey(
            np.arange(5.0), inclination, azimuth, [1.7, 10.0], [0.2, 0.26], [0.3, 0.2], max_step=1.0
        )
        law = ContactLaw(
            stiffness=500.0,
            law="hertz" if "hertz" in kind else "linear",
            slip_velocity=0.5,
            static_ratio=1.5 if "stribeck" in kind else 1.0,
            points=3,
            own=OwnLaw(FRICTION, "own", own_friction) if "own" in kind else None,
        )
        components.append(Contact(mesh, well, law))
        position, tangents, _ = well.at(np.arange(5.0))
        if "bit" in kind:
            end, axis, _ = well.at(np.array([4.2]))
            components.append(BitOnBottom(4, 0.3, 0.2, 2e3, 0.4, end[0], axis[0], 0.3))
    system = DiscreteSystem(mesh, frames, components)
    offset = np.array([0.15, 0.1, 0.0]) if "contact" in kind else 0.0
    system.set_field("string.position", position + offset + noise * rng.standard_normal((5, 3)))
    system.set_field("string.tangent", tangents + 2 * noise * rng.standard_normal((5, 3)))
    system.set_field("string.spin", 2 * rng.standard_normal((5, 1)))
    if "junction" in kind:
        system.set_field("string.ratio", np.full((5, 1), 1.2))
    asm = system.assembly
    asm.v0[:], asm.v1[:] = rng.standard_normal(len(asm.v0)), rng.standard_normal(len(asm.v1))
    if "motor" in kind:
        for name, size, _ in STATES:
            system.set_field(name, rng.standard_normal((5, size)))
    if "hoist" in kind:
        for name, _ in HOIST_STATES:
            system.set_field(name, 0.2 * rng.standard_normal((5, 1)))
    if (
        "drive" in kind or "motor" in kind
    ):  # a drive rotates about the fixed direction of its node, where spin rate and rate of the angle are equal
        here = system.layout.dofs["string.tangent"][0]
        asm.x[here] = 1.1 * curved_tangents(1)[0]
        asm.v0[here] = -SHIFT * asm.x[here]
    if "turning" in kind:
        components[-1].release_sliding_direction()
    if "held" in kind:
        components[-1].hold()
        components[-1].params["held"] = 3.0  # of the size of the other stiffnesses
    if "rounded" in kind:  # the torque is within the rounding of the limit
        asm.condense(SHIFT)
        components[-1].powers(0.4, asm)
        command = components[-1].results(asm)[RESULTS["command"]]
        components[-1].params["max_torque"] = 1.001 * abs(command)
        components[-1].params["min_torque"] = -1.001 * abs(command)
    return system


KINDS = [
    "beam", "beam_damped", "beam_junction", "beam_damped_junction", "bodies", "bodies_junction", "curvature",
    "curvature_junction", "loads", "drive", "motor_pi", "motor_given", "motor_held", "motor_soft_lag",
    "motor_soft_delay", "motor_ztorque", "motor_ztorque_direct", "motor_ztorque_direct_delay",
    "motor_ztorque_lag_delay", "motor_ztorque_estimated", "motor_upper", "motor_rounded", "motor_lower",
    "motor_power", "motor_rate", "hoist_line", "hoist_heave_damped", "hoist_wob",
    "hoist_wob_rop_torque_filter_damped", "hoist_wob_sample", "hoist_wob_upper", "hoist_wob_lower", "pads",
    "pads_turning", "tilt", "topdrive", "clamped", "contact", "contact_hertz_stribeck", "mud_items",
    "contact_junction_bodies_bit", "contact_junction_bodies_guided", "contact_own",
    "contact_junction_bodies_own",
]  # fmt: skip


def dense(system: DiscreteSystem) -> np.ndarray:
    """(n, n) sum of the entries of the assembly."""
    asm, n = system.assembly, system.layout.size
    rows, columns = asm.places()
    keep = (rows >= 0) & (columns >= 0)
    J = np.zeros((n, n))
    np.add.at(J, (rows[keep], columns[keep]), asm.values[keep])
    return J


def residual(system: DiscreteSystem, x: np.ndarray, t: float) -> np.ndarray:
    """(n,) condensed residual at the unknowns ``x`` and time ``t``, rates by the formula of shift SHIFT."""
    asm, vector = system.assembly, system.new_condensed()
    asm.x[: system.layout.size] = x
    asm.condense(SHIFT)
    asm.apply_prescribed_rates(t, SHIFT)
    system.sum_residual(t, vector)
    return vector.getArray().copy()


def lengths(system: DiscreteSystem, h: float) -> np.ndarray:
    """(n,) steps of `differences`: ``h`` for unknowns with accelerations, 0.04 of it for pressures, flow rates and multipliers."""
    fields = system.layout.fields
    return np.array([h if fields[k].second_order else 0.04 * h for k in system.layout.field_of])


def differences(system: DiscreteSystem, x0: np.ndarray, t: float, h: float | np.ndarray) -> np.ndarray:
    """(n, n) derivatives of ``residual`` at ``x0``, by differences of fourth order with steps ``h``, a number or (n,)."""
    F = np.zeros((len(x0), len(x0)))
    for j, step in enumerate(np.broadcast_to(h, len(x0))):
        e = np.zeros(len(x0))
        e[j] = step
        r = [residual(system, x0 + k * e, t) for k in (-2, -1, 1, 2)]
        F[:, j] = (r[0] - 8 * r[1] + 8 * r[2] - r[3]) / (12 * step)
    return F


def both_jacobians(system: DiscreteSystem, t: float, h: float | np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(n, n) condensed Jacobian of the assembly at its unknowns, and that of `differences` with steps ``h``."""
    x0 = system.assembly.x[: system.layout.size].copy()
    residual(system, x0, t)
    system.assembly.jacobian(t, (1.0, SHIFT, SHIFT**2), condensed=True)
    return dense(system), differences(system, x0, t, h)


def meet_conditions(system: DiscreteSystem, t: float) -> np.ndarray:
    """Set what rows prescribe to its values at ``t``; (n, n): the projection on what they leave free."""
    asm, free = system.assembly, np.eye(system.layout.size)
    for f in asm.row_replacements:
        asm.x[f.rows] += f.D.T @ (f.condition.value(t) - f.D @ asm.x[f.rows])
        free[np.ix_(f.rows, f.rows)] = f.complement
    return free
