"""Generalised-alpha on small systems: one oscillator, a mixed system, a turning spring, and its parameters.

Reference values: exact amplification of the linear oscillator, and computations with the published recurrence
(Arnold and Bruels 2007; Jansen, Whiting and Hulbert 2000) that were made apart from this code.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from drillpetsc.kernels import pointer
from drillpetsc.solvers.time.alpha_formula import AlphaFormula, AlphaHistory, AlphaOutputErrors, radius_of
from tests.helpers.tables import each_row

Rows = Callable[[float, np.ndarray, np.ndarray, np.ndarray], np.ndarray]


def try_step(history: AlphaHistory, t: float, h: float, rows: Rows) -> tuple[np.ndarray, ...]:
    """Try the step of ``h`` that ends at t: Newton on rows(t, x, y, w) = 0 with a difference Jacobian.

    Returns its state, which the caller keeps until the history has accepted the step.
    """
    n = len(history.error)
    v0, v1, x = np.empty((3, n))
    history.begin(h, *map(pointer, (v0, v1, x)))
    s, s2 = history.formula.shifts(h)

    def residual(x: np.ndarray) -> np.ndarray:
        y = s * x + v0
        return rows(t, x, y, s2 * y + v1)

    for _ in range(8):
        r, J = residual(x), np.zeros((n, n))
        for j in range(n):
            e = np.zeros(n)
            e[j] = 1e-6
            J[:, j] = (residual(x + e) - residual(x - e)) / 2e-6
        step = np.linalg.solve(J, r)
        x = x - step
        if np.abs(step).max() < 1e-13:
            break
    y = s * x + v0
    w = s2 * y + v1
    history.advance(h, *map(pointer, (x, y, w)))
    return x, y, w


def integrated(
    history: AlphaHistory, end: float, step: float, rows: Rows, pattern: tuple[float, ...] = (1.0,)
) -> AlphaHistory:
    """From 0 to ``end`` in steps of ``step`` times the numbers of ``pattern``, repeated."""
    t, k = 0.0, 0
    while t < end - 1e-9 * end:
        h = min(step * pattern[k % len(pattern)], end - t)
        if history.step == 0.0:
            _state = try_step(history, t + h, h, rows)
            history.lead_by_trial()
        _state = try_step(history, t + h, h, rows)
        history.accept()
        t, k = t + h, k + 1
    return history


# ---------------------------------------------------------------------- one oscillator
@each_row(
    ("radius", "product", "energy", "period"),
    [
        (1.0, 0.1, 0.0, 8.327785e-4), (1.0, 0.5, 0.0, 2.0497038e-2), (0.9, 0.1, -9.144405e-7, 8.431570e-4),
        (0.9, 0.5, -1.0971943e-4, 2.0751195e-2), (0.8, 0.1, -8.600957e-6, 8.790238e-4),
        (0.8, 0.5, -1.0236987e-3, 2.1623932e-2), (0.5, 0.1, -2.3142990e-4, 1.2480912e-3),
        (0.5, 0.5, -2.5282875e-2, 3.0147662e-2), (0.0, 0.1, -6.0511639e-3, 4.5007512e-3),
        (0.0, 0.5, -3.5170782e-1, 8.5786604e-2),
    ],
)  # fmt: skip
def test_oscillator_loses_energy_and_time_as_computed(radius, product, energy, period):
    """Energy change of a period and error of the period of x'' + x = 0 at angular frequency times step.

    The figures are those of the eigenvalues of the 3 x 3 amplification matrix of Chung and Hulbert (1993) in position, rate and acceleration,
    their alphas as functions of the spectral radius, computed apart from this code; 1e-6.  A run then has the same factor.
    """
    formula = AlphaFormula(radius)
    factor = formula.amplification(product)
    steps = 2 * np.pi / abs(np.angle(factor))
    assert abs(factor) ** (2 * steps) - 1 == pytest.approx(energy, rel=1e-6, abs=1e-12)
    assert steps * product / (2 * np.pi) - 1 == pytest.approx(period, rel=1e-6)
    # a run has the same factor: the start of these exact histories excites the other eigenvectors hardly
    history = AlphaHistory(formula, np.array([True]))
    one, zero = np.array([1.0]), np.array([0.0])
    history.start(one, zero, -one, zero, -one)
    values = [integrated(history, 100 * product, product, lambda t, x, y, w: w + x).arrays["x"][0]]
    for _ in range(2):
        _state = try_step(history, 0.0, product, lambda t, x, y, w: w + x)
        history.accept()
        values.append(history.arrays["x"][0])
    # x_(n+1) - 2 Re(factor) x_n + |factor|^2 x_(n-1) = 0 for a pair of eigenvalues
    rest = values[2] - 2 * factor.real * values[1] + abs(factor) ** 2 * values[0]
    assert abs(rest) < 1e-9


# ---------------------------------------------------------------------- first-order unknowns beside the others
def mixed_rows(t: float, x: np.ndarray, y: np.ndarray, w: np.ndarray) -> np.ndarray:
    return np.array([w[0] + 4 * x[0] - x[1], y[1] + 3 * x[1] + y[0] - np.sin(t)])


def mixed(radius: float, step: float, pattern: tuple[float, ...] = (1.0,)) -> np.ndarray:
    """x, x', p at t = 2 of x'' + 4 x = p, p' + 3 p + x' = sin t."""
    history = AlphaHistory(AlphaFormula(radius), np.array([True, False]))
    zero = np.zeros(2)
    w = np.array([0.5 - 4.0, 0.0])
    history.start(np.array([1.0, 0.5]), np.array([0.0, -1.5]), w, zero, w)
    q = integrated(history, 2.0, step, mixed_rows, pattern).arrays
    return np.array([q["x"][0], q["y"][0], q["x"][1]])


