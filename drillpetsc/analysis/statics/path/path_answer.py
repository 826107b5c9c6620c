"""Results of the paths of a buckled string with friction, in numbers and in sentences (manual: sec-statics-path)."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any, Literal

from drillpetsc.arrays import FloatArray
from drillpetsc.unit_systems import System, display, plain

PathKind = Literal["sliding", "slack_off"]
OVERLOAD = 1.3  # load from which the second path comes back, over the load
STEADY = 2e-3  # largest change from quarter to quarter of the slide of what the string transmits: force over the push, torque over itself


@dataclass(frozen=True)
class PathEnd:
    """End of one path; its state is in the model's system.

    start: ``straight``, ``overload``, or ``buckled``: near an equilibrium of the buckled string.
    hook_load, wob: forces at both ends [N]; surface_torque: of a string that turns [N m], else 0.
    negative_pivots: of the stiffness with friction as a dead load; above 0 friction alone holds the state.
    change: from the third to the last quarter of the slide, of the mean transmitted force over the push, or of the mean
    torque over itself [-].
    slid: distance [m]; steps, iterations: of the path.
    """

    start: str
    hook_load: float
    wob: float
    surface_torque: float
    negative_pivots: int
    change: float
    slid: float
    steps: int
    iterations: int

    @property
    def steady(self) -> bool:
        """Whether the transmitted force has settled."""
        return self.change <= STEADY


@dataclass(frozen=True)
class PathAnswer:
    """Answer to one question about a buckled string with friction.

    kind: the question.  ends: of the paths, that of the state in the system first.
    persistent_load: (n,) random side loads that led the string off its axis [N].
    force_given: the top's force is given, and the weight on bit follows; else the hook load follows.
    turns: the string turns.
    failed: (start, reason) of paths without an end.
    held_end: the lower end of the string is held.  may_slack_off: the case has an answer to that question, too.
    """

    kind: PathKind
    ends: tuple[PathEnd, ...]
    persistent_load: FloatArray
    force_given: bool
    turns: bool = False
    failed: tuple[tuple[str, str], ...] = ()
    held_end: bool = False
    may_slack_off: bool = True

    @property
    def held_by_friction(self) -> bool:
        """Whether friction alone holds the state of the first path; friction holds no string that turns."""
        return bool(self.ends[0].negative_pivots) and not self.turns

    def as_dict(self) -> dict[str, Any]:
        """Entries of summary.json."""
        return {"path": self.kind, "path_states": [asdict(end) for end in self.ends]}

    def lines(self, units: System = "metric") -> list[str]:
        """Sentences for the user, with forces and lengths in a system of units."""

        def text(value: float, kind: str) -> str:
            number, unit = display(value, kind, units)
            return f"{number:.5g} {unit}"

        if self.kind == "slack_off":
            out = [
                "question answered: slack-off on a bit that stands; the string was run in, then lowered "
                "(--path sliding: steady sliding)"
            ]
        else:
            out = [
                "question answered: steady turning, the side force of friction left out (it may make the string whirl)"
                if self.turns
                else "question answered: steady sliding, "
                + (
                    "friction acts all along the string as if it moved, down to the lower end that is held"
                    if self.held_end
                    else "the whole string moves along the hole"
                )
                + " (--path slack_off: it is lowered onto a bit that stands)" * self.may_slack_off
            ]
            name, what = ("wob", "weight on bit") if self.force_given else ("hook_load", "hook load")
            bands = [(name, what, "force")] + [("surface_torque", "surface torque", "torque")] * self.turns
            if len(self.ends) > 1:
                out += [
                    self._band(what, *(text(getattr(e, name), kind) for e in self.ends))
                    for name, what, kind in bands
                ]
                out.append("the table is that of the string from a straight start")
            elif self.ends[0].start == "buckled" and not self.failed:
                out.append(
                    "its buckles creep along the wall while it slides; the state is that after "
                    f"{text(self.ends[0].slid, 'length')} from its lateral equilibrium"
                )
            measure = "torque or force" if self.turns else what
            for end in self.ends:
                if not end.steady:
                    out.append(
                        f"the state from the {end.start} start still changes: {measure} by {plain(100 * end.change, 2)} % "
                        f"({'of itself or ' if self.turns else ''}of the push) over the last "
                        f"{text(end.slid / 4, 'length')} of {text(end.slid, 'length')}"
                    )
        pivots = self.ends[0].negative_pivots
        directions = f"{pivots} unstable direction{'s' if pivots > 1 else ''}"
        if self.held_by_friction:
            out.append(f"held by friction only: without it the state has {directions}")
        elif self.turns and pivots:
            out.append(
                f"the state has {directions}: buckles go on travelling slowly, while force and torque stay"
            )
        return out + [f"no state from the {start} start: {why}" for start, why in self.failed]

    @staticmethod
    def _band(what: str, first: str, second: str) -> str:
        """Sentence on what a straight start and an overload give."""
        if first == second:
            return f"{what} {first} from a straight string, and the same after an overload of {OVERLOAD:g}"
        return f"{what}, a band: {first} from a straight string, {second} after an overload of {OVERLOAD:g}"
