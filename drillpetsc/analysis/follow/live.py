"""live.html: a page in one file, without a server, that shows the present state of a rig that is followed."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from datetime import UTC, datetime
from importlib.resources import files
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from drillpetsc.analysis.follow.alarms import INSIDE
from drillpetsc.analysis.follow.follower import Follower, Update
from drillpetsc.analysis.follow.strings import SLIPS
from drillpetsc.case.case import Case
from drillpetsc.output.files.atomic import replace_text
from drillpetsc.output.shown_units import shown_unit

MOST = 600  # rows that the page draws
FAR = 100.0  # depth between rows that no line joins [m]
#: reading -> (title, name of the quantity by which its unit is chosen, unit); the first two have a chart
READINGS = {
    "hook_load": ("Hook load", "hook_load", "N"),
    "torque": ("Surface torque", "surface_torque", "N m"),
    "pump_pressure": ("Pump pressure", "pump_pressure", "Pa"),
}


def write_page(
    path: Path,
    case: Case,
    feed: str,
    updates: Sequence[Update],
    follower: Follower,
    alarms: Sequence[dict[str, Any]],
) -> None:
    """Write the page of the latest updates, whole or not at all."""
    page = files(__package__).joinpath("live.html").read_text(encoding="utf-8")
    data = json.dumps(_plain(_data(case, feed, updates, follower, alarms)), allow_nan=False).replace(
        "<", "\\u003c"
    )
    replace_text(path, page.replace("/*DATA*/null", data))


def _data(
    case: Case, feed: str, updates: Sequence[Update], follower: Follower, alarms: Sequence[dict[str, Any]]
) -> dict[str, Any]:
    system = case.shown_units
    units = {name: shown_unit(key, unit, system, plot=True) for name, (_, key, unit) in READINGS.items()}
    depth = shown_unit("bit_depth", "m", system, plot=True)
    moving = [q for q in updates if q.reading.load.operation != SLIPS]
    some = moving[:: max(math.ceil(len(moving) / MOST), 1)]
    loads = [q.reading.load for q in some]
    series: dict[str, list[Any]] = {
        "depth": [q.bit_depth / depth[0] for q in loads],
        "new": [True] * min(len(loads), 1),
    }
    series["new"] += [  # where a line begins anew: another operation, or far away
        a.operation != b.operation or abs(a.bit_depth - b.bit_depth) > FAR for a, b in pairwise(loads)
    ]
    charts = []
    last = moving[-1].ahead if moving else None
    for k, name in enumerate(list(READINGS)[:2]):
        size, unit = units[name]
        errors = [q.forecast.get(name) for q in some]
        chart: dict[str, Any] = {
            "title": READINGS[name][0],
            "unit": unit,
            "read": [getattr(q.reading, name) / size for q in some],
        }
        for key, sign in (("low", -1), ("high", 1)):
            chart[key] = [
                math.nan if e is None else (e.forecast + sign * INSIDE * e.sd) / size for e in errors
            ]
        if last is not None and (k == 0 or moving[-1].reading.load.rotation):
            middle, half = float(last.mean[k]), INSIDE * float(last.sd[k])
            chart["ahead"] = [last.bit_depth / depth[0], *((middle + q * half) / size for q in (-1, 0, 1))]
        charts.append(chart)
    names = [q.name for q in follower.states]
    friction = [
        {
            "name": name.replace("_", " "),
            "mean": [float(q.belief.mean[names.index(name)]) for q in some],
            "sd": [float(q.belief.sd[names.index(name)]) for q in some],
        }
        for name in follower.strings.groups
    ]
    return {
        "title": case.title or "case", "feed": feed, "written": datetime.now(UTC).isoformat(sep=" ", timespec="seconds"),
        "gauges": _gauges(updates, moving, units, depth), "series": series, "charts": charts, "friction": friction,
        "depth_unit": depth[1], "alarms": list(alarms)[::-1][:30],
    }  # fmt: skip


def _gauges(
    updates: Sequence[Update],
    moving: Sequence[Update],
    units: dict[str, tuple[float, str]],
    depth: tuple[float, str],
) -> list[Any]:
    """[name, value and unit, remark] of each gauge."""
    if not updates:
        return []
    load = updates[-1].reading.load
    out = [["Bit depth", _value(load.bit_depth, depth), load.operation.replace("_", " ")]]
    for name, (title, _, _) in READINGS.items():
        latest = next((q for q in reversed(moving) if math.isfinite(getattr(q.reading, name))), None)
        if latest is None:
            continue
        error = latest.forecast.get(name)
        remark = "no forecast yet"
        if error is not None:
            remark = f"forecast {_value(error.forecast, units[name])} ({error.standard:+.1f} sd)"
        out.append([title, _value(getattr(latest.reading, name), units[name]), remark])
    return out


def _value(value: float, unit: tuple[float, str]) -> str:
    return "-" if not math.isfinite(value) else f"{value / unit[0]:,.5g} {unit[1]}".replace(",", " ")


def _plain(value: Any) -> Any:
    """The value with None in place of numbers that JSON does not have, and five digits."""
    if isinstance(value, dict):
        return {key: _plain(q) for key, q in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(q) for q in value]
    if isinstance(value, float | np.floating):
        return float(f"{value:.6g}") if math.isfinite(value) else None
    return value
