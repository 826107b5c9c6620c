"""Points for `calibrate` out of a log: medians of spells in which the state, rotation and flow stay the same."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.errors import CaseError
from drillpetsc.logs.log import Log
from drillpetsc.logs.quality import OFF_BOTTOM
from drillpetsc.logs.states import States
from drillpetsc.units import UnitError, to_si

OPERATION_OF = {
    "trip_in": "trip_in",
    "trip_out": "trip_out",
    "rotate_off": "rotate_off_bottom",
    "drilling": "drilling",
    "slide": "sliding",
    "backream": "backreaming",
}
RPM_BAND, FLOW_BAND, SMALLEST_FLOW = to_si("3 rpm", "rad/s"), 0.03, to_si("100 l/min", "m^3/s")
LONGEST = 45.0  # depth that a spell covers: a stand and a half [m]
FEWEST, FEWEST_TRIP = 3, 2  # readings of a spell
SLOWEST_TRIP = 0.08  # [m/s]
LIFTED = 0.55  # share of the string's weight that hangs on the hook of a trip at least
MEDIANS = ("hook_load", "torque", "wob", "torque_downhole", "rpm", "flow_rate", "pump_pressure")


@dataclass(frozen=True)
class Every:
    """Length of a point while drilling: a depth [m] or a time [s]."""

    depth: float | None = 10.0
    time: float | None = None


@dataclass(frozen=True)
class Point:
    """Medians of a spell, SI.

    operation: of `roadmap`; bit_depth [m]; values: channel -> median; scatter: channel -> 1.4826 times the median deviation.
    speed: mean, nan where the bit does not move along the hole by itself [m/s]; n: readings.
    """

    operation: str
    bit_depth: float
    values: dict[str, float]
    scatter: dict[str, float]
    speed: float
    n: int


def read_every(text: str | None, by_time: bool) -> Every:
    """The option `--every 1m` or `--every 10s`; raises CaseError."""
    if text is None:
        return Every()
    for unit, found in (("m", "depth"), ("s", "time")):
        try:
            size = to_si(text, unit)
        except UnitError:
            continue
        if size > 0 and any(q.isalpha() for q in text) and (by_time or unit == "m"):
            return replace(Every(None, None), **{found: size})
    raise CaseError(
        at="--every",
        got=text,
        want="a length, such as 1 m" + (", or a time, such as 10 s" if by_time else ""),
    )


def points_of(log: Log, states: States, weight: FloatArray, every: Every, far: np.ndarray) -> list[Point]:
    """Points of all spells that `calibrate` can compare, by depth where the log is by depth, else in time.

    weight: (n,) of the string in mud [N]; far: (n,) mask of rows after a gap.
    """
    bands = _bands(log)
    out = []
    if not log.by_time:
        assert every.depth is not None
        bins = np.floor(log.values["bit_depth"] / every.depth)
        keys = np.stack([bins, *bands], axis=1)
        groups, number = np.unique(keys, axis=0, return_inverse=True)
        order = np.argsort(number.ravel(), kind="stable")
        ends = np.cumsum(np.bincount(number.ravel(), minlength=len(groups)))
        for a, b in zip(np.append(0, ends[:-1]), ends, strict=True):
            for word in np.unique(states.word[order[a:b]]):
                rows = order[a:b][states.word[order[a:b]] == word]
                out += point_of(log, states, weight, rows, str(word))
        return out
    cut = far.copy()
    for band in bands:
        cut[1:] |= band[1:] != band[:-1]
    for rows in _spells(log, states, cut, every):
        out += point_of(log, states, weight, rows, str(states.word[rows[0]]))
    return out


def _spells(log: Log, states: States, cut: np.ndarray, every: Every) -> list[np.ndarray]:
    """Rows of each spell: of a trip those of one stand, from slips to slips, though it may stop on the way."""
    stand = np.cumsum(states.in_slips & ~np.append(False, states.in_slips[:-1]))
    part = np.cumsum(cut)
    out = []
    for word in OPERATION_OF:
        rows = np.flatnonzero(states.word == word)
        if not len(rows):
            continue
        if word in ("trip_in", "trip_out", "backream"):
            new = (np.diff(stand[rows]) != 0) | (np.diff(part[rows]) != 0)
        else:
            new = (np.diff(rows) != 1) | (np.diff(part[rows]) != 0)
        for piece in np.split(rows, np.flatnonzero(new) + 1):
            out += _pieces(log, piece, word, every)
    return sorted(out, key=lambda rows: int(rows[0]))


def _bands(log: Log) -> list[FloatArray]:
    """(n,) number of the band of rotation and of flow, 0 around the value that is read most."""
    rpm, flow = (np.nan_to_num(log.column(name)) for name in ("rpm", "flow_rate"))
    pumping = flow > SMALLEST_FLOW
    usual = np.median(flow[pumping]) if pumping.any() else SMALLEST_FLOW
    ratio = np.log(np.where(pumping, flow, usual) / usual)
    turning = rpm > RPM_BAND
    middle = np.median(rpm[turning]) if turning.any() else 0.0
    return [
        np.where(turning, np.round((rpm - middle) / (2 * RPM_BAND)), -1e6),
        np.where(pumping, np.round(ratio / (2 * np.log1p(FLOW_BAND))), -1e6),
    ]


def _pieces(log: Log, rows: np.ndarray, word: str, every: Every) -> list[np.ndarray]:
    """Rows of a spell in pieces, none longer than a stand and a half, nor while drilling than `every`."""
    depth = log.values["bit_depth"][rows]
    key = np.floor(np.abs(depth - depth[0]) / LONGEST)
    if word in ("drilling", "slide"):
        if every.time is not None:
            key = np.floor(log.values["time"][rows] / every.time)
        else:
            assert every.depth is not None
            key = np.floor(depth / every.depth)
    return [rows[key == k] for k in np.unique(key)]


def point_of(log: Log, states: States, weight: FloatArray, rows: np.ndarray, word: str) -> list[Point]:
    """The point of some rows of one state; none where they are too few, too slow, or the hook carries too little."""
    operation = OPERATION_OF.get(word)
    trip = word in ("trip_in", "trip_out", "backream")
    if operation is None or len(rows) < (FEWEST_TRIP if trip else FEWEST):
        return []
    depth = log.values["bit_depth"][rows]
    values, scatter = {}, {}
    for name in MEDIANS:
        some = log.column(name)[rows]
        some = some[~np.isnan(some)]
        if len(some):
            values[name] = float(np.median(some))
            own = some[np.append(True, np.diff(some) != 0)]  # a held value is one reading
            scatter[name] = 1.4826 * float(np.median(np.abs(own - np.median(own))))
    wob = log.column("wob_downhole")[rows]
    if not np.isnan(wob).all():
        values["wob"] = float(np.nanmedian(wob))
    if np.nanmax(log.column("hole_depth")[rows] - depth, initial=-np.inf) > OFF_BOTTOM:
        values.pop("wob", None)
    if values.get("rpm", np.inf) < RPM_BAND:  # without rotation friction makes no torque
        values["rpm"] = 0.0
        values.pop("torque", None)
    if "hook_load" not in values and not values.get("torque"):
        return []
    speed = np.nan
    if trip:
        speed = abs(float(np.mean(states.speed[rows])))
        if states.block is None:  # slips are not recognised, nor how near to them these rows are
            return []
        least = states.block + LIFTED * float(np.mean(weight[rows]))
        if not speed >= SLOWEST_TRIP or values.get("hook_load", np.inf) <= least:
            return []
    return [Point(operation, float(np.median(depth)), values, scatter, speed, len(rows))]


#: column of `points.csv` -> its place in a point; `measured` of a case and `--measured` read the same file
COLUMNS = (
    ("bit depth", "m", "bit_depth"),
    ("operation", "", "operation"),
    ("hook load", "N", "hook_load"),
    ("torque", "N m", "torque"),
    ("WOB", "N", "wob"),
    ("TOB", "N m", "torque_downhole"),
    ("RPM", "rad/s", "rpm"),
    ("speed", "m/s", "speed"),
    ("flow rate", "m3/s", "flow_rate"),
    ("scatter of hook load", "N", "hook_load"),
    ("scatter of torque", "N m", "torque"),
    ("readings", "", "n"),
)


def cells_of(points: list[Point]) -> dict[str, list[Any]]:
    """name of a column -> its cells, empty where nothing was read."""
    out: dict[str, list[Any]] = {name: [] for name, _, _ in COLUMNS}
    for point in points:
        for name, _, key in COLUMNS:
            if name.startswith("scatter"):
                value: Any = point.scatter.get(key, np.nan)
            else:
                value = point.values.get(key, getattr(point, key, np.nan))
            if key == "wob" and isinstance(value, float):
                value = max(value, 0.0)  # a reading whose zero has drifted
            out[name].append("" if isinstance(value, float) and np.isnan(value) else value)
    return out
