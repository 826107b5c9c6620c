"""Systems beside a run, each with a parameter changed: the parts of their rows that the parameter changes, and their states and reactions.

Manual: sec-sensitivities-steps.
"""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from drillpetsc.arrays import FloatArray, IntArray
from drillpetsc.fem.bound_parts import BoundBlock
from drillpetsc.fem.discrete_system import DiscreteSystem
from drillpetsc.kernels import function, pointer
from drillpetsc.kernels.parameters import structure

_PartCall, _BesideCall = structure("part_call"), structure("beside_call")
_MatrixCall = structure("matrix_call")
_beside_states = function("beside_states", "ippipppipp")
FEW = 8  # elements of a block at prescribed motion, of which the derivatives of reactions are formed


class Part(NamedTuple):
    """Elements of a block from ``first`` to ``last``, which is not included.

    params: theirs, (n, p); others: those of the other systems of the parameter: rows are the same where these are; none: unknown.
    """

    block: BoundBlock
    first: int
    last: int
    params: FloatArray
    others: tuple[FloatArray, ...] = ()


@dataclass(frozen=True)
class Beside:
    """A system with a parameter changed.  change: of the parameter [its SI unit]; weight: in a derivative by it [1/SI]."""

    system: DiscreteSystem
    change: float
    weight: float


