"""WITSML 1.4.1.1: trajectory, tubular and wellbore geometry as plain data of a case."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from drillpetsc.case.importers.stations import number_of
from drillpetsc.case.importers.table import Table
from drillpetsc.case.importers.xml_tree import Element, read_xml
from drillpetsc.errors import CaseError
from drillpetsc.units import UnitError, to_si

NAMESPACE = "http://www.witsml.org/schemas/1series"
OBJECTS = {"trajectorys": "trajectory", "tubulars": "tubular", "wbGeometrys": "wbGeometry"}
STEEL = 7850.0  # [kg/m3]
LIGHTEST, LOWEST_ID = 0.95, 1e-4  # of the plain tube's weight that a tally may give; [m]
TONNES = 1e5  # [kg/m] no tubular is that heavy


@dataclass
class Imported:
    """What a file gives to a case.

    kind: trajectory, tubular or wbGeometry
    title: name of the well
    string: items from the top down; sections: of the hole; both as plain data with units as texts
    remarks: what was left out, replaced or assumed
    """

    kind: str
    title: str = ""
    string: list[dict[str, Any]] = field(default_factory=list)
    sections: list[dict[str, Any]] = field(default_factory=list)
    remarks: list[str] = field(default_factory=list)


def read_witsml(file: Path) -> tuple[Element, str]:
    """(the one object of a file, its kind: trajectory, tubular or wbGeometry)."""
    root = read_xml(file)
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


def _value(element: Element | None, unit: str, file: Path) -> float | None:
    """Value [SI] of an element with a unit in its attribute `uom`; None without an element or text."""
    if element is None or not element.text.strip():
        return None
    number, uom = number_of(element.text, ""), element.attributes.get("uom", "")
    if number is None:
        raise CaseError(
            at=element.name, got=element.text.strip(), want="a number", file=file, line=element.line
        )
    if not uom:
        want = f"an attribute uom, the unit of {element.name}"
        raise CaseError(at=element.name, got=element.text.strip(), want=want, file=file, line=element.line)
    try:
        return to_si(f"{number!r} {uom}", unit)
    except UnitError as error:
        got = f"{element.text.strip()} {uom}"
        raise CaseError(
            at=element.name, got=got, want=error.want, hint=error.hint, file=file, line=element.line
        ) from None


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
    rows: list[tuple[float, int, list[str]]] = []
    skipped = 0
    for station in trajectory.all("trajectoryStation"):
        values = [_value(station.first(name), unit, file) for name, unit in names.items()]
        md, inclination, azimuth = values[:3]
        if md is None or inclination is None or azimuth is None:
            skipped += 1
            continue
        rows.append((md, station.line, ["" if value is None else repr(value) for value in values]))
    if skipped:
        remarks.append(f"{skipped} stations without depth, inclination or azimuth left out")
    rows.sort(key=lambda row: row[:2])
    si = ("m", "rad", "rad", "m", "m", "m", "1/m")
    found = {column: (i, si[i]) for i, column in enumerate(columns)}
    cells = [(line, texts) for _, line, texts in rows]
    return Table(file, list(names), trajectory.line, found, cells, remarks=remarks)


# ---------------------------------------------------------------------- import
def import_witsml(file: Path) -> Imported:
    """What a WITSML file gives to a case."""
    found, kind = read_witsml(file)
    out = Imported(kind, " ".join(filter(None, (found.word("nameWell"), found.word("nameWellbore")))))
    if kind == "tubular":
        _string(found, file, out)
    elif kind == "wbGeometry":
        _sections(found, file, out)
    return out


def _length(value: float) -> str:
    return f"{value:.6g} m"


def _diameter(value: float) -> str:
    return f"{value * 1e3:.6g} mm"


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
        out.remarks.append("components without sequence: taken from the bit up, as they stand in the file")
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
    for component in reversed(components):
        out.string.append(_item(component, file, out.remarks))


def _is_bit(component: Element) -> bool:
    return component.word("typeTubularComp").casefold().startswith("bit")


def _item(component: Element, file: Path, remarks: list[str]) -> dict[str, Any]:
    """The item of a component. A weight that no tube of this size has is left out, with a remark."""
    kind = component.word("typeTubularComp") or "unknown"
    name = component.word("name") or component.word("description") or kind
    name = name[:60]

    def size(*path: str, unit: str = "m") -> float | None:
        return _value(component.first(*path), unit, file)

    def refused(at: str, want: str) -> CaseError:
        return CaseError(at=at, got=f"{name}: nothing", want=want, file=file, line=component.line)

    length, bore = size("len"), size("id") or 0.0
    if length is None or length <= 0:
        raise refused("len", "a length above 0")
    words = kind.casefold()
    if _is_bit(component):
        return _bit(component, file, length, bore, name, refused)
    od = size("od") or size("odMx")
    weight = size("wtPerLen", unit="kg/m")
    if "stabilizer" in words:
        blade = size("stabilizer", "odBladeMx") or size("odMx") or od
        if blade is None:
            raise refused("odBladeMx", "a diameter over the blades")
        item: dict[str, Any] = {
            "kind": "stabilizer",
            "name": name,
            "length": _length(length),
            "od": _diameter(blade),
        }
        if bore:
            item["id"] = _diameter(bore)
        body = od or blade
        if body < blade:
            item["body_od"] = _diameter(body)
        plain = STEEL * math.pi / 4 * (body**2 - bore**2)
        mass = weight if weight is not None and _plausible(weight, body, bore) else plain
        if weight is not None and mass != weight:
            remarks.append(
                f"WARNING: {name}: {weight:.4g} kg/m is no weight of {body * 1e3:.4g} x {bore * 1e3:.4g} mm; {plain:.4g} kg/m taken"
            )
        return item | {"mass": f"{mass * length:.6g} kg"}
    if od is None:
        raise refused("od", "an outer diameter")
    if bore >= od:
        raise CaseError(
            at="id",
            got=f"{name}: {bore * 1e3:.4g} mm",
            want=f"below od, {od * 1e3:.4g} mm",
            file=file,
            line=component.line,
        )
    item = {"kind": "pipe", "name": name, "length": _length(length), "od": _diameter(od)}
    if bore:
        item["id"] = _diameter(bore)
    joint = _tool_joint(component, file, od, bore) if "drill pipe" in words else None
    if "collar" in words:
        item["kind"] = "drill_collar"
        if "non-mag" in words or "nonmag" in words:
            item["nonmagnetic"] = True
    elif joint is not None:
        item |= {"kind": "hwdp" if "heavy" in words else "drill_pipe", "tool_joint": joint}
    elif "drill pipe" in words:
        remarks.append(f"{name} is a plain pipe: the file has no connections with od, id and len")
    plain = STEEL * math.pi / 4 * (od**2 - bore**2)
    if weight is not None and not _plausible(weight, od, bore):
        remarks.append(
            f"WARNING: {name}: {weight:.4g} kg/m is no weight of {od * 1e3:.4g} x {bore * 1e3:.4g} mm; {plain:.4g} kg/m taken"
        )
    elif weight is not None and item["kind"] != "pipe":
        item["adjusted_weight"] = f"{weight:.6g} kg/m"
    elif weight is not None and abs(weight - plain) > 1e-3 * plain:
        item["material"] = {"density": f"{STEEL * weight / plain:.6g} kg/m3"}
        remarks.append(
            f"{name}: density raised or lowered so that the tube weighs {weight:.4g} kg/m in air, as the file says"
        )
    if not any(
        word in words for word in ("drill pipe", "drill collar", "heavy weight", "collar", "casing", "tubing")
    ):
        remarks.append(f"{name} ({kind}) is a plain pipe of its diameters and weight")
    if component.first("bend") is not None:
        remarks.append(f"{name}: its bend is left out")
    return item


def _tool_joint(component: Element, file: Path, od: float, bore: float) -> dict[str, str] | None:
    """Tool joint of a pipe, from the connections at both of its ends; None where the file lacks them."""
    ends = list(component.all("connection"))
    if len(ends) != 2:
        return None
    sizes = [[_value(end.first(name), "m", file) for name in ("od", "id", "len")] for end in ends]
    outer, inner, length = (
        [size for size in column if size is not None] for column in zip(*sizes, strict=True)
    )
    if min(len(outer), len(inner), len(length)) < 2 or min(outer) < od or min(inner) <= 0:
        return None
    return {"od": _diameter(max(outer)), "id": _diameter(min(inner)), "length": _length(sum(length))}


def _plausible(weight: float, od: float, bore: float) -> bool:
    """Whether a weight per length [kg/m] lies between that of the plain tube and that of a solid bar."""
    return LIGHTEST * STEEL * math.pi / 4 * (od**2 - bore**2) <= weight <= STEEL * math.pi / 4 * od**2


def _bit(
    component: Element, file: Path, length: float, bore: float, name: str, refused: Any
) -> dict[str, Any]:
    def size(*path: str, unit: str = "m") -> float | None:
        return _value(component.first(*path), unit, file)

    od = size("bitRecord", "diaBit") or size("odMx") or size("od")
    if od is None:
        raise refused("diaBit", "the bit's diameter")
    item: dict[str, Any] = {"kind": "bit", "name": name, "length": _length(length), "od": _diameter(od)}
    words = component.word("typeTubularComp").casefold()
    for word, kind in (("pdc", "PDC"), ("roller", "roller_cone"), ("diamond", "diamond"), ("core", "core")):
        if word in words:
            item["bit_type"] = kind
            break
    if LOWEST_ID < bore < od:
        item["id"] = _diameter(bore)
    weight = size("wtPerLen", unit="kg/m")
    if weight is not None and 0 < weight <= STEEL * math.pi / 4 * od**2:
        item["mass"] = f"{weight * length:.6g} kg"
    area = size("areaNozzleFlow", unit="m^2")
    if area is None:
        diameters = [_value(nozzle.first("diaNozzle"), "m", file) for nozzle in component.all("nozzle")]
        area = sum(math.pi / 4 * diameter**2 for diameter in diameters if diameter) or None
    if area:
        item["nozzle_area"] = f"{area * 1e6:.6g} mm2"
    return item


# ---------------------------------------------------------------------- hole
_CASED = ("casing", "liner", "conductor", "riser", "tubing", "drive pipe")
_OPEN = ("open hole", "openhole", "hole", "caving", "cavern", "rat hole")


def _sections(geometry: Element, file: Path, out: Imported) -> None:
    """Sections of the hole: at each depth the narrowest one of the file."""
    found: list[tuple[float, float, float, str, float | None]] = []
    for section in geometry.all("wbGeometrySection"):
        top, bottom = (_value(section.first(name), "m", file) for name in ("mdTop", "mdBottom"))
        inner = _value(section.first("idSection"), "m", file)
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
        found.append((top, bottom, inner, "casing" if cased else "open_hole", friction))
    if not found:
        raise CaseError(
            at="wbGeometry", got="no wbGeometrySection", want="at least one", file=file, line=geometry.line
        )
    edges = sorted({edge for top, bottom, *_ in found for edge in (top, bottom)} | {0.0})
    rows: list[tuple[float, tuple[float, str, float | None]]] = []
    for above, below in zip(edges, edges[1:], strict=False):
        around = [section for section in found if section[0] <= above and section[1] >= below]
        if not around:
            got = f"no section from {above:g} m to {below:g} m"
            want = "sections without a gap, from 0 m"
            raise CaseError(at="wbGeometry", got=got, want=want, file=file, line=geometry.line)
        _, _, inner, kind, friction = min(around, key=lambda section: section[2])
        if rows and rows[-1][1] == (inner, kind, friction):
            rows[-1] = (below, rows[-1][1])
        else:
            rows.append((below, (inner, kind, friction)))
    for below, (inner, kind, friction) in rows:
        section_data: dict[str, Any] = {"to": _length(below), "kind": kind, "diameter": _diameter(inner)}
        if friction is not None:
            section_data["friction"] = friction
        out.sections.append(section_data)
