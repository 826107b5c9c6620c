"""Spectra against tones and Parseval's theorem (manual: sec-vibration-spectra)."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc import vibration


def test_order_of_a_ramp():
    """C29: a tone of 3 x in a ramp from 60 to 180 rpm in 60 s has its ridge at 3.00 +- 0.02 throughout."""
    t = np.arange(0, 60, 1e-3)
    speed = (60 + 2 * t) * np.pi / 30
    found = vibration.order_map(t, 2 * np.sin(3 * vibration.turned_angle(t, speed)), speed, 16)
    assert found.time[0] < 8 and found.time[-1] > 55
    assert vibration.ridge(found, 0.5, 10) == pytest.approx(3.0, abs=0.02)
    assert found.amplitude.max() == pytest.approx(2.0, rel=1e-3)


def test_two_orders_at_a_coarse_rate():
    """25 values in a second, tones of 1 x and 2.5 x between 60 and 120 rpm: both amplitudes within 2 %."""
    t = np.arange(0, 80, 0.02)
    speed = (1.5 + 0.5 * np.sin(2 * np.pi * t / 40)) * 2 * np.pi
    angle = vibration.turned_angle(t, speed)
    found = vibration.order_map(t, np.sin(angle) + 0.5 * np.sin(2.5 * angle), speed, 20)
    for order, size in ((1.0, 1.0), (2.5, 0.5)):
        line = np.argmin(np.abs(found.frequency - order))
        assert found.amplitude[:, line] == pytest.approx(size, rel=2e-2)


def test_tone_in_a_spectrogram():
    """Amplitude and frequency of a tone between two lines."""
    t = np.arange(0, 10, 1e-3)
    found = vibration.spectrogram(t, 5 + 3 * np.sin(2 * np.pi * 40.0 * t), 1.0)
    assert vibration.ridge(found, 5, 400) == pytest.approx(40.0, abs=1e-3)
    assert found.amplitude.max() == pytest.approx(3.0, rel=1e-3)
    between = vibration.spectrogram(t, 3 * np.sin(2 * np.pi * 40.4 * t), 1.0)
    assert vibration.ridge(between, 5, 400) == pytest.approx(40.4, abs=0.05)


def test_power_is_the_variance():
    """The integral of the density of noise is its variance (Parseval); that of a tone is half its amplitude squared."""
    t = np.arange(0, 100, 1e-3)
    noise = np.random.default_rng(3).normal(size=len(t))
    frequency, density = vibration.power_density(t, noise)
    assert np.sum(density) * frequency[1] == pytest.approx(np.var(noise), rel=1e-2)
    frequency, density = vibration.power_density(t, 3 * np.sin(2 * np.pi * 50 * t))
    assert np.sum(density) * frequency[1] == pytest.approx(4.5, rel=1e-3)


def test_a_segment_sets_the_lines():
    """Lines of a segment of 2 s are 0.5 Hz apart; a tone on one of them has its power within the two beside it (Hann's window)."""
    t = np.arange(0, 100, 1e-3)
    frequency, density = vibration.power_density(t, 3 * np.sin(2 * np.pi * 50 * t), 2.0)
    assert frequency[1] == pytest.approx(0.5) and len(frequency) == 1001
    near = np.abs(frequency - 50) < 0.75
    assert np.sum(near) == 3 and np.sum(density[near]) * frequency[1] == pytest.approx(4.5, rel=1e-6)


def test_uneven_and_short_series():
    """Rows of a history that are not even are made so; a run shorter than a segment is one segment."""
    t = np.cumsum(np.random.default_rng(4).uniform(0.8e-3, 1.2e-3, 4000))
    found = vibration.spectrogram(t, np.sin(2 * np.pi * 7 * t), 2.0)
    assert vibration.ridge(found, 1, 100) == pytest.approx(7.0, abs=0.05)
    assert len(vibration.spectrogram(t[:50], np.sin(t[:50]), 10.0).time) == 1
    with pytest.raises(ValueError, match="at least 4 values"):
        vibration.spectrogram(t[:3], t[:3])
    with pytest.raises(ValueError, match="4 revolutions"):
        vibration.order_map(t, t, np.zeros(len(t)))


def test_order_map_of_stick_slip_is_finite():
    """A string that stands for a second in every three, and turns back: no division by its speed."""
    t = np.arange(0, 60, 0.01)
    speed = 10 * (1 + 1.3 * np.sin(2 * np.pi * t / 3))
    found = vibration.order_map(t, np.sin(t), speed)
    assert np.isfinite(found.amplitude).all()
