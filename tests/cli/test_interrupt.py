"""Runs that are stopped from outside: by signals, and by a disk that is full."""

from __future__ import annotations

import json
import os
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from drillpetsc.analysis.motion.run_control import NOTHING, SAVE, STOP, WRITE, RunControl
from drillpetsc.output import read_frame, read_series, read_table
from drillpetsc.parallel import ENDING
from tests.helpers.command import ENVIRONMENT, succeeds

CASE = """
title: for interruption
well:
  survey: {md: [0 m, 60 m], inclination: [60 deg, 60 deg], azimuth: [0 deg, 0 deg]}
  sections: [{to: 60 m, kind: casing, diameter: 215.9 mm, friction: 0.2}]
string:
  - {kind: pipe, length: 30 m, od: 127 mm, id: 108.6 mm, element_length: 10 m}
  - {kind: pipe, length: 20 m, od: 171.5 mm, id: 71.4 mm, element_length: 10 m}
top: {kind: top_drive, rotation: {ramp: 0.1 s, value: 60 rpm}}
time: {end: 1 s}
output: {history_every: 0.01 s, field_every: 0.05 s, probes: [25 m], checkpoint_every: 100 s}
"""
FILES = ("history.csv", "probes.csv", "string.pvd", "trajectory.csv")


def start(folder: Path, *words: str, command: str = "run") -> subprocess.Popen:
    """drillpetsc run ... in ``folder``, in a process that can be stopped."""
    line = [sys.executable, "-m", "drillpetsc", command, *words, "--progress", "silent"]
    environment, pipe = os.environ | ENVIRONMENT, subprocess.PIPE
    return subprocess.Popen(line, cwd=folder, env=environment, text=True, stdout=pipe, stderr=pipe)


def finish(folder: Path, *words: str, command: str = "run") -> str:
    """The same in this process, to its end; returns what it prints."""
    done = succeeds(command, *words, "--progress", "silent", cwd=folder)
    return done.stdout


def wait_for_rows(file: Path, rows: int, job: subprocess.Popen) -> None:
    """Until the table has so many rows."""
    end = time.monotonic() + 60
    while time.monotonic() < end and job.poll() is None:
        if file.exists() and file.read_text().count("\n") > rows:
            return
        time.sleep(0.002)
    raise AssertionError(f"no {rows} rows in {file}: {job.communicate()}")


def same(one: Path, other: Path) -> None:
    for name in FILES:
        assert (one / name).read_bytes() == (other / name).read_bytes(), name
    frames = sorted(p.name for p in (one / "string").iterdir())
    assert frames == sorted(p.name for p in (other / "string").iterdir())
    for name in frames:
        assert (one / "string" / name).read_bytes() == (other / "string" / name).read_bytes(), name


@pytest.fixture(scope="module")
def whole(tmp_path_factory) -> Path:
    """A folder with the case and its uninterrupted run, in run/."""
    folder = tmp_path_factory.mktemp("interrupt")
    (folder / "case.yaml").write_text(CASE)
    finish(folder, "case.yaml", "--out", "run")
    return folder


