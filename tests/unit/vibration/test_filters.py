"""Filters of sensors against Butterworth's gain and analytic responses (manual: sec-vibration-filter)."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc.vibration import butterworth
from tests.helpers.tables import each_row


@pytest.mark.parametrize(("order", "cutoff", "tone", "gain"), [(2, 200, 300, 0.40614), (4, 100, 60, 0.99171)])
def test_gain_of_a_tone(order, cutoff, tone, gain):
    """C29: gains 1/sqrt(1 + (f/fc)^(2n)), of the formula and of a filtered tone, within 1 %."""
    assert butterworth(order, cutoff).gain(tone) == pytest.approx(gain, rel=1e-5)
    t = np.arange(0, 40.25 / tone + 0.05, 1 / (64 * tone))
    f = butterworth(order, cutoff)
    out, _ = f.run(t, np.sin(2 * np.pi * tone * t)[:, None], f.at_rest(1))
    late = out[t > 0.05, 0]
    assert np.abs(late).max() == pytest.approx(gain, rel=1e-2)


@each_row("order", range(1, 11))
def test_gain_of_every_order(order):
    """At 0, at the cutoff and at ten times the cutoff; the weights sum up to 1."""
    f = butterworth(order, 50.0)
    assert np.sum(f.weights) == pytest.approx(1.0, abs=1e-9)
    frequency = np.array([0.0, 50.0, 500.0])
    assert f.gain(frequency) == pytest.approx(1 / np.sqrt(1 + (frequency / 50) ** (2 * order)), rel=1e-5)
    assert np.all(f.poles.real < 0)


def test_a_ramp_is_exact_at_any_steps():
    """First order: the response to u = t from rest is t - T (1 - exp(-t/T)), T = 1/(2 pi fc), whatever the steps."""
    f, period = butterworth(1, 2.0), 1 / (4 * np.pi)
    t = np.array([0.0, 0.3, 0.30001, 0.5, 2.0])
    out, _ = f.run(t, t[:, None], f.at_rest(1))
    assert out[:, 0] == pytest.approx(t - period * (1 - np.exp(-t / period)), abs=1e-14)


def test_a_series_may_be_divided_anywhere():
    """The results are the same to the last bit."""
    t = np.cumsum(np.random.default_rng(1).uniform(1e-4, 1e-2, 200))
    u = np.random.default_rng(2).normal(size=(200, 3))
    f = butterworth(4, 30.0)
    whole, end = f.run(t, u, f.at_rest(3))
    first, state = f.run(t[:81], u[:81], f.at_rest(3))
    second, last = f.run(t[80:], u[80:], state)
    assert np.array_equal(np.vstack([first, second[1:]]), whole)
    assert np.array_equal(last, end)


def test_refused():
    """An order or a cutoff of 0 is no filter."""
    for order, cutoff in ((0, 1.0), (2, 0.0)):
        with pytest.raises(ValueError):
            butterworth(order, cutoff)
