"""Doubts about a buckled string: it may have other states, and its loads a band."""

from __future__ import annotations

from drillpetsc.doubts.doubt import Values, doubt, span, written
from drillpetsc.doubts.moments import StaticAnswer

FEW_RANGES = 3  # that are reported one by one


@doubt(
    "{how} buckled {where}",
    "Reduce the compression there, or use stiffer pipe. A buckled string may be used if its stresses and friction are acceptable.",
)
def buckled(at: StaticAnswer) -> Values:
    """The compression exceeds the buckling load of the string in its hole (manual: sec-statics-report).

    A sinusoidally buckled string snakes on the low side; a helically buckled one coils along the wall.
    """
    for how, ranges in (("sinusoidally", at.buckled.sinusoidal), ("helically", at.buckled.helical)):
        if len(ranges) <= FEW_RANGES:
            for a, b in ranges:
                yield {"how": how, "where": f"from MD {span(a, b, at.units)}"}
            continue
        whole, length = span(ranges[0][0], ranges[-1][1], at.units), sum(b - a for a, b in ranges)
        pieces = written(", {length:length} in all", {"length": length}, at.units)
        yield {"how": how, "where": f"in {len(ranges)} pieces from MD {whole}{pieces}"}


@doubt(
    "a buckled string may have other stable states; which one it is depends on its history{path}",
    "Use `--path` for the states of a known history.",
)
def other_states(at: StaticAnswer) -> Values:
    """A buckled string may rest in several shapes, so its loads depend on how it came there."""
    if at.buckled:
        band = " (this one is of steady sliding; --path sliding gives a band)" if at.slides else ""
        yield {"path": band}


@doubt(
    "the {what} is not unique: by theory it lies between {low:force} and {high:force}, depending on whether the pipe becomes helical "
    "at 1.83 or at 1.41 times the sinusoidal buckling load{other}",
    "Plan with the unfavourable end of the band.",
)
def band_of_theory(at: StaticAnswer) -> Values:
    """The load of a coiled string with friction is not unique: it lies in a band, of which statics gives one value (manual: sec-statics-path)."""
    if not at.buckled or at.band is None:
        return
    what = {"wob": "weight on bit", "hook_load": "hook load"}[at.band.name]
    more = "; --path sliding gives the states from a straight string and after an overload"
    yield {"what": what, "low": at.band.low, "high": at.band.high, "other": more if at.has_path else ""}


@doubt(
    "the bit bears initial.wob, {wob:force}, while friction acts as in hoisting; for the pick-up load off bottom leave out "
    "initial.wob",
    "Leave out `initial.wob`, or use `--operation trip_out`.",
)
def hoisted_with_weight(at: StaticAnswer) -> Values:
    """Friction is as in hoisting while the bit bears weight, which no operation does."""
    return at.case.initial.wob and at.lowering < 0 and {"wob": at.case.initial.wob}
