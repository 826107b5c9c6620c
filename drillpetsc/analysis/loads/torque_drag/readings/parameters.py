"""Parameters of a calibration: friction factors, numbers of the rig, and any continuous number of the case."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

from drillpetsc.analysis.loads.torque_drag.operations import KINDS
from drillpetsc.analysis.sensitivities.keys import STEP, Key, key_of
from drillpetsc.case.case import Case
from drillpetsc.errors import CaseError
from drillpetsc.output.shown_units import key_unit, shown_unit
from drillpetsc.unit_systems import System

FREE = 0.5  # of a number of the case: how far it may be from its value
KNOWN = 0.25  # of it: half width of an interval beyond which it is not determined
BLOCK_SHARE = 0.25  # that of the block weight, of the largest hook load read


@dataclass(frozen=True)
class Parameter:
    """What is fitted.

    bounds: least and largest value; step: of differences; start: where the search begins, None: at the case's value [SI].
    widest: half width of a 95 % interval beyond which it is not determined; None: a share of the hook load.
    key: number of the case that it is; None for the others.
    """

    name: str
    bounds: tuple[float, float]
    step: float
    widest: float | None
    start: float | None = None
    key: Key | None = None

    @property
    def is_factor(self) -> bool:
        """Whether it is the friction factor of a group of sections."""
        return self.key is None and self.name not in OF_RIG

    @property
    def of_string(self) -> bool:
        """Whether it changes the string itself, and not what the rig reads of it."""
        return self.name not in OF_RIG or self.name == "weight_factor"

    def size(self, value: float) -> float:
        """Magnitude by which differences of the string are chosen [SI]."""
        return (abs(value) or 0.1) if self.key is None else self.key.size

    @property
    def words(self) -> str:
        """Its name on the screen."""
        if not self.is_factor:
            return self.name if self.key is not None else self.name.replace("_", " ")
        return {"cased": "friction, cased", "open_hole": "friction, open hole"}.get(
            self.name, f"friction, {self.name}"
        )

    @property
    def si_unit(self) -> str:
        """SI unit, empty for a pure number."""
        if self.key is not None:
            return self.key.unit
        return {"block_weight": "N", "running_drag": "N s/m"}.get(self.name, "")

    def unit(self, system: System) -> tuple[float, str]:
        """(SI value of the unit on the screen, its name)."""
        if self.key is not None:
            return key_unit(self.key.name, self.key.unit, system)
        if self.name == "block_weight":
            return shown_unit("hook_load", "N", system)
        return (1e3, "kN per m/s") if self.name == "running_drag" else (1.0, "")

    def shown(self, value: float, system: System) -> str:
        """A value as text, with its unit."""
        size, unit = self.unit(system)
        return f"{value / size:.4g} {unit}".rstrip()


OF_RIG = {
    q.name: q
    for q in (
        Parameter("block_weight", (0.0, 5e6), 10.0, None),
        Parameter("weight_factor", (0.5, 1.5), 1e-5, 0.1, 1.0),
        Parameter("running_drag", (0.0, 1e6), 10.0, 1e5, 5e4),
        Parameter("sheave_efficiency", (0.8, 1.0), 1e-6, 0.02, 0.98),
    )
}
#: where the search of these friction factors begins
START = {"cased": 0.25, "open_hole": 0.3}


def parameter_of(case: Case, name: str, factors: Collection[str]) -> Parameter:
    """A parameter by its name; factors: names of the groups of the hole's sections.

    Raises CaseError for a name that is neither one of them nor a continuous number of the case.
    """
    if name in OF_RIG:
        return OF_RIG[name]
    if name in (*KINDS, *factors):
        return Parameter(name, (0.0, 1.0), 1e-4, 0.25, START.get(name))
    if "." not in name and "[" not in name:
        want = ", ".join([*factors, *OF_RIG])
        raise CaseError(at="--fit", got=name, want=f"{want}, or a number of the case such as fluid.density")
    try:
        key = key_of(case, name)
    except CaseError as error:
        raise CaseError(at="--fit", got=error.got, want=error.want, hint=error.hint) from None
    bounds = key.value - FREE * key.size, key.value + FREE * key.size
    return Parameter(key.name, bounds, STEP * key.size, KNOWN * key.size, key=key)