def mixed_exact() -> np.ndarray:
    """The same by the matrix exponential of the linear system with sin t and cos t as further states."""
    from scipy.linalg import expm

    A = np.zeros((5, 5))  # x, v, p, sin, cos
    A[0, 1], A[1, 0], A[1, 2], A[2, 1], A[2, 2], A[2, 3], A[3, 4], A[4, 3] = 1, -4, 1, -1, -3, 1, 1, -1
    return (expm(2.0 * A) @ [1.0, 0.0, 0.5, 0.0, 1.0])[:3]


@pytest.mark.parametrize(
    ("radius", "errors"), [(0.8, (1.0561e-4, 1.0951e-4, 6.0396e-5)), (0.5, (1.5074e-4, 1.6638e-4, 8.6712e-5))]
)
def test_mixed_system_has_order_two_in_all_unknowns(radius, errors):
    exact = mixed_exact()
    coarse, fine = (np.abs(mixed(radius, h) - exact) for h in (0.01, 0.005))
    assert coarse == pytest.approx(errors, rel=0.02)
    assert coarse / fine == pytest.approx([4.0] * 3, rel=0.02)


@pytest.mark.parametrize("radius", [0.8, 0.5])
def test_order_two_with_steps_that_change(radius):
    """The shift of the algorithmic accelerations to their new lead keeps the order."""
    exact, pattern = mixed_exact(), (1.0, 1.0, 2.0, 2.0, 1.0, 0.5)
    coarse, fine = (np.abs(mixed(radius, h, pattern) - exact) for h in (0.005, 0.0025))
    assert np.log2(coarse / fine) == pytest.approx([2.0] * 3, abs=0.05)


def test_local_error_is_that_of_one_step():
    """The estimate against the error of a step from exact values, for both kinds of unknowns."""
    formula, h = AlphaFormula(0.8), 0.01
    history = AlphaHistory(formula, np.array([True, False]))
    zero, w = np.zeros(2), np.array([-3.5, 0.0])
    history.start(np.array([1.0, 0.5]), np.array([0.0, -1.5]), w, zero, w)
    integrated(history, 0.4, h, mixed_rows)
    _state = try_step(history, 0.4 + h, h, mixed_rows)
    history.accept()
    # third derivatives from the equations: x''' = p' - 4 x', p''' = -3 p'' - x''' - sin t
    x, y = history.arrays["x"], history.arrays["y"]
    t = 0.4 + 0.5 * h
    second = np.cos(t) - 3 * y[1] - (x[1] - 4 * x[0])
    thirds = np.array([y[1] - 4 * y[0], -3 * second - (y[1] - 4 * y[0]) - np.sin(t)])
    wanted = np.array(formula.error_constants) * h**3 * np.abs(thirds)
    assert np.abs(history.error) == pytest.approx(wanted, rel=0.05)


# ---------------------------------------------------------------------- a stiff spring that turns
def turning_energy(radius: float, per_turn: int, turns: int = 10) -> float:
    """Relative energy change of a mass that turns on a radial spring of 200 times the frequency of rotation."""
    stiffness = 200.0**2
    length = 1.0 - 1.0 / stiffness  # at rest; turning at 1 rad/s it is 1

    def force(x: np.ndarray) -> np.ndarray:
        r = np.hypot(*x)
        return stiffness * (r - length) * x / r

    history = AlphaHistory(AlphaFormula(radius), np.array([True, True]))
    x, v = np.array([1.0, 0.0]), np.array([0.0, 1.0])
    history.start(x, v, -x, v, -x)

    def energy(q: dict[str, np.ndarray]) -> float:
        return 0.5 * q["y"] @ q["y"] + 0.5 * stiffness * (np.hypot(*q["x"]) - length) ** 2

    before = energy(history.arrays)
    h = 2 * np.pi / per_turn
    after = energy(integrated(history, turns * per_turn * h, h, lambda t, x, y, w: w + force(x)).arrays)
    return after / before - 1


@pytest.mark.parametrize(
    ("radius", "per_turn", "change"),
    [
        (0.9, 50, -3.6e-5), (0.8, 50, -3.38e-4), (0.5, 50, -8.91e-3), (0.9, 100, -4.5e-6),
        (0.8, 100, -4.26e-5), (0.5, 100, -1.15e-3), (0.8, 200, -5.3e-6), (0.5, 200, -1.44e-4),
    ],
)  # fmt: skip
def test_turning_spring_loses_little_and_never_gains(radius, per_turn, change):
    """Forces at the end of the step: none of the false strain that the chord of a turning mass would give."""
    assert turning_energy(radius, per_turn) == pytest.approx(change, rel=0.05)


