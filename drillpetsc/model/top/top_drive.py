"""From `top.motor` and `top.control` to the drive: gains from the pipe, the inertia and the lowest torsional frequency."""

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
from drillpetsc.fem.string_mesh import StringMesh
from drillpetsc.physics.top.control import Law, Motor
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
