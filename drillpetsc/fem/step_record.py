"""Numbers of several steps, copied after each of them by one compiled call.

Rows of tables and balances are computed from them later, for many steps at once. So a step costs little more than the kernels of its
results.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from typing import Any

import numpy as np

from drillpetsc.arrays import FloatArray, IntArray
from drillpetsc.fem.bound_parts import BlockResults
from drillpetsc.fem.component import ElementBlock
from drillpetsc.fem.quantity import OneStep, Places, Sample
from drillpetsc.kernels import function, pointer

_record_step = function("record_step", "ipipp")


class StepRecord(OneStep):
    """Steps of a system with the numbers that outputs are computed from.

    A function of outputs requests its numbers by ``numbers``, ``sums``, ``parameters`` and ``computed``.  Before the first step it is
    called once, which registers them, and gets the present ones as for one step.  Later it gets the numbers of all recorded steps.

    system: the discrete system; capacity: most steps that it holds.
    times: of the inputs of the steps [s].
    """

    def __init__(self, system: Any, capacity: int) -> None:
        super().__init__(system.assembly, 0.0)
        self.system, self.capacity, self.times = system, capacity, []
        #: results of blocks: with block, kernel and number of columns, and whether every step needs them
        self._results: dict[BlockResults, tuple[tuple[ElementBlock, str, int], bool]] = {}
        self._spans: dict[Any, slice] = {}
        self._addresses: list[int] = []
        self._kept: list[Any] = []  # whose addresses and ids are in use
        self._functions: list[tuple[Callable[[Sample], Any], slice, bool]] = []
        self._own = 0  # columns of the functions' values
        #: whether numbers that are not recorded yet can still be requested
        self.is_open = True
        self._table: FloatArray | None = (
            None  # a row for each step, so that a step writes to one place in memory
        )
        self._columns = np.zeros((0, 0))  # the same by number, in which sums run along contiguous memory
        self._always = True

    # ------------------------------------------------------------------ before the first step
    def only_sampled(self) -> None:
        """Numbers requested from now on are recorded at sampled steps only."""
        self._always = False

    def _close(self) -> None:
        self.is_open, self._table = False, np.zeros((self.capacity, len(self._addresses)))
        self._values = np.zeros((self.capacity, self._own))
        self._from = (ctypes.c_void_p * max(1, len(self._addresses)))(*self._addresses)
        self._start = pointer(self._table)
        groups = [[r for r, (_, always) in self._results.items() if always or every] for every in (0, 1)]
        self._groups = [
            (dict.fromkeys(g, True), (ctypes.c_void_p * max(1, len(g)))(*(r.address for r in g)))
            for g in groups
        ]

    # ------------------------------------------------------------------ steps
    def add(self, time: float, sampled: bool = True) -> None:
        """Record the present state of the assembly.  time: of its inputs [s]; sampled: with all numbers."""
        if self._table is None:
            self._close()
        asm, k = self.assembly, len(self.times)
        members, calls = self._groups[sampled]
        count = len(members)
        if asm.derive is not None:  # derived unknowns are evaluated first
            count = 0
            for found in members:
                asm.results(*self._results[found][0])
        n = len(self._addresses)
        _record_step(count, calls, n, self._from, self._start + 8 * n * k)
        asm.have_results(members)
        if self._functions:
            sample, row = Sample(self.system, time), self._values[k]
            for call, span, always in self._functions:
                if sampled or always:
                    row[span] = call(sample)
        self.times.append(time)

    @property
    def unknowns_read(self) -> IntArray | None:
        """Unknowns on which the recorded numbers depend, after the first step; None if functions of the state are recorded."""
        asm = self.assembly
        if self._functions or asm.derive is not None:
            return None
        found = [asm.index_of(block).ravel() for (block, _, _), _ in self._results.values()]
        for start in asm.state_at[:3]:
            places = (np.array(self._addresses, dtype=np.int64) - start) // 8
            found.append(places[(places >= 0) & (places < len(asm.x))])
        return np.unique(np.concatenate(found)).astype(np.int32)

    def fill(self, call: Any) -> None:
        """Fill the ``call`` that records steps of several systems, with all numbers, after the first step."""
        _, results = self._groups[True]
        call.results, call.blocks = ctypes.addressof(results), len(self._groups[True][0])
        call.sources, call.table, call.n = ctypes.addressof(self._from), self._start, len(self._addresses)

    def clear(self) -> None:
        """Forget all steps."""
        self.times, self._columns = [], np.zeros((0, 0))

    # ------------------------------------------------------------------ numbers
    def results(self, block: ElementBlock, kernel: str, columns: int) -> BlockResults:
        if self._table is not None:
            return self.assembly.block_results(block, kernel, columns)
        found = self.assembly.results(block, kernel, columns)
        always = self._always or (found in self._results and self._results[found][1])
        self._results[found] = (block, kernel, columns), always
        return found

    def numbers(self, array: FloatArray, places: Places) -> FloatArray:
        """As of one step.

        array: C-contiguous, of doubles; it is kept and must keep its memory.
        """
        one = isinstance(places, int | np.integer)
        key = pointer(array), int(np.asarray(places)) if one else np.asarray(places).tobytes()
        span = self._spans.get(key)
        if span is None:
            if self._table is not None:
                raise LookupError("a number that was not requested before the first step")
            if array.dtype != np.float64:
                raise TypeError(f"a record holds doubles, not {array.dtype}")
            flat = np.asarray(places, dtype=int).ravel().tolist()
            if flat and not 0 <= min(flat) <= max(flat) < array.size:
                raise IndexError(f"places {min(flat)} to {max(flat)} in an array of {array.size} numbers")
            start = len(self._addresses)
            self._addresses += [key[0] + 8 * p for p in flat]
            self._kept.append(array)
            span = self._spans[key] = slice(start, start + len(flat))
        if self._table is None:
            return super().numbers(array, places)
        if self._columns.shape[1] != len(self.times):
            self._columns = np.ascontiguousarray(self._table[: len(self.times)].T)
        found = self._columns[span].T
        return np.asarray(found[:, 0] if one else found)

    def sums(self, block: ElementBlock, kernel: str, columns: int) -> FloatArray:
        return self.numbers(self.results(block, kernel, columns).sums, range(columns))

    def computed(self, call: Callable[[Sample], Any], size: int, *key: Any) -> FloatArray:
        span = self._spans.get(key)
        if span is None:
            if self._table is not None:
                raise LookupError("a function that was not requested before the first step")
            span = self._spans[key] = slice(self._own, self._own + size)
            self._own += size
            self._functions.append((call, span, self._always))
            self._kept.append(key)
        if self._table is None:
            return Sample(self.system, 0.0).computed(call, size)
        return self._values[: len(self.times), span]
