"""Doubts about derivatives."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drillpetsc.case.blocks.fluid import Newtonian
from drillpetsc.doubts.doubt import CaseMoment, Values, doubt, remark

DISAGREES = 1e-4  # error of a derivative, relative, above which it is reported
SMALL = 1e-4  # relative derivatives below it are judged by their absolute error


MOST_NAMED = 15  # keys without effect that are named


@dataclass(frozen=True)
class Differentiated(CaseMoment):
    """Outputs are differentiated (sensitivities).

    analysis: statics, roadmap, hydraulics or run; one_sided: some derivatives have a kink beside them; without: keys without effect.
    left_out: why rows at a bit depth [m] have no derivative.
    zero_flows: keys that are flow rates of zero.
    """

    analysis: str
    one_sided: bool
    without: list[str]
    left_out: dict[float, str]
    zero_flows: list[str]

    @property
    def named(self) -> str:
        """The keys without effect, the first of many."""
        more = f" and {len(self.without) - MOST_NAMED} others" if len(self.without) > MOST_NAMED else ""
        return ", ".join(self.without[:MOST_NAMED]) + more


@dataclass(frozen=True)
class Checked(CaseMoment):
    """A derivative is compared with differences of full solutions.

    output, key: their names; derivative, difference: relative [-]; rounding: of the difference [-].
    """

    output: str
    key: str
    derivative: float
    difference: float
    rounding: float = 0.0

    @property
    def error(self) -> float:
        """Of the derivative, relative to the difference, or to ``SMALL`` if that is smaller; rounding alone is ``DISAGREES``."""
        return abs(self.derivative - self.difference) / max(
            abs(self.difference), SMALL, self.rounding / DISAGREES
        )


@dataclass(frozen=True)
class Unchecked(CaseMoment):
    """Derivatives by ``keys`` are not compared, because no run of the changed cases took the same steps."""

    keys: list[str]


@dataclass(frozen=True)
class HoleRenewed(CaseMoment):
    """Generalised-alpha followed ``keys`` of the survey in mud, whose hole is evaluated again where the string moves along it."""

    keys: list[str]


@dataclass(frozen=True)
class Followed(CaseMoment):
    """The derivatives of a column of a run are known over time.

    until: of each key, the time [s] up to which the derivative is determined (``chaos.determined_until``).
    """

    column: str
    until: dict[str, float]


@dataclass(frozen=True)
class Stepped(CaseMoment):
    """A derivative of a run moves if its steps are looser.

    output, key: names; effect: of the stated change of the key; other: the same with ten times the tolerance, nan without such a run [SI].
    """

    output: str
    key: str
    effect: float
    other: float


@doubt(
    "the effect of {key} on {output} is {effect:.4g} but {other} with ten times the tolerance of the steps (SI): it is not resolved; "
    "reduce petsc.ts_rtol",
    "Reduce `petsc.ts_rtol` until the numbers stay. In stick-slip this took 1e-7.",
)
def coarse(at: Stepped) -> Values:
    """Derivatives of a run depend on the tolerance of its steps: with ten times the tolerance they change by more than a tenth.

    The run itself may be right to a part in a thousand.  A bit that breaks loose or a contact that opens within a few steps delays or
    advances by parts of a step, which the derivatives contain in full.
    """
    other = f"{at.other:.4g}" if np.isfinite(at.other) else "unknown"
    yield {"key": at.key, "output": at.output, "effect": at.effect, "other": other}


@doubt(
    "derivatives of {column} are not determined beyond {time:.4g} s by {keys}: they grow exponentially, as in chaotic motion",
    "End the window of the output before that time, or compare means of several runs with `sweep`.",
)
def chaotic(at: Followed) -> Values:
    """Derivatives of a run grow exponentially over half of it, as in chaotic motion: they say nothing about means.

    The time is that at which 1 % of the key would move the column by a tenth of its range. Outputs that end later have no derivative.
    """
    keys = [key for key, time in at.until.items() if np.isfinite(time)]
    return keys and {"column": at.column, "time": min(at.until.values()), "keys": ", ".join(keys)}


@doubt(
    "the derivative of {output} by {key} is {derivative:.6g}, full solutions give {difference:.6g} (relative numbers)",
    "Use the differences: a contact, a regime or a place changes within the step of the key.",
)
def disagrees(at: Checked) -> Values:
    """A derivative differs from central differences of full solutions by more than 1e-4.

    Both numbers are relative: the share by which the output changes over the share by which the key changes.
    """
    if not at.error <= DISAGREES:  # nor if a number is missing
        yield {
            "output": at.output,
            "key": at.key,
            "derivative": at.derivative,
            "difference": at.difference,
        }


@doubt(
    "derivatives by {keys} are not checked: runs of the changed cases cannot take the same steps",
    "Reduce petsc.ts_rtol.",
)
def no_same_steps(at: Unchecked) -> Values:
    """Newton's method fails in a run of a changed case with the steps of the run, which are long where a bit sticks or bounces."""
    return at.keys and {"keys": ", ".join(at.keys)}


@doubt(
    "derivatives by {keys} are right to some 0.2 % only while the string moves along the hole: time.integrator: bdf has 0.05 %",
    "Repeat them with `time.integrator: bdf`.",
)
def survey_in_mud(at: HoleRenewed) -> Values:
    """Forces of the mud jump a little where the hole about a moving string is evaluated again; generalised-alpha keeps the jump's derivative."""
    return at.keys and {"keys": ", ".join(at.keys)}


@doubt(
    "the mud is at rest: derivatives by {keys} follow from the rounding of its stress at small shear rates (fluid.rheology.shear_rate)",
    "Take them at a flow rate that is pumped, where the rounding has no part.",
)
def flow_at_rest(at: Differentiated) -> Values:
    """The friction of a mud that is not Newtonian has no derivative by its flow rate at rest, but for the rounding of its stress."""
    mud = at.case.fluid
    if at.zero_flows and mud is not None and not isinstance(mud.rheology, Newtonian):
        yield {"keys": ", ".join(at.zero_flows)}


@doubt(
    "rows at {depth:length 6} are left out: {reason}",
    "Use --model soft for these rows, or follow the path of friction with statics.",
    weight="remark",
)
def left_out(at: Differentiated) -> Values:
    """A row of a roadmap with the beam has no state with a derivative: it ends on a path of friction, or was not found."""
    yield from ({"depth": depth, "reason": reason} for depth, reason in at.left_out.items())


remark(
    Differentiated,
    "friction is that of the hole's sections; roadmap.friction_factor is left out",
    lambda at: at.analysis == "roadmap",
)
remark(Differentiated, "no effect on these outputs: {names}", lambda at: at.without and {"names": at.named})
remark(
    Differentiated,
    "one-sided: a contact, a buckling state, a regime or a place changes closer than the stated change; sensitivities.csv has the "
    "effects of both sides",
    lambda at: at.one_sided,
)