class BesideSystems:
    """The systems beside a run.

    system: of the run; groups: of each of k parameters, the systems beside it.

    calls, count: records for compiled code.
    moved: (blocks of the run, k) whether a parameter changes a block whose contacts open and close: its rows are evaluated at moved
    positions, in which they do so less than at the positions of the run.
    """

    def __init__(self, system: DiscreteSystem, groups: Sequence[Sequence[Beside]]) -> None:
        self.system = system
        every = [(k, beside) for k, group in enumerate(groups) for beside in group]
        self.groups, self.count = groups, len(every)
        self.calls = (_BesideCall * len(every))()
        self._every = every
        #: (k,) whether the prescribed motion of a parameter's systems differs from the run's by a constant at most
        self.follows = [all(_follows(system, b.system) for b in group) for group in groups]
        self.moved = np.zeros((len(system.assembly.calls.blocks), len(groups)), dtype=np.int8)
        self._kept: list[Any] = []
        self._kept_ends: list[Any] = []
        self._updates: list[tuple[BoundBlock, Any]] = []
        blocks = [b.block for _, beside in every for b in beside.system.assembly.bound_blocks]
        self._recorded = [(block, block.constants) for block in blocks if block.constants]
        self.take_parts()

    def renew(self) -> None:
        """Find the elements anew if numbers of records have changed, as of a hole that has grown."""
        if any(block.constants is not before for block, before in self._recorded):
            self._recorded = [(block, block.constants) for block, _ in self._recorded]
            self.take_parts()

    def take_parts(self) -> None:
        """Find the elements whose rows the parameters change, after components have changed theirs."""
        parts = [part for group in self.groups for part in _parts_of(group)]
        ours = {b.block.name: (i, b) for i, b in enumerate(self.system.assembly.calls.blocks)}
        pairs = zip(self.system.assembly.bound_blocks, self.system.component_of, strict=True)
        opens = {b.block.name for b, component in pairs if component.has_contact}
        self._kept, self._updates = [], []
        self.moved[:] = 0
        for call, (k, beside), changed in zip(self.calls, self._every, parts, strict=True):
            asm, (still, moved) = beside.system.assembly, (list[Part](), list[Part]())
            for part in changed:
                i, b = ours.get(part.block.block.name, (0, part.block))
                moves = part.block.block.name in opens and b is not part.block and _correspond(b, part.block)
                (moved if moves else still).append(part)
                self.moved[i, k] |= moves
            ends = _end_parts(asm)
            along = [part for part in ends if self._has_derivative(part, opens)]
            apart = [part for part in ends if not self._has_derivative(part, opens)]
            call.step, call.key = asm.calls.step_at, k
            call.change, call.weight, call.follows = beside.change, beside.weight, self.follows[k]
            call.parts, call.part_count = self._records(still, moved)
            call.ends, call.end_count = self._records(along, apart)
            call.first, call.last = _range(changed, asm.layout.array_length)
            call.low, call.high = _range(moved, asm.layout.size)
            used = {id(part.block): part.block for part in (*changed, *ends)}
            self._updates += [(b, b.block.update) for b in used.values() if b.block.update]

    @staticmethod
    def _has_derivative(part: Part, opens: set[str]) -> bool:
        """Whether the rows of a part at prescribed motion are followed by their derivative, not at the moved state."""
        return part.block.block.name not in opens and part.last - part.first <= FEW

    def end_calls(self) -> tuple[Any, int]:
        """Records of the run's blocks at prescribed motion whose derivatives are formed, and the numbers that they need."""
        asm, size = self.system.assembly, 0
        pairs = zip(asm.bound_blocks, self.system.component_of, strict=True)
        opens = {b.block.name for b, component in pairs if component.has_contact}
        parts = [part for part in _end_parts(asm) if self._has_derivative(part, opens)]
        calls = (_MatrixCall * len(parts))()
        for call, (b, first, last, params, _) in zip(calls, parts, strict=True):
            index = b.index[first:last]
            spins = np.ascontiguousarray(b.spins.reshape(b.count, -1)[first:last])
            call.jacobian = ctypes.cast(b.jacobian, ctypes.c_void_p).value
            call.count, call.width, call.record = last - first, b.width, b.block.context
            call.index, call.nodes, call.parameters = pointer(index), pointer(spins), pointer(params)
            self._kept_ends += [index, spins, params]
            size = max(size, call.count * b.width**2 + 4 * b.width)
        return calls, size

    def _records(self, still: Sequence[Part], moved: Sequence[Part] = ()) -> tuple[int, int]:
        """Address and number of records of parts; moved: those that are evaluated at moved positions."""
        parts = [*still, *moved]
        calls = (_PartCall * len(parts))()
        for i, (call, (b, first, last, params, others)) in enumerate(zip(calls, parts, strict=True)):
            index, at = b.index[first:last], (ctypes.c_void_p * max(1, len(others)))(*map(pointer, others))
            call.others, call.other_count, call.size = ctypes.addressof(at), len(others), params.size
            call.residual, call.record, call.count = b.residual_at, b.block.context, last - first
            call.index, call.parameters, call.moved = pointer(index), pointer(params), i >= len(still)
            self._kept += [index, params, at]
        self._kept.append(calls)
        return ctypes.addressof(calls), len(parts)

    def update(self, t: float) -> None:
        """Evaluate the parameters that follow the time at ``t`` [s]."""
        for b, update in self._updates:
            try:
                update(t)
            except Exception as error:
                b.note_place(error, t)
                raise

    def move(
        self,
        x: FloatArray,
        y: FloatArray,
        a: FloatArray,
        reactions: tuple[IntArray, FloatArray] | None = None,
    ) -> None:
        """Put all systems into the state of the run, moved along the derivatives (k, length) of x, y, a.

        reactions: places of the unknowns that are moved, with those of the elements at prescribed motion, and derivatives (k, length) of
        the rows of ``end_calls``: the reactions follow, with the parameters of the last ``update``.  None: all unknowns, without reactions.
        """
        at = self.system.assembly.calls.step_at
        some: tuple[int | None, ...] = (-1, None, None)
        if reactions is not None:
            places, ends = reactions
            some = (len(places), pointer(places), pointer(ends))
        _beside_states(self.count, self.calls, at, x.shape[1], pointer(x), pointer(y), pointer(a), *some)

    @property
    def end_places(self) -> IntArray:
        """Unknowns of the elements at prescribed motion, in the systems beside the run."""
        parts = [part for _, beside in self._every for part in _end_parts(beside.system.assembly)]
        found = [part.block.index[part.first : part.last].ravel() for part in parts]
        return np.unique(np.concatenate([*found, np.zeros(0, dtype=np.int32)]))