# ---------------------------------------------------------------------- parameters
@each_row("radius", [0.0, 0.3, 0.5, 0.8, 1.0])
def test_parameters_of_a_radius(radius):
    """Spectral radius at infinite frequency, order 2, one shift for both kinds of unknowns; PETSc's letters."""
    f = AlphaFormula(radius)
    assert abs(f.amplification(1e7)) == pytest.approx(radius, abs=2e-3)
    assert f.gamma == pytest.approx(0.5 - f.mean_mass + f.mean_force)
    first = (1 - f.mean_rate) / ((1 - f.mean_force) * f.gamma_rate * 0.01)
    assert f.shifts(0.01)[0] == pytest.approx(first)
    assert radius_of(1 - f.mean_mass, 1 - f.mean_force, f.gamma, f.beta) == pytest.approx(radius)


@each_row(
    ("parameters", "message"),
    [
        ((0.5, 0.3), "alpha_f"),
        ((0.9, 0.5), "alpha_m"),
        ((0.5, 0.5, 0.6), "order 1"),
        ((0.5, 0.5, 0.5, 0.3), "beta"),
    ],
)
def test_parameters_off_the_family_are_refused(parameters, message):
    with pytest.raises(ValueError, match=message):
        radius_of(*parameters)


def test_frequency_above_which_a_period_loses_one_per_cent():
    """Damping sets in at higher frequencies for larger radii, and nowhere at 1."""
    found = [AlphaFormula(radius).damped_product for radius in (0.0, 0.5, 0.8, 0.9)]
    assert all(p is not None for p in found) and found == sorted(found)  # type: ignore[type-var]
    assert AlphaFormula(1.0).damped_product is None


@each_row("radius", [0.0, 0.8, 1.0])
def test_local_error_of_a_cubic(radius):
    """Uneven times, values 2 t^3 and t^2: the third derivative is 12 and 0, and the error of a step 12 C h^3 with
    C = 1/12 + 3/8 ((1 - rho)/(1 + rho))^2; so it is by the weights of the four values (manual: eq-time-alpha-phase)."""
    times = np.array([0.0, 0.1, 0.25, 0.3, 0.5, 0.9])
    values = np.column_stack([2 * times**3, times**2])
    constant = 1 / 12 + 0.375 * ((1 - radius) / (1 + radius)) ** 2
    expected = np.column_stack([12 * constant * np.diff(times)[2:] ** 3, np.zeros(3)])
    errors = AlphaOutputErrors(AlphaFormula(radius))
    assert errors.local_errors(times, values) == pytest.approx(expected, rel=1e-9, abs=1e-12)
    weights = [errors.weights(times[k : k + 4].tolist()) @ values[k : k + 4] for k in range(3)]
    assert np.array(weights) == pytest.approx(expected, rel=1e-9, abs=1e-12)


@each_row("radius", [0.0, 0.3, 1.0])
def test_error_of_a_position_in_a_step(radius):
    """x = t^3 with accelerations 6 t that lead: the formula misses it by C h^3 times the third derivative; 1/12 of the trapezoidal rule."""
    q, t, h = AlphaFormula(radius), 0.7, 0.2
    earlier, later = (6 * (end + q.lead * h) for end in (t, t + h))
    moved = t**3 + h * 3 * t**2 + h**2 * ((0.5 - q.beta) * earlier + q.beta * later)
    assert abs((t + h) ** 3 - moved) == pytest.approx(6 * h**3 * q.error_constants[0], rel=1e-9)
    if radius == 1.0:
        assert q.error_constants[0] == pytest.approx(1 / 12)


@each_row("radius", [0.0, 0.8, 1.0])
def test_error_of_a_first_order_unknown_over_uneven_steps(radius):
    """t^3 over steps of 0.1 and 0.25: the error of the second is C h^3 times the third derivative, 6."""
    formula = AlphaFormula(radius)
    history, t, zero = AlphaHistory(formula, np.array([False])), 0.3, np.zeros(1)
    history.start(np.array([t**3]), np.array([3 * t**2]), zero, zero, zero)
    for step in (0.1, 0.25):
        t += step
        state = np.array([t**3]), np.array([3 * t**2]), zero
        history.advance(step, *map(pointer, state))
        error = abs(history.error[0])
        history.accept()
    assert error == pytest.approx(6 * formula.error_constants[1] * 0.25**3, rel=1e-9)


def test_a_jump_at_the_start_is_a_start_after_it():
    """Of unknowns of second and of first order: every row of the history."""
    formula, two = AlphaFormula(0.6), np.array([True, False])
    x, y, w, rate, second, change, more = np.random.default_rng(3).standard_normal((7, 2))
    jumped, begun = AlphaHistory(formula, two), AlphaHistory(formula, two)
    jumped.start(x, y, w, rate, second)
    jumped.jump(change, more)
    begun.start(x, y + np.where(two, 0.0, change), w + change, rate, second + more)
    assert jumped.values == pytest.approx(begun.values, abs=1e-14)
