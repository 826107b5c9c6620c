"""Progress of commands over many points: how many are done, and the time left."""

from __future__ import annotations

import io

import pytest

from drillpetsc.output.progress import counted
from tests.unit.output.test_progress import Clock, Terminal, clock

__all__ = ["clock"]  # the fixture


@pytest.fixture(autouse=True)
def _terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TERM", "xterm")


def work(clock: Clock, seconds: float, count: int, rank: int, stream: io.StringIO) -> str:
    done = []
    for k in counted(range(count), "points", rank, stream):
        done.append(k)
        clock.now += seconds
    assert done == list(range(count))
    return stream.getvalue()


def test_a_log_has_a_line_every_ten_seconds_with_the_time_left(clock: Clock) -> None:
    """Six points of 6 s: lines after 12, 24 s (the next ones ten seconds later), with 6 s a point left."""
    lines = work(clock, 6.0, 6, 0, io.StringIO()).splitlines()
    assert lines == ["2 of 6 points (33 %)  ETA 24 s", "4 of 6 points (66 %)  ETA 12 s"]


def test_short_work_and_other_ranks_show_nothing(clock: Clock) -> None:
    assert work(clock, 1.0, 9, 0, io.StringIO()) == "" and work(clock, 60.0, 9, 1, io.StringIO()) == ""


def test_a_terminal_has_one_line_which_is_taken_away(clock: Clock) -> None:
    text = work(clock, 2.0, 4, 0, Terminal())
    assert text == "\r2 of 4 points (50 %)  ETA 4.0 s\x1b[K\r3 of 4 points (75 %)  ETA 2.0 s\x1b[K\r\x1b[K"
