"""Time functions: integral against closed forms, derivative of the integral, limits at jumps."""

import math
import pickle

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from drillpetsc.time_function import Constant, PiecewiseLinear, Ramp, TimeFunction
from tests.helpers.tables import each_row

moment = st.floats(-50, 50)
number = st.floats(-100, 100)


@st.composite
def tables(draw: st.DrawFn) -> PiecewiseLinear:
    """Tables with steps of at least 0.01 s and with jumps."""
    times, t = [], draw(st.floats(-20, 20))
    for _ in range(draw(st.integers(1, 6))):
        times.extend([t] * draw(st.integers(1, 2)))
        t += draw(st.floats(0.01, 10))
    return PiecewiseLinear(tuple(times), tuple(draw(number) for _ in times))


ramps = st.builds(Ramp, st.floats(0.01, 20), number)
functions = st.one_of(st.builds(Constant, number), tables(), ramps)


def gauss(function: TimeFunction, a: float, b: float) -> float:
    """Two-point Gauss rule on [a, b], exact for cubics."""
    middle, half = (a + b) / 2, (b - a) / 2
    return half * sum(function.value(middle + sign * half / math.sqrt(3)) for sign in (-1, 1))


def smooth_around(function: TimeFunction, t: float, width: float) -> bool:
    return all(abs(t - t_break) > width for t_break in function.breaks())


@given(functions, moment)
def test_rate_is_the_derivative_of_the_value(function: TimeFunction, t: float) -> None:
    h = 1e-4
    assume(smooth_around(function, t, 2 * h))
    difference = (function.value(t + h) - function.value(t - h)) / (2 * h)
    # error of the difference: h^2/6 times the third derivative, at most 100/2 (pi/0.01)^3 for the ramp, and
    # rounding
    scale = 100 / 2 * (math.pi / function.duration) ** 3 if isinstance(function, Ramp) else 0.0
    assert function.rate(t) == pytest.approx(difference, abs=scale * h**2 / 6 + 1e-9)


@given(functions, moment)
def test_value_is_the_derivative_of_the_integral(function: TimeFunction, t: float) -> None:
    h = 1e-4
    assume(smooth_around(function, t, 2 * h))
    difference = (function.integral(t + h) - function.integral(t - h)) / (2 * h)
    scale = 100 / 2 * (math.pi / function.duration) ** 2 if isinstance(function, Ramp) else 0.0
    assert function.value(t) == pytest.approx(difference, abs=scale * h**2 / 6 + 1e-7)


@given(tables(), moment)
def test_integral_of_a_table_is_the_gauss_sum_over_its_pieces(table: PiecewiseLinear, t: float) -> None:
    a, b = min(0.0, t), max(0.0, t)
    cuts = [a, *(x for x in sorted(set(table.times)) if a < x < b), b]
    area = sum(gauss(table, x, y) for x, y in zip(cuts, cuts[1:], strict=False))
    assert table.integral(t) == pytest.approx(area if t > 0 else -area, abs=1e-9)


@given(functions)
def test_integral_starts_at_time_zero(function: TimeFunction) -> None:
    assert function.integral(0.0) == 0.0


@given(functions, moment)
def test_left_and_right_values_differ_only_at_jumps(function: TimeFunction, t: float) -> None:
    for time in (t, *function.breaks()):
        assert (function.value(time) == function.value(time, before=True)) or time in function.jumps()


@given(tables(), moment)
def test_a_table_stays_in_the_range_of_its_values(table: PiecewiseLinear, t: float) -> None:
    slack = 1e-13 * max(map(abs, table.values))
    assert min(table.values) - slack <= table.value(t) <= max(table.values) + slack


@given(functions)
def test_jumps_are_breaks(function: TimeFunction) -> None:
    assert set(function.jumps()) <= set(function.breaks())
    assert list(function.breaks()) == sorted(set(function.breaks()))


def test_a_ramp_is_half_a_cosine() -> None:
    """80 rpm in 2 s: value (1 - cos)/2, angle turned in the ramp half of full speed, then at full speed."""
    speed = 80 * 2 * math.pi / 60
    ramp = Ramp(2.0, speed)
    assert ramp.value(-1.0) == ramp.value(0.0) == ramp.rate(0.0) == 0.0
    assert ramp.value(0.5) == pytest.approx(speed * (1 - math.cos(math.pi / 4)) / 2, rel=1e-15)
    assert ramp.value(1.0) == pytest.approx(speed / 2, rel=1e-15)
    assert ramp.rate(1.0) == pytest.approx(speed * math.pi / 4, rel=1e-15)
    assert ramp.value(2.0) == ramp.value(7.0) == speed
    assert ramp.rate(2.0) == 0.0
    assert ramp.integral(1.0) == pytest.approx(speed * (0.5 - 1 / math.pi), rel=1e-14)
    assert ramp.integral(2.0) == pytest.approx(speed, rel=1e-15)
    assert ramp.integral(5.0) == pytest.approx(4 * speed, rel=1e-15)
    assert ramp.integral(-3.0) == 0.0
    assert ramp.breaks() == (0.0, 2.0)
    assert ramp.jumps() == ()


def test_a_time_that_stands_twice_is_a_jump() -> None:
    table = PiecewiseLinear((0.0, 1.0, 1.0, 3.0), (2.0, 4.0, -1.0, 1.0))
    assert table.value(1.0, before=True) == 4.0
    assert table.value(1.0) == -1.0
    assert table.rate(1.0, before=True) == 2.0
    assert table.rate(1.0) == 1.0
    assert table.value(-5.0) == 2.0
    assert table.value(9.0) == 1.0
    assert table.jumps() == (1.0,)
    assert table.breaks() == (0.0, 1.0, 3.0)
    assert table.integral(1.0) == 3.0
    assert table.integral(2.0) == 3.0 - 0.5
    assert table.integral(5.0) == 3.0 + 0.0 + 2.0
    assert table.integral(-2.0) == -4.0


def test_a_point_on_a_straight_line_is_no_break() -> None:
    assert PiecewiseLinear((0.0, 1.0, 2.0), (0.0, 1.0, 2.0)).breaks() == (0.0, 2.0)
    assert PiecewiseLinear((0.0, 1.0), (3.0, 3.0)).breaks() == ()
    assert Constant(3.0).breaks() == ()


def test_integral_of_a_table_that_starts_late() -> None:
    table = PiecewiseLinear((10.0, 12.0), (1.0, 3.0))
    assert table.integral(10.0) == 10.0
    assert table.integral(12.0) == 14.0


@each_row(
    ("times", "values"),
    [((), ()), ((0.0, 1.0), (1.0,)), ((1.0, 0.0), (1.0, 2.0)), ((1.0, 1.0, 1.0), (1.0, 2.0, 3.0))],
)
def test_refused_tables(times: tuple[float, ...], values: tuple[float, ...]) -> None:
    with pytest.raises(ValueError):
        PiecewiseLinear(times, values)


def test_a_ramp_takes_time() -> None:
    with pytest.raises(ValueError):
        Ramp(0.0, 1.0)


@given(functions)
def test_frozen_equal_and_pickled(function: TimeFunction) -> None:
    assert pickle.loads(pickle.dumps(function)) == function
    assert hash(function) == hash(pickle.loads(pickle.dumps(function)))
    with pytest.raises(AttributeError):
        function.constant = 1.0  # type: ignore[union-attr, misc]
