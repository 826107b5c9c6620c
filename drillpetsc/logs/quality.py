"""What is wrong with the records of a log: depths that jump, held values, gaps, spikes, weight off bottom, units by size."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.errors import CaseError
from drillpetsc.logs.log import Log
from drillpetsc.units import to_si

WINDOW = 11  # rows of a running median
JUMP = 0.3  # off the running median, of a depth that jumps out and back [m]
FASTEST = 5.0  # of a block [m/s]: a bit that is faster out and back jumps in a log by time
SPIKE = 5.0  # deviations of Hampel's test
LONGEST_GAP_ROWS, LONGEST_GAP = 5.0, 10.0  # steps of a log by time; depth [m]
WEIGHT_OFF_BOTTOM = to_si("0.5 t", "N")
OFF_BOTTOM = 1.0  # height of the bit above the end of the hole [m]
WORST_RATIO = 3.0  # of a hook load over the computed weight, or its inverse, that is another unit
LARGEST_TORQUE = to_si("200 kN m", "N m")  # of any top drive
SLOWEST_DRILLING = to_si("6 rpm", "rad/s")  # median on bottom below which a rotation may be in Hz
#: unit of the numbers and that which the heading gives -> hook load as read over the true one
_SLIPS_OF_UNITS = {
    "t read as kN": 1 / 9.80665,
    "kN read as t": 9.80665,
    "klbf read as kN": 1 / 4.4482,
    "kN read as klbf": 4.4482,
    "kN read as N, or klbf as lbf": 1e-3,
    "N read as kN, or lbf as klbf": 1e3,
}


@dataclass(frozen=True)
class Check:
    """One check of a log.

    name: of the check; channel; count of n: rows that it found; action: what was done with them; detail: a figure in words.
    rows: their numbers in the log as read, empty where they stay.
    """

    name: str
    channel: str
    count: int
    n: int
    action: str
    detail: str = ""

    def record(self) -> dict[str, object]:
        """The check for `quality.json`."""
        share = self.count / self.n if self.n else 0.0
        return {
            "check": self.name,
            "channel": self.channel,
            "count": self.count,
            "share": round(share, 6),
            "action": self.action,
            "detail": self.detail,
        }


def running_median(values: FloatArray) -> FloatArray:
    """(n,) median of `WINDOW` rows around each; of fewer at the ends."""
    half = WINDOW // 2
    if len(values) <= half:
        return np.full(len(values), np.nanmedian(values))
    padded = np.concatenate([np.full(half, np.nan), values, np.full(half, np.nan)])
    rows = np.lib.stride_tricks.sliding_window_view(padded, WINDOW)
    out = np.median(rows, axis=1)
    ends = np.isnan(out)
    with np.errstate(all="ignore"):
        out[ends] = [np.nanmedian(row) if not np.isnan(row).all() else np.nan for row in rows[ends]]
    return out


def without_jumps(log: Log) -> tuple[Log, Check]:
    """The log without rows whose bit depth jumps out and back; one by depth is then sorted by depth."""
    depth = log.column("bit_depth")
    if log.by_time:
        bad = _faster_than_a_block(log.values["time"], depth)
        detail = f"faster than {FASTEST:g} m/s, out and back"
    else:
        bad = np.abs(depth - running_median(depth)) > JUMP
        before, after = (int((np.diff(q) < 0).sum()) for q in (depth, depth[~bad]))
        detail = f"more than {JUMP:g} m off the median of {WINDOW} rows; {before} steps back become {after}"
    check = Check("depth jumps", "bit_depth", int(bad.sum()), len(log), "dropped", detail)
    log = log.rows(~bad)
    return (log if log.by_time else log.rows(np.argsort(log.values["bit_depth"], kind="stable"))), check


def _faster_than_a_block(time: FloatArray, depth: FloatArray) -> np.ndarray:
    """(n,) mask of rows between a jump and its return, at most `WINDOW` // 2 rows later."""
    bad = np.zeros(len(depth), dtype=bool)
    if len(depth) < 3:
        return bad
    step = np.diff(depth)
    jumps = np.flatnonzero(np.abs(step) > FASTEST * np.diff(time))
    for a, b in zip(jumps, jumps[1:], strict=False):
        if b - a <= WINDOW // 2 and step[a] * step[b] < 0:
            bad[a + 1 : b + 1] = True
    return bad


def held_values(log: Log) -> list[Check]:
    """Channels whose readings stand still for many rows: each is one reading."""
    out = []
    for name in ("hook_load", "torque", "wob", "wob_downhole", "torque_downhole", "pump_pressure"):
        values = log.column(name)
        some = values[~np.isnan(values)]
        held = int((np.diff(some) == 0).sum()) if len(some) else 0
        if held:
            detail = f"{len(np.unique(some))} distinct values"
            out.append(Check("held value", name, held, len(some) - 1, "each counts as one reading", detail))
    return out


def far_rows(log: Log, usual: float) -> np.ndarray:
    """(n,) mask of rows further from the row before than a log with a ``usual`` step has them."""
    return np.append(False, np.diff(log.index) > (LONGEST_GAP_ROWS * usual if log.by_time else LONGEST_GAP))


