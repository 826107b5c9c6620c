"""Bad PETSc options, -ts_max_steps, and pipes that are closed, as a user meets them."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.helpers.mpi import start_mpi

ROOT = Path(__file__).parents[2]
CASE = """
gravity: 0 m/s2
string: [{kind: pipe, length: 30 m, od: 127 mm, id: 108.6 mm, element_length: 10 m}]
top: {kind: top_drive, rotation: 60 rpm}
time: {end: 20 ms}
"""


def drillpetsc(*words: str, cwd: Path) -> subprocess.CompletedProcess:
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "OMP_NUM_THREADS": "1"}
    line = [sys.executable, "-m", "drillpetsc", *words]
    return subprocess.run(line, cwd=cwd, env=environment, capture_output=True, text=True, timeout=120)


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    made = tmp_path_factory.mktemp("options")
    (made / "case.yaml").write_text(CASE)
    return made


BAD = [
    ("-ts_rtol 0", "above 0"),
    ("-ts_rtol -1e-3", "above 0"),
    ("-ts_rtol nan", "above 0"),
    ("-ts_rtol much", "above 0"),
    ("-ts_type nonsense", "bdf | alpha2"),
    ("-ts_type rosw", "hook load"),
    ("-snes_type x", "SNES type"),
    ("-q_snes_type x", "SNES type"),
    ("-q_ksp_type x", "KSP type"),
    ("-q_pc_type x", "PC type"),
    ("-mat_type x", "Mat type"),
    ("-q_snes_linesearch_type x", "bt"),
    ("-ts_adapt_type x", "basic"),
    ("-ts_adapt_clip 5", "-ts_adapt_clip"),
    ("-ts_max_steps 0", "at least 1"),
    ("-ts_dt 0", "above 0"),
    ("-ts_bdf_order 9", "at most 6"),
    ("-ts_max_time 1", "time.end"),
    ("-ts_atol 1", "-ts_rtol"),
]


@pytest.mark.parametrize("option, words", BAD)
def test_a_bad_option_is_refused_in_one_line(option, words, folder):
    done = drillpetsc("run", "case.yaml", "--out", "bad", *option.split(), cwd=folder)
    assert done.returncode == 2, done.stderr
    assert len(done.stderr.splitlines()) == 1 and words in done.stderr and done.stdout == ""
    assert not (folder / "bad").exists()


@pytest.mark.parametrize("command", ["statics", "limits"])
def test_a_misspelt_option_is_refused_without_a_run(command, folder):
    """Options of runs, read or not, are accepted where nothing is integrated; others were taken without a word."""
    well = "well: {survey: {md: [0, 40], inclination: [0, 0], azimuth: [0, 0]}, sections: [{kind: open_hole, diameter: 0.3}]}"
    (folder / "still.yaml").write_text(CASE.replace("0 m/s2", "9.81 m/s2") + well)
    for option, words in (("-ts_rtoll", "did you mean -ts_rtol?"), ("-q_snes_stoll", "-q_snes_stol?")):
        done = drillpetsc(command, "still.yaml", "--out", command, option, "1e-3", cwd=folder)
        assert done.returncode == 2 and words in done.stderr and not (folder / command).exists()
    accepted = ("-ts_rtol", "1e-3", "-ts_adapt_safety", "0.8", "-snes_stol", "1e-4")
    assert drillpetsc(command, "still.yaml", "--out", command, *accepted, cwd=folder).returncode == 0


def test_a_bad_option_on_two_ranks_is_refused_without_an_abort(folder):
    script = ROOT / "tests" / "parallel" / "run_case.py"
    job = start_mpi(2, script, [str(folder / "case.yaml"), str(folder / "bad"), "-q_pc_type", "x"])
    out, err = job.communicate(timeout=120)
    assert job.returncode == 2
    assert (out + err).count("drillpetsc: petsc option -q_pc_type") == 1
    assert "MPI_ABORT" not in out + err and "Traceback" not in out + err


def test_the_last_step_of_max_steps_can_be_continued(folder):
    """Five steps, a message with the time, exit status 1; without the option --restart comes to the end."""
    whole = drillpetsc("run", "case.yaml", "--out", "whole", cwd=folder)
    assert whole.returncode == 0, whole.stderr
    done = drillpetsc("run", "case.yaml", "--out", "steps", "-ts_max_steps", "5", cwd=folder)
    assert done.returncode == 1 and "5 steps of -ts_max_steps" in done.stderr
    summary = json.loads((folder / "steps" / "summary.json").read_text())
    assert summary["steps"] == 5 and 0 < summary["time"] < 0.02
    again = drillpetsc("run", "case.yaml", "--out", "steps", "--restart", cwd=folder)
    assert again.returncode == 0, again.stderr
    one, other = (folder / name / "history.csv" for name in ("whole", "steps"))
    assert one.read_bytes() == other.read_bytes()


def test_the_help_offers_what_is_accepted(folder):
    """Every integrator of the help is accepted; commands that take no PETSc options do not mention them."""
    text = drillpetsc("run", "--help", cwd=folder).stdout
    offered = re.search(r"-ts_type ([\w, ]+) integrate", text)
    assert offered
    for kind in offered[1].split(", "):
        done = drillpetsc("run", "case.yaml", "--out", kind, "-ts_type", kind, cwd=folder)
        assert done.returncode == 0, done.stderr
    for command in ("view", "plot", "schema"):
        assert "PETSc" not in drillpetsc(command, "--help", cwd=folder).stdout


@pytest.mark.parametrize("words", ["--help", "check case.yaml", "schema", "run --help"])
def test_a_closed_pipe_ends_quietly(words, folder):
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    read, write = os.pipe()
    os.close(read)  # as `head` does once it has its line
    line = [sys.executable, "-m", "drillpetsc", *words.split()]
    done = subprocess.run(line, cwd=folder, env=environment, stdout=write, stderr=subprocess.PIPE, text=True)
    os.close(write)
    assert done.stderr == "" and done.returncode == 0
