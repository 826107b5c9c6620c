"""The box at the head of a report: how close the operation comes to the limits of rig, string and open hole.

All figures are from the run folders of the report. Only the worst of several runs is shown.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from drillpetsc.case import Case
from drillpetsc.output.files.tables import read_table
from drillpetsc.output.shown_units import lengths_shown, unit_of
from drillpetsc.reporting.results import Run
from drillpetsc.reporting.units import in_units, label_of, texts
from drillpetsc.unit_systems import System

CLOSE = 0.9  # share of a limit from which on a figure is close to it
EXCEEDED, NEAR, WITHIN, UNKNOWN = "exceeded", "close", "within", "not compared"
DIGITS = 4  # of the figures
#: ratios of ``limits`` to their own limit, which is 1
_RATIOS = ("torque_ratio", "make_up_ratio", "fatigue_ratio", "burst_ratio", "collapse_ratio")


@dataclass(frozen=True)
class Check:
    """A figure beside its limit.

    name: of the figure; title: of a column in its unit; value, limit: in SI, None if not known; where: place and operation, lengths
    in metres; share: of the limit that is used, 1 at the limit, None without a limit; below: the limit is the smallest value allowed;
    missing: what gives the limit.
    """

    name: str
    title: str
    value: float | None
    limit: float | None
    where: str
    share: float | None
    below: bool = False
    missing: str = ""

    @property
    def state(self) -> str:
        """Word for the share."""
        if self.share is None or np.isnan(self.share):
            return UNKNOWN
        return EXCEEDED if self.share > 1.0 else NEAR if self.share > CLOSE else WITHIN

    @property
    def margin(self) -> float | None:
        """Distance from the limit, negative beyond it."""
        if self.value is None or self.limit is None:
            return None
        return self.value - self.limit if self.below else self.limit - self.value


def _share(value: float | None, limit: float | None) -> float | None:
    """Share of the largest allowed value that is used; None if one of the two is not known."""
    if value is None or limit is None:
        return None
    return value / limit if limit > 0 else np.inf


def _upper(name: str, title: str, value: float, limit: float | None, where: str, missing: str = "") -> Check:
    """A figure that must stay below its limit."""
    return Check(name, title, value, limit, where, _share(value, limit), missing=missing)


# ---------------------------------------------------------------------- figures of each kind of run
def _of_roadmap(run: Run, case: Case) -> Iterator[Check]:
    """Largest hook load and surface torque of the roadmap, at any of its friction factors."""
    file = run.folder.path / "roadmap.csv"
    if not file.is_file():  # of calibrate
        return
    table = read_table(file)
    known = np.asarray(table.get("status [-]", "ok")) == "ok"
    for name, title, key in (
        ("Hook load", "hook_load_total [N]", "max_hookload"),
        ("Surface torque", "surface_torque [N m]", "max_surface_torque"),
    ):
        values = np.where(known, table.get(title, np.nan), -np.inf)
        if not np.isfinite(values).any():  # no row, or the folder of an older version
            continue
        k = int(values.argmax())
        factors = ", ".join(f"{table[f][k]:.3g}" for f in table if f.startswith("ff_"))
        operation = str(table["operation [-]"][k]).replace("_", " ")
        where = f"{operation}, bit at MD {table['bit_depth [m]'][k]:.6g} m, friction factors {factors}"
        limit = None if case.rig is None else getattr(case.rig, key)
        yield _upper(name, title, float(values[k]), limit, where, f"rig.{key}")


def _of_limits(run: Run, case: Case) -> Iterator[Check]:
    """The weakest places of the string, its pull and its weight on bit."""
    s = run.summary
    if not {"operation", "choices", "weakest"} <= set(s):  # a run that has not ended
        return
    operation, choices, weakest = str(s["operation"]).replace("_", " "), s["choices"], s["weakest"]
    if operation == "as the case":
        operation = "motion of the case"

    def at(row: Mapping[str, Any]) -> str:
        return f"{operation}: {row['item']} at MD {row['md']:.6g} m"

    row = weakest.get("safety_factor")
    if row:
        factor = choices["design_factor"]
        yield Check(
            "Safety factor against yield",
            "safety_factor [-]",
            row["value"],
            factor,
            at(row),
            factor / row["value"],
            True,
        )
    for name in _RATIOS:
        if row := weakest.get(name):
            yield _upper(label_of(f"{name} [-]", "SI"), f"{name} [-]", row["value"], 1.0, at(row))
    if row := weakest.get("side_force_per_joint"):
        title, limit = "side_force_per_joint [N]", choices["side_force_per_joint"]
        yield _upper(label_of(title, "SI"), title, row["value"], limit, at(row))
    if (row := s.get("margin_of_overpull")) and row.get("ratio"):
        where = f"{row['item']} at MD {row['md']:.6g} m gives way first"
        yield Check(
            "Margin of overpull", "overpull_margin [N]", row["margin"], 0.0, where, 1 / row["ratio"], True
        )
    turning = s.get("motion", {}).get("rotation") != 0.0
    row = (s.get("available_wob") or {}).get("drilling" if turning else "sliding")
    if row and row.get("wob") is not None and s.get("wob"):
        why = (
            f"then {row['limited_by']} buckling"
            if row["limited_by"] in ("helical", "sinusoidal")
            else row["limited_by"]
        )
        yield _upper("Weight on bit", "wob [N]", s["wob"], row["wob"], f"{operation}, {why}")


def _of_hydraulics(run: Run, case: Case) -> Iterator[Check]:
    """Pump pressure, and ECD in the open hole beside the window of pore and fracture pressure."""
    if flows := run.summary.get("flows"):
        most = max(flows, key=lambda flow: flow["pump_pressure"])
        limit = None if case.rig is None else case.rig.max_spp
        where = f"bit at MD {run.summary['bit_depth']:.6g} m"
        yield _upper(
            "Pump pressure", "pump_pressure [Pa]", most["pump_pressure"], limit, where, "rig.max_spp"
        )
    window = run.summary.get("window")
    file = run.folder.path / "pressure_profile.csv"
    if not window or not file.is_file():
        return
    table = read_table(file)
    tvd, ecd = table["tvd [m]"], table["ecd [kg/m3]"]
    inside = (table["md [m]"] >= run.summary["shoe_depth"]) & np.isfinite(ecd)
    inside &= (tvd >= window["tvd"][0]) & (tvd <= window["tvd"][-1])
    if not inside.any():
        return
    tvd, ecd = tvd[inside], ecd[inside]
    pore, frac = (np.interp(tvd, window["tvd"], window[name]) for name in ("pore", "frac"))
    place = (ecd - pore) / (frac - pore)
    for name, share, bound, below in (
        ("ECD below fracture gradient", place, frac, False),
        ("ECD above pore pressure", 1.0 - place, pore, True),
    ):
        k = int(share.argmax())
        where = f"at TVD {tvd[k]:.6g} m; margin as a share of the window"
        yield Check(name, "ecd [kg/m3]", float(ecd[k]), float(bound[k]), where, float(share[k]), below)


def _of_surge(run: Run, case: Case) -> Iterator[Check]:
    """Trip speed of the roadmap beside the largest one that stays within the window."""
    planned = None if case.roadmap is None else case.roadmap.trip_speed
    for operation in ("trip_in", "trip_out"):
        rows = [row for row in run.summary.get("max_trip_speed") or () if row["operation"] == operation]
        rows = [
            row
            for row in rows
            if row["max_trip_speed"] is not None and row["limited_by"] not in ("none", "-")
        ]
        if rows:
            row = min(rows, key=lambda row: row["max_trip_speed"])
            where = f"{row['pipe']} pipe, bit at MD {row['bit_depth']:.6g} m, {row['limited_by']}"
            share = _share(planned, row["max_trip_speed"])
            name = "Trip speed, " + ("running in" if operation == "trip_in" else "pulling out")
            yield Check(
                name,
                "trip_speed [m/s]",
                planned,
                row["max_trip_speed"],
                where,
                share,
                missing="roadmap.trip_speed",
            )


_OF: Mapping[str, Callable[[Run, Case], Iterator[Check]]] = {
    "roadmap": _of_roadmap,
    "limits": _of_limits,
    "hydraulics": _of_hydraulics,
    "surge": _of_surge,
}


# ---------------------------------------------------------------------- the box
def checks(runs: Sequence[Run], case: Case) -> list[Check]:
    """The figures of all runs beside their limits, the worst of each name."""
    worst: dict[str, Check] = {}
    for kind, found in _OF.items():
        for run in runs:
            if kind not in [k.key for k in run.kinds] or not run.summary:
                continue
            for check in found(run, case):
                known = worst.get(check.name)
                if known is None or (check.share or 0.0) > (known.share or 0.0):
                    worst[check.name] = check
    return list(worst.values())


@dataclass(frozen=True)
class Answer:
    """The box: its sentence, and rows (figure, value, limit, margin, state, where)."""

    sentence: str
    rows: list[tuple[str, str, str, str, str, str]]


def answer(runs: Sequence[Run], case: Case, system: System) -> Answer | None:
    """The box of a report in a system of units; None if no run has a figure with a limit."""
    found = checks(runs, case)
    if not found:
        return None

    def text(value: float | None, title: str) -> str:
        if value is None:
            return "-"
        if title.endswith("[-]"):
            return f"{value:.3g}" if value >= 0.001 else "0"
        return f"{texts(in_units(title, [value], system), DIGITS)[0]} {unit_of(title, system)[2]}".strip()

    rows = []
    for check in sorted(found, key=lambda check: (EXCEEDED, NEAR, WITHIN, UNKNOWN).index(check.state)):
        limit = text(check.limit, check.title)
        if check.limit is not None:
            limit = f"{'at least' if check.below else 'at most'} {limit}"
        value, where = text(check.value, check.title), lengths_shown(check.where, system)
        if check.share is None:
            where += f"; {check.missing} is not given" if check.missing else ""
        margin = text(check.margin, check.title)
        if check.share is not None and np.isfinite(check.share):
            margin += f" ({100 * (1 - check.share):.0f} %)"
        rows.append((check.name, value, limit, margin, check.state, where))
    return Answer(_sentence(found), rows)


def _sentence(found: Sequence[Check]) -> str:
    """What the reader must see first."""

    def names(state: str) -> str:
        return ", ".join(check.name for check in found if check.state == state)

    parts = []
    if beyond := names(EXCEEDED):
        parts.append(f"Limit exceeded: {beyond}.")
    if near := names(NEAR):
        parts.append(f"Less than {100 * (1 - CLOSE):.0f} % left: {near}.")
    if not parts:
        parts.append(f"All figures with a limit keep at least {100 * (1 - CLOSE):.0f} % of it.")
    if unknown := names(UNKNOWN):
        parts.append(f"Not compared, since the case gives no limit or plan: {unknown}.")
    return " ".join(parts)
