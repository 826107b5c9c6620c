"""Options of the commands of the frequency domain: excitation and excitation lines."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from drillpetsc.case.blocks.items.string import Flexible
from drillpetsc.case.case import Case
from drillpetsc.case.key_paths import suggestion
from drillpetsc.case.options.ranges import WITH_UNIT
from drillpetsc.case.quantities import Quantity, said
from drillpetsc.errors import CaseError
from drillpetsc.unit_systems import System
from drillpetsc.units import UnitError, to_si


@dataclass(frozen=True)
class Excitation:
    """A harmonic excitation.

    kind: ``unbalance``, ``bit``, ``motor``, the orbit of a downhole motor's rotor, or ``place``, somewhere along the string.
    what: of bit and place: ``displacement`` along the string [m], ``force`` along it [N] or ``torque`` [N m]; otherwise empty.
    amplitude: [m], [N] or [N m], 0 with unbalance and motor.
    order: cycles per turn; nan with motor, which sets its own frequency.
    place: name of the place, md: its measured depth [m].
    """

    kind: str
    what: str = ""
    amplitude: float = 0.0
    order: float = 1.0
    place: str = "the lower end"
    md: float = math.nan

    def words(self, units: System) -> str:
        """For people, in a system of units."""
        if self.kind == "unbalance":
            return "unbalance, once per turn"
        if self.kind == "motor":
            return "orbit of the motor's rotor"
        kind = {"displacement": "diameter"}.get(self.what, self.what)
        return f"{self.what} of {said(self.amplitude, kind, units)} at {self.place}, {self.order:g} per turn"


KINDS = ("unbalance", "bit", "motor")
AMPLITUDES = {
    "displacement": Quantity("m", above=0, at_most=1, kind="none"),
    "force": Quantity("N", above=0, at_most=1e8, kind="none"),
    "torque": Quantity("N m", above=0, at_most=1e7, kind="none"),
}


def _place(text: str, case: Case) -> tuple[str, float]:
    """Name and measured depth [m] of a place along the string: an item by its name, the middle of pipe and the upper end of a rigid
    item, or a depth with its unit; CaseError."""
    seen: dict[str, int] = {}
    found: dict[str, float] = {}
    for item, (upper, lower) in zip(case.string, case.item_depths, strict=True):
        seen[item.name] = number = seen.get(item.name, 0) + 1
        name = item.name if number == 1 else f"{item.name} {number}"
        found[name] = 0.5 * (upper + lower) if isinstance(item, Flexible) else upper
    if text in found:
        return text, found[text]
    try:
        depth = to_si(text, "m") if WITH_UNIT.fullmatch(text) else None
    except UnitError:
        depth = None
    if depth is None:
        want = (
            f"{', '.join(KINDS)}, the name of a string item ({', '.join(found)}), or a measured depth (120 m)"
        )
        raise CaseError(at="--excite", got=text, want=want, hint=suggestion(text, [*KINDS, *found]))
    if not 0 <= depth <= case.string_length:
        want = (
            f"a measured depth along the string, 0 to {said(case.string_length, 'length', case.said_units)}"
        )
        raise CaseError(at="--excite", got=text, want=want)
    return f"MD {text}", depth


def read_excitation(
    kind: str, amplitude: str | None = None, order: float | None = None, case: Case | None = None
) -> Excitation:
    """Read the excitation of `response`.

    kind: one of ``KINDS``, or a place of the ``case``: the name of a string item, or a measured depth (``120 m``).
    amplitude: of a motion (``3 mm``), force (``5 kN``) or torque (``1 kN m``) of bit or place; its unit decides which.
    order: cycles per turn, None: 3 of the bit (the lobes that a roller-cone bit cuts), 1 of a place.
    Raises CaseError.
    """
    place: tuple[str, float] | tuple[()] = ()
    if kind not in KINDS:
        if case is None:
            raise CaseError(at="--excite", got=kind, want=f"one of {', '.join(KINDS)}")
        place = _place(kind, case)
    elif kind != "bit":
        says = {
            "unbalance": "the case has the unbalance, which turns once per turn",
            "motor": "the case has the mass and the orbit of the rotor",
        }
        for name, value in (("--amplitude", amplitude), ("--order", order)):
            if value is not None:
                raise CaseError(at=name, got=value, want=f"no such option with --excite {kind}: {says[kind]}")
        return Excitation(kind, order=1.0 if kind == "unbalance" else float("nan"))
    want = "the amplitude of a motion (3 mm), a force (5 kN) or a torque (1 kN m), with its unit"
    if amplitude is None:
        raise CaseError(at="--amplitude", want=want)
    for what, quantity in AMPLITUDES.items():
        try:
            value = to_si(str(amplitude), quantity.unit) if WITH_UNIT.fullmatch(str(amplitude)) else None
        except UnitError:
            continue
        if value is None:
            break
        if not quantity.inside(value):
            raise CaseError(at="--amplitude", got=amplitude, want=f"a number {quantity.allowed()}")
        order = (1.0 if place else 3.0) if order is None else float(order)
        if not 0 < order <= 1000:
            raise CaseError(at="--order", got=order, want="cycles per turn, above 0, at most 1000")
        return Excitation("place" if place else "bit", what, value, order, *place)
    raise CaseError(at="--amplitude", got=amplitude, want=want)


# ---------------------------------------------------------------------- lines
#: excitation lines by name: the blades of bit and reamer, the orbit of a downhole motor's rotor
LINE_NAMES = ("blades", "motor")


def read_lines(text: str | Sequence[float | str]) -> tuple[float | str, ...]:
    """Read excitation lines: cycles per turn and ``LINE_NAMES``, such as ``1,2,3,motor``; CaseError for another word, or for a
    number that is not above 0.  Numbers come first, ascending."""
    parts = text.split(",") if isinstance(text, str) else list(text) if isinstance(text, Iterable) else [text]
    out, names = [], list[str]()
    for part in parts:
        if str(part).strip() in LINE_NAMES:
            names.append(str(part).strip())
            continue
        try:
            value = float(part)
        except ValueError:
            value = -1.0
        if not 0 < value <= 1000:
            raise CaseError(
                at="--lines",
                got=str(part).strip(),
                want="cycles per turn, above 0, at most 1000, such as 1,2,3; or blades, or motor",
            )
        out.append(value)
    return (*sorted(set(out)), *sorted(set(names)))
