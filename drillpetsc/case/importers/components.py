"""Items of a string from the components of a tally, whatever the file that lists them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

from drillpetsc.errors import CaseError

STEEL = 7850.0  # [kg/m3]
LIGHTEST, LOWEST_ID = 0.95, 1e-4  # of the plain tube's weight that a tally may give; [m]
BIT_TYPES = (("pdc", "PDC"), ("roller", "roller_cone"), ("diamond", "diamond"), ("core", "core"))

SAME_DEPTH = 0.01  # [m] depths that differ by rounding

Kind = Literal["bit", "stabilizer", "drill_pipe", "hwdp", "drill_collar", "other"]


@dataclass(frozen=True)
class Component:
    """One row of a tally, in SI; None for data that the file does not give.

    kind: kind of item to create; words: its type in the words of the file
    length, od, bore [m], weight per length [kg/m]
    blade: diameter over the blades of a stabilizer [m]; bit_od: of a bit [m]; nozzle_area [m2]
    tool_joint: (outer, inner diameter, length of pin and box) of a joint [m]
    keys: names of length, od, id, blade, bit_od in the file; file, line: its location
    """

    kind: Kind
    words: str
    name: str
    length: float | None
    od: float | None
    bore: float
    weight: float | None
    file: Path
    line: int
    blade: float | None = None
    bit_od: float | None = None
    nozzle_area: float | None = None
    tool_joint: tuple[float, float, float] | None = None
    nonmagnetic: bool = False
    tube: bool = False
    keys: Mapping[str, str] = field(default_factory=dict)

    def refused(self, key: str, got: str, want: str) -> CaseError:
        """The error for a value that is impossible for any item."""
        at = self.keys.get(key, key)
        return CaseError(at=at, got=f"{self.name}: {got}", want=want, file=self.file, line=self.line)


def length_text(value: float) -> str:
    return f"{value:.6g} m"


def diameter_text(value: float) -> str:
    return f"{value * 1e3:.6g} mm"


def item_of(component: Component, remarks: list[str]) -> dict[str, Any]:
    """The item of a component as plain data. A weight that no tube of this size has is left out, with a remark.

    Raises CaseError for a component without a length or an outer diameter.
    """
    c = component
    if c.length is None or not 0 < c.length:
        raise c.refused("length", "nothing", "a length above 0")
    if c.kind == "bit":
        return _bit(c, c.length)
    if c.kind == "stabilizer":
        return _stabilizer(c, c.length, remarks)
    if c.od is None:
        raise c.refused("od", "nothing", "an outer diameter")
    if c.bore >= c.od:
        want = f"below od, {c.od * 1e3:.4g} mm"
        raise c.refused("id", f"{c.bore * 1e3:.4g} mm", want)
    return _tube(c, c.length, c.od, remarks)


def _tube(c: Component, length: float, od: float, remarks: list[str]) -> dict[str, Any]:
    item: dict[str, Any] = {
        "kind": "pipe",
        "name": c.name,
        "length": length_text(length),
        "od": diameter_text(od),
    }
    if c.bore:
        item["id"] = diameter_text(c.bore)
    if c.kind == "drill_collar":
        item["kind"] = "drill_collar"
        if c.nonmagnetic:
            item["nonmagnetic"] = True
    elif c.kind in ("drill_pipe", "hwdp"):
        joint = _fitting(c.tool_joint, od)
        if joint is not None:
            item |= {"kind": c.kind, "tool_joint": joint}
        else:
            remarks.append(f"{c.name} is a plain pipe: the file has no connections with od, id and len")
    plain = STEEL * math.pi / 4 * (od**2 - c.bore**2)
    if c.weight is not None and not plausible(c.weight, od, c.bore):
        remarks.append(
            f"WARNING: {c.name}: {c.weight:.4g} kg/m is not a plausible weight for {od * 1e3:.4g} x {c.bore * 1e3:.4g} mm; {plain:.4g} kg/m taken"
        )
    elif c.weight is not None and item["kind"] != "pipe":
        item["adjusted_weight"] = f"{c.weight:.6g} kg/m"
    elif c.weight is not None and abs(c.weight - plain) > 1e-3 * plain:
        item["material"] = {"density": f"{STEEL * c.weight / plain:.6g} kg/m3"}
        remarks.append(
            f"{c.name}: density raised or lowered so that the tube weighs {c.weight:.4g} kg/m in air, as the file says"
        )
    if c.kind == "other" and not c.tube:
        remarks.append(f"{c.name} ({c.words}) is a plain pipe of its diameters and weight")
    return item


def _fitting(joint: tuple[float, float, float] | None, od: float) -> dict[str, str] | None:
    """Tool joint as plain data; None if there is none that fits the tube."""
    if joint is None or joint[0] < od or not 0 < joint[1] < joint[0] or not joint[2] > 0:
        return None
    return {
        "od": diameter_text(joint[0]),
        "id": diameter_text(joint[1]),
        "length": length_text(joint[2]),
    }


def _stabilizer(c: Component, length: float, remarks: list[str]) -> dict[str, Any]:
    blade = c.blade or c.od
    if blade is None:
        raise c.refused("blade", "nothing", "a diameter over the blades")
    item: dict[str, Any] = {
        "kind": "stabilizer",
        "name": c.name,
        "length": length_text(length),
        "od": diameter_text(blade),
    }
    if c.bore:
        item["id"] = diameter_text(c.bore)
    body = c.od or blade
    if body < blade:
        item["body_od"] = diameter_text(body)
    plain = STEEL * math.pi / 4 * (body**2 - c.bore**2)
    mass = c.weight if c.weight is not None and plausible(c.weight, body, c.bore) else plain
    if c.weight is not None and mass != c.weight:
        remarks.append(
            f"WARNING: {c.name}: {c.weight:.4g} kg/m is not a plausible weight for {body * 1e3:.4g} x {c.bore * 1e3:.4g} mm; {plain:.4g} kg/m taken"
        )
    return item | {"mass": f"{mass * length:.6g} kg"}


def _bit(c: Component, length: float) -> dict[str, Any]:
    od = c.bit_od or c.od
    if od is None:
        raise c.refused("bit_od", "nothing", "the bit's diameter")
    item: dict[str, Any] = {
        "kind": "bit",
        "name": c.name,
        "length": length_text(length),
        "od": diameter_text(od),
    }
    for word, kind in BIT_TYPES:
        if word in c.words.casefold():
            item["bit_type"] = kind
            break
    if LOWEST_ID < c.bore < od:
        item["id"] = diameter_text(c.bore)
    if c.weight is not None and 0 < c.weight <= STEEL * math.pi / 4 * od**2:
        item["mass"] = f"{c.weight * length:.6g} kg"
    if c.nozzle_area:
        item["nozzle_area"] = f"{c.nozzle_area * 1e6:.6g} mm2"
    return item


def plausible(weight: float, od: float, bore: float) -> bool:
    """Whether a weight per length [kg/m] lies between the weights of the plain tube and of a solid bar."""
    return LIGHTEST * STEEL * math.pi / 4 * (od**2 - bore**2) <= weight <= STEEL * math.pi / 4 * od**2


# ---------------------------------------------------------------------- hole
@dataclass(frozen=True)
class Piece:
    """A piece of the hole: top, bottom, inner diameter [m], casing or open_hole, friction coefficient or None."""

    top: float
    bottom: float
    inner: float
    kind: str
    friction: float | None


def narrowest(pieces: list[Piece], at: str, file: Path, line: int) -> list[dict[str, Any]]:
    """Sections of the hole as plain data: at each depth the narrowest piece. CaseError if there is none.

    at: name of the list in the file
    """
    edges = [0.0]
    for edge in sorted(edge for piece in pieces for edge in (piece.top, piece.bottom)):
        if edge > edges[-1] + SAME_DEPTH:
            edges.append(edge)
    rows: list[tuple[float, tuple[float, str, float | None]]] = []
    for above, below in zip(edges, edges[1:], strict=False):
        around = [
            piece
            for piece in pieces
            if piece.top <= above + SAME_DEPTH and piece.bottom >= below - SAME_DEPTH
        ]
        if not around:
            got = f"no section from {above:g} m to {below:g} m"
            want = "sections without a gap, from 0 m"
            raise CaseError(at=at, got=got, want=want, file=file, line=line)
        here = min(around, key=lambda piece: piece.inner)
        told = (here.inner, here.kind, here.friction)
        if rows and rows[-1][1] == told:
            rows[-1] = (below, told)
        else:
            rows.append((below, told))
    out = []
    for below, (inner, kind, friction) in rows:
        section: dict[str, Any] = {"to": length_text(below), "kind": kind, "diameter": diameter_text(inner)}
        if friction is not None:
            section["friction"] = friction
        out.append(section)
    return out
