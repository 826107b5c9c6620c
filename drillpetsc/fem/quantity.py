"""Quantities: one object describes one output, and evaluates it.

A component returns its quantities from ``quantities()``.  The history, the probes, the statics table,
the fields of ``string.pvd``, plots, study tables and the manual read these objects. Their words stand in tables.  This module does not use PETSc or MPI.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any, Literal, Protocol, TypeVar

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.unit_systems import System, shown

Result = TypeVar("Result")
Places = int | Sequence[int] | np.ndarray

Entity = Literal["scalar", "node", "element", "item", "rigid_item", "joint", "probe", "sensor"]
Interpolation = Literal["linear", "motion", "none"]
#: placeholder of a measured depth [m] in the name of a quantity of a joint or a probe
DEPTH = "NNN"
#: placeholder of the name of a sensor in the name of a quantity
NAME = "NAME"
_PLACES = {DEPTH: r"([-+.\deE]+)", NAME: r"([A-Za-z0-9_-]+)"}


def numbered(word: str, number: int) -> str:
    """``word`` for the first of several in the string from the top, ``word_2`` for the second, and so on."""
    return word if number == 1 else f"{word}_{number}"


@cache
def _of_one(values: Callable[[Any, Any], Any]) -> Callable[[Any, Any], Any]:
    """The ``value`` of a quantity from its ``values``; the same function for the same values."""
    return lambda source, sample: values(source, sample)[0]


@dataclass(frozen=True)
class Quantity:
    """One output: its name and unit in files, the words that reports show, and how it is evaluated.

    name: column or array in files; ``NNN`` in it stands for the measured depth [m] of a joint, probe or rigid item, ``NAME`` for
    the name of a sensor.
    unit: SI, as in ``N m``; ``-`` for a pure number.
    on: what has a value: the whole model (``scalar``), each node, element, item, rigid item, joint, probe or sensor.
    label: words in pictures and reports.
    mnemonic: abbreviation in exports, WITS or WITSML where one exists.
    sign: what a positive value means.
    doc: one sentence.
    interpolate: between two steps: a straight line, a parabola through three steps (``motion``), or none: the value
    at the time of writing.
    mean: the mean over a time has a meaning.
    values(source, steps): the ``value`` after each of k recorded steps (``fem.step_record``), (k, ...); without it, ``value`` is
    called after every step.
    value(source, sample): by default that of ``values``; this rank's share, summed over ranks: a number, or (k, size) for k joints or probes; for
    ``node`` (nv, size) at the local vertices; for ``element`` (nc,) or (nc, 2, ...) at its upper and lower end.
    size: numbers of one entity that ``value`` returns.
    finish(source, values, depth): numbers to be written, from the ``size`` numbers of one entity; of nodes and probes
    from those of all, (n, size) at depths (n,), as (n, k); without it, the values themselves.
    finish_rows(source, values): the numbers of ``finish`` of a scalar at k times, (k, m), from ``values`` (k, size); without it,
    ``finish`` is called for each.
    index: which of these numbers is the quantity's; None: all.
    panel: quantities of one panel are drawn together, panels in ascending order; 0: with others of the same unit.
    numerics: describes the computation, not the string.
    interest: 1 for what a study compares first; 0: after all others.
    kind: key of ``unit_systems.KINDS``, for the unit in which people see it; empty: the usual kind of the unit.
    tool: word in the name that is followed by the number of the second and later tools of a kind.
    """

    name: str
    unit: str
    label: str
    on: Entity = "scalar"
    mnemonic: str = ""
    sign: str = ""
    doc: str = ""
    interpolate: Interpolation = "linear"
    mean: bool = True
    value: Callable[[Any, Any], Any] | None = None
    values: Callable[[Any, Any], Any] | None = None
    size: int = 1
    finish: Callable[[Any, FloatArray, Any], Any] | None = None
    finish_rows: Callable[[Any, FloatArray], FloatArray] | None = None
    index: int | None = 0
    panel: int = 0
    numerics: bool = False
    interest: int = 0
    kind: str = ""
    tool: str = ""

    def __post_init__(self) -> None:
        if self.value is None and self.values is not None:
            object.__setattr__(self, "value", _of_one(self.values))

    def numbered(self, number: int) -> Quantity:
        """The quantity of the tool of this ``number`` from the top; the first keeps the name."""
        if number == 1 or not self.tool:
            return self
        name = self.name.replace(self.tool, numbered(self.tool, number), 1)
        return replace(
            self, name=name, label=f"{self.label} {number}", mnemonic=f"{self.mnemonic}{number}", tool=""
        )

    @property
    def title(self) -> str:
        """Heading of a column."""
        return f"{self.name} [{self.unit}]"

    @property
    def column(self) -> tuple[str, str]:
        """Name and unit."""
        return self.name, self.unit

    def at(self, depth: float) -> tuple[str, str]:
        """Name and unit of the column of a joint or probe at a measured depth [m]."""
        return self.name.replace(DEPTH, f"{depth:g}"), self.unit

    def matches(self, name: str) -> bool:
        """Whether ``name`` is this quantity's name, at whatever depth."""
        return self.place(name) is not None

    def place(self, name: str) -> str | None:
        """Depth or name of a sensor in ``name``, empty for a quantity without; None if it is another quantity's name."""
        if self.tool:
            above, below = self.name.split(self.tool, 1)
            found = re.fullmatch(f"{above}{self.tool}(?:_([0-9]+))?{below}", name)
            return (found.group(1) or "") if found else None
        for word, pattern in _PLACES.items():
            if word in self.name:
                found = re.fullmatch(re.escape(self.name).replace(word, pattern), name)
                return found.group(1) if found else None
        return "" if name == self.name else None

    def label_at(self, place: str, system: System = "SI") -> str:
        """The label with the depth, in a system of units, or the name of a sensor in it."""
        if self.tool and place:
            return f"{self.label} {place}"
        if place and DEPTH in self.label:
            return self.label.replace(f"{DEPTH} m", shown(float(place), "length", system, 6))
        return self.label.replace(NAME, place) if place else self.label


