"""A sweep with a PETSc option that none of its cases reads is refused before anything is written or run."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from petsc4py import PETSc

from drillpetsc.case import Case
from drillpetsc.errors import CaseError
from drillpetsc.solvers import petsc_options as options
from drillpetsc.studies.sweep import sweep as sweep_module
from drillpetsc.studies.sweep.sweep import run_cases, sweep

CASE = """
well:
  survey: {md: [0 m, 60 m], inclination: [60 deg, 60 deg], azimuth: [0 deg, 0 deg]}
  sections: [{to: 60 m, kind: casing, diameter: 215.9 mm, friction: 0.2}]
string: [{kind: pipe, length: 50 m, od: 127 mm, id: 108.6 mm, element_length: 25 m}]
top: {kind: top_drive, rotation: 60 rpm}
initial: {from: rest}
time: {end: 1 ms}
"""
SPEEDS = {"top.rotation": ["50 rpm", "60 rpm"]}


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "small.yaml"
    path.write_text(CASE)
    return path


@pytest.fixture
def on_the_command_line() -> Iterator[list[str]]:
    """Names of options that are removed after the test."""
    names: list[str] = []
    yield names
    for name in names:
        PETSc.Options().delValue(name)


def test_a_misspelt_option_of_the_command_line(
    file: Path, tmp_path: Path, on_the_command_line: list[str]
) -> None:
    on_the_command_line.append("ts_rtoll")
    PETSc.Options()["ts_rtoll"] = 1e-3
    with pytest.raises(CaseError) as caught:
        sweep(file, SPEEDS, tmp_path / "out", progress="silent")
    assert caught.value.at == "petsc option -ts_rtoll" and "did you mean -ts_rtol?" in caught.value.hint
    assert "one of the cases" in caught.value.want and caught.value.exit_status == 2
    assert not (tmp_path / "out").exists()


def test_a_misspelt_option_of_one_case(file: Path, tmp_path: Path) -> None:
    other = tmp_path / "other.yaml"
    other.write_text(CASE + "petsc: {ts_typ: bdf}\n")
    with pytest.raises(CaseError, match="-ts_typ"):
        run_cases([file, other], tmp_path / "out", progress="silent")
    assert not (tmp_path / "out").exists()


def test_the_misspelt_one_of_two_is_named(file: Path, tmp_path: Path) -> None:
    file.write_text(CASE + "petsc: {ts_rtol: 1.0e-3, q_snes_stoll: 1.0e-8, ts_monitor_nothing: 1}\n")
    with pytest.raises(CaseError, match="-q_snes_stoll"):
        sweep(file, SPEEDS, tmp_path / "out", progress="silent")


def test_an_option_that_one_case_reads_and_another_does_not(
    file: Path, tmp_path: Path, on_the_command_line: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """BDF does not read the type of ARKIMEX; the members with BDF run nevertheless."""
    on_the_command_line.append("ts_arkimex_type")
    PETSc.Options()["ts_arkimex_type"] = "3"
    ran: list[str] = []

    def run(case: Case, *arguments: object, **more: object) -> None:
        options.refuse_unread(["ts_arkimex_type"])  # as a run does
        ran.append(str(case.petsc["ts_type"]))

    monkeypatch.setattr(sweep_module, "run", run)
    file.write_text(CASE + "petsc: {ts_type: bdf}\n")
    result = sweep(file, {"petsc.ts_type": ["bdf", "arkimex"]}, tmp_path / "out", progress="silent")
    assert [row["status"] for row in result.rows] == ["done", "done"] and sorted(ran) == ["arkimex", "bdf"]


def test_members_run_with_the_options_that_they_read(
    file: Path, tmp_path: Path, on_the_command_line: list[str]
) -> None:
    on_the_command_line.append("ts_rtol")
    PETSc.Options()["ts_rtol"] = 1e-3
    result = sweep(file, SPEEDS, tmp_path / "out", progress="silent")
    assert [row["status"] for row in result.rows] == ["done", "done"]
    assert not (tmp_path / "out" / ".lock").exists()
