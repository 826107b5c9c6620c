"""Pulls: rows over which the hook load rises with the block."""

from __future__ import annotations

from drillpetsc.logs.pulls import Pull, Pulls


def taken(rows: list[tuple[float, float, float]], hangs: bool = True) -> list[tuple[float, Pull]]:
    """(time, pull) of rows of time [s], height [m], hook load [kN]."""
    pulls = Pulls()
    return [(t, q) for t, z, f in rows for q in pulls.take(t, z, 1000.0 - z, 1e3 * f, hangs)]


RISE = [(float(k), 0.05 * k, 900 + 20.0 * k) for k in range(11)]


def test_a_pull_is_given_while_it_is_held_and_when_it_ends():
    """Each five seconds for a minute after the highest load, and once at the fall, with all rows since its beginning."""
    held = [(float(t), 0.5, 1099.0) for t in range(11, 200)]
    found = taken([*RISE, *held, (200.0, 0.2, 900.0)])
    assert [t for t, _ in found] == [*range(15, 71, 5)]
    assert len(found[-1][1].height) == 71 and found[-1][1].hook_load.max() == 1100e3
    assert found[-1][1].bit_depth == 999.5
    found = taken([*RISE, (11.0, 0.2, 900.0)])
    assert [t for t, _ in found] == [11] and len(found[0][1].height) == 11


def test_what_is_not_a_pull():
    """Rows in slips; a rise of 40 kN; a load that rises along more than six metres; rows without a load; one that only falls."""
    assert not taken(RISE, hangs=False)
    assert not taken([(t, z, 900 + (f - 900) / 5) for t, z, f in RISE] + [(30.0, 0.5, 930.0)])
    slow = [(float(t), 0.3 * t, 900 + t) for t in range(300)]
    assert not taken([*slow, (310.0, 90.0, 1000.0)])
    assert not taken([(t, z, float("nan")) for t, z, f in RISE])
    falls = [(float(k), 0.05 * k, 3000 - 8.0 * k) for k in range(8)]
    assert not taken([*falls, (8.0, 0.2, 500.0)])
