"""The quaternion string on several ranks."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.helpers.mpi import run_mpi

SCRIPT = Path(__file__).with_name("run_quaternion.py")


@pytest.mark.parallel
def test_a_quaternion_string_is_the_same_on_1_2_and_3_ranks():
    """Static start and 20 steps in contact, both forms of the constraints: motion, multipliers, reactions and
    energies equal to 1e-8 of their sizes (systems solved to rounding; friction with a slip velocity of 0.01
    m/s amplifies it)."""
    runs, muddy, items = [], [], []
    for n in (1, 2, 3):
        reported = run_mpi(n, SCRIPT).splitlines()
        runs.append(
            np.array([[float(w) for w in line.split()[2:]] for line in reported if line.startswith("END")])
        )
        items.append(
            np.array(
                [
                    [float(w) for w in line.split()[1:]]
                    for line in reported
                    if line.startswith(("ITEMS", "HERMITE"))
                ]
            )
        )
        muddy += [
            np.array([float(w) for w in line.split()[1:]]) for line in reported if line.startswith("MUD")
        ]
    one = runs[0]
    assert one.shape == (2, 13)
    assert [len(row) for row in muddy] == [8, 8, 8] and (muddy[0] != 0).all()
    for row in muddy[1:]:  # with mud, unbalance and a bit that drills
        assert row == pytest.approx(muddy[0], rel=1e-7)
    assert items[0].shape == (2, 20)
    for other in items[1:]:  # rigid items above other pipe with a joint, with mud of the Hermite form
        assert np.all(np.abs(other - items[0]) <= 1e-7 * np.maximum(np.abs(items[0]), 1e-3))
    for other in runs[1:]:
        assert np.all(np.abs(other - one) <= 1e-8 * np.maximum(np.abs(one), 1e-3))
