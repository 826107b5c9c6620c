"""Bad PETSc options, -ts_max_steps, and pipes that are closed, as a user meets them."""

from __future__ import annotations

import json
import os
import re
from pathlib import Path

import pytest

from drillpetsc.cli import main
from drillpetsc.operations import OPERATIONS
from tests.helpers.command import drillpetsc, in_own_process, succeeds, unrendered
from tests.helpers.mpi import start_mpi

ROOT = Path(__file__).parents[2]
CASE = """
gravity: 0 m/s2
string: [{kind: pipe, length: 30 m, od: 127 mm, id: 108.6 mm, element_length: 10 m}]
top: {kind: top_drive, rotation: 60 rpm}
time: {end: 20 ms}
"""


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
    done = drillpetsc("run case.yaml --out bad", *option.split(), cwd=folder)
    assert done.returncode == 2, done.stderr
    assert len(done.stderr.splitlines()) == 1 and words in done.stderr and done.stdout == ""
    assert not (folder / "bad").exists()


STILL = """
title: a string that stands, with all that the commands below ask for
well:
  survey: {md: [0, 40], inclination: [0, 0], azimuth: [0, 0]}
  sections: [{kind: casing, to: 10, diameter: 0.3, friction: 0.2}, {kind: open_hole, to: 40, diameter: 0.25, friction: 0.3}]
string:
  - {kind: pipe, length: 39 m, od: 127 mm, id: 108.6 mm, eccentricity: 1 mm, element_length: 13 m}
  - {kind: bit, length: 1 m, od: 250 mm, mass: 90 kg, nozzle_area: 300 mm2}
top: {kind: top_drive, rotation: 60 rpm, lowering: 1 m/h, motor: {inertia: 2900 kg m2, max_torque: 60 kN m}, control: {kind: stiff}}
bottom: bit
formation: {drillability: 4e-8}
fluid: {density: 1100, flow_rate: 20 l/s, rheology: {model: newtonian, viscosity: 20 cP}}
roadmap: {bit_depth: {from: 35, to: 40, step: 5}, friction_factor: {cased: 0.2, open_hole: 0.3}}
initial: {wob: 1 kN}
time: {end: 1 ms}
uncertain: {fluid.density: {normal: [1100, 10]}}
"""
LOG = "Bit Depth [m], Operation, HKLD [kN]\n35, POOH, 9\n40, POOH, 11\n"
#: commands that take PETSc options and a case, with the words that they need; `study` is in test_study_cli
COMMANDS = {
    "check": "",
    "run": "--out OUT --progress silent",
    "sweep": "top.rotation=50,60 --out OUT --progress silent",
    "statics": "--out OUT",
    "sensitivities": "--to fluid.density --out OUT",
    "uncertain": "--samples 20 --out OUT",
    "limits": "--out OUT",
    "freepoint": "--stretch 1in --pull 10klb",
    "roadmap": "--out OUT",
    "roadmap --model stiff": "--out OUT",
    "follow": "--log log.csv --out OUT",
    "calibrate": "--measured log.csv --fit weight_factor --out OUT",
    "hydraulics": "--out OUT",
    "surge": "--speeds 10m/min --out OUT",
    "modes": "--count 2 --out OUT",
    "campbell": "--speeds 60,70rpm --count 2 --without-control --out OUT",
    "stability": "--speeds 60rpm --wob 1kN --count 2 --out OUT",
    "response": "--excite unbalance --speeds 60rpm --without-control --out OUT",
    "linearise": "--inputs top.rotation --outputs bit_speed --out OUT",
    "top-drive": "--out OUT",
    "fmu": "--out OUT.fmu",
}


@pytest.mark.parametrize("command", COMMANDS)
def test_a_misspelt_option_of_a_case_is_refused_in_every_command(command, folder, monkeypatch, capsys):
    """Options of runs, read or not, are accepted where nothing is integrated; others were taken without a word."""
    monkeypatch.chdir(folder)
    (folder / "log.csv").write_text(LOG)
    name, *more = command.split()
    for number, (option, hint) in enumerate(
        (("ts_rtoll", "did you mean -ts_rtol?"), ("q_snes_stoll", "-q_snes_stol?"), ("ts_rtol", ""))
    ):
        accepted = "" if hint or name in ("run", "sweep") else ", ts_adapt_safety: 0.8, snes_stol: 1e-4"
        (folder / "still.yaml").write_text(f"{STILL}petsc: {{{option}: 1e-3{accepted}}}\n")
        out = f"{'-'.join((name, *more))}-{number}"
        words = [name, "still.yaml", *more, *COMMANDS[command].replace("OUT", out).split()]
        with unrendered():
            status = main(words)
        assert status == (2 if hint else 0), capsys.readouterr().err
        assert hint in capsys.readouterr().err and bool(list(folder.glob(f"{out}*"))) == (
            not hint and name not in ("check", "freepoint")
        )


