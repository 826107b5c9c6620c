"""State of the element blocks on one rank, and what kernels compute from it: results, rows and power of a block."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from typing import Any

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.fem.bound_parts import BlockResults, BoundBlock, ResultGroup, block_call
from drillpetsc.fem.component import ElementBlock
from drillpetsc.fem.dof_layout import DofLayout
from drillpetsc.kernels import function, pointer
from drillpetsc.kernels.parameters import structure

_element_rows = function("element_rows", "pippp")
_BlockCall = structure("block_call")  # BlockCall of kernels/core/step.hpp


class _Unchanged:
    """Context of ``BlockState.unchanged``; several are entered in every step, and a generator would take four times as long."""

    __slots__ = ("_outer", "_state")

    def __init__(self, state: BlockState):
        self._state = state

    def __enter__(self) -> None:
        state = self._state
        self._outer = state.kept
        if self._outer is None:
            state.kept, state.asked = {}, {}

    def __exit__(self, *error: object) -> None:
        state = self._state
        state.kept = self._outer
        if self._outer is None and state.asked and state.asked != state.group.members:
            state.group = ResultGroup(state.asked)


class BlockState:
    """Unknowns, rates and accelerations of the blocks on this rank.

    With n local dofs in condensed numbering, ghosts included:
    x, y, a: (array_length,) unknowns, rates and accelerations [SI of each field].  Entry n stands for absent
    fields; the derived fields follow it (``DofLayout.derived``; ``derive`` computes them).
    r: (array_length,) residual, not summed over ranks.
    bound_blocks: the blocks with their dofs.
    """

    def __init__(self, layout: DofLayout, blocks: tuple[ElementBlock, ...]):
        self.layout = layout
        self.x, self.y, self.a, self.r = (np.zeros(layout.array_length) for _ in range(4))
        self.x[layout.size] = 1.0  # an absent stretch ratio is one
        self.derive: Callable[[Any], None] | None = None
        self._derived_index: dict[int, np.ndarray] = {}  # dofs of blocks that use derived fields, by id
        self._results: dict[tuple[int, str], BlockResults] = {}  # by id of the block and kernel
        self._seen: list[ElementBlock] = []  # keeps blocks that are not bound, so that their ids stay theirs
        self.kept: dict[Any, Any] | None = None  # see ``unchanged``
        self.group = ResultGroup({})  # results requested for the last state, requested again for the next
        self.asked: dict[Any, bool] = {}  # within ``unchanged``
        size, self.bound_blocks = 0, list[BoundBlock]()
        for block in blocks:
            self.bound_blocks.append(BoundBlock(block, layout, size))
            size = self.bound_blocks[-1].span.stop
        self._index_by_block = {id(b.block): b.index for b in self.bound_blocks}
        #: addresses of x, y, a, r
        self.state_at: tuple[int, ...] = tuple(map(pointer, (self.x, self.y, self.a, self.r)))
        #: of ``block_rows``
        self._one_call, self._separate, self._work = _BlockCall(), np.zeros(0, dtype=np.int32), np.zeros(0)

    def unchanged(self) -> AbstractContextManager[None]:
        """Within this context ``evaluate_once`` keeps its results; x, y, a and parameters must not change."""
        return _Unchanged(self)

    @contextmanager
    def elsewhere(self, x: FloatArray, y: FloatArray) -> Iterator[None]:
        """Within this context the unknowns and rates are ``x`` and ``y`` (as long as those); results are evaluated again."""
        here, kept = (self.x.copy(), self.y.copy()), self.kept
        self.x[:], self.y[:], self.kept = x, y, None
        try:
            yield
        finally:
            self.x[:], self.y[:] = here
            self.kept = None if kept is None else {}

    def evaluate_once(self, function: Callable[..., Any], *arguments: Any) -> Any:
        """``function(*arguments)``, evaluated once within ``unchanged``.  The caller must not change the result."""
        if self.kept is None:
            return function(*arguments)
        key = function, *arguments
        if key not in self.kept:
            self.kept[key] = function(*arguments)
        return self.kept[key]

    def results(self, block: ElementBlock, kernel: str, columns: int) -> BlockResults:
        """Results of the elements of a block at x, y, evaluated once within ``unchanged``.

        kernel: entry point of the results; columns: their number for one element.
        Do not change or keep the tables: the next evaluation overwrites them.
        """
        found = self._results.get((id(block), kernel)) or self.block_results(block, kernel, columns)
        if self.kept is not None:
            self.asked[found] = True
            if found in self.kept:
                return found
            if found in self.group.members and self.derive is None:
                self.group.evaluate()
                self.kept |= self.group.members
                return found
            self.kept[found] = True
        if id(block) in self._derived_index:
            self.index_of(block)  # computes the derived fields
        found.evaluate()
        return found

    def block_results(self, block: ElementBlock, kernel: str, columns: int) -> BlockResults:
        """The tables of ``results``, as they were evaluated last."""
        found = self._results.get((id(block), kernel))
        if found is None:
            found = BlockResults(kernel, columns, block, self.index_of(block), self.state_at)
            self._results[id(block), kernel] = found
            self._seen.append(block)
        return found

    def evaluated(self, block: ElementBlock, kernel: str, columns: int) -> BlockResults:
        """As ``results``, but evaluated now, for a block whose parameters may have changed since."""
        self.index_of(block)  # computes the derived fields
        found = self.block_results(block, kernel, columns)
        found.evaluate()
        return found

    def have_results(self, members: dict[BlockResults, bool]) -> None:
        """Mark these results as just evaluated, for calls within ``unchanged``."""
        if self.kept is not None:
            self.kept |= members

    def index_of(self, block: ElementBlock) -> np.ndarray:
        """Return the (n, d) dofs of a block in x, y, a.

        Derived fields are computed first if it uses them.
        """
        found = self._index_by_block.get(id(block))
        if found is not None:
            return found
        if self.derive is not None:
            self.derive(self)
        if id(block) not in self._derived_index:
            self._derived_index[id(block)] = self.layout.index(block)
            self._seen.append(block)
        return self._derived_index[id(block)]

    def dofs_of(self, name: str) -> np.ndarray:
        """Return the (nv, size) dofs of a field, or of a derived field after computing it."""
        if name not in self.layout.dofs and self.derive is not None:
            self.derive(self)
        return self.layout.dofs_of(name)

    def block_rows(self, bound: BoundBlock, t: float) -> FloatArray:
        """Compute the residual rows (n, d) of each element of one block at x, y, a and time ``t`` [s]."""
        if bound.block.update:
            bound.update_parameters(t)
        rows, size = np.empty((bound.count, bound.width)), bound.count * bound.width
        if size > len(self._separate):  # one copy of the unknowns for every element
            self._separate, self._work = np.arange(size, dtype=np.int32), np.empty(3 * size)
        block_call(self._one_call, bound, self.state_at)
        _element_rows(
            ctypes.addressof(self._one_call),
            bound.width,
            pointer(self._separate),
            pointer(self._work),
            pointer(rows),
        )
        return rows

    def power(self, block: ElementBlock, t: float) -> float:
        """Compute the power [W] that the rows of ``block`` take from the motion at x, y, on this rank."""
        # a beam may have rewritten the block for its unknowns; the parameters are the same
        bound = next(b for b in self.bound_blocks if b.block.params is block.params)
        block = bound.block
        if not bound.count:
            return 0.0
        if block.update:
            block.update(t)
        rows = np.zeros_like(self.r)
        bound.residual(
            bound.count,
            pointer(bound.index),
            pointer(block.params),
            block.context,
            pointer(self.x),
            pointer(self.y),
            pointer(self.a),
            pointer(rows),
        )
        return float(rows[: self.layout.size] @ self.y[: self.layout.size])
