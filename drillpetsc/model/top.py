"""From the top drive and the hoist of a case to their components (manual: sec-top-drive, sec-hoist)."""

from __future__ import annotations

from typing import Any

import numpy as np

from drillpetsc.case.blocks.ends import HeldBottom
from drillpetsc.case.blocks.ends import TopDrive as TopDriveCase
from drillpetsc.case.blocks.top_drive import (
    AnyController,
    PiController,
    PythonController,
    SoftTorqueController,
    StiffController,
    ZTorqueController,
)
from drillpetsc.case.case import Case
from drillpetsc.errors import CaseError
from drillpetsc.fem.quantity import OneStep
from drillpetsc.fem.string_mesh import StringMesh
from drillpetsc.model.fluid import FluidComponents
from drillpetsc.physics import interfaces
from drillpetsc.physics.end_conditions import EndPlace, Input, TopDrive
from drillpetsc.physics.top.control import Law, Motor
from drillpetsc.physics.top.hoist import Hoist, HoistedTop, HoistLine, RigidHoist
from drillpetsc.physics.top.hoisting import Autodriller, Heave, HeavingSpeed, Hoisting, Line, Loop
from drillpetsc.physics.top.sampled_law import SampledTorque
from drillpetsc.physics.top.top_drive import MotorDrive


def pipe_impedance(mesh: StringMesh) -> float:
    """Compute the torsional impedance zeta = J sqrt(G rho) of the uppermost pipe [N m s/rad]."""
    first = int(np.flatnonzero(~mesh.is_joint)[0])
    return float(np.sqrt(mesh.torsional_stiffness[first] * mesh.polar_inertia[first]))


def lowest_torsional_frequency(mesh: StringMesh, bottom_held: bool = False) -> float:
    """Compute the lowest torsional frequency [Hz] of the string with its top held.

    The string is straight and in air, with the elements of the model: linear rotation and consistent inertia.
    bottom_held: the lower end does not turn.
    Raises CaseError if joints leave parts of the string free to turn.
    """
    if any(j.kind == "revolute" for j in mesh.joints):
        raise CaseError(
            at="top.control.frequency",
            got="auto",
            want="a frequency in Hz: a revolute joint may let a part of the string turn by itself",
        )
    n = mesh.nodes
    element = ~mesh.is_joint
    k = np.zeros(n - 1)
    k[element] = mesh.torsional_stiffness[element] / mesh.length[element]
    inertia = np.where(element, mesh.polar_inertia * mesh.length, 0.0)
    K, M = np.zeros((2, n)), np.zeros((2, n))
    K[1, :-1] += k
    K[1, 1:] += k
    K[0, 1:] -= k
    M[1, :-1] += inertia / 3
    M[1, 1:] += inertia / 3
    M[0, 1:] += inertia / 6
    for b in mesh.bodies:
        M[1, b.node] += b.axial
    last = n - 1 if bottom_held else n
    return _lowest(K[:, 1:last], M[:, 1:last])


def _lowest(K: np.ndarray, M: np.ndarray) -> float:
    """Lowest frequency [Hz] of K u = w^2 M u by inverse iteration; upper bands (2, n)."""
    u = np.arange(1.0, K.shape[1] + 1)
    import scipy.linalg  # a slow import

    factor = scipy.linalg.cholesky_banded(K)
    squared = 0.0
    for _ in range(200):
        v = scipy.linalg.cho_solve_banded((factor, False), _times(M, u))
        last, squared = squared, float((u @ _times(M, u)) / (u @ _times(M, v)))
        u = v / np.linalg.norm(v)
        if abs(squared - last) < 1e-14 * squared:
            break
    return float(np.sqrt(squared) / (2 * np.pi))


