"""Model of the time of a step on several ranks."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc.analysis.commands.rank_model import GAIN, RANKS, UNEVEN, StepCounts, lines_of
from drillpetsc.solvers.chain.block_tridiagonal import Piece
from tests.helpers.tables import each_row

WET, DRY = (1016.0, 11), (216.0, 7)  # entries for each element, unknowns of a node


@each_row("block", [7, 11])
@each_row("interfaces, ranks", [(0, 1), (2, 2), (3, 3)])
def test_operations_are_those_of_the_solver(block, interfaces, ranks):
    """Per node of a long piece without, with one and with two interfaces, to 1 %; leading term 14/3 b^3 and 38/3 b^3."""
    n = 2000
    piece = Piece(np.full(n, block), interfaces)
    counted = StepCounts(ranks * n, 1.0, block).operations(ranks)
    assert np.allclose(np.array(piece.flops()) / n, counted, rtol=1e-2)
    leading = (38 if ranks > 2 else 14) / 3 * block**3
    assert counted[0] == pytest.approx(leading, rel=0.25)


@each_row("entries, block", [WET, DRY])
@each_row("elements", [1, 16, 225, 2400, 20000, 10**7])
def test_speed_up_is_below_the_number_of_ranks(elements, entries, block):
    counts = StepCounts(elements, entries, block)
    assert counts.speed_up(1) == 1.0 and counts.communication(1) == 0.0
    for ranks in RANKS:
        assert 0.0 < counts.speed_up(ranks) < ranks


@each_row(
    "elements, string, one, two",
    [(225, DRY, 0.444, 0.735), (600, WET, 6.94, 4.99), (2400, WET, 28.8, 18.35), (4800, WET, 52.4, 32.7)],
)
def test_speed_ups_are_those_that_were_measured(elements, string, one, two):
    """Wall time [ms] of a step on one and on two ranks with a core each (manual: sec-parallel-model), to 15 %."""
    assert StepCounts(elements, *string).speed_up(2) == pytest.approx(one / two, rel=0.15)


def test_long_strings_reach_the_limit_of_the_work():
    """Two ranks: the busier one has UNEVEN times half of the work; more ranks eliminate with fill besides."""
    counts = StepCounts(10**8, *WET)
    assert counts.speed_up(2) == pytest.approx(2 / UNEVEN, rel=1e-3)
    assert 0.6 * 64 < counts.speed_up(64) < 64 / UNEVEN


@each_row("entries, block", [WET, DRY])
@each_row("ranks", [2, 4, 64])
def test_least_elements(ranks, entries, block):
    """With one element less on each rank they gain less than GAIN over half as many."""
    least = StepCounts(1, entries, block).least_elements(ranks)
    for elements, pays in ((least, True), (least - 1, False)):
        string = StepCounts(ranks * elements, entries, block)
        assert (string.time(ranks // 2) / string.time(ranks) >= GAIN) is pays


def test_lines():
    """Small strings: one rank; no more ranks than elements; ranks in ascending order, each with more than the one before."""
    for elements in (1, 2, 16, 225):
        (line,) = lines_of(StepCounts(elements, *DRY))
        assert "1 rank is fastest" in line and "as long" in line, line
    (line,) = lines_of(StepCounts(4800, *WET))
    shown = [float(part.split()[2]) for part in line.split("each: ")[1].split("; ")[0].split(", ")]
    assert len(shown) >= 3 and shown == sorted(shown) and 1.5 < shown[0] < 2.0, line


@each_row("entries, block", [WET, DRY])
@each_row("elements", [600, 1199, 2400, 4800, 20000])
def test_the_line_agrees_with_itself(elements, entries, block):
    """Ranks that are said to pay have at least the elements that are said to be needed."""
    (line,) = lines_of(StepCounts(elements, entries, block))
    if "core each" in line:
        ranks = int(line.split(" ranks: ")[-2].split()[-1])
        needed = int(line.split("fewer than ")[1].split()[0])
        assert elements / ranks >= needed - 1, line
    else:
        assert elements / 2 < int(line.split("above ")[1].split()[0]), line
