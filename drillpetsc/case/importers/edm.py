"""Landmark EDM exports (XML) through the package welleng: well path, drill string and hole as plain data of a case.

An EDM export is a flat list of database rows, often of several wellbores, assemblies and designs; it names no units. The database stores
lengths in feet, diameters in inches, weights in lb/ft and angles in degrees.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from drillpetsc.case.importers.components import Component, Kind, Piece, items_of, narrowest
from drillpetsc.case.importers.stations import Rules, stations_of
from drillpetsc.case.importers.table import Table
from drillpetsc.case.importers.witsml import Imported
from drillpetsc.case.key_paths import suggestion
from drillpetsc.errors import CaseError

INSTALL = "pip install 'drillpetsc[edm]'"
FOOT, INCH, LB_PER_FT = 0.3048, 0.0254, 0.45359237 / 0.3048
DRILL_STRING = ("drill", "bha")  # in the type of an assembly
PHASES = ("ACTUAL", "PLAN", "PROTOTYPE")  # of definitive surveys, the first that there is
LINE = 1  # rows of the database have no line
KEYS = {"od": "od_body", "id": "id_body", "blade": "od_body", "bit_od": "od_body"}
OPEN_WORDS = ("open", "oh", "hol")  # beginnings of codes of uncased sections
CASED_WORDS = ("cas", "csg", "liner", "lin", "ris", "tub", "con", "dri")  # of cased ones
_BIT, _NO_BIT = re.compile(r"\bbit\b"), re.compile(r"\b(?:sub|box|near.bit|motor|float|stab\w*)\b")


@dataclass(frozen=True)
class Wanted:
    """Choice among several entries of an export: names of the wellbore, of the assembly, of the design with the hole."""

    wellbore: str | None = None
    assembly: str | None = None
    hole: str | None = None


def import_edm(file: Path, wanted: Wanted) -> Imported:
    """The contribution of an export to a case.

    Raises CaseError without the package welleng, for a file that it cannot read, for names that the file does not have,
    and if a choice among several wellbores is needed.
    """
    reader = _opened(file)
    bore = _wellbore(reader, file, wanted.wellbore)
    out = Imported(str(bore.name))
    out.remarks.append(
        "an EDM export names no units: lengths taken in ft, diameters in in, weights in lb/ft, angles in deg"
    )
    _survey(reader, bore, file, out)
    _string(reader, bore, file, wanted.assembly, out)
    _hole(reader, bore, file, wanted.hole, out)
    return out


def _opened(file: Path) -> Any:
    """The reader of welleng on the file; CaseError if it is missing or fails."""
    try:
        from welleng.exchange.edm_stream import EDMReader
    except ImportError:
        want = "the package welleng, which reads EDM exports"
        raise CaseError(at="FILE", got=file, want=want, hint=INSTALL) from None
    try:
        return EDMReader(str(file), source_units="feet", with_geopressure=True, with_assemblies=True)
    except OSError:
        raise
    except KeyError as error:
        raise _unread(file, f"a row without the attribute {error.args[0] if error.args else ''}") from None
    except (SyntaxError, ValueError, LookupError, TypeError, ArithmeticError) as error:
        raise _unread(file, " ".join(str(error).split())[:200]) from None


def _unread(file: Path, hint: str) -> CaseError:
    return CaseError(got=file.name, want="an EDM export that can be read", hint=hint, file=file, line=LINE)


def _one_of(found: dict[str, Any], name: str, at: str, what: str) -> Any:
    """The entry of this name, whatever the case of its letters; CaseError with the names that there are."""
    for key, value in found.items():
        if key.casefold() == name.casefold():
            return value
    has = ", ".join(sorted(found)) or "none"
    raise CaseError(
        at=at, got=name, want=f"{what} of the file: {has}"[:600], hint=suggestion(name, list(found))
    )


def _wellbore(reader: Any, file: Path, name: str | None) -> Any:
    """The wellbore of this name; without one, the only one that has a definitive survey."""
    bores = {str(bore.name): bore for bore in reader.wellbores.values()}
    if not bores:
        raise _unread(file, "it has no wellbore (CD_WELLBORE)")
    if name is not None:
        return _one_of(bores, name, "--wellbore", "a wellbore")
    with_survey = [key for key, bore in bores.items() if reader.survey_headers(bore)]
    chosen = with_survey or list(bores)
    if len(chosen) > 1:
        want = f"--wellbore with one of: {', '.join(sorted(chosen))}"[:600]
        raise CaseError(at="--wellbore", got=f"{len(chosen)} wellbores in {file.name}", want=want)
    return bores[chosen[0]]


# ---------------------------------------------------------------------- well path
def _survey(reader: Any, bore: Any, file: Path, out: Imported) -> None:
    """Stations of the definitive survey; left out, with a remark, if the file has none."""
    for phase in PHASES:
        headers = reader.survey_headers(bore, phase=phase)
        if headers:
            break
    else:
        out.remarks.append(f"{bore.name} has no definitive survey")
        return
    found = reader.survey(bore, phase=phase)
    told = f"definitive survey {found.header.name or found.header.header_id} ({phase}), {len(found)} stations"
    others = len(reader.survey_headers(bore)) - 1
    out.remarks.append(told + (f"; {others} other surveys left out" if others else ""))
    names = ("md", "inc", "azi", "tvd", "north", "east")
    columns = ("md", "inclination", "azimuth", "tvd", "ns", "ew")
    units = ("ft", "deg", "deg", "ft", "ft", "ft")
    rows = [
        (i, [_cell(getattr(station, name)) for name in names])
        for i, station in enumerate(found.stations, start=1)
    ]
    table = Table(
        file,
        list(names),
        LINE,
        {column: (k, units[k]) for k, column in enumerate(columns)},
        rows,
        counted="station",
    )
    stations = stations_of(table, Rules())
    out.remarks += stations.remarks
    degrees = [
        [f"{math.degrees(angle):.10g} deg" for angle in angles]
        for angles in (stations.inclination, stations.azimuth)
    ]
    out.survey = {
        "md": [f"{md:.10g} m" for md in stations.md],
        "inclination": degrees[0],
        "azimuth": degrees[1],
    }
    out.end = stations.md[-1]


def _cell(value: float | None) -> str:
    return repr(float(value)) if value is not None and math.isfinite(value) else ""


def _size(value: Any, unit: float) -> float | None:
    """A number of the database in SI; None if there is none above zero."""
    try:
        number = float(value)
    except (TypeError, ValueError):
        return None
    return number * unit if math.isfinite(number) and number > 0 else None


def _depth(value: Any) -> float | None:
    """A depth of the database [m], 0 included; None if there is none."""
    try:
        number = float(value)
    except (TypeError, ValueError):
        return None
    return number * FOOT if math.isfinite(number) and number >= 0 else None


# ---------------------------------------------------------------------- string
def _string(reader: Any, bore: Any, file: Path, name: str | None, out: Imported) -> None:
    """Items of the drill string, from the rig down; left out, with a remark, if the file has none or several."""
    every = {str(assembly.name or assembly.assembly_id): assembly for assembly in reader.assemblies(bore)}
    drilling = {
        key: assembly
        for key, assembly in every.items()
        if any(word in str(assembly.string_type).casefold() for word in DRILL_STRING)
    }
    if name is not None:
        assembly = _one_of(every, name, "--assembly", "an assembly")
    elif len(drilling) == 1:
        assembly = next(iter(drilling.values()))
    else:
        names = ", ".join(sorted(drilling))
        out.remarks.append(
            f"{len(drilling)} drill strings ({names}): choose one with --assembly"[:600]
            if drilling
            else "the file has no drill string of this wellbore"
        )
        return
    told = str(assembly.name or assembly.assembly_id)
    components = list(assembly.components)
    if not components:
        out.remarks.append(f"the string {told} has no components")
        return
    ordered = _from_the_top(components, assembly, file, told, out.remarks)
    out.string += items_of([_component(component, file) for component in ordered], out.remarks)
    out.remarks.append(f"string {told}; grades, threads, motors and bends are left out")


def _from_the_top(
    components: Sequence[Any], assembly: Any, file: Path, told: str, remarks: list[str]
) -> Sequence[Any]:
    """Components from the rig down: the bit is the lowest; without a bit, by the flag of the assembly."""
    bits = [i for i, component in enumerate(components) if _kind(component) == "bit"]
    if bits == [len(components) - 1]:
        return components
    if bits == [0]:
        return components[::-1]
    if bits:
        got = f"bit as number {bits[-1] + 1} of {len(components)} in {told}"
        want = "the bit at an end of the string"
        raise CaseError(at="CD_ASSEMBLY_COMP", got=got, want=want, file=file, line=LINE)
    flag = str(assembly.raw.get("is_top_down", "")).upper()
    if flag not in ("Y", "N"):
        remarks.append(
            f"{told} has no bit and no order (is_top_down): its first component taken as the lowest"
        )
    return components if flag == "Y" else components[::-1]


def _words(component: Any) -> str:
    raw = component.raw
    parts = (component.sect_type_code, raw.get("comp_type_code", ""), raw.get("comp_name", ""))
    return " ".join(str(part) for part in (*parts, component.description) if part)


def _kind(component: Any) -> Kind:
    """Kind of item for a component, by its codes or otherwise by its description."""
    codes = {str(component.sect_type_code).upper(), str(component.raw.get("comp_type_code", "")).upper()}
    words = _words(component).casefold()
    if any(code.startswith("BIT") for code in codes) or (_BIT.search(words) and not _NO_BIT.search(words)):
        return "bit"
    if any(code.startswith("STAB") or code == "STB" for code in codes) or "stabili" in words:
        return "stabilizer"
    if codes & {"HW", "HWDP"} or "heavy" in words or "hwdp" in words:
        return "hwdp"
    if codes & {"DC", "NMDC", "SDC"} or "collar" in words:
        return "drill_collar"
    if "DP" in codes or "drill pipe" in words or "drillpipe" in words:
        return "drill_pipe"
    return "other"


def _component(component: Any, file: Path) -> Component:
    words = _words(component)
    name = str(component.raw.get("comp_name") or component.description or component.sect_type_code or "item")
    joint = [
        _size(component.od_connection, INCH),
        _size(component.id_connection, INCH),
        _size(component.length_tool_joint, FOOT),
    ]
    outer, inner, length = joint
    low = words.casefold()
    return Component(
        kind=_kind(component),
        words=words,
        name=" ".join(name.split())[:60],
        length=_size(component.length, FOOT),
        od=_size(component.od_body, INCH),
        bore=_size(component.id_body, INCH) or 0.0,
        weight=_size(component.approximate_weight, LB_PER_FT),
        blade=_size(component.raw.get("od_blade"), INCH),
        nozzle_area=_size(component.raw.get("tfa"), INCH**2),
        tool_joint=(outer, inner, length) if outer and inner and length else None,
        nonmagnetic="non-mag" in low or "nonmag" in low or "non mag" in low or "nmdc" in low,
        tube=str(component.sect_type_code).upper() in ("CAS", "TUB"),
        keys=KEYS,
        file=file,
        line=LINE,
    )


# ---------------------------------------------------------------------- hole
def _hole(reader: Any, bore: Any, file: Path, name: str | None, out: Imported) -> None:
    """Sections of the hole; left out, with a remark, if the file has none or several different designs."""
    groups = reader.hole_section_groups(bore)
    named: dict[str, list[Any]] = {}
    for group in groups:
        sections = reader.geometry(bore, group.group_id)
        for key in group.case_names or [group.group_id]:
            named.setdefault(str(key), sections)
    if name is not None:
        sections = _one_of(named, name, "--hole", "a design")
    elif not groups:
        out.remarks.append("the file has no hole sections of this wellbore")
        return
    else:
        designs = {
            tuple(_piece_key(section) for section in sections): sections for sections in named.values()
        }
        if len(designs) > 1:
            out.remarks.append(
                f"{len(named)} designs of the hole ({', '.join(sorted(named))}): choose one with --hole"[:600]
            )
            return
        sections = next(iter(designs.values()))
    pieces = _pieces(sections, file)
    if pieces:
        out.sections += narrowest(pieces, "CD_HOLE_SECT", file, LINE)


def _piece_key(section: Any) -> tuple[Any, ...]:
    """All that ``_pieces`` reads of a section: designs that differ in any of it are different."""
    sizes = ("sect_type_code", "id_casing", "hole_size", "length", "md_shoe")
    raw = ("md_base", "effective_diameter", "cof")
    return (*(getattr(section, size) for size in sizes), *(section.raw.get(name) for name in raw))


def _pieces(sections: Sequence[Any], file: Path) -> list[Piece]:
    """Pieces of the hole, by the depth of their lower ends."""
    out: list[Piece] = []
    for section in sections:
        code = str(section.sect_type_code).casefold()
        is_open = code.startswith(OPEN_WORDS)
        if not is_open and not code.startswith(CASED_WORDS):
            want = "CAS, OPEN or another code of casing, liner, riser or open hole"
            raise CaseError(
                at="sect_type_code", got=section.sect_type_code or "nothing", want=want, file=file, line=LINE
            )
        raw = section.raw
        bottom = _size(section.md_shoe, FOOT) or _size(raw.get("md_base"), FOOT)
        effective = _size(raw.get("effective_diameter"), INCH)
        inner = (effective or _size(section.hole_size, INCH)) if is_open else _size(section.id_casing, INCH)
        for at, value in (("md_shoe", bottom), ("hole_size" if is_open else "id_casing", inner)):
            if value is None:
                told = section.description or section.sect_type_code
                raise CaseError(at=at, got=f"{told}: nothing", want="a value above 0", file=file, line=LINE)
        assert bottom is not None and inner is not None
        length = _size(section.length, FOOT)
        top = _depth(raw.get("md_top"))
        if top is None:
            top = max(bottom - length, 0.0) if length else 0.0
        if top >= bottom:
            got = f"{top:g} to {bottom:g} m"
            raise CaseError(at="md_top", got=got, want="above md_shoe", file=file, line=LINE)
        friction = _size(raw.get("cof"), 1.0)
        out.append(Piece(top, bottom, inner, "open_hole" if is_open else "casing", friction))
    return out
