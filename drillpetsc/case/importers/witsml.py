"""WITSML 1.4.1.1: trajectory, tubular and wellbore geometry as plain data of a case."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from drillpetsc.case.importers.components import Component, Kind, Piece, items_of, narrowest
from drillpetsc.case.importers.stations import number_of
from drillpetsc.case.importers.table import Table
from drillpetsc.case.importers.xml_tree import Element, first_element, read_xml
from drillpetsc.errors import CaseError
from drillpetsc.units import UnitError, to_si

NAMESPACE = "http://www.witsml.org/schemas/1series"
NAMESPACE_2 = "http://www.energistics.org/energyml/data/witsmlv2"
EDM_ROOT = "export"  # first element of a Landmark EDM export
OBJECTS = {"trajectorys": "trajectory", "tubulars": "tubular", "wbGeometrys": "wbGeometry"}
KEYS = {"length": "len", "od": "od", "id": "id", "blade": "odBladeMx", "bit_od": "diaBit"}


@dataclass
class Imported:
    """Contribution of a file to a case.

    title: name of the well
    survey: well.survey, the name of its file or stations as plain data, None without; end: its last measured depth [m]
    string: items from the top down; sections: of the hole; both as plain data with units as texts
    remarks: what was left out, replaced or assumed
    """

    title: str = ""
    survey: str | dict[str, Any] | None = None
    end: float = math.nan
    string: list[dict[str, Any]] = field(default_factory=list)
    sections: list[dict[str, Any]] = field(default_factory=list)
    remarks: list[str] = field(default_factory=list)


def read_witsml(file: Path) -> tuple[Element, str]:
    """(the one object of a file, its kind: trajectory, tubular or wbGeometry)."""
    if first_element(file) == EDM_ROOT:
        want = f"a WITSML document: {', '.join(OBJECTS)}"
        hint = f"an EDM export becomes a case by drillpetsc import {file.name} --out case.yaml"
        raise CaseError(got=f"<{EDM_ROOT}>", want=want, hint=hint, file=file, line=1)
    root = read_xml(file)
    if root.space == NAMESPACE_2 or "schemaVersion" in root.attributes:
        got = f"WITSML {root.attributes.get('schemaVersion', '2.0')}, <{root.name}>"[:80]
        hint = "version 2.0 has other elements and is not read: export 1.4.1.1, or a table in CSV"
        raise CaseError(got=got, want="WITSML 1.4.1", hint=hint, file=file, line=root.line)
    if root.name not in OBJECTS:
        want = f"a WITSML document: {', '.join(OBJECTS)}"
        raise CaseError(got=f"<{root.name}>"[:80], want=want, file=file, line=root.line)
    version = root.attributes.get("version", "")
    if root.space != NAMESPACE or not version.startswith("1.4.1"):
        got = f"version {version or 'unknown'}, namespace {root.space or 'none'}"
        want = f"WITSML 1.4.1, namespace {NAMESPACE}"
        raise CaseError(at=root.name, got=got, want=want, file=file, line=root.line)
    kind = OBJECTS[root.name]
    found = list(root.all(kind))
    if len(found) != 1:
        raise CaseError(
            at=root.name, got=f"{len(found)} objects", want=f"one {kind}", file=file, line=root.line
        )
    return found[0], kind


def told(element: Element, parent: Element | None) -> str:
    """An element in words: its own name and its parent's, with the uid that the parent has."""
    if parent is None:
        return element.name
    uid = parent.attributes.get("uid", "")
    return f"{parent.name} '{uid}': {element.name}" if uid else f"{parent.name}: {element.name}"


def _value(element: Element | None, unit: str, file: Path, parent: Element | None = None) -> float | None:
    """Value [SI] of an element with a unit in its attribute `uom`; None without an element or text.

    parent: of the element, for messages: in a file of one line the line says nothing
    """
    if element is None or not element.text.strip():
        return None
    number, uom = number_of(element.text, ""), element.attributes.get("uom", "")
    at, line = told(element, parent), element.line
    if number is None:
        raise CaseError(at=at, got=element.text.strip(), want="a number", file=file, line=line)
    if not uom:
        want = f"an attribute uom, the unit of {element.name}"
        raise CaseError(at=at, got=element.text.strip(), want=want, file=file, line=line)
    try:
        return to_si(f"{number!r} {uom}", unit)
    except UnitError as error:
        got = f"{element.text.strip()} {uom}"
        raise CaseError(at=at, got=got, want=error.want, hint=error.hint, file=file, line=line) from None


