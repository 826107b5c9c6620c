"""Doubts about a buckled string: it may have other states, and its loads a band."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from drillpetsc.doubts.doubt import Doubt, span, written
from drillpetsc.doubts.moments import StaticAnswer

Values = Iterable[dict[str, Any]]

FEW_RANGES = 3  # that are reported one by one


class Buckled(Doubt):
    """The compression exceeds the buckling load of the string in its hole (manual: sec-statics-report).

    A sinusoidally buckled string snakes on the low side; a helically buckled one coils along the wall.
    """

    about = (StaticAnswer,)
    sentence = "{how} buckled {where}"
    remedy = "Reduce the compression there, or use stiffer pipe. A buckled string may be used if its stresses and friction are acceptable."

    def look(self, at: StaticAnswer) -> Values:
        for how, ranges in (("sinusoidally", at.buckled.sinusoidal), ("helically", at.buckled.helical)):
            if len(ranges) <= FEW_RANGES:
                for a, b in ranges:
                    yield {"how": how, "where": f"from MD {span(a, b, at.units)}"}
                continue
            whole, length = span(ranges[0][0], ranges[-1][1], at.units), sum(b - a for a, b in ranges)
            pieces = written(", {length:length} in all", {"length": length}, at.units)
            yield {"how": how, "where": f"in {len(ranges)} pieces from MD {whole}{pieces}"}


class OtherStates(Doubt):
    """A buckled string may rest in several shapes, so its loads depend on how it came there."""

    about = (StaticAnswer,)
    sentence = "a buckled string may have other stable states; which one it is depends on its history{path}"
    remedy = "Use `--path` for the states of a known history."

    def look(self, at: StaticAnswer) -> Values:
        if at.buckled:
            band = " (this one is of steady sliding; --path sliding gives a band)" if at.slides else ""
            yield {"path": band}


class BandOfTheory(Doubt):
    """The load of a coiled string with friction is not unique: it lies in a band, of which statics gives one value (manual: sec-statics-path)."""

    about = (StaticAnswer,)
    sentence = (
        "the {what} is not unique: by theory it lies between {low:force} and {high:force}, depending on whether the pipe becomes helical "
        "at 1.83 or at 1.41 times the sinusoidal buckling load{other}"
    )
    remedy = "Plan with the unfavourable end of the band."

    def look(self, at: StaticAnswer) -> Values:
        if not at.buckled or at.band is None:
            return
        what = {"wob": "weight on bit", "hook_load": "hook load"}[at.band.name]
        more = "; --path sliding gives the states from a straight string and after an overload"
        yield {"what": what, "low": at.band.low, "high": at.band.high, "other": more if at.has_path else ""}


class HoistedWithWeight(Doubt):
    """Friction is as in hoisting while the bit bears weight, which no operation does."""

    about = (StaticAnswer,)
    sentence = (
        "the bit bears initial.wob, {wob:force}, while friction acts as in hoisting; for the pick-up load off bottom leave out "
        "initial.wob"
    )
    remedy = "Leave out `initial.wob`, or use `--operation trip_out`."

    def look(self, at: StaticAnswer) -> Values:
        if at.case.initial.wob and at.lowering < 0:
            yield {"wob": at.case.initial.wob}