def test_a_request_for_a_checkpoint_does_not_end_the_start(whole: Path) -> None:
    """SIGUSR1 from the first moment of the command on, before the run moves, where its default would end the process."""
    job = start(whole, "case.yaml", "--out", "asked")
    status = Path(f"/proc/{job.pid}/status")
    handled = 1 << (signal.SIGUSR1 - 1)

    def caught() -> int:
        found = [line.split()[1] for line in status.read_text().splitlines() if line.startswith("SigCgt")]
        return int(found[0], 16) & handled

    end = time.monotonic() + 60
    while not caught() and time.monotonic() < end:  # Python itself has not begun
        time.sleep(0.001)
    for _ in range(20):
        job.send_signal(signal.SIGUSR1)
        time.sleep(0.02)
    _, err = job.communicate(timeout=120)
    assert job.returncode == 0, err


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_ends_the_run_with_a_checkpoint_that_goes_on_identically(whole, number):
    """Stopped at any step (not at a time of output): exit status 1, the words to continue with, and every
    file in the end the same. The other signals are taken over alike, as the test of `RunControl` shows."""
    name = f"stopped-{number}"
    job = start(whole, "case.yaml", "--out", name)
    wait_for_rows(whole / name / "history.csv", 15, job)
    job.send_signal(number)
    _, err = job.communicate(timeout=60)
    assert job.returncode == 1, err
    assert (
        signal.Signals(number).name in err
        and "--restart" in err
        and f"--out {name}" in err
        and "Traceback" not in err
    )
    summary = json.loads((whole / name / "summary.json").read_text())
    assert summary["interrupted"] and 0 < summary["time"] < 1
    assert abs(summary["energy"]["error_share"]) < 0.05 and "hook_load [N]" in summary["final"]
    rows = len(read_table(whole / name / "history.csv")["time [s]"])
    assert rows >= 15
    finish(whole, "case.yaml", "--out", name, "--restart")
    same(whole / "run", whole / name)
    assert json.loads((whole / name / "summary.json").read_text())["interrupted"] is False


def test_sigusr1_asks_for_a_checkpoint_and_the_run_goes_on(whole):
    job = start(whole, "case.yaml", "--out", "saved")
    wait_for_rows(whole / "saved" / "history.csv", 5, job)
    first = (whole / "saved" / "checkpoint.h5").stat().st_mtime_ns  # the one of time 0
    job.send_signal(signal.SIGUSR1)
    end = time.monotonic() + 20
    while (
        (whole / "saved" / "checkpoint.h5").stat().st_mtime_ns == first
        and job.poll() is None
        and time.monotonic() < end
    ):
        time.sleep(0.002)
    assert job.poll() is None, "the run ended before it could be seen to write"
    assert (whole / "saved" / "checkpoint.h5").stat().st_mtime_ns != first
    _, err = job.communicate(timeout=60)
    assert job.returncode == 0, err
    same(whole / "run", whole / "saved")


def test_a_killed_run_goes_on_identically(whole):
    """SIGKILL after half of the rows; scripts/kill-test does it at 50 random moments."""
    (whole / "often.yaml").write_text(CASE.replace("100 s", "50 ms"))
    job = start(whole, "often.yaml", "--out", "killed")
    wait_for_rows(whole / "killed" / "history.csv", 50, job)
    job.kill()
    job.communicate()
    assert not (whole / "killed" / "summary.json").exists()
    finish(whole, "often.yaml", "--out", "killed", "--restart")
    same(whole / "run", whole / "killed")


def test_a_stopped_sweep_starts_no_further_member_and_goes_on_later(whole):
    """SIGTERM in the first of two members: that one is saved, the second has not begun; --restart does
    both."""
    values = ["case.yaml", "contact.stiffness=1e8,1.1e8", "--out", "sweep"]
    job = start(whole, *values, command="sweep")
    first, second = (whole / "sweep" / f"member-{k:03d}" for k in (1, 2))
    wait_for_rows(first / "history.csv", 10, job)
    job.send_signal(signal.SIGTERM)
    out, err = job.communicate(timeout=60)
    assert job.returncode == 1 and "stopped by SIGTERM" in out + err, out + err
    assert (
        json.loads((first / "summary.json").read_text())["interrupted"]
        and not (second / "history.csv").exists()
    )
    assert "2 of 2 members done" in finish(whole, *values, "--restart", command="sweep")
    same(whole / "run", first)  # 1e8 is the default