# ---------------------------------------------------------------------- trajectory
def trajectory_table(file: Path) -> Table:
    """Stations of a trajectory as a table in SI, sorted by depth; rows are lines of the file."""
    trajectory, kind = read_witsml(file)
    if kind != "trajectory":
        raise CaseError(got=f"a {kind}", want="a trajectory", file=file, line=trajectory.line)
    names = {"md": "m", "incl": "rad", "azi": "rad", "tvd": "m", "dispNs": "m", "dispEw": "m", "dls": "1/m"}
    columns = ("md", "inclination", "azimuth", "tvd", "ns", "ew", "dls")
    remarks: list[str] = []
    reference = trajectory.word("aziRef")
    if reference:
        remarks.append(f"azimuths from {reference}")
    rows: list[tuple[float, int, str, list[str]]] = []
    skipped = 0
    for station in trajectory.all("trajectoryStation"):
        uid = station.attributes.get("uid", "")
        values = [_value(station.first(name), unit, file, station) for name, unit in names.items()]
        md, inclination, azimuth = values[:3]
        if md is None or inclination is None or azimuth is None:
            skipped += 1
            continue
        rows.append((md, station.line, uid, ["" if value is None else repr(value) for value in values]))
    if skipped:
        remarks.append(f"{skipped} stations without depth, inclination or azimuth left out")
    rows.sort(key=lambda row: row[:2])
    si = ("m", "rad", "rad", "m", "m", "m", "1/m")
    found = {column: (i, si[i]) for i, column in enumerate(columns)}
    cells = [(line, texts) for _, line, _, texts in rows]
    uids = [uid for _, _, uid, _ in rows]
    return Table(file, list(names), trajectory.line, found, cells, remarks=remarks, uids=uids)


# ---------------------------------------------------------------------- import
def import_witsml(file: Path) -> Imported:
    """The parts of a case in a WITSML file."""
    found, kind = read_witsml(file)
    out = Imported(" ".join(filter(None, (found.word("nameWell"), found.word("nameWellbore")))))
    if kind == "tubular":
        _string(found, file, out)
    elif kind == "wbGeometry":
        _sections(found, file, out)
    return out


def _string(tubular: Element, file: Path, out: Imported) -> None:
    """Items of a tubular, from the top down."""
    components = list(tubular.all("tubularComponent"))
    if not components:
        raise CaseError(
            at="tubular", got="no tubularComponent", want="at least one", file=file, line=tubular.line
        )
    numbers = [number_of(component.word("sequence") or "x", "") for component in components]
    ordered = [number for number in numbers if number is not None]
    if len(ordered) == len(components) and len(set(ordered)) == len(ordered):
        pairs = sorted(zip(ordered, range(len(components)), strict=True))
        components = [components[i] for _, i in pairs]
    else:
        out.remarks.append("components without sequence: taken from the bit up, in the order of the file")
    bits = [i for i, component in enumerate(components) if _is_bit(component)]
    if bits and bits != [0]:
        component = components[bits[-1]]
        want = "the bit as the first component: sequence 1 is the lowest"
        raise CaseError(
            at="tubularComponent",
            got=f"bit as number {bits[-1] + 1}",
            want=want,
            file=file,
            line=component.line,
        )
    out.string += items_of([_component(component, file) for component in reversed(components)], out.remarks)
    out.remarks += [f"{_name(q)}: its bend is left out" for q in components if q.first("bend") is not None]


def _is_bit(component: Element) -> bool:
    return component.word("typeTubularComp").casefold().startswith("bit")


def _name(component: Element) -> str:
    name = component.word("name") or component.word("description") or component.word("typeTubularComp")
    return (name or "unknown")[:60]


