"""Spectrograms over frequency and over the order of rotation, and power densities (manual: sec-vibration-spectra).

Segments are weighted with Hann's window and their mean is taken off.  A series that is not evenly spaced is made so by straight lines
between its points.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drillpetsc.arrays import FloatArray

OVERLAP = 0.75  # part of a segment that the next one shares
SEGMENTS = 120  # of a map, about; a longer series moves on by more than its overlap allows
SLOWEST = 0.05  # part of the mean speed below which the string counts as standing in an order map
ANGLES = 4096  # most points in a revolution of an order map


@dataclass(frozen=True)
class Spectrogram:
    """Amplitudes over time and frequency, or over time and order.

    time: (k,) middle of the segments [s]; frequency: (m,) [Hz], or order [-]; amplitude: (k, m) of a sine of this frequency.
    width: spacing of lines that can be told apart, two lines of the grid [Hz or -].
    """

    time: FloatArray
    frequency: FloatArray
    amplitude: FloatArray
    width: float


def _even(time: FloatArray, values: FloatArray) -> tuple[FloatArray, FloatArray, float]:
    """Evenly spaced times and values, and their spacing [s]."""
    t, v = np.asarray(time, dtype=float), np.asarray(values, dtype=float)
    if len(t) < 4:
        raise ValueError(f"a spectrum needs at least 4 values, not {len(t)}")
    v = np.where(np.isfinite(v), v, 0.0)
    spacing = (t[-1] - t[0]) / (len(t) - 1)
    grid = t[0] + spacing * np.arange(len(t))
    return (
        (t, v, spacing)
        if np.allclose(t, grid, rtol=0, atol=1e-6 * spacing)
        else (grid, np.interp(grid, t, v), spacing)
    )


def _pieces(values: FloatArray, length: int, hop: int) -> tuple[np.ndarray, FloatArray]:
    """First indices (k,) of segments, and the segments (k, length) without their means, weighted."""
    begins = np.arange(0, len(values) - length + 1, hop)
    parts = values[begins[:, None] + np.arange(length)]
    window = 0.5 * (1 - np.cos(2 * np.pi * np.arange(length) / length))
    return begins, (parts - parts.mean(axis=1, keepdims=True)) * window


def spectrogram(time: FloatArray, values: FloatArray, segment: float | None = None) -> Spectrogram:
    """Amplitudes of a series over time and frequency.

    time: (n,) [s]; values: (n,); segment: length of a segment [s], by default a fiftieth of the series, at least 64 values.
    A series shorter than a segment is one segment.
    """
    t, v, spacing = _even(time, values)
    length = max(64, len(t) // 50) if segment is None else round(segment / spacing)
    length = int(np.clip(length, 4, len(t)))
    hop = max(1, int((1 - OVERLAP) * length), (len(t) - length) // SEGMENTS)
    begins, parts = _pieces(v, length, hop)
    amplitude = 4.0 / length * np.abs(np.fft.rfft(parts, axis=1))
    middle = t[0] + spacing * (begins + 0.5 * (length - 1))
    frequency = np.fft.rfftfreq(length, spacing)
    return Spectrogram(middle, frequency, amplitude, 2 * float(frequency[1]))


def power_density(
    time: FloatArray, values: FloatArray, segment: float | None = None
) -> tuple[FloatArray, FloatArray]:
    """(frequency [Hz], power density [unit^2/Hz]) of a series, one-sided (Welch, IEEE Trans. AU-15, 1967).

    segment: length of the segments [s] whose densities are averaged, by default an eighth of the series.  The integral of the density
    over the frequency is the variance of the series.
    """
    t, v, spacing = _even(time, values)
    length = max(64, len(t) // 8) if segment is None else round(segment / spacing)
    length = int(np.clip(length, 4, len(t)))
    _, parts = _pieces(v, length, max(1, length // 2))
    window = 0.5 * (1 - np.cos(2 * np.pi * np.arange(length) / length))
    density = 2 * spacing / np.sum(window**2) * np.mean(np.abs(np.fft.rfft(parts, axis=1)) ** 2, axis=0)
    density[0] *= 0.5
    if length % 2 == 0:
        density[-1] *= 0.5
    return np.fft.rfftfreq(length, spacing), density


def turned_angle(time: FloatArray, speed: FloatArray) -> FloatArray:
    """(n,) angle [rad] that a shaft of speed (n,) [rad/s] has turned at times (n,) [s], by the trapezoidal rule."""
    return np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(time))])


def order_map(
    time: FloatArray, values: FloatArray, speed: FloatArray, revolutions: float = 64.0
) -> Spectrogram:
    """Amplitudes of a series over time and the order of rotation: the series is resampled over the angle.

    time: (n,) [s]; values: (n,); speed: (n,) rotation [rad/s]; revolutions: in a segment, whose orders are 1/revolutions apart.
    Times at which the shaft is at rest or turns back are left out.  Raises ValueError if the shaft turns less than four revolutions.
    """
    t, v, spacing = _even(time, values)
    w = np.interp(t, time, speed)
    mean = float(np.mean(w))
    w = w * (np.sign(mean) or 1.0)
    angle = turned_angle(t, np.maximum(w, SLOWEST * abs(mean)) if mean else w) / (2 * np.pi)
    if not angle[-1] >= 4.0:
        raise ValueError(f"an order map needs at least 4 revolutions; the string turns {abs(angle[-1]):.3g}")
    fastest = float(np.max(w)) / (2 * np.pi)
    slowest = max(float(np.percentile(w, 5)), SLOWEST * abs(mean)) / (2 * np.pi)
    points = int(
        np.clip(1.0 / (spacing * slowest), 8, ANGLES)
    )  # in a revolution, so that none is lost where it is slow
    grid = np.arange(0.0, angle[-1], 1.0 / points)
    at = np.interp(grid, angle, t)
    resampled = _cubic(t, v, spacing, at)
    length = int(np.clip(revolutions * points, 8, len(grid)))
    length = max(points, length // points * points)  # whole revolutions
    hop = max(1, int((1 - OVERLAP) * length), (len(grid) - length) // SEGMENTS)
    begins, parts = _pieces(resampled, length, hop)
    amplitude = 4.0 / length * np.abs(np.fft.rfft(parts, axis=1))
    order = np.fft.rfftfreq(length, 1.0 / points)
    kept = order <= 0.5 / (spacing * fastest)  # what the series resolves at its highest speed
    middle = np.interp(grid[begins] + 0.5 * length / points, angle, t)
    return Spectrogram(middle, order[kept], amplitude[:, kept], 2 * float(order[1]))


def _cubic(t: FloatArray, v: FloatArray, spacing: float, at: FloatArray) -> FloatArray:
    """Values at times ``at`` of an evenly spaced series, by cubic polynomials through four points (Catmull and Rom)."""
    i = np.clip(((at - t[0]) / spacing).astype(int), 0, len(t) - 2)
    s = (at - t[i]) / spacing
    a, b, c, d = v[np.maximum(i - 1, 0)], v[i], v[i + 1], v[np.minimum(i + 2, len(t) - 1)]
    return b + 0.5 * s * (c - a + s * (2 * a - 5 * b + 4 * c - d + s * (3 * (b - c) + d - a)))


def ridge(found: Spectrogram, low: float, high: float) -> FloatArray:
    """(k,) frequency or order of the largest amplitude between two of them, by a parabola through the logarithms of three lines."""
    inside = np.flatnonzero((found.frequency >= low) & (found.frequency <= high))
    if not len(inside):
        raise ValueError(f"no line between {low:g} and {high:g}")
    peak = inside[np.argmax(found.amplitude[:, inside], axis=1)]
    rows, at = np.arange(len(peak)), np.clip(peak, 1, len(found.frequency) - 2)
    left, middle, right = (np.log(np.maximum(found.amplitude[rows, at + k], 1e-300)) for k in (-1, 0, 1))
    bend = left - 2 * middle + right
    shift = np.where(bend < 0, 0.5 * (left - right) / np.where(bend < 0, bend, 1.0), 0.0)
    return found.frequency[at] + np.clip(shift, -1, 1) * (found.frequency[1] - found.frequency[0])
