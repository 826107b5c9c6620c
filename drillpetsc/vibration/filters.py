"""Low-pass filters of sensors, exact on signals that are straight between their points (manual: sec-vibration-filter)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drillpetsc.arrays import FloatArray


@dataclass(frozen=True)
class LowPass:
    """A stable low-pass filter of gain 1 at frequency 0, as a sum of first-order parts.

    poles: (n,) complex [1/s], distinct; weights: (n,) complex, their sum is 1.
    The transfer function is the sum of weights[i] poles[i] / (poles[i] - s).
    """

    poles: np.ndarray
    weights: np.ndarray

    def gain(self, frequency: FloatArray | float) -> FloatArray:
        """Size of the response at a frequency [Hz]."""
        s = 2j * np.pi * np.atleast_1d(np.asarray(frequency, dtype=float))[:, None]
        response = np.sum(self.weights * self.poles / (self.poles - s), axis=1)
        return np.abs(response).reshape(np.shape(frequency))

    def at_rest(self, channels: int) -> np.ndarray:
        """State (channels, n) of a filter whose input has always been what it is at the start."""
        return np.zeros((channels, len(self.poles)), dtype=complex)

    def run(self, times: FloatArray, values: FloatArray, state: np.ndarray) -> tuple[FloatArray, np.ndarray]:
        """Filter signals that are straight between the points; returns (k, channels) values and the state at the end.

        times: (k,) [s], ascending; values: (k, channels) at these times; state: (channels, n) at the first time.

        The state holds the difference w of each part from the input u: w' = p w - u'.  With a constant u' over h its
        solution is w(h) = exp(p h) w(0) - u' (exp(p h) - 1)/p, without a further error.
        """
        h = np.diff(times)
        grown = h[:, None] * self.poles
        factor, slope = np.exp(grown), np.diff(values, axis=0)
        share = np.where(h[:, None] > 0, np.expm1(grown) / np.where(grown == 0, 1.0, grown), 1.0)
        push = slope[:, :, None] * share[:, None, :]
        states = np.empty((len(times), *state.shape), dtype=complex)
        states[0] = w = state
        for k in range(len(h)):  # one after the other, so that no result depends on how a series is divided
            w = factor[k] * w - push[k]
            states[k + 1] = w
        return values + np.sum(states * self.weights, axis=-1).real, w


def butterworth(order: int, cutoff: float) -> LowPass:
    """Butterworth's low-pass filter: gain 1/sqrt(1 + (f/cutoff)^(2 order)) (Butterworth, Wireless Engineer 7, 1930).

    cutoff: frequency [Hz] at which the gain is 1/sqrt(2).
    """
    if order < 1 or not cutoff > 0:
        raise ValueError(f"butterworth: order {order} and cutoff {cutoff:g} Hz; both must be above 0")
    k = np.arange(1, order + 1)
    poles = 2 * np.pi * cutoff * np.exp(0.5j * np.pi * (2 * k + order - 1) / order)
    weights = np.array(
        [np.prod(np.delete(poles, i) / (np.delete(poles, i) - p)) for i, p in enumerate(poles)]
    )
    return LowPass(poles, weights)