def _component(component: Element, file: Path) -> Component:
    """The component in SI."""
    kind = component.word("typeTubularComp") or "unknown"
    words = kind.casefold()

    def size(*path: str, unit: str = "m") -> float | None:
        return _value(component.first(*path), unit, file, component)

    bit = _is_bit(component)
    od = (size("odMx") or size("od")) if bit else (size("od") or size("odMx"))
    return Component(
        kind="bit" if bit else _kind(words),
        words=kind,
        name=_name(component),
        length=size("len"),
        od=od,
        bore=size("id") or 0.0,
        weight=size("wtPerLen", unit="kg/m"),
        blade=size("stabilizer", "odBladeMx") or size("odMx"),
        bit_od=size("bitRecord", "diaBit"),
        nozzle_area=_nozzles(component, file) if bit else None,
        tool_joint=_tool_joint(component, file, od) if "drill pipe" in words and od else None,
        nonmagnetic="non-mag" in words or "nonmag" in words,
        tube="casing" in words or "tubing" in words,
        keys=KEYS,
        file=file,
        line=component.line,
    )


def _kind(words: str) -> Kind:
    """Kind of item for a component that is not a bit."""
    if "stabilizer" in words:
        return "stabilizer"
    if "collar" in words:
        return "drill_collar"
    if "drill pipe" in words:
        return "hwdp" if "heavy" in words else "drill_pipe"
    return "other"


def _tool_joint(component: Element, file: Path, od: float) -> tuple[float, float, float] | None:
    """Tool joint of a pipe, from the connections at both of its ends; None if the file lacks them."""
    ends = list(component.all("connection"))
    if len(ends) != 2:
        return None
    sizes = [[_value(end.first(name), "m", file) for name in ("od", "id", "len")] for end in ends]
    outer, inner, length = (
        [size for size in column if size is not None] for column in zip(*sizes, strict=True)
    )
    if min(len(outer), len(inner), len(length)) < 2 or min(outer) < od:
        return None
    return max(outer), min(inner), sum(length)


def _nozzles(component: Element, file: Path) -> float | None:
    """Flow area of a bit's nozzles [m2]."""
    area = _value(component.first("areaNozzleFlow"), "m^2", file)
    if area is None:
        diameters = [_value(nozzle.first("diaNozzle"), "m", file) for nozzle in component.all("nozzle")]
        area = sum(math.pi / 4 * diameter**2 for diameter in diameters if diameter) or None
    return area


# ---------------------------------------------------------------------- hole
_CASED = ("casing", "liner", "conductor", "riser", "tubing", "drive pipe")
_OPEN = ("open hole", "openhole", "hole", "caving", "cavern", "rat hole")


def _sections(geometry: Element, file: Path, out: Imported) -> None:
    """Sections of the hole: at each depth the narrowest one of the file."""
    found: list[Piece] = []
    for section in geometry.all("wbGeometrySection"):
        top, bottom = (_value(section.first(name), "m", file, section) for name in ("mdTop", "mdBottom"))
        inner = _value(section.first("idSection"), "m", file, section)
        for name, value in (("mdTop", top), ("mdBottom", bottom), ("idSection", inner)):
            if value is None:
                raise CaseError(
                    at=name, got="nothing", want="a value with its uom", file=file, line=section.line
                )
        assert top is not None and bottom is not None and inner is not None
        words = section.word("typeHoleCasing").casefold()
        cased = any(word in words for word in _CASED)
        if not cased and not any(word in words for word in _OPEN):
            want = "casing, liner, conductor, riser or open hole"
            got = section.word("typeHoleCasing") or "nothing"
            raise CaseError(at="typeHoleCasing", got=got, want=want, file=file, line=section.line)
        if bottom <= top or inner <= 0:
            got = f"{top:g} to {bottom:g} m, {inner:g} m wide"
            want = "mdBottom below mdTop, idSection above 0"
            raise CaseError(at="wbGeometrySection", got=got, want=want, file=file, line=section.line)
        friction = number_of(section.word("factFric") or "x", "")
        kind = "riser" if "riser" in words else "casing" if cased else "open_hole"
        found.append(Piece(top, bottom, inner, kind, friction))
    if not found:
        raise CaseError(
            at="wbGeometry", got="no wbGeometrySection", want="at least one", file=file, line=geometry.line
        )
    out.sections += narrowest(found, "wbGeometry", file, geometry.line)
