"""What makes a result doubtful: one function a doubt, which every command calls at the moments that its annotation names.

    @doubt(
        "the top pushes the string into the hole with {push:force}: a hook can only pull",
        "Lower the weight on bit, or check the friction factors.",
    )
    def top_push(at: Answer | Start) -> Values:
        \"\"\"The top pushes the string into the hole, which a hook cannot.\"\"\"
        return at.hook_load < 0 and {"push": -at.hook_load}

The docstring says when the doubt appears and what it means; with sentence and remedy it is the doubt's entry in the
manual. Without a remedy it is a remark on what a result contains or leaves out; ``remark`` registers one in one call.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from string import Formatter
from typing import Any, Literal, get_args, get_type_hints

from drillpetsc.case.case import Case
from drillpetsc.unit_systems import KINDS, System, display_unit, duration, shown

Weight = Literal["warning", "remark"]
#: what a doubt returns: nothing or False if it does not appear; True; the values of its sentence; or these once for each place,
#: as a generator.  Collective, and equal on all ranks.
Values = Any


@dataclass(frozen=True)
class CaseMoment:
    """A moment of a case, at which doubts may appear."""

    case: Case

    @property
    def units(self) -> System:
        """Units of the reader."""
        return self.case.shown_units


@dataclass(frozen=True)
class Doubt:
    """One doubt about a result.

    about: the moments (doubts/moments.py) at which it may appear.
    sentence: what the user reads. ``{depth:length 6}`` shows an SI value in the reader's units with up to 6 digits, 4 unless given;
    ``{step:duration}`` a time as 2 ms or 3 s; any
    other format is Python's.
    function(moment): whether it appears, and with which values.
    remedy: what the user can do.
    weight: a remark says what a result contains or leaves out; a warning says that it may be wrong.
    """

    about: tuple[type, ...]
    sentence: str
    function: Callable[[Any], Values]
    remedy: str = ""
    weight: Weight = "warning"

    def look(self, at: Any) -> list[Mapping[str, Any]]:
        """Values of the sentence, once for each place where the doubt appears; collective."""
        found = self.function(at)
        if isinstance(found, Iterator):
            return list(found)
        return [found if isinstance(found, Mapping) else {}] if found else []

    def sentences(self, at: Any) -> list[str]:
        """What the user reads at a moment; collective."""
        return [written(self.sentence, values, at.units) for values in self.look(at)]


def doubt(
    sentence: str, remedy: str = "", *, weight: Weight = "warning"
) -> Callable[[Callable[[Any], Values]], Doubt]:
    """Register the decorated function as a doubt about the moments of its annotation, a class or several."""

    def register(function: Callable[[Any], Values]) -> Doubt:
        about = get_type_hints(function)["at"]
        DOUBTS.append(
            Doubt(get_args(about) or (about,), sentence, function, remedy, weight if remedy else "remark")
        )
        return DOUBTS[-1]

    return register


def remark(about: type, sentence: str, function: Callable[[Any], Values]) -> None:
    """Register a remark about a moment, in one sentence that needs no explanation."""
    DOUBTS.append(Doubt((about,), sentence, function, weight="remark"))


#: every doubt, in the order in which the user reads them
DOUBTS: list[Doubt] = []


class _InUnits(Formatter):
    """Formats SI values by their kind in a system of units."""

    def __init__(self, units: System) -> None:
        self.units = units

    def format_field(self, value: Any, format_spec: str) -> str:
        kind, _, digits = format_spec.partition(" ")
        if kind == "duration":
            return duration(float(value))
        if kind in KINDS:
            return shown(float(value), kind, self.units, int(digits or 4))
        return str(super().format_field(value, format_spec))


def span(upper: float, lower: float, units: System) -> str:
    """`40 to 172 m`: a range of measured depth [m] in whole units."""
    scale, _, unit = display_unit("length", units)
    return f"{upper / scale:.0f} to {lower / scale:.0f} {unit}"


def written(sentence: str, values: Mapping[str, Any], units: System) -> str:
    """The sentence with its values in a system of units."""
    return _InUnits(units).vformat(sentence, (), values)


def doubts_at(at: Any, weight: Weight | None = None) -> list[str]:
    """The sentences of all doubts at this moment, or only those of one weight, each once; collective."""
    asked = [q for q in DOUBTS if isinstance(at, q.about) and weight in (None, q.weight)]
    return list(dict.fromkeys(sentence for doubt in asked for sentence in doubt.sentences(at)))
