"""Items of a string from the components of a tally, whatever the file that lists them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

from drillpetsc.case.catalogue.formulas import POSSIBLE, USUAL, steel_tube
from drillpetsc.errors import CaseError

LOWEST_ID = 1e-4  # [m]
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
    """The item of a component as plain data. A weight that no item of this size has is left out, with a remark.

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
    weight = _weight(c, od, remarks)
    if weight is not None:
        item["weight"] = f"{weight:.6g} kg/m"
    if c.kind == "other" and not c.tube:
        item["kind"] = "tool"
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
    weight = _weight(c, body, remarks)
    if weight is None:
        weight = steel_tube(body, c.bore)
    return item | {"mass": f"{weight * length:.6g} kg"}


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
    if c.weight is not None and 0 < c.weight <= steel_tube(od, 0.0):
        item["mass"] = f"{c.weight * length:.6g} kg"
    if c.nozzle_area:
        item["nozzle_area"] = f"{c.nozzle_area * 1e6:.6g} mm2"
    return item


def _weight(c: Component, od: float, remarks: list[str]) -> float | None:
    """Weight per length [kg/m] of the file; None without one, or if it is too far from a steel tube's."""
    if c.weight is None:
        return None
    steel = steel_tube(od, c.bore)
    ratio, size = c.weight / steel, f"{od * 1e3:.4g} x {c.bore * 1e3:.4g} mm"
    if not POSSIBLE[0] <= ratio <= POSSIBLE[1]:
        remarks.append(
            f"WARNING: {c.name}: {c.weight:.4g} kg/m is not a plausible weight for {size}; {steel:.4g} kg/m taken"
        )
        return None
    if not USUAL[0] <= ratio <= USUAL[1]:
        remarks.append(
            f"WARNING: {c.name}: {c.weight:.4g} kg/m is {ratio:.2g} times a steel tube of {size}, {steel:.4g} kg/m"
        )
    return c.weight


def items_of(components: Sequence[Component], remarks: list[str]) -> list[dict[str, Any]]:
    """Items of the components, from the top down. Two weights that fit only each other's row are named.

    Raises CaseError for a component without a length or an outer diameter.
    """
    sized = [(c, steel_tube(c.od, c.bore)) for c in components if c.od and c.od > c.bore and c.kind != "bit"]
    odd = [(c, steel) for c, steel in sized if c.weight and not USUAL[0] <= c.weight / steel <= USUAL[1]]
    for i, (one, steel) in enumerate(odd):
        for other, other_steel in odd[i + 1 :]:
            assert one.weight and other.weight
            if all(USUAL[0] <= q <= USUAL[1] for q in (other.weight / steel, one.weight / other_steel)):
                remarks.append(f"WARNING: the weights of {one.name} and {other.name} fit if they are swapped")
    return [item_of(component, remarks) for component in components]


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
