"""Expected time of a step on several ranks, from counts: entries, operations, messages and bytes (manual: sec-parallel-model).

The times of an entry, an operation and a message are those of one machine; the speed-up depends on their ratios only.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, log2

from drillpetsc.model.drilling_model import DrillingModel, is_quasi_static
from drillpetsc.solvers.chain.block_tridiagonal import chain_flops

RANKS = (2, 4, 8, 16, 32, 64)
#: solves, residuals and Jacobians of a step: those of a well that turns in its hole (scripts/benchmark)
ITERATIONS, RESIDUALS, JACOBIANS = 3.5, 4.5, 0.75
#: s for each entry of the Jacobian, in a run whose matrices do not stay in the cache
RESIDUAL, JACOBIAN, ASSEMBLY, SOLVE, AFTER = 0.58e-9, 2.3e-9, 1.5e-9, 0.3e-9, 1.9e-9
OPERATION = 0.08e-9  # s for each operation of the elimination of small blocks
STEP = 260e-6  # s of each step, whatever the number of elements
ITERATION = 2e-6, 25e-6  # s of each iteration: one compiled call on one rank, its parts on several
#: sums over all ranks: of each step and of each iteration
SUMS = 1.5, 3.7
#: exchanges with neighbours: of each step and of each residual
EXCHANGES = 2.0, 2.0
#: s of a call beside the message; s of a message between two ranks of a machine, and of a byte
CALL, LATENCY, BYTE = 18e-6, 2e-6, 0.2e-9
UNEVEN = 1.08  # work of the busiest rank over the mean: elements in contact take longer
GAIN = 1.4  # a doubling of the ranks that gains less does not pay


@dataclass(frozen=True)
class StepCounts:
    """What a step of a string consists of.

    elements: their number; entries: of the Jacobian, for each element; block: unknowns of a node.
    """

    elements: int
    entries: float
    block: int

    def work(self, ranks: int) -> float:
        """Time [s] of the elements of one rank: kernels, assembly, elimination, solves, results."""
        entries = self.entries * self.elements / ranks
        by_entry = (
            RESIDUALS * RESIDUAL
            + JACOBIANS * (JACOBIAN + ASSEMBLY)
            + ITERATIONS * SOLVE * self.operations(ranks)[1] / self.operations(1)[1]
            + AFTER
        )
        factor = JACOBIANS * OPERATION * self.operations(ranks)[0] * self.elements / ranks
        return (entries * by_entry + factor) * (UNEVEN if ranks > 1 else 1.0)

    def operations(self, ranks: int) -> tuple[float, float]:
        """Operations of a factorisation and of a solve for a node of the busiest rank, which has an interface at both ends on three
        ranks and more."""
        return chain_flops(self.block, self.block, self.block if ranks > 2 else 0)

    def messages(self, ranks: int) -> dict[str, tuple[float, float]]:
        """Calls of a step, and bytes that a rank receives in one of them: sums, exchanges with neighbours, gathers of interface blocks
        and of their right-hand sides."""
        if ranks == 1:
            return dict.fromkeys(("sum", "exchange", "blocks", "right-hand side"), (0.0, 0.0))
        blocks = (4 * (ranks - 2) + 2) * self.block**2 + 5 * ranks
        return {
            "sum": (SUMS[0] + SUMS[1] * ITERATIONS, 60.0),
            "exchange": (EXCHANGES[0] + EXCHANGES[1] * RESIDUALS, 8.0 * self.block),
            "blocks": (JACOBIANS, 8.0 * blocks),
            "right-hand side": (ITERATIONS, 8.0 * 2 * (ranks - 1) * self.block),
        }

    def communication(self, ranks: int) -> float:
        """Time [s] of the messages of a step, and of the system of the interfaces, which every rank solves."""
        if ranks == 1:
            return 0.0
        seconds, stages = 0.0, ceil(log2(ranks))
        for kind, (calls, size) in self.messages(ranks).items():
            passes = 1 if kind == "exchange" else stages
            seconds += calls * (CALL + passes * LATENCY + size * BYTE)
        factor, solve = chain_flops(self.block, self.block, 0)
        interfaces = ranks - 1
        entries = 4 * self.block**2
        shared = JACOBIANS * (OPERATION * factor + ASSEMBLY * entries) + ITERATIONS * OPERATION * solve
        return seconds + interfaces * shared

    def time(self, ranks: int) -> float:
        """Time [s] of a step on so many ranks, each with a core of its own."""
        return STEP + ITERATIONS * ITERATION[ranks > 1] + self.work(ranks) + self.communication(ranks)

    def speed_up(self, ranks: int) -> float:
        """Time on one rank over that on several."""
        return self.time(1) / self.time(ranks)

    def least_elements(self, ranks: int = 2) -> int:
        """Fewest elements of a rank with which so many ranks gain ``GAIN`` over half as many."""
        few, many = 1, 1 << 24
        while few < many:
            middle = (few + many) // 2
            string = StepCounts(ranks * middle, self.entries, self.block)
            if string.time(ranks // 2) / string.time(ranks) >= GAIN:
                many = middle
            else:
                few = middle + 1
        return few


def step_counts(model: DrillingModel) -> StepCounts:
    """Counts of a model, from this rank's part of it."""
    chain, system = model.system.chain, model.system
    elements = int((~model.mesh.is_joint).sum())
    entries = len(system.assembly.values) / max(1, len(chain.cells))
    return StepCounts(elements, entries, round(system.layout.size / max(1, len(chain.vertices))))


def rank_lines(model: DrillingModel) -> list[str]:
    """What to expect of several ranks; empty if no motion in time is computed."""
    if model.case.time is None or is_quasi_static(model.case) or model.system.comm.size > 1:
        return []
    return lines_of(step_counts(model))


def lines_of(counts: StepCounts) -> list[str]:
    """The same from counts."""
    pay = [p for p in RANKS if p <= counts.elements and counts.time(p // 2) / counts.time(p) >= GAIN]
    two = counts.speed_up(2)
    if 2 not in pay:
        what = f"2 would be {two:.2g} x as fast" if two >= 1.0 else f"2 would take {1 / two:.2g} x as long"
        best = "1 rank is fastest" if two < 1.0 else "a second rank hardly pays"
        return [
            f"expected on several ranks: {best}, {what}; ranks pay above {counts.least_elements()} elements each"
        ]
    parts = ", ".join(f"{p} ranks: {counts.speed_up(p):.2g} x" for p in pay)
    least = counts.least_elements(pay[-1])
    return [
        f"expected on ranks with a core each: {parts}; a rank with fewer than {least} elements does not pay"
    ]