def _follows(system: DiscreteSystem, other: DiscreteSystem) -> bool:
    """Whether prescribed motions of two systems have the same directions and follow the same functions of time."""
    pairs = zip(system.assembly.row_replacements, other.assembly.row_replacements, strict=True)
    return all(
        f.condition.along_path is None
        and g.condition.along_path is None
        and f.condition.inputs is not None
        and f.condition.inputs == g.condition.inputs
        and np.array_equal(f.D, g.D)
        for f, g in pairs
    )


def _range(parts: Sequence[Part], length: int) -> tuple[int, int]:
    """First unknown of parts and the one after their last, of ``length`` ones at most."""
    if not parts:
        return 0, 0
    index = [part.block.index[part.first : part.last] for part in parts]
    return int(min(q.min() for q in index)), min(length, int(max(q.max() for q in index)) + 1)


def _part(b: BoundBlock, first: int, last: int) -> Part:
    return Part(b, first, last, b.block.params[first:last])


def _end_parts(asm: Any) -> list[Part]:
    """The elements at prescribed motion, in whole runs of their blocks."""
    at: dict[int, tuple[BoundBlock, list[int]]] = {}
    for f in asm.row_replacements:
        for b, e, _ in f.elements:
            at.setdefault(id(b), (b, []))[1].append(e)
    # records count their elements from the first one on
    return [_part(b, 0 if b.block.context else min(found), max(found) + 1) for b, found in at.values()]


def _parts_of(group: Sequence[Beside]) -> list[list[Part]]:
    """Of each system, the parts whose rows, times the weights, add up to the derivative of all rows at one state."""
    lists = [[b for b in beside.system.assembly.bound_blocks if b.count] for beside in group]
    if not all(len(one) == len(lists[0]) and all(map(_correspond, one, lists[0])) for one in lists):
        return [[_part(b, 0, b.count) for b in one] for one in lists]
    parts: list[list[Part]] = [[] for _ in group]
    for blocks in zip(*lists, strict=True):
        for mine, part in zip(parts, _changed(blocks, [b.weight for b in group]), strict=False):
            mine.append(part)
    return parts


def _correspond(a: BoundBlock, b: BoundBlock) -> bool:
    return a.block.kernel == b.block.kernel and np.array_equal(a.index, b.index)


def _changed(blocks: Sequence[BoundBlock], weights: Sequence[float]) -> list[Part]:
    """Parts of corresponding blocks for ``_parts_of``: of each, of the first one, or none."""
    first, count = blocks[0].block, blocks[0].count
    if first.context and not _equal(blocks):
        return [_part(b, 0, count) for b in blocks]
    if any(b.block.update or b.block.remembers for b in blocks):
        return [Part(b, 0, count, b.block.params, tuple(q.block.params for q in blocks)) for b in blocks]
    differs = np.zeros(first.params.shape, dtype=bool)
    for b in blocks[1:]:
        differs |= ~((b.block.params == first.params) | (np.isnan(b.block.params) & np.isnan(first.params)))
    found = np.flatnonzero(differs.any(axis=1))
    if not len(found):
        return []
    if first.context:  # its record counts the elements from the first one on
        return [_part(b, 0, count) for b in blocks]
    span = slice(int(found[0]), int(found[-1]) + 1)
    linear = np.zeros(differs.shape[1], dtype=bool)
    for name in first.linear:
        linear[first.named.columns[name]] = True
    if differs[:, ~linear].any():
        return [_part(b, span.start, span.stop) for b in blocks]
    # rows that are linear in the parameters have as derivative the rows with the derivatives of the parameters
    params = first.params[span].copy()
    sums = np.tensordot(weights, np.array([b.block.params[span] for b in blocks]), 1)
    params[:, linear] = sums[:, linear] / weights[0]
    return [Part(blocks[0], span.start, span.stop, params)]


def _equal(blocks: Sequence[BoundBlock]) -> bool:
    """Whether the records of blocks are known to hold the same numbers."""
    first = blocks[0].block.constants
    return bool(first) and all(
        len(b.block.constants) == len(first) and all(map(np.array_equal, b.block.constants, first))
        for b in blocks
    )
