"""What makes a result doubtful: one class a doubt, which every command asks at the moments that the class names.

    class TopPush(Doubt):
        \"\"\"The top pushes the string into the hole, which a hook cannot.\"\"\"

        about = (Answer, Start)
        sentence = "the top pushes the string into the hole with {push:force}: a hook can only pull"
        remedy = "Lower the weight on bit, or check the friction factors."

        def look(self, at):
            if at.hook_load < 0:
                yield {"push": -at.hook_load}

The docstring says when the doubt appears and what it means; with ``sentence`` and ``remedy`` it is the doubt's entry in the
manual. Defining the class registers it. A remark on what a result contains or leaves out is one call of ``remark``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from string import Formatter
from typing import Any, ClassVar, Literal

from drillpetsc.case.case import Case
from drillpetsc.unit_systems import KINDS, System, display_unit, duration, shown

Weight = Literal["warning", "remark"]


@dataclass(frozen=True)
class CaseMoment:
    """A moment of a case, at which doubts may appear."""

    case: Case

    @property
    def units(self) -> System:
        """Units of the reader."""
        return self.case.shown_units


class Doubt:
    """One doubt about a result.

    about: the moments (doubts/moments.py) at which it may appear.
    sentence: what the user reads. ``{depth:length 6}`` shows an SI value in the reader's units with up to 6 digits, 4 unless given;
    ``{step:duration}`` a time as 2 ms or 3 s; any
    other format is Python's.
    remedy: what the user can do.
    weight: a remark says what a result contains or leaves out; a warning says that it may be wrong.
    """

    about: tuple[type, ...]
    sentence: str
    remedy: str = ""
    weight: Weight = "warning"

    def __init_subclass__(cls) -> None:
        if hasattr(cls, "sentence"):  # not of a base class that several share
            DOUBTS.append(cls())

    def look(self, at: Any) -> Iterable[Mapping[str, Any]]:
        """Values of the sentence, once for each place where the doubt appears; collective, and equal on all ranks."""
        raise NotImplementedError

    def sentences(self, at: Any) -> list[str]:
        """What the user reads at a moment; collective."""
        return [written(self.sentence, values, at.units) for values in self.look(at)]


@dataclass(frozen=True)
class Remark:
    """What a result contains or leaves out, in one sentence that needs no explanation (``remark``)."""

    about: tuple[type, ...]
    sentence: str
    holds: Callable[[Any], Any]
    module: str
    remedy: ClassVar[str] = ""
    weight: ClassVar[Weight] = "remark"

    def sentences(self, at: Any) -> list[str]:
        """What the user reads at a moment."""
        values = self.holds(at)
        if not values:
            return []
        return [written(self.sentence, values if isinstance(values, Mapping) else {}, at.units)]


def remark(about: type, sentence: str, holds: Callable[[Any], Any]) -> None:
    """Register a remark about a moment: ``holds`` returns nothing or False if it does not appear, else True or the values."""
    DOUBTS.append(Remark((about,), sentence, holds, holds.__module__))


#: every doubt, in the order in which the user reads them
DOUBTS: list[Doubt | Remark] = []


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
