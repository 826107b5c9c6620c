"""Closed-form solutions for convergence studies: waves along a string or a bore, by the method of
characteristics.

Each function checks the case and returns None if its assumptions do not hold. The name of a case has no
influence.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.case import Case
from drillpetsc.case.blocks.ends import TopDrive
from drillpetsc.case.blocks.items.string import Beam, Pipe
from drillpetsc.fem.string_mesh import tube
from drillpetsc.time_function import TimeFunction

Outputs = dict[str, FloatArray]

MOST_CELLS = 40000
FEWEST_CELLS = 1000  # for output times between the cell times
EQUAL_SPEED = 1e-9  # largest relative difference of wave speeds that count as equal


def exact_outputs(case: Case, times: FloatArray) -> tuple[Outputs, str] | None:
    """Outputs name -> (k,) [SI] of a closed form at ``times`` (k,) [s], and its name; None if the case has no
    closed form."""
    for name, form in FORMS.items():
        found = form(case, times)
        if found is not None:
            return found, name
    return None


# ---------------------------------------------------------------------- waves
def characteristics(
    impedance: FloatArray, cell_time: float, top: Callable[[float], float], end: float
) -> tuple[FloatArray, FloatArray]:
    """Times (k,) [s] and speed (k,) [m/s or rad/s] of the free lower end of a chain of cells.

    impedance: (n,) of each cell.
    cell_time: travel time of a wave through one cell [s].
    top: prescribed speed of the upper end at a time [s].
    end: last time [s].

    The speed in a cell is the sum of a downward wave d and an upward wave u. Both sides of a joint have the
    speed 2 (Za d + Zb u)/(Za + Zb), which is exact at multiples of the cell time (d'Alembert).
    """
    n = len(impedance)
    steps = int(end / cell_time) + 2
    za, zb = impedance[:-1], impedance[1:]
    down, up = np.zeros(n), np.zeros(n)
    out = np.empty(steps)
    for k in range(steps):
        new_down, new_up = np.empty(n), np.empty(n)
        joint = 2 * (za * down[:-1] + zb * up[1:]) / (za + zb)
        new_down[1:], new_up[:-1] = joint - up[1:], joint - down[:-1]
        new_down[0], new_up[-1] = top(k * cell_time) - up[0], down[-1]
        out[k] = 2 * down[-1]
        down, up = new_down, new_up
    return np.arange(steps) * cell_time, out


def _sections(case: Case, stiffness: str, inertia: str) -> tuple[FloatArray, float] | None:
    """Impedance (n,) of cells of equal travel time, and that time [s].

    None for a string with bodies or with several wave speeds.
    """
    rows = []
    for item in case.string:
        if isinstance(item, Pipe) and item.bend is None and item.eccentricity == 0 and item.curvature == 0:
            m = item.material
            values, damping = tube(item.od, item.id, m.young, m.poisson, m.density), m.damping
        elif isinstance(item, Beam):
            values, damping = {k: getattr(item, k) for k in (stiffness, inertia)}, item.damping
        else:
            return None
        if damping.stiffness or damping.mass:
            return None
        rows.append(
            (
                item.length,
                math.sqrt(values[stiffness] / values[inertia]),
                math.sqrt(values[stiffness] * values[inertia]),
            )
        )
    lengths, speeds, impedances = map(np.array, zip(*rows, strict=True))
    if np.ptp(speeds) > EQUAL_SPEED * speeds[0]:
        return None
    millimetres = np.round(lengths * 1e3).astype(int)
    if np.any(np.abs(millimetres / 1e3 - lengths) > 1e-9 * lengths):
        return None
    cell = int(np.gcd.reduce(millimetres))
    cell //= max(1, round(cell * FEWEST_CELLS / int(millimetres.sum())))
    if cell == 0 or millimetres.sum() // cell > MOST_CELLS or np.any(millimetres % cell):
        return None
    return np.repeat(impedances, millimetres // cell), cell * 1e-3 / float(speeds[0])


def _free_string(case: Case) -> bool:
    """Whether the string hangs straight from a top drive, with a free lower end, without well and fluid."""
    return (
        case.well is None
        and case.fluid is None
        and not case.loads
        and not case.hold_string
        and case.bottom.kind == "free"
        and isinstance(case.top, TopDrive)
        and case.top.force is None
        and case.top.motor is None
        and case.top.hoist is None
        and case.beam.formulation in ("ancf", "quaternion")
    )


def _vertical(case: Case) -> bool:
    return (
        case.initial.inclination == 0
        and case.gravity[0] == case.gravity[1] == 0
        and case.gravity[2] >= 0
        and case.initial.from_ in ("statics", "rest", "straight")
    )


def torsional_wave(case: Case, times: FloatArray) -> Outputs | None:
    """Bit speed of a string that hangs from a rotating top drive.

    Torsional waves with c = sqrt(GJ/polar inertia) and impedance sqrt(GJ x inertia). Weight and stretch have
    no influence on a straight string. At time 0 the whole string turns with the speed of the top drive.
    """
    if not (_free_string(case) and _vertical(case)):
        return None
    assert isinstance(case.top, TopDrive)
    cells = _sections(case, "torsional_stiffness", "polar_inertia")
    return None if cells is None else {"bit_speed": _end_speed(cells, case.top.rotation, times)}


def _end_speed(cells: tuple[FloatArray, float], drive: TimeFunction, times: FloatArray) -> FloatArray:
    start = drive.value(0.0)
    t, speed = characteristics(*cells, lambda s: drive.value(s) - start, float(times[-1]))
    return start + np.interp(times, t, speed)


def mud_pressure_wave(case: Case, times: FloatArray) -> Outputs | None:
    """Pump pressure of a fixed string filled with frictionless mud, with an open lower end.

    Joukowsky waves of amplitude rho c q/A that are reversed at the open end after each L/c. For small flow the
    compression of the mud is linear. In a rigid bore c = sqrt(K/rho).
    """
    f = case.fluid
    if (
        f is None
        or not case.hold_string
        or f.annulus
        or f.elastic_walls
        or f.pump_pressure is not None
        or case.bottom.plugged
    ):
        return None
    if f.rheology.model != "newtonian" or f.rheology.viscosity != 0 or any(case.gravity):
        return None
    item = case.string[0]
    if len(case.string) > 1 or not isinstance(item, (Pipe, Beam)) or f.flow_rate is None:
        return None
    speed = math.sqrt(f.bulk_modulus / f.density)
    impedance = f.density * speed / (math.pi / 4 * item.id**2)
    back = 2 * case.string_length / speed
    flow = f.flow_rate

    def pressure(t: float) -> float:
        reflections = sum(
            (-1) ** k * 2 * (flow.value(t - k * back) - flow.value(0.0)) for k in range(1, int(t / back) + 1)
        )
        return impedance * (flow.value(t) - flow.value(0.0) + reflections)

    return {"pump_pressure": np.array([pressure(float(t)) for t in times])}


FORMS: dict[str, Callable[[Case, FloatArray], Outputs | None]] = {
    "torsional wave by characteristics": torsional_wave,
    "pressure wave by characteristics (Joukowsky)": mud_pressure_wave,
}
