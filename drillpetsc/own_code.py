"""Functions of the user: the states that they get, and where they failed (manual: sec-own-physics)."""

from __future__ import annotations

import inspect
import math
import traceback
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

MEMORY = "memory"  # parameter of a function that keeps numbers from step to step


@dataclass(frozen=True)
class Given:
    """What a law is called with, beside its state.  unit [SI]; meaning.

    sample: usual values, at which the law is tried out; size: usual size, over which differences are taken; relative: the
    differences grow with the value; least: smallest value that occurs.
    """

    unit: str
    meaning: str
    sample: tuple[float, float, float]
    size: float
    relative: bool = True
    least: float = -math.inf


@dataclass(frozen=True)
class BitState:
    """The bit on the bottom of its hole: numbers, or arrays (n,) of several states."""

    weight: Annotated[Any, Given("N", "force on the bottom, along the hole", (2e4, 5e4, 1e5), 1e3, least=0.0)]
    speed: Annotated[Any, Given("rad/s", "rotation of the bit", (0.5, 4.0, 12.0), 1.0)]
    angle: Annotated[
        Any, Given("rad", "angle through which the bit has turned", (0.0, 1.0, 30.0), 1.0, False)
    ]
    advance: Annotated[
        Any, Given("m/s", "speed of the bit along the hole, down positive", (1e-3, 3e-3, 1e-2), 1e-2)
    ]
    depth: Annotated[Any, Given("m", "measured depth of the bottom", (1.0, 2.0, 5.0), 1.0, False)]
    time: float = 0.0

    @property
    def depth_of_cut(self) -> Any:
        """Advance per turn [m]."""
        return 2 * math.pi * self.advance / self.speed


@dataclass(frozen=True)
class FrictionState:
    """The string at a point of contact with the wall: numbers, or arrays (n,) of several points."""

    normal: Annotated[
        Any, Given("N", "normal force of the contact point", (10.0, 500.0, 5e3), 10.0, least=0.0)
    ]
    slip_speed: Annotated[
        Any, Given("m/s", "speed of the surface against the wall", (0.02, 0.3, 2.0), 0.1, least=0.0)
    ]
    axial: Annotated[Any, Given("m/s", "its part along the hole, down positive", (0.01, 0.2, 1.0), 0.1)]
    around: Annotated[Any, Given("m/s", "its part round the hole", (0.01, 0.2, 1.0), 0.1)]
    given: Annotated[
        Any, Given("", "friction coefficient of the wall or the item in the case", (0.2, 0.25, 0.3), 0.1)
    ]
    depth: Annotated[Any, Given("m", "measured depth", (10.0, 100.0, 1000.0), 1.0, False)]
    time: float = 0.0


@dataclass(frozen=True)
class RockState:
    """The bottom of the hole: a number, or an array (n,) of several depths."""

    depth: Annotated[Any, Given("m", "measured depth of the bottom", (1.0, 2.0, 5.0), 1.0, False)]
    time: float = 0.0


@dataclass(frozen=True)
class RheologyState:
    """Mud in shear: a number, or an array (n,) of several shear rates."""

    shear_rate: Annotated[Any, Given("1/s", "shear rate", (5.1, 170.0, 1022.0), 1.0, least=0.0)]
    time: float = 0.0


@dataclass(frozen=True)
class CompiledLaw:
    """A law of a plug-in in C++.  folder: of its sources; law: its name."""

    folder: Path
    law: str


def parameters_of(call: Any) -> tuple[inspect.Parameter, ...]:
    """The parameters of a function; a compiled function may tell none."""
    try:
        return tuple(inspect.signature(call).parameters.values())
    except (TypeError, ValueError):
        return ()


def file_of(call: Any) -> Path | None:
    """The file with the source of a function; None if it is compiled."""
    try:
        return Path(inspect.getsourcefile(call if hasattr(call, "__code__") else type(call)) or "").resolve()
    except TypeError:
        return None


def place_of(error: BaseException, call: Any) -> str:
    """``law.py, line 12`` where the user's function raised an error; empty if its code was not reached."""
    own = file_of(call)
    lines = [
        at for at in traceback.extract_tb(error.__traceback__) if own is not None and Path(at.filename) == own
    ]
    return f"{lines[-1].filename}, line {lines[-1].lineno}" if lines else ""
