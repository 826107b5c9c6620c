"""A log that is being written: rows a few at a time, old and broken ones left out, points that do not depend on the pieces."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc.errors import CaseError
from drillpetsc.logs.growing import GrowingLog
from drillpetsc.logs.stream import LogStream
from drillpetsc.output.files.json_file import plain

HEAD = "time,bit_md_m,hole_md_m,hookload_kN,rpm,flow_in_lpm"


def _trip() -> list[str]:
    """Lines of a trip out at 10 s: stands of 28 m in 80 s, then 60 s in slips."""
    out, depth = [HEAD], 2300.0
    for i in range(140):
        pulled = i % 14 < 8
        depth -= 3.5 if pulled else 0.0
        out.append(
            f"2026-01-01T{i // 360:02d}:{i // 6 % 60:02d}:{10 * (i % 6):02d},{depth:.1f},2400,{1300 if pulled else 600},0,0"
        )
    return out


def _points(lines: list[str], size: int) -> list:
    stream, growing, out = LogStream("rig.csv"), None, []
    for i in range(0, len(lines), size):
        log = stream.rows(lines[i : i + size])
        if log is None:
            continue
        growing = growing or GrowingLog(lambda depth: np.full(len(depth), 700e3), 600e3, 1.0, stream.titles)
        out += growing.add(log)
    return out + growing.finish()


def test_points_do_not_depend_on_the_pieces():
    whole = _points(_trip(), 1000)
    kinds = [point.operation for point, _ in whole]
    assert kinds.count("trip_out") == 10 and kinds.count("in_slips") >= 9
    pulled = [point for point, _ in whole if point.operation == "trip_out"]
    assert all(point.values["hook_load"] == 1300e3 for point in pulled)
    assert np.median([point.speed for point in pulled]) == pytest.approx(0.35, rel=0.01)
    for size in (1, 7):
        assert repr(_points(_trip(), size)) == repr(whole)


def test_a_column_of_dates_beside_the_times_changes_no_point():
    """Date;Time with a comma for decimals, the day before the month as dots say, is the log with one column of clock times."""
    lines = [HEAD.replace("time", "Date,Time").replace(",", ";")]
    for line in _trip()[1:]:
        moment, *cells = line.split(",")
        lines.append(";".join(["01.02.2026", moment[11:], *(q.replace(".", ",") for q in cells)]))
    assert _points(lines, 7) == _points(_trip(), 7)


def test_the_order_of_day_and_month_holds_for_later_pieces():
    """Rows of the 31st show it, those of the first days of a month no longer do."""
    stream = LogStream("rig.csv")
    stream.rows([HEAD, "31/01/2026 23:59:50,2300,2400,600,0,0"])
    log = stream.rows(["01/02/2026 00:00:00,2300,2400,600,0,0"])
    assert log is not None and log.values["time"].tolist() == [10.0] and not stream.left_out


def test_restart_amid_a_stand():
    lines = _trip()
    stream = LogStream("rig.csv")
    first = stream.rows(lines[:75])
    growing = GrowingLog(lambda depth: np.full(len(depth), 700e3), 600e3, 1.0, stream.titles)
    out = growing.add(first)
    again = GrowingLog(lambda depth: np.full(len(depth), 700e3), 600e3, 1.0, stream.titles)
    again.restore(plain(growing.saved()))
    out += again.add(stream.rows(lines[75:])) + again.finish()
    assert repr(out) == repr(_points(lines, 1000))


def test_broken_and_old_rows_are_left_out_and_counted():
    lines = _trip()
    good = LogStream("rig.csv").rows(lines)
    broken = [
        *lines[:40],
        lines[20],
        "2026-01-01T00:06:35,oops",
        *lines[40:60],
        lines[60].replace("2300", "x"),
        *lines[61:],
    ]
    broken[50] = broken[50].replace(",1300,", ",no value,").replace(",600,", ",no value,")
    broken.insert(70, "yesterday,2000,2400,1300,0,0")
    stream = LogStream("rig.csv")
    log = stream.rows(broken)
    assert len(log) == len(good)
    assert np.isnan(log.values["hook_load"]).sum() == 1
    assert stream.left_out == {
        "rows of another length than the headings": 1,
        "rows older than the row before": 1,
        "rows without a time": 1,
        "cells of hookload_kN that are not numbers": 1,
    }


def test_a_second_line_with_units_and_a_log_by_depth():
    stream = LogStream("rig.csv")
    log = stream.rows(["Depth;Hook load;Torque", "m;t;kNm", "1000;100;12", "1000.5;101;12.5"])
    assert log.values["bit_depth"].tolist() == [1000.0, 1000.5]
    assert log.values["hook_load"].tolist() == pytest.approx([980665.0, 990471.65])
    assert not stream.by_time and stream.last is None


@pytest.mark.parametrize(
    ("lines", "words"),
    [
        (["one,two,three"] * 60, "a heading with time or depth"),
        (["time [s],hole depth [m],hook load [t]", "1,2000,100"], "bit depth"),
        (["time,bit depth [m],hook load [t]", "12,2000,100"], "a unit"),
        (["time [s],bit depth [m],hook load", "12,2000,100"], "hook_load"),
    ],
)
def test_what_cannot_be_understood(lines, words):
    with pytest.raises(CaseError, match=words):
        LogStream("rig.csv").rows(lines)
