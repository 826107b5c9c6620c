"""Checkpoints on several ranks, signals to one of them, and errors on one of them."""

from __future__ import annotations

import json
import os
import shutil
import signal
import time
from pathlib import Path

import numpy as np
import pytest

from drillpetsc.output import read_table
from tests.helpers.mpi import ROOT, run_mpi, start_mpi
from tests.helpers.ranks import run_here
from tests.helpers.restarts import files
from tests.parallel.test_restart import CASE

RUN = ROOT / "tests" / "parallel" / "run_case.py"
LONG = CASE.replace("time: {end: 0.1 s}", "time: {end: 0.3 s}").replace(
    "checkpoint_every: 3 ms", "checkpoint_every: 50 ms"
)


def children(number: int) -> list[int]:
    """Processes that a process has started."""
    return [int(word) for word in Path(f"/proc/{number}/task/{number}/children").read_text().split()]


def rank_processes(job) -> list[int]:
    """The ranks of a job: the Python processes under the launcher."""
    found, open_ = [], [job.pid]
    while open_:
        for child in children(open_.pop()):
            open_.append(child)
            if b"run_case.py" in Path(f"/proc/{child}/cmdline").read_bytes():
                found.append(child)
    return found


def wait_for_rows(file: Path, rows: int, job) -> None:
    end = time.monotonic() + 100
    while time.monotonic() < end and job.poll() is None:
        if file.exists() and file.read_text().count("\n") > rows:
            return
        time.sleep(0.005)
    raise AssertionError(f"no {rows} rows in {file}: {job.communicate()}")


@pytest.fixture(scope="module")
def whole(tmp_path_factory) -> Path:
    """The run on two ranks that nothing stops."""
    folder = tmp_path_factory.mktemp("whole")
    (folder / "case.yaml").write_text(LONG)
    run_mpi(2, RUN, [str(folder / "case.yaml"), str(folder / "run")], timeout=200)
    return folder / "run"


@pytest.mark.parallel
def test_a_signal_to_one_of_two_ranks_stops_both_and_the_restart_is_identical(whole, tmp_path):
    """SIGTERM to the second rank alone: both stop at the same step, with a checkpoint; restarted on 2 ranks, every
    file is identical."""
    (tmp_path / "case.yaml").write_text(LONG)
    job = start_mpi(2, RUN, [str(tmp_path / "case.yaml"), str(tmp_path / "stopped")])
    wait_for_rows(tmp_path / "stopped" / "history.csv", 10, job)
    ranks = rank_processes(job)
    assert len(ranks) == 2
    os.kill(ranks[1], signal.SIGTERM)
    _, err = job.communicate(timeout=60)
    assert job.returncode == 1 and err.count("stopped by SIGTERM") == 1, err
    assert json.loads((tmp_path / "stopped" / "summary.json").read_text())["interrupted"]
    run_mpi(2, RUN, [str(tmp_path / "case.yaml"), str(tmp_path / "stopped"), "--restart"], timeout=200)
    expected = files(whole)
    for name, content in files(tmp_path / "stopped").items():
        assert content == expected[name], name


@pytest.mark.parallel
def test_a_restart_on_another_number_of_ranks_gives_the_same(tmp_path):
    """From a checkpoint of 1 rank on 1 and on 2 ranks, Newton to 1e-12: all columns equal to 3e-8 of their
    size over the following 0.1 s.

    Adaptive steps differ by 7e-8 with the order of summation: their local error is a difference of nearly equal
    numbers. The kinetic energy follows them to 1.1e-8. The energy error is a small difference of large numbers; step
    and Newton count are not results.
    """
    text = (
        (ROOT / "cases" / "lying-string.yaml")
        .read_text()
        .replace("history_every: 0.05 s", "history_every: 5 ms")
    )
    for name, end in (("half", "0.1 s"), ("case", "0.2 s")):
        (tmp_path / f"{name}.yaml").write_text(text.replace("time: {end: 1 s}", f"time: {{end: {end}}}"))
    exact = ["-q_snes_stol", "1e-12"]
    run_here(tmp_path / "half.yaml", tmp_path / "ranks1", exact)
    shutil.copytree(tmp_path / "ranks1", tmp_path / "ranks2")
    run_here(tmp_path / "case.yaml", tmp_path / "ranks1", ["--restart", *exact])
    words = [str(tmp_path / "case.yaml"), str(tmp_path / "ranks2"), "--restart", *exact]
    run_mpi(2, RUN, words, timeout=200)
    one, two = (read_table(tmp_path / f"ranks{n}" / "history.csv") for n in (1, 2))
    assert one["time [s]"][-1] == 0.2
    for column, values in one.items():
        if column.startswith(("energy_error", "newton", "step")):
            continue
        assert np.abs(two[column] - values).max() <= 3e-8 * np.abs(values).max(), column


@pytest.mark.parallel
@pytest.mark.parametrize(
    "kind, words",
    [
        ("nan", ("component contact", "element 4", "Newton")),
        ("exception", ("ZeroDivisionError", "in component contact, element", "rank 1")),
        ("error", ("rank 1: spoiled on purpose", "component contact")),
    ],
)
def test_an_error_on_one_rank_ends_the_job_with_a_message(kind, words, tmp_path):
    """A nan, an exception, or an error of one rank alone: within 10 s the job ends with a status and the
    place."""
    (tmp_path / "case.yaml").write_text(LONG)
    clock = tmp_path / "clock"
    arguments = [kind, str(tmp_path / "case.yaml"), str(tmp_path / "run"), str(clock)]
    job = start_mpi(2, ROOT / "tests" / "parallel" / "fail_case.py", arguments)
    _, err = job.communicate(timeout=100)
    took = time.time() - float(clock.read_text())
    assert job.returncode not in (0, None)
    for word in words:
        assert word in err, err
    assert took < 10.0, f"{took:.1f} s"
    read_table(tmp_path / "run" / "history.csv")  # the output is readable
