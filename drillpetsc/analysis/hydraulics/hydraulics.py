"""The `hydraulics` command: steady flow of a case, its losses and equivalent densities, for one or more flow rates."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from drillpetsc.analysis.hydraulics import rheology_fits
from drillpetsc.analysis.hydraulics import trade_formulas as trade
from drillpetsc.analysis.hydraulics.doubts import Pumped, PumpedString
from drillpetsc.analysis.hydraulics.flow_model import (
    LARGEST_FLOW,
    FlowModel,
    need_mud,
    whole_string,
)
from drillpetsc.analysis.hydraulics.losses import (
    Loss,
    balance,
    blend_excess,
    largest_loss,
    loss_rows,
    rounded_off,
)
from drillpetsc.analysis.hydraulics.nozzles import bit_flow, nozzle_rows
from drillpetsc.analysis.hydraulics.open_hole import (
    NOT_CHECKED,
    OpenHole,
    annulus_pressure_at,
    open_hole,
    shoe_depth,
    vertical_depth,
)
from drillpetsc.analysis.motion.run_options import options_of
from drillpetsc.arrays import FloatArray
from drillpetsc.case.blocks.items.string import Bit
from drillpetsc.case.blocks.well import Window
from drillpetsc.case.case import Case
from drillpetsc.case.plausible.plausible_string import beyond_curves, short_of_hole
from drillpetsc.case.quantities import largest, said
from drillpetsc.doubts import doubts_at
from drillpetsc.errors import CaseError
from drillpetsc.output.files.json_file import plain
from drillpetsc.output.files.run_folder import (
    FITS_TABLE,
    FLOW_CURVE_TABLE,
    LOSS_TABLE,
    NOZZLE_TABLE,
    PROFILE_TABLE,
    READINGS_TABLE,
)
from drillpetsc.output.job import Job, RunResult
from drillpetsc.output.quantities.tables import COLUMNS
from drillpetsc.output.shown_units import lengths_shown, shown_unit
from drillpetsc.physics.fluid.channel_flow import RESULT_NAMES
from drillpetsc.physics.roots import bracketed_root
from drillpetsc.time_function import Constant
from drillpetsc.unit_systems import System

_SPEED = RESULT_NAMES.index("speed")
CURVE = np.linspace(0.1, 1.25, 12)  # flow rates of the curve over the largest one asked for [-]
PER_BLOCK = 6  # flow rates side by side on the screen
SPP = "--spp"
SMALLEST_FLOW = 1e-5  # [m3/s]
STANDING = 1e-9  # share of the pump's flow below which mud stands still

Numbers = dict[str, float | None]


@dataclass(frozen=True)
class FlowResult:
    """Steady flow at one flow rate.

    flow_rate: [m3/s]; summary: of summary.json, None if absent; rows: of hydraulics.csv.
    profile: columns of pressure_profile.csv, nan where absent.
    limited_by: limit of the window that is passed, `none`, or `-` without a window.
    nozzles: rows of nozzles.csv, where there are any above the bit.
    """

    flow_rate: float
    summary: Numbers
    rows: list[Loss]
    profile: dict[str, FloatArray]
    limited_by: str
    warnings: list[str]
    nozzles: list[dict[str, Any]] = field(default_factory=list)


def default_flow(case: Case, notes: list[str]) -> float:
    """The flow rate of the case [m3/s]; its largest value where it varies, with a note.

    Raises CaseError if there is none.
    """
    fluid = need_mud(case, "hydraulics")
    flow = fluid.flow_rate
    if flow is None:  # a pump pressure instead
        return 0.0
    rate = flow.constant if isinstance(flow, Constant) else largest(flow)
    if not isinstance(flow, Constant):
        notes.append(
            f"fluid.flow_rate varies: its largest value, {said(rate, 'flow', case.shown_units)}, is taken; --flow takes others"
        )
    if rate < 0:
        raise CaseError(
            at="fluid.flow_rate",
            got=said(rate, "flow", case.shown_units),
            want="a flow rate above 0",
            hint="hydraulics is for normal circulation",
        )
    if rate == 0:
        raise CaseError(
            at="fluid.flow_rate",
            got=0,
            want="a flow rate above 0",
            hint="give --flow, such as --flow '500 gpm'",
        )
    return rate


def flow_at_pressure(flow: FlowModel, pressure: float, at: str) -> float:
    """Find the flow rate [m3/s] at which the pump, or the string's upper end, has a pressure [Pa].

    at: option or key of the pressure: `--spp` is that of the pump, before the surface line.
    Raises CaseError if the pressure does not start the flow, which a yield stress resists, or is beyond the largest flow.
    """
    units = flow.case.shown_units

    def excess(rate: float) -> float:
        flow.solve(rate)
        sums = balance(flow)
        return sums["pump_pressure"] - (0.0 if at == SPP else sums["surface_line_loss"]) - pressure

    start = pressure + excess(SMALLEST_FLOW) + rounded_off(flow)[0]
    if pressure <= start:
        raise CaseError(
            at=at,
            got=said(pressure, "pressure", units),
            want=f"above {said(start, 'pressure', units)}, which starts the flow",
        )
    high = 0.02
    while excess(high) < 0:
        if high >= LARGEST_FLOW:
            raise CaseError(
                at=at,
                got=said(pressure, "pressure", units),
                want=f"a pressure that gives at most {said(LARGEST_FLOW, 'flow', units)}",
            )
        high = min(2 * high, LARGEST_FLOW)
    return bracketed_root(excess, SMALLEST_FLOW, high, 1e-10, 1e-10)


class Hydraulics:
    """The flow model of a case and what all of its flow rates share.

    case: with mud and an open lower end.
    Raises CaseError if there is no such flow.
    """

    def __init__(self, case: Case) -> None:
        need_mud(case, "hydraulics")
        if case.bottom.plugged and not case.side_nozzles or not case.has_bore:
            raise CaseError(
                at="bottom.plugged" if case.bottom.plugged else "string",
                got=True if case.bottom.plugged else None,
                want="a string with a bore that is open at its lower end: the mud must get out",
            )
        self.case = case
        self.units = case.shown_units
        self.flow = FlowModel(case, whole_string(case), "pumping")
        self.flow.solve(0.0)
        still = self.flow.pressure("annulus")
        self.esd = None if still is None else self.flow.equivalent_density(still, self.flow.tvd)
        self.window = open_hole(case, case.window) if still is not None else None
        well = case.well
        self.end = None if well is None else float(well.survey.md[-1])
        self.shoe = shoe_depth(case)
        ready = PumpedString(case, self.flow, self.window, self.end)
        self.warnings = [*short_of_hole(case), *doubts_at(ready, "warning")]
        self.notes = doubts_at(ready, "remark")

    def at(self, rate: float) -> FlowResult:
        """Solve at a flow rate [m3/s]."""
        case, flow = self.case, self.flow
        flow.solve(rate)
        limited = NOT_CHECKED if self.window is None else self.window.limited_by(flow)
        rows = loss_rows(flow)
        groups, summary = (
            nozzle_rows(flow, rate),
            flow_figures(flow, rate, rows, self.shoe, self.end, self.window),
        )
        place = largest_loss(rows, self.units)
        warnings = doubts_at(
            Pumped(case, summary, self.units, place, flow, blend_excess(flow), rounded_off(flow)[1], limited)
        )
        if (
            case.fluid is None
            or case.fluid.pump_pressure is not None
            or abs(rate) > largest(case.fluid.flow_rate)
        ):
            warnings += beyond_curves(case, abs(rate))  # at the case's own flow rate the case is doubted
        return FlowResult(rate, summary, rows, self._profile(), limited, warnings, groups)

    def densities(self) -> Numbers:
        """Equivalent densities [kg/m3] at the bit, the last shoe and the end of the hole; None if absent."""
        return densities(self.flow, self.shoe, self.end)

    def _profile(self) -> dict[str, FloatArray]:
        flow = self.flow
        n = len(flow.md)
        out = {q.name: np.full(n, np.nan) for q in COLUMNS[PROFILE_TABLE] if q.name != "pump_flow"}
        out["md"], out["tvd"] = flow.md, flow.tvd
        for name, column in (("bore", "internal"), ("annulus", "annulus")):
            pressure, component = flow.pressure(name), getattr(flow.fluid, name)
            if pressure is None:
                continue
            out[f"{column}_pressure"] = pressure
            speed = component.element_results(flow.system.assembly)[:, _SPEED]
            out[f"{column}_speed"] = np.append(speed, speed[-1])
        if self.esd is not None:
            out["ecd"], out["esd"] = flow.equivalent_density(out["annulus_pressure"], out["tvd"]), self.esd
        if flow.fluid.annulus is not None and self.end is not None and self.end - flow.md[-1] > 1e-3:
            self._add_end(out)
        return out

    def _add_end(self, out: dict[str, FloatArray]) -> None:
        """Append the end of the hole, below the string, to the profile."""
        flow = self.flow
        tvd = vertical_depth(self.case, np.array([self.end]))
        pressure = flow.pressure_below(tvd)
        still = float(flow.equivalent_density(pressure, tvd)[0])
        last = {
            "md": self.end,
            "tvd": tvd[0],
            "annulus_pressure": pressure[0],
            "ecd": still,
            "annulus_speed": 0.0,
        }
        for name, values in out.items():
            out[name] = np.append(values, last.get(name, np.nan))


def flow_figures(
    flow: FlowModel,
    rate: float,
    rows: Sequence[Loss],
    shoe: float | None,
    end: float | None,
    window: OpenHole | None = None,
) -> Numbers:
    """Figures of summary.json [SI] of a steady flow that is solved, None if absent.

    rate: of the pump [m3/s]; rows: its losses; shoe, end: measured depths of the last shoe and of the end of the hole [m].
    window: of the open hole.
    """
    case = flow.case
    sums = balance(flow)
    out: Numbers = {q.name: None for q in COLUMNS["summary.json of hydraulics"]}
    out |= {k: v for k, v in sums.items() if k in out}
    out["pump_flow"] = rate
    out["bit_pressure"] = flow.bottom_pressure()
    if flow.fluid.annulus is not None:
        out |= densities(flow, shoe, end)
        out |= {} if window is None else window.margins(flow)
    for name in ("bore", "annulus"):
        out[f"{name}_volume"] = sum(row.volume for row in rows if row.channel == name)
    bit = flow.fluid.bit
    through = bit_flow(flow)
    if flow.fluid.side is not None:
        out["bit_flow"], out["side_flow"] = through, flow.fluid.side.outflow(flow.system.assembly)
    if bit is not None and bit.has_link and bit.end.nozzle:
        density = flow.fluid.constants.density
        power = trade.hydraulic_power(sums["bit_loss"], through)
        out["jet_velocity"] = trade.jet_velocity(through, bit.end.nozzle)
        out["impact_force"] = trade.impact_force(through, density, bit.end.nozzle)
        out["bit_power"] = power
        out["bit_share"] = sums["bit_loss"] / sums["pump_pressure"]
        last = case.string[-1]
        if isinstance(last, Bit):
            out["bit_power_per_area"] = trade.power_per_bit_area(power, last.od)
    out["hydraulic_power"] = trade.hydraulic_power(sums["pump_pressure"], rate)
    annulus = [row for row in rows if row.channel == "annulus"]
    if annulus:
        out["bottoms_up_time"] = _time_through(annulus, rate)
        out["lowest_annular_velocity"] = min(row.velocity for row in annulus)
    both = [row for row in rows if row.channel in ("bore", "annulus")]
    out["circulation_time"] = _time_through(both, rate)
    return out


def _time_through(rows: list[Loss], rate: float) -> float | None:
    """Time [s] that mud takes through the channels of ``rows``, by way of the bit; None where mud stands still.

    rate: of the pump [m3/s].  Nozzles above the bit leave less flow below them.
    """
    if any(row.flow < STANDING * rate for row in rows):
        return None
    return float(sum(row.volume / row.flow for row in rows))


def densities(flow: FlowModel, shoe: float | None, end: float | None) -> Numbers:
    """Equivalent densities [kg/m3] at the bit, at the shoe and at the end of the hole, at measured depths [m]."""
    out: Numbers = {}
    depths = {"ecd_bit": flow.string.depth, "ecd_shoe": shoe, "ecd_td": end}
    for name, md in depths.items():
        out[name] = None
        if md is None:
            continue
        at = np.array([md])
        tvd = vertical_depth(flow.case, at)
        value = float(flow.equivalent_density(annulus_pressure_at(flow, at, tvd), tvd)[0])
        out[name] = None if np.isnan(value) else value
    return out


def window_table(window: Window | None) -> dict[str, list[float] | None] | None:
    """The window for the summary: tvd [m] (None: one pair), pore and frac [kg/m3]."""
    if window is None:
        return None
    tvd = None if window.tvd is None else list(window.tvd)
    return {"tvd": tvd, "pore": list(window.pore), "frac": list(window.frac)}


# ---------------------------------------------------------------------- command
def run_hydraulics(
    job: Job, flows: Sequence[float] | None = None, pump_pressure: float | None = None
) -> RunResult:
    """Solve for the steady flow at some flow rates (collective).

    flows: flow rates [m3/s]; None: the case's.
    pump_pressure: [Pa], instead of flows: the flow rate that it gives is found.
    Every rank computes the same, the first one writes.
    """
    case = job.case
    with options_of(case):
        hydraulics = Hydraulics(case)
        at = SPP
        if pump_pressure is None and not flows:
            own = default_flow(case, hydraulics.notes)
            given = case.given_fluid.pump_pressure
            if given is None:
                flows = [own]
            else:
                pump_pressure, at = given.value(0.0), "fluid.pump_pressure"
        if pump_pressure is not None:
            flows = [flow_at_pressure(hydraulics.flow, pump_pressure, at)]
        assert flows
        results = [hydraulics.at(rate) for rate in flows]
        rates = np.unique(np.append(np.minimum(max(flows) * CURVE, 2 * LARGEST_FLOW), flows))
        curve = [_curve_row(hydraulics, rate) for rate in rates]
        folder = job.make_folder()
        summary = _summary(case, hydraulics, results)
    return job.result(folder, summary, _lines(case, results, summary), _tables(case, results, curve))


def _curve_row(hydraulics: Hydraulics, rate: float) -> Numbers:
    flow = hydraulics.flow
    flow.solve(float(rate))
    out: Numbers = {q.name: None for q in COLUMNS[FLOW_CURVE_TABLE]} | balance(flow)
    out |= {"pump_flow": float(rate), "bit_pressure": flow.bottom_pressure()}
    return out | (hydraulics.densities() if flow.fluid.annulus is not None else {})


def _tables(
    case: Case, results: list[FlowResult], curve: list[Numbers]
) -> dict[str, Iterable[dict[str, Any] | tuple[Any, ...]]]:
    """Rows of the files of all flow rates."""
    renamed = {"from": "upper", "to": "lower", "mean_velocity": "velocity"}
    names = [q.name for q in COLUMNS[LOSS_TABLE]]
    tables: dict[str, Iterable[dict[str, Any] | tuple[Any, ...]]] = {
        LOSS_TABLE: [
            tuple(r.flow_rate if q == "pump_flow" else getattr(row, renamed.get(q, q)) for q in names)
            for r in results
            for row in r.rows
        ],
        PROFILE_TABLE: [
            dict(zip([*r.profile, "pump_flow"], [*row, r.flow_rate], strict=True))
            for r in results
            for row in zip(*r.profile.values(), strict=True)
        ],
        FLOW_CURVE_TABLE: curve,
    }
    if results[0].nozzles:
        tables[NOZZLE_TABLE] = [row for r in results for row in r.nozzles]
    rheology = case.given_fluid.rheology
    mud = rheology_fits.readings(rheology)
    if mud is not None:
        tables[READINGS_TABLE] = zip(mud.speed, mud.rate, mud.reading, mud.stress, strict=True)
        fits = rheology_fits.fits(rheology)
        tables[FITS_TABLE] = [vars(f) | {"used": "yes" if f.used else "no"} for f in fits]
    return tables


def _summary(case: Case, hydraulics: Hydraulics, results: list[FlowResult]) -> dict[str, Any]:
    return {
        "title": case.title,
        "bit_depth": hydraulics.flow.string.depth,
        "hole_depth": hydraulics.end,
        "shoe_depth": hydraulics.shoe,
        "shoe_tvd": (
            None if hydraulics.shoe is None else float(vertical_depth(case, np.array([hydraulics.shoe]))[0])
        ),
        "window": window_table(case.window),
        "outlet_pressure": case.given_fluid.outlet_pressure.value(0.0),
        "flows": [
            {
                **r.summary,
                **({"nozzles": plain(r.nozzles)} if r.nozzles else {}),
                "limited_by": r.limited_by,
                "warnings": r.warnings,
            }
            for r in results
        ],
        "rheology": rheology_fits.figures(case.given_fluid.rheology) or None,
        "warnings": hydraulics.warnings,
        "notes": hydraulics.notes,
        "units": case.shown_units,
    }


def _nozzle_lines(results: list[FlowResult], system: System) -> list[str]:
    """A line for each group of nozzles and flow rate; nothing without nozzles above the bit."""
    if not results[0].nozzles:
        return []
    shown = [(q, *shown_unit(q.name, q.unit, system)) for q in COLUMNS[NOZZLE_TABLE] if q.name != "item"]
    lines = [
        "  Nozzles: "
        + ", ".join(f"{q.label.lower()} [{unit}]" if unit else q.label.lower() for q, _, unit in shown)
    ]
    for result in results:
        for row in result.nozzles:
            cells = "".join(
                f"{'-' if np.isnan(row[q.name]) else format(row[q.name] / size, '.5g'):>11}"
                for q, size, _ in shown
            )
            lines.append(f"  {row['item'][:16]:<16}{cells}")
    return lines


def _lines(case: Case, results: list[FlowResult], summary: dict[str, Any]) -> list[str]:
    size, unit = shown_unit("bit_depth", "m", summary["units"])
    lines = [
        f"{case.title or 'case'}: steady flow, string at rest, bit at MD {summary['bit_depth'] / size:.6g} {unit}"
    ]
    for first in range(0, len(results), PER_BLOCK):
        block = results[first : first + PER_BLOCK]
        for q in COLUMNS["summary.json of hydraulics"]:
            values = [result.summary[q.name] for result in block]
            if all(value is None for value in values) or (
                q in (*COLUMNS["losses"], *COLUMNS["levels"]) and not any(values)
            ):
                continue
            size, unit = shown_unit(q.name, q.unit, summary["units"])
            cells = "".join(f"{'-' if v is None else format(v / size, '.5g'):>10}" for v in values)
            lines.append(f"  {q.label:<28}{cells} {unit}".rstrip())
        if any(result.limited_by != NOT_CHECKED for result in block):
            lines.append(
                "  Open hole, limit passed: "
                + "; ".join(lengths_shown(r.limited_by, summary["units"]) for r in block)
            )
    return (
        lines
        + _nozzle_lines(results, summary["units"])
        + _mud_lines(case, summary["units"])
        + _warnings_by_flow(results, summary["units"])
    )


def _warnings_by_flow(results: list[FlowResult], system: System) -> list[str]:
    """One line for the warnings of several flow rates that differ in their numbers only: the first, and the other rates."""
    size, unit = shown_unit("pump_flow", "m3/s", system)
    alike: dict[str, list[tuple[str, str]]] = {}
    for result in results:
        for w in result.warnings:
            text = lengths_shown(w, system)
            alike.setdefault(re.sub(r"\d[\d.]*", "#", text), []).append(
                (f"{result.flow_rate / size:.5g}", text)
            )
    lines = []
    for (rate, text), *others in alike.values():
        also = f"; also at {', '.join(rate for rate, _ in others)} {unit}" if others else ""
        lines.append(f"  WARNING: at {rate} {unit}: {text}{also}")
    return lines


def _mud_lines(case: Case, system: System) -> list[str]:
    """The flow curves that fit the dial readings; nothing without readings."""
    found = rheology_fits.fits(case.given_fluid.rheology)
    if not found:
        return []
    (y, stress), (k, consistency) = (
        shown_unit(name, unit, system) for name, unit in (("yield_stress", "Pa"), ("consistency", "Pa s^n"))
    )
    lines = ["  Flow curves of the dial readings: model, fit, yield stress, index, consistency, misfit"]
    for f in found:
        lines.append(
            f"  {'*' if f.used else ' '} {f.model:<17}{f.fit:<14}{f.yield_stress / y:>10.4g}{f.index:>9.4f}{f.consistency / k:>10.4g}"
            f"{f.misfit / y:>10.3g}  {stress}, {consistency}"
        )
    return lines
