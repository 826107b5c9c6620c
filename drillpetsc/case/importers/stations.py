"""Stations of a survey from a table of texts: numbers, missing rows, ties, the start, doglegs, positions."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from drillpetsc.case.importers.table import _POINTED, _THOUSANDS, NEEDED, SI_UNIT, Table
from drillpetsc.case.quantities import said
from drillpetsc.errors import CaseError
from drillpetsc.unit_systems import System
from drillpetsc.units import UnitError, to_si

MOST_ERRORS = 10
MISSING = (-999.25, -999.0, -9999.0, -9999.25)  # what other programs write for no value
STEEPEST_START = math.radians(
    5
)  # of a first station below measured depth 0, above which the hole is taken as vertical
STRAIGHT = math.radians(0.5)  # inclination below which an azimuth has no meaning
SHARPEST = math.radians(30) / 30  # [rad/m] dogleg of a typing error
SAME_DEPTH = 1e-6  # [m]
NO_ROW = -1  # of a station that is in no row
_NUMBER = re.compile(r"[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d{1,3})?", re.ASCII)


@dataclass
class Stations:
    """A survey in SI.

    md: [m]; inclination, azimuth: [rad]
    remarks: what was assumed, left out or found
    """

    md: list[float] = field(default_factory=list)
    inclination: list[float] = field(default_factory=list)
    azimuth: list[float] = field(default_factory=list)
    remarks: list[str] = field(default_factory=list)


@dataclass(frozen=True)
class Rules:
    """Limits of a survey.

    units: unit system of the case, for columns without a unit; SI: metres and degrees
    tie_in: (md [m], inclination [rad], azimuth [rad]) of the station before the first
    allow_dogleg: sharp bends are not typing errors
    exact: a file that this program wrote: nothing is corrected
    columns: quantity -> title of its column, for titles that are not known
    """

    units: System = "SI"
    tie_in: tuple[float, float, float] | None = None
    allow_dogleg: bool = False
    exact: bool = False
    columns: Mapping[str, str] = field(default_factory=dict)


def stations_of(table: Table, rules: Rules) -> Stations:
    """The stations of a table. CaseError for bad cells and impossible stations, at most ten at once."""
    out = Stations(remarks=list(table.remarks))
    units = _units(table, rules, out.remarks)
    numbers, values, given = _numbers(table, units, out)
    _ordered(table, numbers, values, out.remarks)
    if rules.tie_in is not None:
        _tied(table, rules.tie_in, numbers, values)
    if len(values["md"]) < 2:
        raise CaseError(
            file=table.file,
            line=table.head_at,
            got=f"{len(values['md'])} stations",
            want="at least two stations",
        )
    if not rules.exact:
        _from_the_top(table, numbers, values, out.remarks)
        _positions(
            table, numbers, values, given, out.remarks
        )  # with the azimuths that its positions belong to
        _no_twist(values, out.remarks)
        if not rules.allow_dogleg:
            _smooth(table, numbers, values)
    elif values["md"][0] != 0:
        want = "a first station at 0 m (the rotary table)"
        raise CaseError(at="md", got=values["md"][0], want=want, file=table.file, line=table.line(numbers[0]))
    out.md, out.inclination, out.azimuth = (values[key] for key in NEEDED)
    return out


# ---------------------------------------------------------------------- cells
def _units(table: Table, rules: Rules, remarks: list[str]) -> dict[str, str]:
    """Unit text of each column."""
    units = {}
    depth_unit = table.columns["md"][1] or table.depth_unit or ("ft" if rules.units == "field" else "m")
    for column, (_, unit) in table.columns.items():
        if not unit and SI_UNIT[column] == "m":
            unit = depth_unit
            if not table.depth_unit and rules.units == "SI" and column == "md" and not rules.exact:
                remarks.append("no unit of depth in the file: metres taken")
        elif not unit and SI_UNIT[column] == "rad":
            unit = "deg"
        units[column] = unit
    return units


def number_of(text: str, comma: str) -> float | None:
    """Number of a cell; None for a text that is not a finite number."""
    text = text.strip().strip("\"'").strip()
    if comma == "decimal" and "," in text:
        text = text.replace(".", "").replace(",", ".") if text.count(",") == 1 else "no number"
    elif comma == "decimal" and _POINTED.fullmatch(text):
        text = text.replace(".", "")
    elif "," in text and _THOUSANDS.fullmatch(text):
        text = text.replace(",", "")
    number = float(text) if _NUMBER.fullmatch(text) else math.inf
    return number if math.isfinite(number) else None


_ALLOWED = {
    "md": (0.0, 50e3, "a depth from 0 to 50 km"),
    "inclination": (0.0, math.pi, "an inclination from 0 to 180 degrees"),
    "azimuth": (-2 * math.pi, 2 * math.pi, "an azimuth in decimal degrees from -360 to 360, such as 23.0"),
}


def _numbers(
    table: Table, units: dict[str, str], out: Stations
) -> tuple[list[int], dict[str, list[float]], dict[int, dict[str, float]]]:
    """(places of the stations in the list of rows, values [SI] of the three columns, values of other columns by place, for
    comparison)."""
    scale = {column: to_si(f"1 {unit}", SI_UNIT[column]) for column, unit in units.items() if unit}
    numbers: list[int] = []
    values: dict[str, list[float]] = {column: [] for column in NEEDED}
    given: dict[int, dict[str, float]] = {}
    errors: list[CaseError] = []
    missing: list[int] = []
    for place, (number, cells) in enumerate(table.rows):
        texts = {
            column: cells[i].strip() if i < len(cells) else "" for column, (i, _) in table.columns.items()
        }
        absent = {
            column for column, text in texts.items() if not text or number_of(text, table.comma) in MISSING
        }
        if absent & set(NEEDED):
            if not absent >= set(NEEDED):
                missing.append(number)
            continue
        row: dict[str, float] = {}
        for column in NEEDED:
            try:
                row[column] = _value(texts[column], column, units[column], table.comma)
            except UnitError as error:
                got = texts[column] or "an empty cell"
                errors.append(
                    CaseError(
                        at=table.at(place, column),
                        got=got,
                        want=error.want,
                        hint=error.hint,
                        file=table.file,
                        line=number,
                    )
                )
                break
        if len(row) < len(NEEDED):
            if len(errors) >= MOST_ERRORS:
                break
            continue
        numbers.append(place)
        for column in NEEDED:
            values[column].append(row[column])
        others = {
            column: value * scale[column]
            for column in scale
            if column not in NEEDED and column not in absent
            for value in [number_of(texts[column], table.comma)]
            if value is not None
        }
        if others:
            given[place] = others
    if errors:
        raise together(errors)
    if missing:
        out.remarks.append(
            f"{len(missing)} rows with missing values left out ({table.counted}s {_few(missing)})"
        )
    return numbers, values, given


def together(errors: Sequence[CaseError]) -> CaseError:
    """The first error, with the others behind it."""
    first, *others = errors
    first.also = tuple(others)
    return first


def _value(text: str, column: str, unit: str, comma: str) -> float:
    low, high, words = _ALLOWED[column]
    number = number_of(text, comma)
    if number is None:
        bearing = column == "azimuth" and re.match(r"[NSns]", text)
        want = words if bearing else f"a number in {unit}"
        raise UnitError(text, want, "a bearing: write it as an azimuth" if bearing else "")
    value = to_si(f"{number!r} {unit}", SI_UNIT[column])
    if not low - 1e-9 <= value <= high + 1e-9:
        raise UnitError(text, words)
    return min(max(value, low), high)


def _few(numbers: Sequence[int]) -> str:
    return ", ".join(map(str, numbers[:8])) + (", ..." if len(numbers) > 8 else "")


# ---------------------------------------------------------------------- stations
def _ordered(table: Table, numbers: list[int], values: dict[str, list[float]], remarks: list[str]) -> None:
    """Leave out repeated stations; refuse falling depths."""
    errors: list[CaseError] = []
    repeated: list[int] = []
    keep: list[int] = []
    md = values["md"]
    for i in range(len(md)):
        if not keep or md[i] > md[keep[-1]] + SAME_DEPTH:
            keep.append(i)
            continue
        last = keep[-1]
        if abs(md[i] - md[last]) <= SAME_DEPTH:
            if _between(values, last, i) < 1e-6:
                repeated.append(table.line(numbers[i]))
                continue
            want = f"one direction at each depth; {table.told(numbers[last])} has another at {md[last]:g} m"
        else:
            want = f"rising depths: above {md[last]:g} m, the station before"
        at, line = table.at(numbers[i], "md"), table.line(numbers[i])
        errors.append(CaseError(at=at, got=md[i], want=want, file=table.file, line=line))
        if len(errors) >= MOST_ERRORS:
            break
    if errors:
        raise together(errors)
    if repeated:
        remarks.append(f"{len(repeated)} repeated stations left out ({table.counted}s {_few(repeated)})")
    for column in values:
        values[column][:] = [values[column][i] for i in keep]
    numbers[:] = [numbers[i] for i in keep]


def _tied(
    table: Table, tie_in: tuple[float, float, float], numbers: list[int], values: dict[str, list[float]]
) -> None:
    """Insert the tie-in station before the first one."""
    if values["md"] and tie_in[0] >= values["md"][0] - SAME_DEPTH:
        want = f"a tie-in station above the first of the file, {values['md'][0]:g} m"
        raise CaseError(
            at="tie_in", got=f"{tie_in[0]:g} m", want=want, file=table.file, line=table.line(numbers[0])
        )
    for column, value in zip(NEEDED, tie_in, strict=True):
        values[column].insert(0, value)
    numbers.insert(0, NO_ROW)


def _from_the_top(
    table: Table, numbers: list[int], values: dict[str, list[float]], remarks: list[str]
) -> None:
    """Insert a vertical station at measured depth 0 before a first station below it."""
    md, inclination = values["md"][0], values["inclination"][0]
    if md <= SAME_DEPTH:
        values["md"][0] = 0.0
        return
    if inclination >= STEEPEST_START:
        what = f"survey starts at {said(md, 'length')} with {math.degrees(inclination):.3g} deg"
        want = "a first station at 0 m (the rotary table), of the file or as tie_in: the hole above must be known"
        hint = "survey: {file: ..., tie_in: {md: 0 m, inclination: 0 deg, azimuth: 0 deg}}"
        raise CaseError(at="md", got=what, want=want, hint=hint, file=table.file, line=table.line(numbers[0]))
    remarks.append(
        f"survey starts at {said(md, 'length')}: a vertical station at {said(0.0, 'length')} inserted"
    )
    for column, value in (("md", 0.0), ("inclination", 0.0), ("azimuth", values["azimuth"][0])):
        values[column].insert(0, value)
    numbers.insert(0, NO_ROW)


def _no_twist(values: dict[str, list[float]], remarks: list[str]) -> None:
    """Replace azimuths of vertical stations, which have no meaning, by the azimuth of the next inclined station."""
    inclined = [i for i, angle in enumerate(values["inclination"]) if angle >= STRAIGHT]
    if not inclined:
        return
    azimuth, count, position = values["azimuth"], 0, 0
    for i in range(len(azimuth)):
        if not 0 < values["inclination"][i] < STRAIGHT:
            continue
        while position < len(inclined) - 1 and inclined[position] < i:
            position += 1
        new = azimuth[inclined[position]]
        if abs(math.remainder(new - azimuth[i], 2 * math.pi)) > math.radians(1):
            count += 1
        azimuth[i] = new
    if count:
        remarks.append(f"azimuths of {count} stations below 0.5 deg of inclination not used")


def _smooth(table: Table, numbers: list[int], values: dict[str, list[float]]) -> None:
    """Refuse doglegs that are impossible in a hole."""
    errors = []
    for i in range(1, len(values["md"])):
        angle = _between(values, i - 1, i)
        length = values["md"][i] - values["md"][i - 1]
        if angle > SHARPEST * length:
            got = f"{math.degrees(angle):.3g} deg in {length:.3g} m above {values['md'][i]:g} m"
            want = "at most 30 deg/30 m between stations"
            hint = "a wrong cell? If the hole is like that: survey: {file: ..., allow_dogleg: true}"
            line, at = table.line(numbers[i]), table.at(numbers[i], "inclination")
            errors.append(CaseError(at=at, got=got, want=want, hint=hint, file=table.file, line=line))
            if len(errors) >= MOST_ERRORS:
                break
    if errors:
        raise together(errors)


def _between(values: dict[str, list[float]], i: int, j: int) -> float:
    """Angle between the directions of two stations [rad]."""
    return dogleg(
        values["inclination"][i], values["azimuth"][i], values["inclination"][j], values["azimuth"][j]
    )


def dogleg(inclination: float, azimuth: float, next_inclination: float, next_azimuth: float) -> float:
    """Angle between two directions [rad], in a form exact for small angles (haversine)."""
    half = math.sin((next_inclination - inclination) / 2) ** 2
    turn = math.sin((next_azimuth - azimuth) / 2) ** 2
    return 2 * math.asin(
        math.sqrt(min(half + math.sin(inclination) * math.sin(next_inclination) * turn, 1.0))
    )


def minimum_curvature_step(
    length: float, inclination: float, azimuth: float, next_inclination: float, next_azimuth: float
) -> tuple[float, float, float]:
    """(north, east, down) [m] from one station to the next along an arc (minimum curvature, any survey manual).

    length: between the stations [m]; angles [rad]
    """
    angle = dogleg(inclination, azimuth, next_inclination, next_azimuth)
    ratio = 1.0 if angle < 1e-6 else 2 / angle * math.tan(min(angle, 3.14) / 2)
    a, b = math.sin(inclination), math.sin(next_inclination)
    north = a * math.cos(azimuth) + b * math.cos(next_azimuth)
    east = a * math.sin(azimuth) + b * math.sin(next_azimuth)
    down = math.cos(inclination) + math.cos(next_inclination)
    step = length / 2 * ratio
    return step * north, step * east, step * down


def cut_stations(
    md: Sequence[float], inclination: Sequence[float], azimuth: Sequence[float], depth: float
) -> tuple[tuple[float, ...], tuple[float, ...], tuple[float, ...]]:
    """Stations down to a measured depth [m], the last one on the arc between the stations around it (minimum curvature).

    md [m], inclination, azimuth [rad] of the stations. Directions on an arc are u = (sin((1 - f) D) u1 + sin(f D) u2)/sin D,
    with the angle D between the stations' and the share f of the length.
    """
    last = next(i for i, value in enumerate(md) if value >= depth - SAME_DEPTH)
    if abs(md[last] - depth) <= SAME_DEPTH:
        return (*md[:last], depth), tuple(inclination[: last + 1]), tuple(azimuth[: last + 1])
    share = (depth - md[last - 1]) / (md[last] - md[last - 1])
    angle = dogleg(inclination[last - 1], azimuth[last - 1], inclination[last], azimuth[last])
    a, b = 1 - share, share
    if angle > 1e-6:
        a, b = math.sin((1 - share) * angle) / math.sin(angle), math.sin(share * angle) / math.sin(angle)
    north, east, down = (
        a * part(last - 1) + b * part(last)
        for part in (
            lambda i: math.sin(inclination[i]) * math.cos(azimuth[i]),
            lambda i: math.sin(inclination[i]) * math.sin(azimuth[i]),
            lambda i: math.cos(inclination[i]),
        )
    )
    across = math.hypot(north, east)
    turned = math.atan2(east, north) if across > 1e-9 else azimuth[last]
    return (
        (*md[:last], depth),
        (*inclination[:last], math.atan2(across, down)),
        (*azimuth[:last], turned),
    )


def _positions(
    table: Table,
    numbers: list[int],
    values: dict[str, list[float]],
    given: dict[int, dict[str, float]],
    remarks: list[str],
) -> None:
    """Compare the positions in the file with positions computed from its angles."""
    at = [0.0, 0.0, 0.0]
    start: dict[str, float] = {}
    off: dict[str, list[tuple[int, float]]] = {}
    for i in range(len(values["md"])):
        if i:
            keys = ("inclination", "azimuth")
            angles = [values[key][j] for j in (i - 1, i) for key in keys]
            length = values["md"][i] - values["md"][i - 1]
            step = minimum_curvature_step(length, *angles)
            at = [position + part for position, part in zip(at, step, strict=True)]
            severity = _between(values, i - 1, i) / length
        else:
            severity = 0.0
        own = {"ns": at[0], "ew": at[1], "tvd": at[2]}
        for column, value in given.get(numbers[i], {}).items():
            if column == "dls":
                if abs(value - severity) > math.radians(0.5) / 30 + 0.1 * severity and i > 1:
                    off.setdefault(column, []).append((i, value - severity))
                continue
            if column != "tvd":  # measured from any point
                start.setdefault(column, value - own[column])
            difference = value - own[column] - start.get(column, 0.0)
            if abs(difference) > 1 + 1e-3 * values["md"][i]:
                off.setdefault(column, []).append((i, difference))
    names = {"tvd": "TVD", "ns": "N/S", "ew": "E/W", "dls": "dogleg severity"}
    for column, found in off.items():
        i, difference = found[0]
        unit = " m" if column != "dls" else " deg/30 m"
        size = abs(difference) if column != "dls" else math.degrees(abs(difference)) * 30
        more = f"; also at {len(found) - 1} other stations" if len(found) > 1 else ""
        remarks.append(
            f"WARNING: {names[column]} of the file is {size:.3g}{unit} off the minimum curvature of its angles at MD "
            f"{values['md'][i]:.6g} m ({table.told(numbers[i])}){more}"
        )