#: how the cells of a table of quantities are read that are not text
_CELLS: dict[str, Callable[[str], Any]] = {
    "panel": int,
    "interest": int,
    "mean": "yes".__eq__,
    "numerics": "yes".__eq__,
}


@cache
def words_of_quantities(table: Path) -> dict[str, dict[str, Any]]:
    """Rows of a CSV table whose columns are fields of ``Quantity``, by name; an empty cell leaves the default."""
    with open(table, encoding="utf-8", newline="") as file:
        rows = [{k: _CELLS.get(k, str)(v) for k, v in row.items() if v} for row in csv.DictReader(file)]
    return {row["name"]: row for row in rows}


def quantities_of(table: Path) -> Callable[..., Quantity]:
    """Return a function that makes a quantity of a table: from its name, and the fields that say how it is evaluated."""

    def quantity(name: str, **evaluation: Any) -> Quantity:
        return Quantity(**words_of_quantities(table)[name], **evaluation)

    return quantity


class Source(Protocol):
    """A source of quantities: a physics component, or a measurement that needs several of them."""

    def quantities(self) -> tuple[Quantity, ...]:
        """Outputs that exist in this model."""
        ...


class OneStep:
    """The present state with the interface of several recorded steps (``fem.step_record.StepRecord``).

    assembly: unknowns and rates on this rank; time: of the inputs [s].
    """

    def __init__(self, assembly: Any, time: float) -> None:
        self.assembly, self.times = assembly, [time]

    def __len__(self) -> int:
        return len(self.times)

    @property
    def time(self) -> float:
        """Of the inputs of the last step [s]."""
        return self.times[-1]

    def results(self, block: Any, kernel: str, columns: int) -> Any:
        """Results of a block at every step; arguments as in ``Assembly.results``."""
        return self.assembly.results(block, kernel, columns)

    def numbers(self, array: FloatArray, places: Places) -> FloatArray:
        """(k, m) the numbers of ``array`` at flat ``places`` (m,), (k,) at one place, of the k steps."""
        flat = array.reshape(-1)
        if isinstance(places, int | np.integer):
            return flat[places : places + 1].copy()
        if isinstance(places, range):  # of neighbours
            return flat[None, places.start : places.stop].copy()
        return np.asarray(flat[np.asarray(places, dtype=int).reshape(-1)][None])

    def computed(self, call: Callable[[Any], Any], size: int, *key: Any) -> FloatArray:
        """(k, size) what ``call`` returns after each step: the way for numbers that are not worth more.

        key: identifies the function: two calls with one key are one.
        """
        return np.asarray(call(self), dtype=float).reshape(1, size)

    def sums(self, block: Any, kernel: str, columns: int) -> FloatArray:
        """(k, columns) sums of the results of a block over its elements on this rank."""
        return np.asarray(self.results(block, kernel, columns).sums[None].copy())

    def parameters(self, block: Any, name: str, row: int) -> FloatArray:
        """(k,) or (k, width) the parameter ``name`` of one element of a block."""
        at, start = block.named.columns[name], row * block.params.shape[1]
        places = start + at if isinstance(at, int) else range(start + at.start, start + at.stop)
        return self.numbers(block.params, places)

    def unknowns(self, dofs: np.ndarray | int) -> FloatArray:
        """As ``numbers``, of the unknowns."""
        return self.numbers(self.assembly.x, dofs)

    def rates(self, dofs: np.ndarray | int) -> FloatArray:
        """As ``numbers``, of the rates."""
        return self.numbers(self.assembly.y, dofs)


class Sample(OneStep):
    """The present state of a ``system``, at which quantities are evaluated."""

    def __init__(self, system: Any, time: float) -> None:
        super().__init__(system.assembly, time)
        self.system = system
        self._results: dict[tuple[Any, ...], Any] = {}

    def once(self, function: Callable[..., Result], *arguments: Any) -> Result:
        """``function(*arguments, assembly)``, evaluated once for all quantities that share its result."""
        key = function, *arguments
        if key not in self._results:
            self._results[key] = function(*arguments, self.assembly)
        return self._results[key]