def gaps(log: Log) -> tuple[np.ndarray, Check]:
    """((n,) mask of rows before which a spell ends, the check)."""
    step = np.diff(log.index)
    usual = float(np.median(step[step > 0])) if (step > 0).any() else 0.0
    far = far_rows(log, usual)
    least = LONGEST_GAP_ROWS * usual if log.by_time else LONGEST_GAP
    channel, unit = ("time", "s") if log.by_time else ("bit_depth", "m")
    longest = float(step.max(initial=0.0))
    detail = f"longer than {least:g} {unit}; usual step {usual:g} {unit}, longest {longest:g} {unit}"
    return far, Check("gap", channel, int(far.sum()), len(log), "a spell ends there", detail)


def spikes(log: Log) -> list[Check]:
    """Hampel's test: told, nothing is dropped, since points are medians."""
    out = []
    for name in ("hook_load", "torque", "pump_pressure"):
        values = log.column(name)
        values = values[~np.isnan(values)]
        if len(values) < WINDOW:
            continue
        off = values - running_median(values)
        usual = 1.4826 * float(np.median(np.abs(off[off != 0]))) if (off != 0).any() else 0.0
        spread = np.maximum(1.4826 * running_median(np.abs(off)), usual)
        beside = np.sign(np.diff(values))
        peak = np.append(
            False, np.append(beside[:-1] * beside[1:] < 0, False)
        )  # alone: a change of state is none
        count = int((peak & (np.abs(off) > SPIKE * spread)).sum()) if usual else 0
        if count:
            out.append(
                Check(
                    "spike",
                    name,
                    count,
                    len(values),
                    "kept: points are medians",
                    f"{SPIKE:g} deviations of {WINDOW} rows",
                )
            )
    return out


def weight_off_bottom(log: Log) -> list[Check]:
    """A weight on bit that is read with the bit off bottom: the zero of the reading has drifted."""
    wob, height = log.column("wob"), log.column("hole_depth") - log.column("bit_depth")
    off = (height > OFF_BOTTOM) & ~np.isnan(wob)
    count = int((np.abs(wob[off]) > WEIGHT_OFF_BOTTOM).sum())
    if not count:
        return []
    detail = f"median {np.median(wob[off]) / 1e3:.3g} kN with the bit off bottom; 0.5 t are allowed"
    return [
        Check(
            "weight off bottom", "wob", count, int(off.sum()), "told: wob of these rows is not used", detail
        )
    ]


def dead_flag(log: Log, in_slips: np.ndarray) -> list[Check]:
    """A flag of slips beside the slips that the hook load shows.  in_slips: (n,) mask."""
    flag = log.column("in_slips")
    if np.isnan(flag).all() or not in_slips.any():
        return []
    missed = int((in_slips & ~(flag > 0)).sum())
    name = "dead flag" if len(np.unique(flag[~np.isnan(flag)])) == 1 else "flag"
    if not missed:
        return []
    detail = f"0 in {int((flag == 0).sum())} rows, {missed} of them in slips by the hook load"
    return [Check(name, "in_slips", missed, len(log), "the flag is not used", detail)]


# ---------------------------------------------------------------------- units by size
def check_sizes(log: Log, expected: Callable[[FloatArray], FloatArray] | None) -> list[str]:
    """Warnings of readings that look like another unit.

    expected: hook load [N] of a string that neither moves nor stands on bottom, block included, at bit depths (k,) [m]; None
    without a case. Raises CaseError for a hook load beyond a third or three times it, unless the user has named its unit.
    """
    out = []
    hook, depth = log.column("hook_load"), log.column("bit_depth")
    weight = np.full(len(hook), np.nan) if expected is None else expected(depth)
    some = (depth > 0) & ~np.isnan(hook + weight)  # below the hole of the case the weight is not known
    if some.any():
        ratio = float(np.percentile(hook[some] / weight[some], 90))
        if not 1 / WORST_RATIO < ratio < WORST_RATIO:
            slip = min(
                _SLIPS_OF_UNITS, key=lambda name: abs(np.log(max(ratio, 1e-9) / _SLIPS_OF_UNITS[name]))
            )
            title = log.titles["hook_load"]
            got = f"{title}: {ratio:.3g} times the computed weight of string and block"
            want = f"1/{WORST_RATIO:g} to {WORST_RATIO:g} times"
            hint = f"{slip}? --map 'hook_load={title}:UNIT' names the unit, also one that is right"
            if "hook_load" not in log.mapped:
                raise CaseError(at="hook_load", got=got, want=want, hint=hint)
            out.append(f"{got}, in the unit that --map gives")
    torque = log.column("torque")
    if not np.isnan(torque).all() and np.nanpercentile(torque, 99) > LARGEST_TORQUE:
        size = np.nanpercentile(torque, 99) / 1e3
        out.append(
            f"{log.titles['torque']}: {size:.4g} kN m is beyond any top drive: a gauge in psi, or another unit?"
        )
    rpm, rop = log.column("rpm"), log.column("rop")
    turning = rpm[(rop > 0) & (rpm > 0)]
    if len(turning) > WINDOW and np.median(turning) < SLOWEST_DRILLING:
        size = np.median(turning) / to_si("1 rpm", "rad/s")
        out.append(f"{log.titles['rpm']}: a median of {size:.3g} rpm while drilling: in Hz?")
    return out