def _times(band: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Product of a symmetric tridiagonal matrix (upper band) and a vector."""
    out = band[1] * u
    out[:-1] += band[0, 1:] * u[1:]
    out[1:] += band[0, 1:] * u[:-1]
    return out


def motor_of(case: Case) -> Motor:
    """The motor of the case."""
    assert isinstance(case.top, TopDriveCase) and case.top.motor is not None
    m = case.top.motor
    largest = m.max_torque or 0.0
    smallest = -largest if m.min_torque is None else m.min_torque
    return Motor(m.inertia, largest, smallest, m.limit_power or 0.0, m.torque_rate or 0.0, m.time_constant)


def laws_of(case: Case, mesh: StringMesh) -> tuple[Law, ...]:
    """The controllers of the case with their gains.

    A sampled one has half a sample more delay: the mean delay of a torque that is held (manual: sec-top-drive-sampled).
    """
    zeta, inertia = pipe_impedance(mesh), motor_of(case).inertia
    if any(isinstance(q, PythonController) for q in case.top.control):
        return ()  # the gains of a function of the user are unknown here
    return tuple(_law(q, case, mesh, zeta, inertia) for q in case.top.control)


def _law(q: AnyController, case: Case, mesh: StringMesh, zeta: float, inertia: float) -> Law:
    assert not isinstance(q, PythonController)
    common: dict[str, Any] = {"start": q.from_, "delay": q.delay + 0.5 * q.sample}
    if isinstance(q, PiController):
        return Law("pi", p=q.p, i=q.i, **common)
    if isinstance(q, StiffController):
        return Law("stiff", p=q.p * zeta, i=q.i * inertia, **common)
    if isinstance(q, SoftTorqueController):
        held = isinstance(case.bottom, HeldBottom) and case.bottom.kind == "clamped"
        f = lowest_torsional_frequency(mesh, held) if q.frequency == "auto" else float(q.frequency)
        kappa = q.inertia_compensation
        i = (2 * np.pi * f) ** 2 * (1 - kappa) * inertia
        return Law(
            "soft_torque", p=q.damping * zeta, i=i, compensation=kappa * inertia, frequency=f, **common
        )
    assert isinstance(q, ZTorqueController)
    return Law(
        "z_torque",
        p=q.p * zeta,
        i=q.i * inertia,
        coupling=q.factor / zeta,
        low_pass=q.low_pass / (2 * np.pi),
        high_pass=q.high_pass / (2 * np.pi),
        estimated=q.estimate == "motor",
        **common,
    )


def build_drive(case: Case, mesh: StringMesh) -> MotorDrive:
    """Create the drive of a case with a motor."""
    top = case.top
    assert isinstance(top, TopDriveCase)
    sampled, laws = any(q.sample > 0 for q in top.control), laws_of(case, mesh)
    torque = SampledTorque() if sampled else top.torque
    drive = MotorDrive(
        top.rotation, torque, () if sampled else laws, motor_of(case), pipe_impedance(mesh), mesh.nodes
    )
    drive.described = laws
    return drive


def continuous_control(case: Case) -> Case:
    """The case of a linear analysis: a sampled controller is continuous, with half a sample more delay.

    Measurements of an autodriller that are held for a sample have a lag of first order of that delay.
    """
    top = case.top
    drill = top.autodriller
    if drill is not None and drill.sample > 0:
        lag = {"sample": 0.0, "filter": drill.filter + 0.5 * drill.sample}
        case = case.model_copy(
            update={"top": top.model_copy(update={"autodriller": drill.model_copy(update=lag)})}
        )
    if not any(
        getattr(q, "sample", 0.0) > 0 and q.kind != "python" for q in getattr(case.top, "control", ())
    ):
        return case
    assert isinstance(case.top, TopDriveCase)
    control = tuple(
        q.model_copy(update={"sample": 0.0, "delay": q.delay + 0.5 * q.sample})
        for q in case.top.control
        if not isinstance(q, PythonController)
    )
    return case.model_copy(update={"top": case.top.model_copy(update={"control": control})})


def gear_of(case: Case) -> Hoisting:
    """Masses, line and heave of the case's hoist."""
    h = case.top.hoist
    assert h is not None
    line = None
    if h.line is not None:
        length = h.crown - h.height
        line = Line(h.lines, h.line.stiffness, length, h.fast_line, h.dead_line, h.damping)
    heave = None
    if h.heave is not None:
        heave = Heave(h.heave.amplitude, h.heave.period, h.heave.phase, h.heave.compensation)
    units = case.said_units
    return Hoisting(h.block_mass, line, h.lines, h.height, h.crown, h.sheave_efficiency, h.tare, heave, units)


def autodriller_of(case: Case) -> Autodriller | None:
    """The autodriller of the case; None without."""
    q, hoist = case.top.autodriller, case.top.hoist
    if q is None or hoist is None:
        return None
    loops = [
        Loop(kind, goal, p, i)
        for kind, goal, p, i in (
            ("wob", q.wob, q.p, q.i),
            ("torque", q.torque, q.torque_p, q.torque_i),
            ("differential_pressure", q.differential_pressure, q.pressure_p, q.pressure_i),
        )
        if goal is not None
    ]
    most = q.max_speed if q.max_speed is not None else hoist.max_speed
    return Autodriller(
        tuple(loops),
        q.rop,
        q.from_,
        -most if q.reverse else 0.0,
        most,
        q.measure == "bit",
        q.filter,
        q.sample,
        q.ramp or 0.0,
    )


def build_hoist(
    case: Case,
    nodes: int,
    place: EndPlace,
    rotation: Input | None,
) -> tuple[interfaces.Top, Hoist]:
    """Create the guided top and the hoist of a case.

    nodes: of the string; place: of its upper end; rotation: prescribed, None: free.
    """
    top, gear = case.top, gear_of(case)
    assert isinstance(top, TopDriveCase)
    gravity = np.array(case.gravity, dtype=float)
    if gear.line is not None:
        guided = HoistedTop(place, rotation)
        statics = case.initial.from_ == "statics"
        return guided, HoistLine(gear, guided, top.lowering, gravity, nodes, autodriller_of(case), statics)
    speed: Any = top.lowering if gear.heave is None else HeavingSpeed(top.lowering, gear.heave)
    weight = gear.mass * float(gravity @ place.tangent)
    guided_by_drum = TopDrive(place, rotation, speed)
    return guided_by_drum, RigidHoist(gear, speed, top.lowering, weight)


def connect_sensors(
    hoist: Hoist,
    drive: interfaces.Drive | None,
    bit: interfaces.Bit | None,
    fluid: FluidComponents | None,
) -> None:
    """Connect the measurements that the hoist's autodriller takes elsewhere."""

    def torque(t: float, state: Any) -> float:
        held = sum(
            float(row.reaction[row.condition.names.index("top.torque_reaction")])
            for row in state.row_replacements
            if row.owned and "top.torque_reaction" in row.condition.names
        )
        return held + (drive.torque(t, state) if drive is not None else 0.0)

    def hook(t: float, state: Any) -> float:
        return -sum(
            float(row.reaction[row.condition.names.index("top.axial_reaction")])
            for row in state.row_replacements
            if row.owned and "top.axial_reaction" in row.condition.names
        )

    if isinstance(hoist, RigidHoist):
        hoist.sensors = {"hook": hook}
        return
    assert isinstance(hoist, HoistLine)
    found: dict[str, Any] = {}
    drill = hoist.autodriller
    if bit is not None:
        found["wob"] = lambda t, state: bit.weight_and_torque(state)[0]
    kinds = {q.kind for q in drill.loops} if drill is not None else set()
    if "torque" in kinds:
        found["torque"] = torque
    if "differential_pressure" in kinds:
        assert fluid is not None
        found["differential_pressure"] = lambda t, state: fluid.pump_pressure_of(OneStep(state, t)).item()
    hoist.sensors = found
