"""Pressure waves in the bore and the annulus of a fixed string (manual: verif-joukowsky,
verif-hammer-with-friction, verif-area-step).

Without friction p and q obey the wave equation with c = sqrt(E_e/rho), 1/E_e = 1/K + d(ln A)/dp, and a change
of flow rate dq emits rho c dq/A (Joukowsky). Instantaneous changes take one time step. The flow speed of
small waves is 1e-6 of c here.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import eigvals
from scipy.special import ive

from drillpetsc import Case, run
from tests.helpers.motion import integrate
from tests.helpers.moving import matrices
from tests.helpers.mud import (
    BORE,
    DENSITY,
    HOLE,
    INNER,
    LENGTH,
    OUTER,
    annulus,
    bore,
    friction,
    history,
    loop,
    started,
)

MODULUS = 2.2e9
SPEED = np.sqrt(MODULUS / DENSITY)  # 1354 m/s
STIFF = {"bulk_modulus": MODULUS, "elastic_walls": False}
SMALL = 1e-5  # flow rate of waves that are linear [m3/s]
YOUNG, NU = 206e9, 0.3


def lame_bore(ro: float, ri: float) -> float:
    """d(ln A)/dp of the bore of a thick tube with fixed axial strain: (D/E e) [2 e/D (1 + nu) + D (1 - nu^2)/(D + e)] with
    bore D and wall e (Wylie and Streeter, Fluid Transients in Systems, 1993: anchored throughout)."""
    D, e = 2 * ri, ro - ri
    return D / (YOUNG * e) * (2 * e / D * (1 + NU) + D * (1 - NU**2) / (D + e))


def ramp(x, T: float) -> np.ndarray:
    """Half a cosine from 0 to 1 over T."""
    return np.sin(0.5 * np.pi * np.clip(np.asarray(x) / T, 0.0, 1.0)) ** 2


def passing(t: np.ndarray, p: np.ndarray, level: float) -> float:
    """First time at which p passes a level, by linear interpolation."""
    k = int(np.argmax(np.sign(level) * p >= abs(level)))
    return float(t[k - 1] + (level - p[k - 1]) * (t[k] - t[k - 1]) / (p[k] - p[k - 1]))


def nearest(model, depth: float) -> int:
    return int(np.argmin(np.abs(model.mesh.node_depth - depth)))


# ---------------------------------------------------------------------- Joukowsky
@pytest.mark.parametrize("elastic", [False, True])
def test_pump_stopped_within_one_step(elastic):
    """30 l/s, then none, 100 elements and 2 ms: the pressure at the pump falls by rho c dq/A until 2L/c, mean
    of the middle half within 0.15 %; then it rises by as much, because the open end reverses the wave
    (manual: verif-joukowsky).

    The increase of stiffness with pressure, p/4K, is 0.06 %. Rigid bore 1354 m/s; elastic one by Lame's
    coefficient 1271.8 m/s. The jump causes oscillations that remain bounded.
    """
    c = np.sqrt(1 / (DENSITY * (1 / MODULUS + elastic * lame_bore(OUTER / 2, INNER / 2))))
    assert c == pytest.approx(1271.759 if elastic else 1354.006, rel=1e-5)
    q, t0, T = 0.03, 0.05, LENGTH / c
    model = bore({**STIFF, "elastic_walls": elastic, "flow_rate": {"time": [t0, t0], "value": [q, 0.0]}}, 100)
    t, p, _ = history(model, t0 + 4 * T, 2e-3)
    step = DENSITY * c * q / BORE
    for first, sign in ((0.0, -1.0), (2.0, 1.0)):
        plateau = (t > t0 + (first + 0.5) * T) & (t < t0 + (first + 1.5) * T)
        assert p[plateau, 0].mean() == pytest.approx(sign * step, rel=1.5e-3)
        assert p[plateau, 0].std() < 0.03 * step
    assert np.abs(p).max() < 1.6 * step


def test_front_of_a_loop_with_friction():
    """Pump of the HB loop at 30 l/s stopped within a step, default steps: the pressure drops by rho c dq/A
    (52 bar at 1345 m/s), then falls at the rate g c/2, with g the friction per length of the flow ahead of
    the front (characteristics; no friction behind it): mean over .1 to .3 s within 1 % (manual:
    verif-hammer-with-friction).

    No step fails; the pressure never exceeds the steady pressures by more than rho c dq/A.
    """
    q, t0 = 0.03, 0.1
    model = started(loop({"bulk_modulus": 2.5e9, "flow_rate": {"time": [t0, t0], "value": [q, 0.0]}}, 100))
    c = np.sqrt(1 / (DENSITY * (1 / 2.5e9 + lame_bore(OUTER / 2, INNER / 2))))
    assert c == pytest.approx(1344.940, rel=1e-6)
    step = DENSITY * c * q / BORE
    assert step == pytest.approx(52.28e5, rel=1e-3)
    place = model.system.layout.dofs["bore.pressure"][:, 0]
    p0, rows = model.system.assembly.x[place].copy(), []
    run = integrate(
        model.system, 6.0, {}, lambda t, dt: rows.append((t, *model.system.assembly.x[place])), model.breaks
    )
    t, p = np.array(rows)[:, 0], np.array(rows)[:, 1:]
    k = (t > t0 + 0.1) & (t < t0 + 0.3)
    drop = np.sum(0.5 * np.diff(t[k]) * (p0[0] - p[k, 0][1:] + p0[0] - p[k, 0][:-1])) / (t[k][-1] - t[k][0])
    assert drop == pytest.approx(step + friction(q, BORE, INNER, False) * c * 0.2 / 2, rel=0.01)
    assert np.abs(p[t < t0] - p0).max() < 1.0
    assert (p - p0).max() < step
    assert run.failure_count() == 0


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_check_valve_reflects_a_fall_and_lets_a_rise_out(sign):
    """Pressure at the top of the bore over an open end changed by P within one step.  A fall finds the valve shut: 2 P there from L/c
    to 3L/c, and no flow; a rise finds it open: no pressure, and a flow of 2 P A/(rho c) (manual: verif-joukowsky)."""
    P, t0, T = sign * DENSITY * SPEED * SMALL / BORE, 0.05, LENGTH / SPEED
    step = {"time": [t0, t0], "value": [0.0, P]}
    model = bore({**STIFF, "pump_pressure": step, "check_valve": True}, 100)
    t, p, q = history(model, t0 + 2.9 * T, 2e-3)
    plateau = (t > t0 + 1.5 * T) & (t < t0 + 2.5 * T)
    expected = (2 * P, 0.0) if sign < 0 else (0.0, 2 * SMALL)
    assert p[plateau, -1].mean() == pytest.approx(expected[0], rel=1.5e-3, abs=1e-3 * abs(P))
    assert q[plateau, -1].mean() == pytest.approx(expected[1], rel=1.5e-3, abs=1e-3 * SMALL)


def test_volume_pumped_into_a_closed_string(tmp_path):
    """25 MPa in a plugged string without weight: its bore takes A L [exp(p/K) (1 + 2 e_hoop)(1 + e_axial) - 1], with Lame's strains of
    a tube with closed ends, and it stretches by e_axial L. The mud in the bore stretches the string and shrinks with its Poisson strain (manual:
    verif-closed-string).
    """
    p, length = 25e6, 400.0
    ri, ro = 0.0543, 0.0635
    case = Case(
        string=[{"kind": "pipe", "length": length, "od": 2 * ro, "id": 2 * ri, "element_length": 50.0}],
        top="clamped",
        bottom={"kind": "free", "plugged": True},
        gravity=0.0,
        material={"young": YOUNG, "poisson": NU},
        fluid={
            "density": DENSITY,
            "bulk_modulus": MODULUS,
            "rheology": {"model": "newtonian", "viscosity": 0.005},
            "pump_pressure": {"time": [0.0, 100.0], "value": [0.0, p]},
        },
        initial={"imperfection": 0.0},
        time={"mode": "quasi_static", "end": 100.0},
    )
    summary = run(case, tmp_path / "closed").summary
    steel = ro**2 - ri**2
    hoop, along = p * (ri**2 + ro**2) / steel, p * ri**2 / steel  # at the bore, where the radial stress is -p
    around, axial = (hoop - NU * (along - p)) / YOUNG, (along - NU * (hoop - p)) / YOUNG
    volume = np.pi * ri**2 * length * (np.exp(p / MODULUS) * (1 + 2 * around) * (1 + axial) - 1)
    assert summary["mass"]["content_change"] == pytest.approx(volume, rel=1e-4)
    assert summary["final"]["bit_depth [m]"] - length == pytest.approx(axial * length, rel=1e-3)


# ---------------------------------------------------------------------- arrival


def test_arrival_of_a_half_cosine():
    """Pump started over .3 L/c: 50 % level in the middle L/2c after that of the ramp; 50 elements and 4 ms
    within 0.05 %, 100 and 2 within 0.02 %."""
    T = 0.3 * LENGTH / SPEED
    for n, dt, most in ((50, 4e-3, 5e-4), (100, 2e-3, 2e-4)):
        model = bore({**STIFF, "flow_rate": {"ramp": T, "value": SMALL}}, n)
        t, p, _ = history(model, 1.2, dt)
        late = (passing(t, p[:, n // 2], 0.5 * DENSITY * SPEED * SMALL / BORE) - T / 2) / (
            0.5 * LENGTH / SPEED
        ) - 1
        assert abs(late) < most


WALLS: dict[str, tuple[dict, float]] = {
    "rigid": ({}, 1395.190),
    "rock": ({"compliance": {"young": 20e9, "poisson": 0.25}}, 1160.055),
}


@pytest.mark.parametrize("wall", WALLS)
def test_wave_speed_of_the_annulus(wall: str):
    """Pressure at the flow line raised by half a cosine over .3 L/c, string plugged and empty, K 2.5 GPa: 50
    % level in the middle after L/2c + half the ramp within 0.1 %, then doubled by the closed lower end until
    3L/c, within 0.5 % (manual: verif-annulus-wave-speed).

    c of steel pipe in a rigid hole and in rock (20 GPa, .25): 1395.190 and 1160.055 m/s (Lame at fixed length; manual:
    eq-mud-wall-annulus).
    """
    section, c = WALLS[wall]
    ro, ri, rw = OUTER / 2, INNER / 2, HOLE / 2
    rock = rw**2 * 1.25 / 20e9 if wall == "rock" else 0.0
    give = 2 / (rw**2 - ro**2) * (rock + ro**2 / YOUNG * (2 * (1 - NU**2) * ro**2 / (ro**2 - ri**2) - 1 - NU))
    assert np.sqrt(1 / (DENSITY * (1 / 2.5e9 + give))) == pytest.approx(c, rel=1e-6)
    T, n = 0.3 * LENGTH / c, 100
    model = annulus({"bulk_modulus": 2.5e9, "outlet_pressure": {"ramp": T, "value": 1e4}}, n, **section)
    t, p, _ = history(model, 2.9 * LENGTH / c, 2e-3, "annulus")
    late = (passing(t, p[:, n // 2], 5e3) - T / 2) / (0.5 * LENGTH / c) - 1
    assert abs(late) < 1e-3
    plateau = (t > 1.5 * LENGTH / c) & (t < 2.8 * LENGTH / c)
    assert p[plateau, -1] == pytest.approx(2e4, rel=5e-3)


def test_reflection_at_an_open_end():
    """Pump started by half a cosine over .3 L/c, lower end open: rho c dq/A at the pump until 2L/c, the
    opposite until 4L/c, again until 6L/c; the flow at the open end is doubled from L/c to 3L/c, and zero
    until 5L/c. 1 % in the middle of each plateau (manual: verif-wave-reflections)."""
    T, L = 0.3 * LENGTH / SPEED, LENGTH / SPEED
    model = bore({**STIFF, "flow_rate": {"ramp": T, "value": SMALL}}, 100)
    t, p, q = history(model, 6 * L, 2e-3)
    step = DENSITY * SPEED * SMALL / BORE
    for k, sign in enumerate((1, -1, 1)):
        middle = (t > (2 * k + 0.6) * L) & (t < (2 * k + 1.8) * L)
        assert p[middle, 0] == pytest.approx(sign * step, rel=0.01)
    for k, value in enumerate((2, 0)):
        middle = (t > (2 * k + 1.6) * L) & (t < (2 * k + 2.8) * L)
        assert q[middle, -1] / SMALL == pytest.approx(value, abs=0.01)


# ---------------------------------------------------------------------- ends and steps


def test_reflection_at_a_closed_end():
    """Plugged bore, pump pressure raised by half a cosine over .3 L/c: doubled under the plug from L/c to
    3L/c, zero until 5L/c; flow into the bore p A/(rho c) until 2L/c, the opposite until 4L/c. 1 % (manual:
    verif-wave-reflections)."""
    T, L, p0 = 0.3 * LENGTH / SPEED, LENGTH / SPEED, 1e4
    model = bore({**STIFF, "pump_pressure": {"ramp": T, "value": p0}}, 100, plugged=True)
    t, p, q = history(model, 5 * L, 2e-3)
    for k, value in enumerate((2, 0)):
        middle = (t > (2 * k + 1.6) * L) & (t < (2 * k + 2.8) * L)
        assert p[middle, -1] / p0 == pytest.approx(value, abs=0.01)
    for k, sign in enumerate((1, -1)):
        middle = (t > (2 * k + 0.6) * L) & (t < (2 * k + 1.8) * L)
        assert q[middle, 0] == pytest.approx(sign * p0 * BORE / (DENSITY * SPEED), rel=0.01)


@pytest.mark.parametrize(("upper", "lower"), [(0.0093, 0.0040), (0.0040, 0.0093)])
def test_step_of_the_bore(upper, lower):
    """Bore of .0093 over .0040 m2, and the reverse: of a wave p, 2 A1/(A1 + A2) p is transmitted (1.3985) and
    (A1 - A2)/(A1 + A2) p reflected (.3985); half a cosine over 0.15 L/c, 200 elements, 0.2 % beside the step
    and in the middle of each half (manual: verif-area-step)."""
    half, T = 0.5 * LENGTH, 0.15 * LENGTH / SPEED
    inner = np.sqrt(4 / np.pi * np.array([upper, lower]))
    pipes = [
        {"kind": "pipe", "length": half, "od": 0.1715, "id": float(d), "element_length": 10.0} for d in inner
    ]
    model = bore({**STIFF, "flow_rate": {"ramp": T, "value": SMALL}}, 200, string=pipes)
    t, p, _ = history(model, 1.45 * LENGTH / SPEED, 1e-3)
    incident, t = DENSITY * SPEED * SMALL / upper, t * SPEED / LENGTH
    sent, back = 2 * upper / (upper + lower), (upper - lower) / (upper + lower)
    place = {depth: nearest(model, depth) for depth in (0.25 * LENGTH, half, half + 10.0, 0.75 * LENGTH)}
    for depth, first, last, value in (
        (0.25, 0.45, 0.7, 1.0),
        (0.5, 0.7, 1.4, sent),
        (0.75, 0.95, 1.2, sent),
        (0.25, 0.95, 1.2, 1 + back),
    ):
        seen = p[(t > first) & (t < last), place[depth * LENGTH]] / incident
        assert seen == pytest.approx(value, rel=2e-3)
    seen = p[(t > 0.75) & (t < 1.35), place[half + 10.0]] / incident
    assert seen == pytest.approx(sent, rel=2e-3)


# ---------------------------------------------------------------------- friction
def test_line_packing_by_linear_friction():
    """Laminar Newtonian flow (200 mPa s) started by half a cosine: until 2L/c the line is infinite for the
    pump.

    Telegraph equation: the pressure of a unit step of flow is Z e^(-bt/2) [(1 + b t) I0(bt/2) + b t
    I1(bt/2)], Z = rho c/A, b = 32 mu/(rho d^2) (inverse of sqrt(s + b)/s^(3/2)); it increases by a half in
    2L/c. Within 0.1 % of rho c dq/A.
    """
    mu, T, L = 0.2, 0.3 * LENGTH / SPEED, LENGTH / SPEED
    b, flow = 32 * mu / (DENSITY * INNER**2), 1e-4
    model = bore(
        {
            **STIFF,
            "rheology": {"model": "newtonian", "viscosity": mu},
            "flow_rate": {"ramp": T, "value": flow},
        },
        100,
    )
    t, p, _ = history(model, 2 * L, 2e-3)
    x, w = np.polynomial.legendre.leggauss(40)
    rise, share = (
        0.5 * T * (x + 1),
        0.25 * np.pi * np.sin(0.5 * np.pi * (x + 1)) * w,
    )  # half the cosine's rate at these times
    late = np.clip(t[:, None] - rise, 0.0, None) * b
    answer = np.where(late > 0, (1 + late) * ive(0, late / 2) + late * ive(1, late / 2), 0.0)
    after = (t > T) & (t < 1.95 * L)  # earlier, the points of the rule do not resolve the ramp
    exact = DENSITY * SPEED / BORE * flow * (answer @ share)
    assert exact[-1] > 1.4 * DENSITY * SPEED / BORE * flow
    assert p[after, 0] == pytest.approx(exact[after], abs=1e-3 * DENSITY * SPEED / BORE * flow)


# ---------------------------------------------------------------------- orders
def test_frequencies_of_a_bore_between_pressure_and_plug():
    """Quarter waves, 40 elements: the dispersion of the averaged compliance h/12 (1, 10, 1) is omega h/2c =
    s/sqrt(1 - s^2/3), s = sin(k h/2), of fourth order: modes 3, 11, 21 in error by -3.1e-6, -9.9e-4, -1.5e-2;
    the closed form within 1e-8 (manual: eq-mud-dispersion)."""
    n = 40
    model = started(bore({**STIFF, "pump_pressure": 0.0}, n, plugged=True))
    K, C, _ = matrices(model.system)
    s = eigvals(K, -C)
    found = np.sort(s[np.isfinite(s) & (s.imag > 1e-9)].imag)
    angle = np.pi * (np.arange(1, n + 1) - 0.5) / n  # kappa h
    sine = np.sin(0.5 * angle)
    assert found == pytest.approx(2 * SPEED * n / LENGTH * sine / np.sqrt(1 - sine**2 / 3), rel=1e-8)
    assert np.abs(s[np.isfinite(s)].real).max() < 1e-9 * found[-1]
    error = found / (angle * SPEED * n / LENGTH) - 1
    assert error[[2, 10, 20]] == pytest.approx([-3.1e-6, -9.9e-4, -1.5e-2], rel=0.03)


def test_second_order_in_space():
    """Half a cosine over .3 L/c passing the middle, steps of 0.5 ms: the rms error against p(t - x/c)
    decreases by 4 from mesh to mesh (a fourth-order scheme for a wave whose second derivative jumps: h^(4 *
    2.5/5))."""
    T, errors = 0.3 * LENGTH / SPEED, []
    for n in (16, 32, 64):
        model = bore({**STIFF, "flow_rate": {"ramp": T, "value": SMALL}}, n)
        t, p, _ = history(model, 1.2, 5e-4)
        e = p[:, n // 2] / (DENSITY * SPEED * SMALL / BORE) - ramp(t - 0.5 * LENGTH / SPEED, T)
        errors.append(np.sqrt(np.mean(e**2)))
    order = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all(order > 1.9)
    assert errors[-1] < 1e-3


def test_second_order_in_time():
    """Half a cosine over .303 L/c, 20 elements, steps of 8, 4, 2, 1 ms: differences between one step length
    and the next decrease by 4 at L/c, 1.48 s, long after the ramp."""
    T, at = 0.448, []
    for dt in (8e-3, 4e-3, 2e-3, 1e-3):
        model = bore({**STIFF, "flow_rate": {"ramp": T, "value": SMALL}}, 20)
        _, p, _ = history(model, 1.48, dt)
        at.append(p[-1])
    gaps = [np.linalg.norm(a - b) for a, b in zip(at, at[1:], strict=False)]
    order = np.log2(np.array(gaps[:-1]) / gaps[1:])
    assert np.all(np.abs(order - 2) < 0.2)
