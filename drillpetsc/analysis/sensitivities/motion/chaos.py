"""Until when the derivatives of a run say something: in chaotic motion they grow exponentially (manual: sec-sensitivities-chaos)."""

from __future__ import annotations

import numpy as np

from drillpetsc.arrays import FloatArray

LINEAR = 0.9  # share of the variance of log |s| that a straight line explains, over half of the run
#: beginning of such a half, over the length of the run -> growth in it; a phase that drifts doubles the derivative in the last half, and
#: powers of the time grow faster at first
GROWN = {0.0: 100.0, 0.125: 100.0, 0.25: 100.0, 0.375: 100.0, 0.5: 10.0}
FEWEST = 8  # rows of a half that tell a rise
CHANGE, MOVED = (
    0.01,
    0.1,
)  # of the key; change of the column by it over the column's range, at which nothing is known


def determined_until(times: FloatArray, values: FloatArray, slopes: FloatArray) -> float:
    """Time [s] up to which a derivative is determined, infinity if that is all the run.

    times: (m,) [s]; values: (m,) of a column; slopes: (m,) its change by a change of the key by its own value.

    The derivative grows exponentially if the logarithm of its largest magnitude so far rises linearly over half of the run.
    """
    finite = np.isfinite(slopes)
    lost = np.inf if finite.all() else float(times[~finite][0])
    times, values, slopes = times[finite], values[finite], slopes[finite]
    return min(lost, _beyond(times, values, slopes)) if _grows(times, slopes) else lost


def _beyond(times: FloatArray, values: FloatArray, slopes: FloatArray) -> float:
    """First time at which one per cent of the key moves the column by a tenth of its range."""
    beyond = times[CHANGE * np.abs(slopes) > MOVED * np.ptp(values)]
    return float(beyond[0]) if len(beyond) else np.inf


def _grows(times: FloatArray, slopes: FloatArray) -> bool:
    if len(times) < FEWEST:
        return False
    largest = np.maximum.accumulate(
        np.abs(slopes)
    )  # without the zeros at which the derivative changes its sign
    for begin, grown in GROWN.items():
        share = (times - times[0]) / max(times[-1] - times[0], np.finfo(float).tiny)
        mine = (share >= begin) & (share <= begin + 0.5) & (largest > 0)
        if np.count_nonzero(mine) < FEWEST:
            continue
        t, height = share[mine], np.log(largest[mine])
        line = np.polyfit(t, height, 1)
        left = np.var(height - np.polyval(line, t))
        if line[0] * np.ptp(t) > np.log(grown) and left < (1 - LINEAR) * np.var(height):
            return True
    return False
