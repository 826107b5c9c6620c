"""Laws of the user: what a function gets and returns, and how a kernel calls it (manual: sec-own-physics).

Kernel: kernels/core/own_law.hpp.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, fields
from math import isfinite
from typing import Any, get_type_hints

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.errors import CaseError, SolveError
from drillpetsc.kernels import KernelsUnavailable, plug_in, pointer
from drillpetsc.kernels.parameters import structure
from drillpetsc.own_code import (
    MEMORY,
    BitState,
    CompiledLaw,
    FrictionState,
    Given,
    RheologyState,
    RockState,
    parameters_of,
    place_of,
)

_Record = structure("own_law")  # OwnLaw of kernels/core/own_law.hpp
_ARGUMENTS = ctypes.c_void_p, ctypes.c_int, ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p
_CALL = ctypes.CFUNCTYPE(None, *_ARGUMENTS)

STEP = float(np.cbrt(np.finfo(float).eps))  # of a central difference, over the usual size
CHECKED = 1e-4  # error of a derivative, over the largest of its result, beyond which it is doubted [-]


@dataclass(frozen=True)
class LawKind:
    """A law that the user can give.

    key: of the case; state: class of what the function gets, with fields in the order of the kernel.
    results: name -> (unit, meaning); the first is the one that a bare number means.
    least: result -> its smallest value; below it, friction would drive the string, or rock push the bit.
    defaults: result that is left out -> its value from the results that are given, None: the built-in law has it.
    memory: the function may keep numbers from step to step.
    """

    key: str
    state: type
    results: Mapping[str, tuple[str, str]]
    defaults: Mapping[str, Callable[[FloatArray], FloatArray] | None] = field(default_factory=dict)
    least: Mapping[str, float] = field(default_factory=dict)
    memory: bool = False

    @property
    def given(self) -> dict[str, Given]:
        """What each field of the state is."""
        hints = get_type_hints(self.state, include_extras=True)
        return {f.name: hints[f.name].__metadata__[0] for f in fields(self.state) if f.name != "time"}


def _size_of(rows: FloatArray) -> FloatArray:
    """Size of a result with its derivatives (n, 1 + states)."""
    return np.asarray(rows * np.where(rows[:, :1] < 0, -1.0, 1.0))


BIT = LawKind(
    "formation.bit_law",
    BitState,
    {
        "torque": ("N m", "torque on bit, against its rotation; it must pass through zero smoothly"),
        "grip": (
            "N m",
            "torque of a face that slides at full speed, for its friction sideways; |torque| if left out",
        ),
        "rate": ("m/s", "rate of penetration along the bit; from the drillability if left out"),
    },
    {"grip": _size_of, "rate": None},
    memory=True,
)
FRICTION = LawKind(
    "contact.friction_law",
    FrictionState,
    {"coefficient": ("", "friction coefficient; the wall multiplies it by the normal force")},
    least={"coefficient": 0.0},
)


ROCK = LawKind(
    "formation.rock_law",
    RockState,
    {
        "strength": (
            "",
            "how many times the force the rock needs for the same cut, relative to the rock of the other keys",
        )
    },
    least={"strength": 1e-6},
)
RHEOLOGY = LawKind(
    "fluid.rheology", RheologyState, {"stress": ("Pa", "shear stress, which grows with the shear rate")}
)


@dataclass(frozen=True)
class Mismatch:
    """A derivative that the function gives, and the difference that it should equal."""

    name: str
    given: float
    found: float
    where: str


class OwnLaw:
    """A law of the user, called by a kernel.

    kind: of the law; name: of the function; call: the function, or a law of a plug-in; parameters: that it takes by name [SI].
    samples: of fields of the state, at which it is tried out, (3,) each; others have usual values.

    Raises CaseError if the function fails at the samples, or returns something else than it should.
    """

    def __init__(
        self,
        kind: LawKind,
        name: str,
        call: Any,
        parameters: Mapping[str, float] | None = None,
        samples: Mapping[str, tuple[float, float, float]] | None = None,
    ) -> None:
        self.kind, self.name, self.call = kind, name, call
        self.parameters = dict(parameters or {})
        self.states, self.results = tuple(kind.given), tuple(kind.results)
        self.time = 0.0
        self.memory: dict[str, FloatArray] = {}
        self._next: dict[str, FloatArray] = {}
        self._error: BaseException | None = None
        self._keep: list[Any] = []
        self._known = {f"{name}_by_{by}" for name in self.results for by in self.states} | {*self.results}
        given = kind.given
        self._usual = [given[name] for name in self.states]
        self._entry: Any = None
        self._values = np.zeros(1)
        if isinstance(call, CompiledLaw):
            self._open(call)
        self._takes_memory = any(q.name == MEMORY for q in parameters_of(call))
        if self._takes_memory and not kind.memory:
            want = f"a function without the parameter {MEMORY}: the points of contact change"
            raise CaseError(at=f"{kind.key}.function", got=name, want=want)
        self.one_by_one = False
        sample = {name: given[name].sample for name in self.states} | dict(samples or {})
        self._samples = np.array([sample[name] for name in self.states], dtype=float).T
        self._try_out(self._samples)

    def changes_with(self, name: str) -> bool:
        """Whether a result has a derivative by a field of the state at a usual state."""
        return bool(np.any(self.evaluate(self._samples, True)[..., 1 + self.states.index(name)]))

    def _open(self, law: CompiledLaw) -> None:
        """Find the entry point of a law in C++, and fill its parameters.  Raises CaseError."""
        key = self.kind.key
        try:
            library = plug_in(law.folder)
            text = getattr(
                library, f"own_{law.law}_parameters_columns"
            )  # of this library: two may have a law of one name
            text.restype = ctypes.c_char_p
            names = [name.strip().lower() for name in text().decode().split(",")][:-1]
        except KernelsUnavailable as error:
            want = "a law of a compiled plug-in"
            raise CaseError(
                at=f"{key}.function", got=self.name, want=want, hint=f"{error.what}; {error.hint}"
            ) from None
        for name in {*names} ^ {*self.parameters}:
            want = f"all parameters of the law, and no others: {', '.join(names)}"
            raise CaseError(at=f"{key}.parameters.{name}", got=self.parameters.get(name), want=want)
        self._entry = getattr(library, f"own_{law.law}")
        self._entry.argtypes, self._entry.restype = _ARGUMENTS, None
        self._values = np.array([self.parameters[name] for name in names] or [0.0])

    # ------------------------------------------------------------------ for kernels
    def record(self, capacity: int, more: int = 0) -> int:
        """Create a record for a kernel that calls the law at up to ``capacity`` points; returns its address.

        more: address of the record of another law of the same kernel, 0 for none.
        """
        S, R = len(self.states), len(self.results)
        state, out = np.zeros((max(1, capacity), S)), np.zeros((max(1, capacity), R, 1 + S))

        def fill(context: Any, n: int, derivatives: int, at: Any, to: Any) -> None:
            try:
                out[:n] = self.evaluate(state[:n], bool(derivatives))
            except BaseException as error:  # no exception passes through compiled code: raise_error raises it
                self._error = self._error or error
                out[:n] = np.nan

        called = _CALL(fill) if self._entry is None else self._entry
        record = _Record(
            call=ctypes.cast(called, ctypes.c_void_p).value, context=pointer(self._values), state=pointer(state), results=pointer(out), states=S,
            result_count=R, capacity=len(state), next=more or None,
        )  # fmt: skip
        self._keep += [state, out, called, record]
        return ctypes.addressof(record)

    def at_time(self, t: float) -> None:
        """Set the time [s] of the next calls, and raise what was raised in the last ones."""
        self.time = t
        self.raise_error()

    def raise_error(self) -> None:
        """Raise what was raised while a kernel called the function."""
        error, self._error = self._error, None
        if error is not None:
            raise error

    @property
    def next_memory(self) -> FloatArray:
        """(m,) memory that the last evaluation returned, by ``memory_names``; it begins with what the function has without one."""
        return np.array([self._next[name][0] if name in self._next else np.nan for name in self.memory_names])

    def set_memory(self, values: Iterable[float]) -> None:
        """Keep the memory (m,), by ``memory_names``, of an accepted step or of a checkpoint; without values the function begins anew."""
        self.memory = {
            name: np.array([value])
            for name, value in zip(self.memory_names, values, strict=False)
            if np.isfinite(value)
        }

    @property
    def gives(self) -> frozenset[str]:
        """Results that the function returns."""
        return self._gives

    # ------------------------------------------------------------------ evaluation
    def value(self, **state: float) -> dict[str, float]:
        """Evaluate the law at one state; fields left out are zero.  Raises SolveError."""
        row = np.array([[state.get(name, 0.0) for name in self.states]])
        found = self.evaluate(row, False)[0, :, 0]
        return dict(zip(self.results, map(float, found), strict=True))

    def evaluate(self, state: FloatArray, derivatives: bool) -> FloatArray:
        """(n, results, 1 + states) results at ``state`` (n, states), with their derivatives if asked for.

        Nan where a state is not finite: a trial that the solver rejects.  Raises SolveError.
        """
        n, S = state.shape
        out = np.zeros((n, len(self.results), 1 + S))
        if not isfinite(state.sum()):
            out[:] = np.nan
            return out
        differenced = self._differenced if derivatives else ()
        if self._entry is not None:
            return self._compiled(self._entry, state, derivatives)
        points, spans = self._with_neighbours(state, differenced) if differenced else (state, [])
        found = self._called(points, n)
        for j, name in enumerate(self.results):
            if name not in self._gives:
                continue
            values = found[name]
            out[:, j, 0] = values[:n]
            if not derivatives:
                continue
            for k, i in enumerate(differenced):
                after, before = (values[(1 + 2 * k + side) * n :][:n] for side in (0, 1))
                out[:, j, 1 + i] = (after - before) / spans[k]
            for i, by in enumerate(self.states):
                if f"{name}_by_{by}" in found:
                    out[:, j, 1 + i] = found[f"{name}_by_{by}"][:n]
        for name, default in self.kind.defaults.items():
            if default is not None and name not in self._gives:
                out[:, self.results.index(name)] = default(out[:, 0])
        return out

    def _compiled(self, entry: Any, state: FloatArray, derivatives: bool) -> FloatArray:
        """The same of a law in C++, results that it does not give left nan."""
        at, out = np.ascontiguousarray(state), np.empty((len(state), len(self.results), 1 + len(self.states)))
        entry(pointer(self._values), len(at), int(derivatives), pointer(at), pointer(out))
        for j, name in enumerate(self.results):
            bad = np.flatnonzero(~np.isfinite(out[:, j]).all(axis=1))
            if name in self._gives and len(bad):
                raise self._failed(f"{self.name} gave {name} = {out[bad[0], j, 0]}", state[bad[:1]], 1)
            self._check_least(name, out[:, j, 0], state, len(state))
        return out

    def _check_least(self, name: str, values: FloatArray, points: FloatArray, n: int) -> None:
        """Raise SolveError if a result is below its smallest value at one of the first ``n`` points, the states of the kernel."""
        least = self.kind.least.get(name)
        if least is not None and (values[:n] < least).any():
            k = int(np.argmin(values[:n]))
            what = f"{self.name} returned {name} = {values[k]:.6g}, which is below {least:g}"
            raise self._failed(what, points[k : k + 1], 1)

    def _with_neighbours(
        self, state: FloatArray, which: tuple[int, ...]
    ) -> tuple[FloatArray, list[FloatArray]]:
        """The states, then for each chosen field those with a larger and a smaller value; distances of the two."""
        rows, spans = [state], []
        for i in which:
            usual, x = self._usual[i], state[:, i]
            step = STEP * (np.maximum(np.abs(x), usual.size) if usual.relative else usual.size)
            pair = x + step, np.maximum(x - step, usual.least)
            for values in pair:
                rows.append(state.copy())
                rows[-1][:, i] = values
            spans.append(pair[0] - pair[1])
        return np.concatenate(rows), spans

    def _called(self, points: FloatArray, n: int) -> dict[str, FloatArray]:
        """Call the function at the points, the first ``n`` of which are states of the kernel; results by name, (k,) each."""
        if not self.one_by_one:
            return self._checked(points, self._returned(points, n), n)
        every, kept = [], []
        for k, row in enumerate(points[:, None]):
            every.append(self._checked(row, self._returned(row, 1, k % n), 1))
            kept.append(self._next)
        self._next = {name: np.concatenate([each[name] for each in kept[:n]]) for name in kept[0]}
        return {name: np.concatenate([each[name] for each in every]) for name in every[0]}

    def _returned(self, points: FloatArray, n: int, at: int | None = None) -> Any:
        """What the function returns; ``at``: number of the one state, which it gets as numbers instead of arrays."""
        fields = points.T.copy() if at is None else points[0].tolist()
        state = self.kind.state(**dict(zip(self.states, fields, strict=True)), time=self.time)
        more: dict[str, Any] = dict(self.parameters)
        if self._takes_memory:
            more[MEMORY] = {
                name: float(values[at]) if at is not None else np.resize(values, len(points))
                for name, values in self.memory.items()
            }
        try:
            return self.call(state, **more)
        except Exception as error:
            place = place_of(error, self.call)
            what = f"{type(error).__name__}: {error}" + (f" ({place})" if place else "")
            raise self._failed(f"{self.name} stopped with {what}", points, n) from error

    def _checked(self, points: FloatArray, returned: Any, n: int) -> dict[str, FloatArray]:
        """What the function returned by name, (k,) each, the memory taken out.  Raises SolveError for anything but that."""
        first = self.results[0]
        given = dict(returned) if isinstance(returned, Mapping) else {first: returned}
        memory = given.pop(MEMORY, None)
        if not given.keys() <= self._known or first not in given:
            unknown = given.keys() - self._known
            wrong = f"unknown names {', '.join(sorted(map(str, unknown)))}" if unknown else f"no {first}"
            allowed = f"{', '.join(self.results)} and their derivatives, such as {first}_by_{self.states[1]}"
            raise self._failed(f"{self.name} returned {wrong}; it returns {allowed}", points, n)
        out = {name: self._row(name, value, points, n) for name, value in given.items()}
        for name in self.kind.least:
            self._check_least(name, out[name], points, n)
        if self._takes_memory:
            if not isinstance(memory, Mapping):
                raise self._failed(f"{self.name} takes a memory and returned none", points, n)
            kept = {
                str(name): self._row(f"memory of {name}", value, points, n) for name, value in memory.items()
            }
            self._next = {name: values[:n].copy() for name, values in kept.items()}
        return out

    def _row(self, name: str, value: Any, points: FloatArray, n: int) -> FloatArray:
        """A result as (k,) finite numbers."""
        k = len(points)
        try:
            values = np.asarray(value, dtype=float)
            if values.shape == (k,) and isfinite(values.sum()):  # nearly always
                return values
        except (TypeError, ValueError):
            raise self._failed(f"{self.name} returned {value!r} as {name}", points, n) from None
        if values.shape not in ((), (1,), (k,)):
            raise self._failed(
                f"{self.name} returned {name} of shape {values.shape} for {k} states", points, n
            )
        values = np.broadcast_to(values, (k,))
        bad = np.flatnonzero(~np.isfinite(values))
        if len(bad):
            raise self._failed(f"{self.name} returned {name} = {values[bad[0]]}", points[bad[:1]], 1)
        return values

    def _failed(self, what: str, points: FloatArray, n: int) -> SolveError:
        """The error, with the state at which it happened, or the range of several states."""
        said = []
        for name, usual, values in zip(self.states, self._usual, points[:n].T, strict=True):
            low, high = values.min(), values.max()
            span = f"{low:.6g}" if low == high else f"{low:.6g} to {high:.6g}"
            said.append(f"{name} {span} {usual.unit}".rstrip())
        return SolveError(f"{self.kind.key}: {what}, at {', '.join(said)}", time=self.time)

    # ------------------------------------------------------------------ at the start
    def _try_out(self, state: FloatArray) -> None:
        """Find out what the function returns; one that works with numbers only is called for each state alone."""
        self._gives = frozenset(self.results)
        self._differenced: tuple[int, ...] = ()
        self.mismatches: tuple[Mismatch, ...] = ()
        self.memory_names: tuple[str, ...] = ()
        if self._entry is not None:
            self._try_compiled(self._entry, state)
            return
        try:
            found = self._called(state, len(state))
        except SolveError as error:
            if not isinstance(error.__cause__, (TypeError, ValueError)) and "of shape" not in error.what:
                raise self._refused(error) from None
            self.one_by_one = True
            try:
                found = self._called(state, len(state))
            except SolveError as alone:
                raise self._refused(alone) from None
        self._gives = frozenset(found) & frozenset(self.results)
        every = [(name, by) for name in self.results if name in self._gives for by in self.states]
        known = {(name, by) for name, by in every if f"{name}_by_{by}" in found}
        self._differenced = tuple(
            i for i, by in enumerate(self.states) if any((n, b) not in known for n, b in every if b == by)
        )
        self.mismatches = self._compared(state, found, known)
        self.memory_names = tuple(sorted(self._next))
        self._next = {}

    def _try_compiled(self, entry: Any, state: FloatArray) -> None:
        self._gives = frozenset()
        found = self._compiled(entry, state, True)
        self._gives = frozenset(name for j, name in enumerate(self.results) if np.isfinite(found[:, j]).all())
        if self.results[0] not in self._gives:
            raise self._refused(
                self._failed(f"{self.name} gave {self.results[0]} = {found[0, 0, 0]}", state, len(state))
            )

    def _compared(
        self, state: FloatArray, found: dict[str, FloatArray], known: set[tuple[str, str]]
    ) -> tuple[Mismatch, ...]:
        """Derivatives that the function gives and that are not its differences."""
        out = []
        for name, by in sorted(known):
            i = self.states.index(by)
            points, (span,) = self._with_neighbours(state, (i,))
            values = self._called(points, len(state))[name]
            n = len(state)
            slope, given = (values[n : 2 * n] - values[2 * n :]) / span, found[f"{name}_by_{by}"]
            # over the derivative, and over what rounding leaves of a difference
            scale = np.abs(slope).max() + np.abs(values).max() * 1e-9 / span.min()
            k = int(np.argmax(np.abs(slope - given)))
            if abs(slope[k] - given[k]) > CHECKED * scale:
                where = f"{by} {state[k, i]:.6g} {self._usual[i].unit}".rstrip()
                out.append(Mismatch(f"{name}_by_{by}", float(given[k]), float(slope[k]), where))
        return tuple(out)

    def _refused(self, error: SolveError) -> CaseError:
        return CaseError(
            at=f"{self.kind.key}.function",
            got=error.what.removeprefix(f"{self.kind.key}: "),
            want=f"a function of a {self.kind.state.__name__} that returns {', '.join(self.results)}",
            hint="the function was tried out at usual states before anything was computed",
            longest=600,
        )
