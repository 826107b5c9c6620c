"""Public records (../shared/data): figures of the contract, which were counted on them beforehand by other means."""

from __future__ import annotations

from datetime import UTC, datetime

import numpy as np
import pytest

from drillpetsc.analysis.commands.import_log import weights
from drillpetsc.case import load_case
from drillpetsc.errors import CaseError
from drillpetsc.logs.log import between, read_log
from drillpetsc.logs.points import Every, points_of
from drillpetsc.logs.quality import dead_flag, gaps, held_values, without_jumps
from drillpetsc.logs.states import Limits, states_of
from tests.helpers.records import record

DAY = "2016-10-05T01:00,2016-10-05T15:00"


@pytest.fixture(scope="module")
def trip():
    """(log, states) of F-4 on 5 October, 01:00 to 15:00."""
    case = load_case(record("volve-f4/f4.yaml"))
    log = between(read_log([record("volve-f4/rig-15s.csv")]), DAY)
    weight = weights(case, log.column("bit_depth"))(log.column("bit_depth"))
    return log, states_of(log, weight, case.rig.block_weight, Limits(), gaps(log)[0])


def test_states_of_a_day_of_tripping(trip):
    """Rows of each state as counted with a script of its own, but for one row in slips and two at rest."""
    log, states = trip
    count = states.count()
    found = {name: count[name] for name in ("hanging", "circulate", "trip_in", "trip_out", "edge", "unknown")}
    found["in_slips"] = count["in_slips"] + count["connection"]
    expected = {
        "in_slips": 1376,
        "hanging": 747,
        "circulate": 557,
        "trip_in": 154,
        "trip_out": 137,
        "edge": 180,
        "unknown": 199,
    }
    assert len(log) == sum(expected.values())
    assert {name: abs(found[name] - expected[name]) <= 2 for name in expected} == dict.fromkeys(
        expected, True
    )
    assert states.block == pytest.approx(661e3, abs=6e3)


def test_connections_of_the_contractor(trip):
    """57 connections noted by the contractor: at least 50 within 15 s of an edge of slips, 55 within 32 s."""
    log, states = trip
    table = read_log([record("volve-f4/trip-connections.csv")])
    day = [datetime.fromisoformat(text).replace(tzinfo=UTC) for text in DAY.split(",")]
    low, high = ((t - table.start).total_seconds() for t in day)
    noted = table.values["time"]
    noted = noted[(noted >= low) & (noted < high)] + (table.start - log.start).total_seconds()
    slips = states.in_slips
    edges = log.values["time"][1:][slips[1:] != slips[:-1]]
    away = np.abs(noted[:, None] - edges).min(1)
    assert len(noted) == 57
    assert (away <= 15).sum() >= 50 and (away <= 32).sum() >= 55


def test_contractors_flag_is_dead(trip):
    """The flag is 0 in 1658 rows, in 674 of which the string is in slips by the log of every 15 s."""
    log, states = trip
    noted = between(read_log([record("volve-f4/trip-time.csv")]), DAY)
    assert len(noted) == 1658 and (noted.column("in_slips") == 0).all()
    at = noted.values["time"] + (noted.start - log.start).total_seconds()
    slips = states.in_slips[np.minimum(np.searchsorted(log.values["time"], at), len(log) - 1)]
    assert slips.sum() == pytest.approx(674, abs=2)
    (check,) = dead_flag(noted, slips)
    assert check.name == "dead flag" and check.count == slips.sum()


def test_drilling_log_by_depth():
    """F-5: jumps, steps back and held values as counted beforehand; every row drills; points of 1 m."""
    log = read_log([record("volve-f5/measured-12in.csv")])
    held = {check.channel: check for check in held_values(log)}
    assert (
        round(held["hook_load"].count / held["hook_load"].n, 2) == 0.57
        and "171 distinct" in held["hook_load"].detail
    )
    assert round(held["wob_downhole"].count / held["wob_downhole"].n, 2) == 0.40
    nothing = np.full(len(log), np.nan)
    whole = states_of(log, nothing, None, Limits(), gaps(log)[0])
    assert whole.count() == {"drilling": 16219}
    rpm = log.column("rpm") * 30 / np.pi
    assert ((rpm > 147) & (rpm < 153)).sum() == 15797
    kept, jumps = without_jumps(log)
    assert jumps.count == 2598 and "3263 steps back become 705" in jumps.detail
    nothing = np.full(len(kept), np.nan)
    far, gap = gaps(kept)
    assert gap.count == 0
    points = points_of(kept, states_of(kept, nothing, None, Limits(), far), nothing, Every(1.0), far)
    assert len({int(p.bit_depth) for p in points}) == 480
    assert np.median([p.scatter["hook_load"] for p in points]) == pytest.approx(1.45e3, rel=0.01)
    assert np.median([p.scatter["torque"] for p in points]) == pytest.approx(430, rel=0.05)


LOGS = (
    *(
        "forge-16b/pason_trial_1min.csv",
        "forge-58-32/measured-1ft.csv",
        "volve-f4/rig-15s.csv",
        "volve-f4/trip-time.csv",
    ),
    *(
        "volve-f5/measured-12in.csv",
        "volve-f9a/measured.csv",
        "volve-f9a/rig-15s.csv",
        "volve-f9a/trip-time.csv",
    ),
)


def test_every_log_reads_without_a_false_alarm():
    """The only warning is true: the torque of FORGE 58-32 is the pressure of a gauge."""
    wrong = []
    for name in LOGS:
        path = record(name)
        try:
            log = read_log([path])
        except CaseError as error:
            wrong.append((name, str(error)))
            continue
        true = ("surface_torque_psi_of_gauge: a pressure",) if "58-32" in name else ()
        if len(log.warnings) != len(true) or not all(
            w.startswith(t) for w, t in zip(log.warnings, true, strict=True)
        ):
            wrong.append((name, log.warnings))
    assert not wrong