def test_a_misspelt_option_of_the_command_line_is_refused_without_a_run(folder):
    (folder / "still.yaml").write_text(STILL)
    done = drillpetsc("modes still.yaml --out modes -ts_rtoll 1e-3", cwd=folder)
    assert (
        done.returncode == 2 and "did you mean -ts_rtol?" in done.stderr and not (folder / "modes").exists()
    )


def test_every_command_with_petsc_options_is_in_the_table():
    takes = {operation.command() for operation in OPERATIONS if operation.petsc}
    assert takes == {command.split()[0] for command in COMMANDS} | {"study"}


def test_a_bad_option_on_two_ranks_is_refused_without_an_abort(folder):
    script = ROOT / "tests" / "parallel" / "run_case.py"
    job = start_mpi(2, script, [str(folder / "case.yaml"), str(folder / "bad"), "-q_pc_type", "x"])
    out, err = job.communicate(timeout=120)
    assert job.returncode == 2
    assert (out + err).count("drillpetsc: petsc option -q_pc_type") == 1
    assert "MPI_ABORT" not in out + err and "Traceback" not in out + err


def test_the_last_step_of_max_steps_can_be_continued(folder):
    """Five steps, a message with the time, exit status 1; without the option --restart comes to the end."""
    succeeds("run case.yaml --out whole", cwd=folder)
    done = drillpetsc("run case.yaml --out steps -ts_max_steps 5", cwd=folder)
    assert done.returncode == 1 and "5 steps of -ts_max_steps" in done.stderr
    summary = json.loads((folder / "steps" / "summary.json").read_text())
    assert summary["steps"] == 5 and 0 < summary["time"] < 0.02
    succeeds("run case.yaml --out steps --restart", cwd=folder)
    one, other = (folder / name / "history.csv" for name in ("whole", "steps"))
    assert one.read_bytes() == other.read_bytes()


def test_the_help_offers_what_is_accepted(folder):
    """Every integrator of the help is accepted; commands that take no PETSc options do not mention them."""
    text = drillpetsc("run --help", cwd=folder).stdout
    offered = re.search(r"-ts_type ([\w, ]+) integrate", text)
    assert offered
    for kind in offered[1].split(", "):
        succeeds("run case.yaml --out", kind, "-ts_type", kind, cwd=folder)
    for command in ("view", "plot", "schema"):
        assert "PETSc" not in drillpetsc(command, "--help", cwd=folder).stdout


@pytest.mark.parametrize("words", ["--help", "check case.yaml", "schema", "run --help"])
def test_a_closed_pipe_ends_quietly(words, folder):
    read, write = os.pipe()
    os.close(read)  # as `head` does once it has its line
    done = in_own_process(*words.split(), cwd=folder, stdout=write)
    os.close(write)
    assert done.stderr == "" and done.returncode == 0


def test_options_from_outside_the_command_line_are_shown(folder: Path, monkeypatch) -> None:
    monkeypatch.setenv("PETSC_OPTIONS", "-ts_rtol 2e-3")
    (folder / ".petscrc").write_text("-q_snes_max_it 24\n")
    try:
        done = in_own_process("run case.yaml --out outside --progress silent -ts_dt 1e-3", cwd=folder)
    finally:
        (folder / ".petscrc").unlink()
    notes = [line for line in done.stderr.splitlines() if line.startswith("note: PETSc options")]
    assert done.returncode == 0 and len(notes) == 1, done.stderr
    assert "-ts_rtol 2e-3" in notes[0] and "-q_snes_max_it 24" in notes[0] and "-ts_dt" not in notes[0]
    used = json.loads((folder / "outside" / "summary.json").read_text())["petsc_options"]
    assert used["ts_rtol"] == "2e-3" and used["q_snes_max_it"] == "24"


def test_a_missing_file_of_options_is_refused_once(folder: Path) -> None:
    """PETSc ended with a stack, and each rank with a traceback."""
    line = ["run", str(folder / "case.yaml"), "--out", str(folder / "missing"), "-options_file", "nowhere"]
    script = Path(__file__).parents[1] / "parallel" / "run_command.py"
    assert in_own_process(" ".join(line), cwd=folder).returncode == 2
    job = start_mpi(2, script, line)
    said = "".join(job.communicate(timeout=60))
    assert job.returncode == 2 and said.count("drillpetsc: -options_file") == 1, said
    assert "nowhere" in said and "Traceback" not in said
