"""`scripts/cluster-job`: a batch job for Slurm, with stand-ins for srun and scontrol in the path."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from drillpetsc.output import read_table
from tests.cli.test_interrupt import CASE, finish, same, wait_for_rows
from tests.helpers.mpi import ROOT, have_mpi

JOB = ROOT / "scripts" / "cluster-job"

#: srun with one rank is the command itself; with more it is mpirun, by the helper that the other tests use
SRUN = """#!/usr/bin/env python3
import os, sys
sys.path.insert(0, {root!r})
count, words = int(sys.argv[1].removeprefix("--ntasks=")), sys.argv[2:]
if count == 1:
    os.execv(words[0], words)
from tests.helpers.mpi import start_mpi
job = start_mpi(count, {module!r}, words[1:])
out, err = job.communicate(timeout=300)
print(out, err)
sys.exit(job.returncode)
"""


@pytest.fixture
def cluster(tmp_path):
    """A checkout whose scripts/drillpetsc is this Python's program, and a path with srun and scontrol."""
    for folder in ("bin", "scripts"):
        (tmp_path / folder).mkdir()
    module = tmp_path / "program.py"
    module.write_text("import sys\nfrom drillpetsc.cli import main\nsys.exit(main())\n")
    files = {
        "scripts/drillpetsc": f'#!/bin/sh\nexec "{sys.executable}" "{module}" "$@"\n',
        "bin/srun": SRUN.format(root=str(ROOT), module=str(module)).replace(
            "/usr/bin/env python3", sys.executable
        ),
        "bin/scontrol": f'#!/bin/sh\necho "$@" >> "{tmp_path}/queue"\n',
    }
    for name, text in files.items():
        (tmp_path / name).write_text(text)
        (tmp_path / name).chmod(0o755)
    (tmp_path / "case.yaml").write_text(CASE.replace("end: 1 s", "end: 0.2 s"))
    (tmp_path / "long.yaml").write_text(CASE)

    def submit(*words: str, **environment: str) -> subprocess.Popen:
        paths = os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])
        slurm = {"SLURM_JOB_ID": "17", "SLURM_SUBMIT_DIR": str(tmp_path), "PYTHONPATH": paths}
        path = {"PATH": f"{tmp_path}/bin{os.pathsep}{os.environ['PATH']}"}
        every = {k: v for k, v in os.environ.items() if k != "DRILLPETSC_ROOT"} | path | slurm | environment
        return subprocess.Popen(
            [str(JOB), *words],
            cwd=tmp_path,
            env=every,
            text=True,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
        )

    return tmp_path, submit


@pytest.mark.skipif(not have_mpi(), reason="no mpirun")
def test_members_on_two_ranks(cluster):
    """A sweep of two members on two tasks: each has its own rank, both are done."""
    folder, submit = cluster
    values = [str(folder / "case.yaml"), "contact.stiffness=1e8,1.1e8", "--out", str(folder / "s")]
    out, err = (job := submit("sweep", *values, SLURM_NTASKS="2")).communicate(timeout=300)
    assert job.returncode == 0 and "2 of 2 members done" in out, out + err
    assert read_table(folder / "s" / "sweep.csv")["ranks"].tolist() == [1, 1]
    assert not (folder / "queue").exists()


def test_time_limit(cluster):
    """SIGTERM to the batch shell, as --signal=B:TERM sends it: a checkpoint, the job queued again; its second start goes on, and
    every file is that of a run without a limit."""
    folder, submit = cluster
    job = submit("run", "long.yaml", "--out", "r", "--progress", "silent")
    wait_for_rows(folder / "r" / "history.csv", 15, job)
    job.send_signal(signal.SIGTERM)
    out, err = job.communicate(timeout=60)
    assert job.returncode == 1 and "queued again" in out, out + err
    assert (folder / "queue").read_text() == "requeue 17\n"
    assert json.loads((folder / "r" / "summary.json").read_text())["interrupted"]
    words = ("run", "long.yaml", "--out", "r", "--progress", "silent")
    out, err = (job := submit(*words, SLURM_RESTART_COUNT="1")).communicate(timeout=60)
    assert job.returncode == 0, out + err
    finish(folder, "long.yaml", "--out", "whole")
    same(folder / "whole", folder / "r")


def test_a_start_that_failed_is_begun_again(cluster):
    """A folder without a checkpoint: begun again by a job that was queued again, refused for a new one."""
    folder, submit = cluster
    (folder / "r").mkdir()
    (folder / "r" / "case.yaml").write_text("left by a node that failed")
    words = ("run", "case.yaml", "--out", "r", "--progress", "silent")
    out, err = (job := submit(*words)).communicate(timeout=60)
    assert job.returncode == 2 and "r" in err, out + err
    out, err = (job := submit(*words, SLURM_RESTART_COUNT="1")).communicate(timeout=60)
    assert job.returncode == 0, out + err
    assert json.loads((folder / "r" / "summary.json").read_text())["time"] == pytest.approx(0.2)


@pytest.mark.parametrize(
    ("words", "environment", "message"),
    [
        (
            ["run", "case.yaml", "--out", "r"],
            {"SLURM_JOB_ID": ""},
            "sbatch scripts/cluster-job run case.yaml --out r",
        ),
        (["run", "case.yaml"], {}, "--out FOLDER is needed"),
        (["statics", "case.yaml", "--out", "r"], {}, "run or sweep, got 'statics'"),
        (["run", "case.yaml", "--out=r", "--restart"], {}, "leave out --restart"),
        (["run", "case.yaml", "--out", "r"], {"SLURM_SUBMIT_DIR": "/"}, "from the folder of the checkout"),
    ],
)
def test_wrong_use(cluster, words, environment, message):
    """One line that says what to do, exit status 2, nothing started."""
    folder, submit = cluster
    began = time.monotonic()
    out, err = (job := submit(*words, **environment)).communicate(timeout=60)
    assert job.returncode == 2 and message in err, out + err
    assert not (folder / "r").exists() and time.monotonic() - began < 30


def test_template_is_valid_for_sbatch():
    """The options stand before the first command, as Slurm reads them; the shell accepts the file."""
    lines = Path(JOB).read_text().splitlines()
    options = [i for i, line in enumerate(lines) if line.startswith("#SBATCH ")]
    first = next(i for i, line in enumerate(lines) if line and not line.startswith("#"))
    assert len(options) == 8 and max(options) < first
    assert subprocess.run(["bash", "-n", str(JOB)]).returncode == 0
