"""Progress: live line on a terminal, plain lines in a log, nothing when silent."""

from __future__ import annotations

import io
import time

import pytest

from drillpetsc.output import progress
from drillpetsc.output.progress import Progress, duration
from tests.helpers.tables import each_row


class Clock:
    now = 100.0

    def __call__(self) -> float:
        return self.now


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    clock = Clock()
    monkeypatch.setattr(progress.time, "monotonic", clock)
    return clock


def run(shown: Progress, clock: Clock, wall: float, speed: float, end: float) -> None:
    """Step by step of 0.1 wall seconds, each worth 0.1 * speed simulated seconds."""
    steps = round(wall / 0.1)
    for k in range(1, steps + 1):
        clock.now += 0.1
        shown.update(min(0.1 * speed * k, end), k, 0.1 * speed)


def test_a_log_gets_one_plain_line_every_few_seconds(clock: Clock) -> None:
    """10 wall seconds at twice real time in a run of 60 s: lines at 5 s and 10 s, factor 2, 20 s left after
    the first has (60 - 10) / 2 = 25 s."""
    log = io.StringIO()
    run(Progress(end=60.0, stream=log), clock, 10.45, 2.0, 60.0)
    lines = log.getvalue().splitlines()
    assert len(lines) == 2 and "\r" not in log.getvalue() and "\x1b" not in log.getvalue()
    assert "/ 60 s" in lines[0] and "step 5" in lines[0] and "dt 2.00e-01 s" in lines[0]
    assert "real-time factor 2 " in lines[0] and "ETA 25 s" in lines[0]


def test_a_terminal_gets_one_live_line_that_is_cleared_at_the_end(
    clock: Clock, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setenv("COLUMNS", "60")
    screen = Terminal()
    shown = Progress(end=10.0, stream=screen)
    run(shown, clock, 4.0, 2.0, 10.0)
    live = screen.getvalue()
    assert "\n" not in live and live.count("\r") >= 10
    assert all(len(part.replace("\x1b[K", "")) <= 59 for part in live.split("\r"))
    shown.message("step cut at 3 s")
    shown.finish(8.0, 40)
    assert screen.getvalue()[len(live) :] == (
        "\r\x1b[Kstep cut at 3 s\n8 s of 10 s in 40 steps, 4.0 s wall, real-time factor 2\n"
    )


def test_a_dumb_terminal_is_a_log(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TERM", "dumb")
    assert Progress(end=1.0, stream=Terminal()).mode == "log"


def test_silent_says_nothing(clock: Clock) -> None:
    log = io.StringIO()
    shown = Progress(end=10.0, stream=log, mode="silent")
    run(shown, clock, 20.0, 1.0, 10.0)
    shown.message("hello")
    shown.finish(10.0, 3)
    assert log.getvalue() == ""


def test_the_estimate_follows_a_run_that_slows_down(clock: Clock) -> None:
    """60 wall s at factor 10, then 60 wall s at factor 1: the last 30 s decide, so 39 s of 699 are 39 wall
    seconds away (all since the start would promise 7)."""
    log = io.StringIO()
    shown = Progress(end=699.0, stream=log)
    simulated = 0.0
    for k in range(1200):
        clock.now += 0.1
        simulated += 1.0 if k < 600 else 0.1
        shown.update(simulated, k, 0.1)
    last = log.getvalue().splitlines()[-1]
    assert "real-time factor 1 " in last
    assert 39 <= float(last.split("ETA ")[1].split(" s")[0]) <= 45


def test_a_restart_and_a_run_that_stands_still(clock: Clock) -> None:
    log = io.StringIO()
    shown = Progress(end=20.0, start=10.0, stream=log, label="well 2")
    clock.now += 6
    shown.update(10.0, 0, 1e-9)
    assert log.getvalue().startswith("well 2: 10 / 20 s (0 %)") and "ETA ?" in log.getvalue()


@each_row(
    ("seconds", "text"),
    [
        (3.2, "3.2 s"), (59.0, "59 s"), (75.0, "1 min 15 s"), (4020.0, "1 h 07 min"), (float("inf"), "?"),
        (float("nan"), "?"),
    ],
)  # fmt: skip
def test_durations(seconds: float, text: str) -> None:
    assert duration(seconds) == text


def test_an_update_that_prints_nothing_costs_little() -> None:
    """5 us were asked for."""
    shown = Progress(end=1.0, stream=io.StringIO(), interval=1e9)
    best = float("inf")
    for _ in range(5):
        start = time.perf_counter()
        for k in range(1000):
            shown.update(0.1, k, 0.1)
        best = min(best, (time.perf_counter() - start) / 1000)
    assert best < 5e-6


def test_a_function_gets_the_share_and_the_lines(clock: Clock) -> None:
    """A run of 10 s at twice real time: after 2.5 wall seconds half of it is done."""
    got: list[tuple[float, str]] = []
    log = io.StringIO()
    shown = Progress(end=10.0, mode=lambda share, text: got.append((share, text)), stream=log)
    run(shown, clock, 2.5, 2.0, 10.0)
    shown.message("warning: a")
    shown.finish(5.0, 25)
    shares = [share for share, _ in got]
    assert shares == sorted(shares) and len(shares) > 8 and shares[-1] == pytest.approx(0.5)
    assert got[-2][1] == "warning: a" and "5 s of 10 s" in got[-1][1] and not log.getvalue()


def test_a_function_that_fails_is_not_called_again(clock: Clock) -> None:
    calls = []

    def fail(share: float, text: str) -> None:
        calls.append(share)
        raise ValueError("no")

    shown = Progress(end=10.0, mode=fail)
    with pytest.raises(ValueError, match="no"):
        run(shown, clock, 2.0, 2.0, 10.0)
    shown.message("later")
    shown.finish(1.0, 5)
    assert len(calls) == 1
