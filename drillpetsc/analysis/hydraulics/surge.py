"""The `surge` command: steady pressures of tripping, and the largest trip speed within the window of the open hole.

The string moves rigidly along the hole.  The solver's steady flow gives the pressures: mud that the string displaces
or leaves, dragged along by the string's wall (manual: sec-mud-string-speed).
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from drillpetsc.analysis.hydraulics.doubts import Tripped, TripPlan
from drillpetsc.analysis.hydraulics.dynamic_surge import ACCELERATION, dynamic_surge
from drillpetsc.analysis.hydraulics.flow_model import (
    SHORTEST_PIECE,
    FlowModel,
    Pipe,
    PlacedString,
    need_mud,
    string_at,
    whole_string,
)
from drillpetsc.analysis.hydraulics.hydraulics import default_flow, densities, window_table
from drillpetsc.analysis.hydraulics.losses import blend_excess, rounded_off
from drillpetsc.analysis.hydraulics.nozzles import bit_flow
from drillpetsc.analysis.hydraulics.open_hole import (
    NOT_CHECKED,
    WITHIN,
    OpenHole,
    open_hole,
    shoe_depth,
)
from drillpetsc.analysis.motion.run_options import options_of
from drillpetsc.case.blocks.well import Window
from drillpetsc.case.case import Case
from drillpetsc.doubts import doubts_at
from drillpetsc.errors import CaseError, SolveError
from drillpetsc.model.fluid import build_rheology
from drillpetsc.output.files.json_file import plain
from drillpetsc.output.files.run_folder import SURGE_TABLE, TRIP_SPEED_TABLE
from drillpetsc.output.job import Job, RunResult
from drillpetsc.output.progress import counted
from drillpetsc.output.quantities.tables import COLUMNS
from drillpetsc.output.shown_units import lengths_shown, shown_unit
from drillpetsc.physics.fluid.rheology import wall_shear
from drillpetsc.units import to_si

OPERATIONS = {"trip_in": 1.0, "trip_out": -1.0}  # operation -> sign of the string's speed, down positive
FASTEST = to_si("600 ft/min", "m/s")  # largest trip speed that is tried [m/s]
TOLERANCE = to_si("1 ft/min", "m/s")  # of the largest trip speed [m/s]
FAILED = "failed"  # in place of a limit: there is no steady flow at this speed
DEPTHS = 6  # bit depths of the table of largest speeds


@dataclass(frozen=True)
class SurgeRow:
    """One row of surge.csv, SI; None if absent.

    trip_speed, surge_pressure: signs as in the table; warnings: what makes the row invalid.
    side_flow: through nozzles above the bit; nan without any, and where they are closed with the pipe.
    dynamic_surge_pressure, dynamic_surge_time: of the start from rest; nan where it was not run or failed.
    """

    operation: str
    pipe: str
    bit_depth: float
    trip_speed: float
    pump_flow: float
    limited_by: str = FAILED
    warnings: tuple[str, ...] = ()
    bit_pressure: float = np.nan
    ecd_bit: float | None = None
    ecd_shoe: float | None = None
    ecd_td: float | None = None
    surge_pressure: float = np.nan
    bit_flow: float = np.nan
    outlet_flow: float = np.nan
    side_flow: float = np.nan
    dynamic_surge_pressure: float = np.nan
    dynamic_surge_time: float = np.nan


class Tripping:
    """One string at one depth with one state of its pipe.

    window: limits of the open hole, None: not compared; flow: rate of the pump while pumping [m3/s].
    """

    def __init__(
        self, case: Case, string: PlacedString, pipe: Pipe, window: OpenHole | None = None, flow: float = 0.0
    ) -> None:
        self.case, self.pipe, self.window = case, pipe, window
        self.pump = flow if pipe == "pumping" else 0.0
        self.flow = FlowModel(case, string, pipe, moving=True)
        self.shoe, self.end = shoe_depth(case), float(case.given_well.survey.md[-1])
        self._solve("at rest", self.pump, 0.0)
        self.at_rest = self.flow.bottom_pressure()
        self.limited_at_rest = self._limited()

    def _limited(self) -> str:
        return NOT_CHECKED if self.window is None else self.window.limited_by(self.flow)

    def _solve(self, what: str, pump: float, speed: float) -> None:
        """Solve for the flow; a SolveError names what was tried."""
        try:
            self.flow.solve(pump, speed)
        except SolveError as error:
            error.what = f"{what}, {self.pipe} pipe, bit at MD {self.flow.string.depth:g} m: {error.what}"
            raise

    def row(self, operation: str, speed: float) -> SurgeRow:
        """The row of a trip at a speed [m/s] before it is solved: without a steady flow."""
        return SurgeRow(operation, self.pipe, self.flow.string.depth, speed, self.pump)

    def limit(self, operation: str, speed: float) -> str:
        """Solve for a trip at a speed [m/s]; which limit of the window it passes."""
        self._solve(f"{operation}, {speed:g} m/s", self.pump, OPERATIONS[operation] * speed)
        return self._limited()

    def at(self, operation: str, speed: float) -> SurgeRow:
        """Solve for a trip at a speed [m/s].

        operation: trip_in or trip_out.
        """
        flow, velocity = self.flow, OPERATIONS[operation] * speed
        limited_by = self.limit(operation, speed)
        annulus, side, state = flow.fluid.annulus, flow.fluid.side, flow.system.assembly
        assert annulus is not None
        return replace(
            self.row(operation, speed),
            limited_by=limited_by,
            warnings=tuple(
                doubts_at(
                    Tripped(
                        self.case,
                        flow,
                        blend_excess(flow, velocity),
                        rounded_off(flow, velocity, ["annulus"])[1],
                    )
                )
            ),
            bit_pressure=flow.bottom_pressure(),
            surge_pressure=flow.bottom_pressure() - self.at_rest,
            bit_flow=bit_flow(flow),
            outlet_flow=float(annulus.outflow(state) or 0.0),
            side_flow=np.nan if side is None else side.outflow(state),
            **densities(flow, self.shoe, self.end),  # type: ignore[arg-type]
        )

    def fastest(self, operation: str) -> tuple[float, str]:
        """Find the largest speed [m/s] within the window, by bisection, and the limit that a larger one passes.

        0 where the mud is outside the window with the string at rest; ``FASTEST`` where no speed passes a limit.
        """
        if self.limited_at_rest not in (WITHIN, NOT_CHECKED):
            return 0.0, f"{self.limited_at_rest}, at rest"
        last = self.limit(operation, FASTEST)
        if last in (WITHIN, NOT_CHECKED):
            return FASTEST, last
        low, high = 0.0, FASTEST
        while high - low > TOLERANCE:
            middle = 0.5 * (low + high)
            found = self.limit(operation, middle)
            if found == WITHIN:
                low = middle
            else:
                high, last = middle, found
        return low, last

    def by_area(self, operation: str, speed: float) -> float:
        """Compute the pressure of an open pipe whose displaced mud goes up bore and annulus by their areas [Pa].

        The rule of Lapeyrouse, section by section with the friction law of the case; without nozzles and without a
        balance of friction.
        """
        flow, law = self.flow, build_rheology(self.case, annulus=True)
        annulus, mesh = flow.fluid.annulus, flow.mesh
        assert annulus is not None
        v, f = OPERATIONS[operation] * speed, flow.fluid.constants
        hole, outer = annulus.parameter("hole"), annulus.parameter("outer")
        bore = mesh.bore_area
        shared = v * (f.clinging + (outer - bore) / (hole - outer + bore))
        gap = annulus.parameter("gap")
        return float(np.sum(4 * wall_shear(law, shared, gap, True, f.density) / gap * mesh.length))


# ---------------------------------------------------------------------- command
@dataclass(frozen=True)
class Trips:
    """What `surge` computes.

    speeds: [m/s]; operations: trip_in, trip_out; pipes: closed, open, pumping.
    bit_depths: measured [m], None: the case's own and, with a window, some along the open hole.
    window: instead of the case's; flow: rate of the pump while pumping [m3/s], None: the case's.
    dynamic: a run from rest for each speed, too.
    """

    speeds: tuple[float, ...]
    operations: tuple[str, ...] = ("trip_in", "trip_out")
    pipes: tuple[Pipe, ...] = ("closed", "open")
    bit_depths: tuple[float, ...] | None = None
    window: Window | None = None
    flow: float | None = None
    dynamic: bool = False


def run_surge(job: Job, plan: Trips) -> RunResult:
    """Solve for the pressures of tripping (collective).

    Every rank computes the same, the first one writes.  Raises CaseError for a case without mud, well or annulus.
    """
    case = job.case
    _check(case, plan)
    notes: list[str] = []
    window = plan.window or case.window
    hole = open_hole(case, window)
    flow = _pump_rate(case, plan, notes) if "pumping" in plan.pipes else 0.0
    top = whole_string(case).top
    notes += doubts_at(TripPlan(case, plan.pipes, ACCELERATION if plan.dynamic else None, hole, top))
    absent: tuple[str, ...] = () if case.side_nozzles else ("side_flow",)
    absent += () if plan.dynamic else ("dynamic_surge_pressure", "dynamic_surge_time")
    names = [q.name for q in COLUMNS[SURGE_TABLE] if q.name not in absent]
    fastest: list[dict[str, Any]] = []
    with options_of(case):
        whole = whole_string(case)
        if whole.top > SHORTEST_PIECE:  # a trip moves the string from the rig
            whole = string_at(case, whole.depth)
        rows, by_area = _trips(case, plan, whole, hole, flow, job.comm.rank)
        if hole is not None:
            for string in _trip_depths(case, plan, whole):
                fastest += _fastest(case, string, plan, hole, flow)
        if all(row.limited_by == FAILED for row in rows):
            raise SolveError(f"no trip has a steady flow: {rows[0].warnings[0]}")
        folder = job.make_folder()
        table = [{name: vars(row)[name] for name in names} for row in rows]
        found = {
            "title": case.title,
            "units": case.shown_units,
            "window": window_table(window),
            "window_from": None if window is None else ("--window" if plan.window is not None else "case"),
            "surge": [cells | {"warnings": row.warnings} for cells, row in zip(table, rows, strict=True)],
            "max_trip_speed": fastest,
            "open_pipe_by_area": by_area,
            "notes": notes,
        }
    summary: dict[str, Any] = plain(found)
    tables = {SURGE_TABLE: table} | ({TRIP_SPEED_TABLE: fastest} if fastest else {})
    return job.result(folder, summary, _lines(case, rows, summary), tables)


def _pump_rate(case: Case, plan: Trips, notes: list[str]) -> float:
    """Flow rate of the pump while pumping [m3/s]; notes one that the case gives over time."""
    flow = default_flow(case, notes) if plan.flow is None else plan.flow
    if not flow:
        raise CaseError(
            at="--flow", want="a flow rate for --pipe pumping", hint="the case has a pump_pressure"
        )
    return flow


def _trips(
    case: Case, plan: Trips, whole: PlacedString, hole: OpenHole | None, flow: float, rank: int
) -> tuple[list[SurgeRow], list[dict[str, Any]]]:
    """Rows of all trips, and for an open pipe the pressures with the flow shared by areas."""
    rows: list[SurgeRow] = []
    by_area: list[dict[str, Any]] = []
    strings = [whole] if plan.bit_depths is None else [string_at(case, d) for d in plan.bit_depths]
    for pipe in plan.pipes:
        for string in strings:
            trip = Tripping(case, string, pipe, hole, flow)
            for operation in plan.operations:
                found = [_row(trip, operation, speed) for speed in plan.speeds]
                if plan.dynamic:
                    starts = counted(found, f"starts of {operation.replace('_', ' ')}", rank)
                    found = [_with_start(case, trip, row) for row in starts]
                rows += found
                if pipe == "open":
                    by_area.append(_by_area(trip, operation, max(plan.speeds), rows[-1]))
    return rows, by_area


def _check(case: Case, plan: Trips) -> None:
    need_mud(case, "surge")
    if case.well is None or not case.has_annulus:
        raise CaseError(
            at="well" if case.well is None else "fluid.annulus",
            want="a well with mud in the annulus for surge",
            hint="surge is the pressure of mud that the string displaces between itself and the hole",
        )
    solid = [p for p in plan.pipes if p != "closed"]
    bare = case.model_copy(update={"bottom": case.bottom.model_copy(update={"plugged": False})})
    if solid and not bare.has_bore:
        raise CaseError(at="--pipe", got=solid[0], want="closed: the string has no bore")


def _row(trip: Tripping, operation: str, speed: float) -> SurgeRow:
    """The row of one speed; one without a steady flow is marked, and the others go on."""
    try:
        return trip.at(operation, speed)
    except SolveError as error:
        return replace(trip.row(operation, speed), warnings=(error.what,))


def _with_start(case: Case, trip: Tripping, row: SurgeRow) -> SurgeRow:
    """The row with the pressure of the start; one whose run fails says why."""
    velocity = OPERATIONS[row.operation] * row.trip_speed
    try:
        start = dynamic_surge(case, trip.flow.string, trip.pipe, velocity, trip.pump)
    except SolveError as error:
        text = f"{row.operation}, {row.pipe} pipe, {row.trip_speed:g} m/s: no pressure of the start: {error.what}"
        return replace(row, warnings=(*row.warnings, text))
    return replace(row, dynamic_surge_pressure=start.pressure, dynamic_surge_time=start.time)


def _by_area(trip: Tripping, operation: str, speed: float, row: SurgeRow) -> dict[str, Any]:
    return {
        "operation": operation,
        "bit_depth": row.bit_depth,
        "trip_speed": speed,
        "by_area": trip.by_area(operation, speed),
        "solver": row.surge_pressure,
    }


def _trip_depths(case: Case, plan: Trips, whole: PlacedString) -> list[PlacedString]:
    """Strings of the table of largest speeds: at the depths given, or along the open hole down to the bit."""
    if plan.bit_depths is not None:
        return [string_at(case, d) for d in plan.bit_depths]
    first = shoe_depth(case) or 0.1 * whole.depth
    if not first < whole.depth - 1.0:
        return [whole]
    strings = []
    for depth in np.linspace(first, whole.depth, DEPTHS)[:-1]:
        try:
            strings.append(string_at(case, float(f"{depth:.6g}")))
        except CaseError:  # the top of the string would be inside a rigid item
            continue
    return [*strings, whole]


def _fastest(
    case: Case, string: PlacedString, plan: Trips, hole: OpenHole, flow: float
) -> list[dict[str, Any]]:
    out = []
    for pipe in plan.pipes:
        trip = Tripping(case, string, pipe, hole, flow)
        for operation in plan.operations:
            try:
                speed, limit = trip.fastest(operation)
            except SolveError:
                speed, limit = np.nan, FAILED
            values = (operation, pipe, string.depth, speed, limit)
            out.append(dict(zip([q.name for q in COLUMNS[TRIP_SPEED_TABLE]], values, strict=True)))
    return out


def _distinct(warnings: list[str]) -> list[str]:
    """Of warnings that differ by numbers alone, the one with the largest first number."""

    def size(text: str) -> float:
        found = re.search(r"\d+(\.\d+)?", text)
        return float(found[0]) if found else 0.0

    kept: dict[str, str] = {}
    for text in sorted(warnings, key=size):
        kept[re.sub(r"-?\d+(\.\d+)?", "#", text)] = text
    return sorted(kept.values())


def _lines(case: Case, rows: list[SurgeRow], summary: dict[str, Any]) -> list[str]:
    system = summary["units"]
    (d, depth), (v, speed), (p, pressure), (e, density) = (
        shown_unit(name, unit, system)
        for name, unit in (
            ("bit_depth", "m"),
            ("trip_speed", "m/s"),
            ("surge_pressure", "Pa"),
            ("ecd_bit", "kg/m3"),
        )
    )
    head = ("bit depth", "trip speed", "surge", "ECD at bit")
    lines = [
        f"{case.title or 'case'}: surge and swab, steady",
        f"  {'operation':<10}{'pipe':<9}" + "".join(f"{text:>12}" for text in head) + "  limited by",
        f"  {'':<19}" + "".join(f"{text:>12}" for text in (depth, speed, pressure, density)),
    ]
    for row in rows:
        ecd = row.ecd_bit
        lines.append(
            f"  {row.operation:<10}{row.pipe:<9}{row.bit_depth / d:>12.6g}{row.trip_speed / v:>12.4g}"
            f"{row.surge_pressure / p:>12.5g}{'-' if ecd is None else format(ecd / e, '.5g'):>12}  {lengths_shown(row.limited_by, system)}"
        )
    started = [row for row in rows if np.isfinite(row.dynamic_surge_pressure)]
    if started:
        lines.append("  while the string starts: surge, at the time")
    lines += [
        f"  {row.operation:<10}{row.pipe:<9}{row.bit_depth / d:>12.6g}{row.trip_speed / v:>12.4g}"
        f"{row.dynamic_surge_pressure / p:>12.5g}{row.dynamic_surge_time:>10.3g} s"
        for row in started
    ]
    if summary["max_trip_speed"]:
        lines.append("  largest trip speed within the window")
    for found in summary["max_trip_speed"]:
        fastest = "-" if found["max_trip_speed"] is None else f"{found['max_trip_speed'] / v:.4g}"
        fastest = f"> {fastest}" if found["limited_by"] in (WITHIN, NOT_CHECKED) else fastest
        lines.append(
            f"  {found['operation']:<10}{found['pipe']:<9}{found['bit_depth'] / d:>12.6g}{fastest:>12}{'':>24}  {lengths_shown(found['limited_by'], system)}"
        )
    lines += [
        f"  {found['operation']}, open pipe, {found['trip_speed'] / v:.4g} {speed}, bit at {found['bit_depth'] / d:.6g} {depth}: "
        f"{found['solver'] / p:.5g} {pressure}; flow shared by areas (handbook): {found['by_area'] / p:.5g} {pressure}"
        for found in summary["open_pipe_by_area"]
        if found["solver"] is not None
    ]
    return lines + [f"  WARNING: {w}" for w in _distinct([w for row in rows for w in row.warnings])]