def test_a_full_disk_ends_the_run_in_order_and_it_can_go_on(whole):
    """No file may grow beyond a limit (half a row is taken there, as on a disk that is full), which the
    history meets in the middle of a row: a message, exit status 1, whole rows and frames; with free space again the
    run goes on to the same files."""
    (whole / "fine.yaml").write_text(
        CASE.replace("history_every: 0.01 s", "history_every: 0.5 ms").replace("100 s", "0.2 s")
    )
    finish(whole, "fine.yaml", "--out", "fine")
    limit = (whole / "fine" / "checkpoint.h5").stat().st_size + 4000
    assert (whole / "fine" / "history.csv").stat().st_size > 1.5 * limit
    job = start(whole, "fine.yaml", "--out", "full")
    wait_for_rows(whole / "full" / "history.csv", 1, job)
    resource.prlimit(job.pid, resource.RLIMIT_FSIZE, (limit, limit))
    _, err = job.communicate(timeout=120)
    assert (
        job.returncode == 1
        and "cannot write full/history.csv: No space left on device" in err
        and "--restart" in err
    ), err
    assert "Traceback" not in err
    text = (whole / "full" / "history.csv").read_text()
    assert text.endswith("\n") and limit - 300 < len(text) <= limit
    assert len(read_table(whole / "full" / "history.csv")["time [s]"]) == text.count("\n") - 1
    assert all(len(read_frame(file).points) > 2 for _, file in read_series(whole / "full"))
    assert "failed: cannot write" in json.loads((whole / "full" / "summary.json").read_text())["status"]
    finish(whole, "fine.yaml", "--out", "full", "--restart")
    same(whole / "fine", whole / "full")


@pytest.mark.parametrize("number", [getattr(signal, name) for name in ENDING])
def test_a_signal_reaches_the_run_once(number):
    """NOTHING before, STOP and the signal's name after; handlers are put back; a request to save is answered
    once."""

    class Alone:
        size, rank = 1, 0

    before = signal.getsignal(number)
    with RunControl(Alone()) as control:
        assert control.poll(False) == NOTHING and control.poll(False, overdue=True) == WRITE
        os.kill(os.getpid(), signal.SIGUSR1)
        assert control.poll(False, overdue=True) == SAVE and control.poll(False) == NOTHING
        os.kill(os.getpid(), number)
        assert control.poll(False) == STOP and control.name == signal.Signals(number).name
    assert signal.getsignal(number) == before
    with RunControl(Alone()) as control, pytest.raises(KeyboardInterrupt):
        os.kill(os.getpid(), signal.SIGINT)
        os.kill(os.getpid(), signal.SIGINT)


def test_a_command_within_a_program_puts_signals_back(tmp_path: Path) -> None:
    """A program that calls a command goes on afterwards: SIGTERM ends it as before, and does not raise KeyboardInterrupt."""
    (tmp_path / "case.yaml").write_text(CASE, encoding="utf-8")
    program = (
        "import signal, sys\n"
        "from drillpetsc.cli.parser import main\n"
        "names = [signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT, signal.SIGUSR1, signal.SIGINT, signal.SIGPIPE]\n"
        "before = [signal.getsignal(q) for q in names]\n"
        "assert main(['statics', 'case.yaml', '--out', 'still']) == 0\n"
        "assert [signal.getsignal(q) for q in names] == before\n"
        "sys.stdout.flush()\n"
        "signal.raise_signal(signal.SIGTERM)\n"
    )
    job = subprocess.run(
        [sys.executable, "-c", program], cwd=tmp_path, capture_output=True, text=True, timeout=120
    )
    assert job.returncode == -signal.SIGTERM, job.stderr


def test_a_run_whose_folder_is_moved_ends_and_says_where_its_rows_are(tmp_path: Path) -> None:
    """It went on in a new folder of the old name, without its rows, and ended with exit status 0."""
    (tmp_path / "case.yaml").write_text(CASE.replace("{end: 1 s}", "{end: 1000 s}"), encoding="utf-8")
    process = start(tmp_path, "case.yaml", "--out", "run")
    try:
        for _ in range(600):
            if (tmp_path / "run" / "string" / "000001.vtu").exists():
                break
            time.sleep(0.1)
        (tmp_path / "run").rename(tmp_path / "moved")
        _, said = process.communicate(timeout=120)
    finally:
        process.kill()
    assert process.returncode == 1 and f"was moved to {tmp_path / 'moved'}" in said, said
    assert not (tmp_path / "run").exists()
    assert len(read_table(tmp_path / "moved" / "history.csv")["time [s]"]) > 1
