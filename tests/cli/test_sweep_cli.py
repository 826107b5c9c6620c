"""`drillpetsc sweep` and `drillpetsc run` with several files, as a user types them."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from drillpetsc.output import read_table
from tests.helpers.command import drillpetsc, in_own_process, succeeds

CASE = """
title: small
well:
  survey: {md: [0 m, 60 m], inclination: [60 deg, 60 deg], azimuth: [0 deg, 0 deg]}
  sections: [{to: 60 m, kind: casing, diameter: 215.9 mm, friction: 0.2}]
string:
  - {kind: pipe, length: 30 m, element_length: 10 m, od: 127 mm, id: 108.6 mm}
  - {kind: pipe, length: 20 m, element_length: 10 m, od: 171.5 mm, id: 71.4 mm}
top: {kind: top_drive, rotation: 60 rpm}
time: {end: 0.05 s}
output: {history_every: 0.01 s, field_every: 0.05 s, checkpoint_every: 0.02 s}
petsc: {ts_rtol: 1e-3}
"""
WORDS = ("top.rotation=60 rpm,90 rpm", "well.sections[0].friction=0.2,0.3")
# Newton's method may not do more than one iteration, and must converge to rounding
HOPELESS = "{q_snes_max_it: 1, q_snes_stol: 1e-15}"


@pytest.fixture(scope="module")
def swept(tmp_path_factory) -> Path:
    """A folder with a 2 x 2 sweep, in sweep/."""
    folder = tmp_path_factory.mktemp("sweep")
    (folder / "small.yaml").write_text(CASE)
    done = succeeds("sweep small.yaml", *WORDS, "--out", "sweep", cwd=folder)
    assert "4 of 4 members done" in done.stdout and "sweep/sweep.csv" in done.stdout
    lines = [line for line in done.stderr.splitlines() if line.startswith("[")]
    assert len(lines) == 4 and lines[3].startswith(
        "[4/4] top.rotation=90 rpm, well.sections[0].friction=0.3: done"
    )
    return folder


def test_values_in_another_unit_are_doubted(tmp_path: Path):
    """Bare numbers of rpm are read as rad/s: said of each value, and once."""
    (tmp_path / "small.yaml").write_text(CASE)
    words = "top.rotation=60,80", "well.sections[0].friction=0.2,0.3"
    done = drillpetsc("sweep small.yaml", *words, "--out", "sweep", cwd=tmp_path)
    said = [line for line in done.stderr.splitlines() if line.startswith("WARNING")]
    assert len(said) == 2 and all(
        f"were {n} rpm meant?" in line for n, line in zip((60, 80), said, strict=True)
    )


def test_one_row_a_member_and_each_has_a_run_folder(swept):
    table = read_table(swept / "sweep" / "sweep.csv")
    assert table["member"].tolist() == [1, 2, 3, 4] and table["status"].tolist() == ["done"] * 4
    assert table["top.rotation"].tolist() == ["60 rpm", "60 rpm", "90 rpm", "90 rpm"]
    assert table["top.rotation (SI)"] == pytest.approx(2 * np.pi * np.array([1, 1, 1.5, 1.5]))
    assert table["well.sections[0].friction"].tolist() == [0.2, 0.3, 0.2, 0.3]
    for name in table["folder"]:
        for file in (
            "history.csv",
            "trajectory.csv",
            "string.pvd",
            "well.vtu",
            "summary.json",
            "checkpoint.h5",
            "case.yaml",
        ):
            assert (swept / "sweep" / name / file).exists(), file
    assert not list((swept / "sweep").glob(".*"))
    reported = json.loads((swept / "sweep" / "summary.json").read_text())
    assert (reported["status"], reported["done"], reported["failed"], reported["ranks"]) == ("done", 4, 0, 1)


def test_figures_are_those_of_the_histories(swept):
    """Final row; mean of the rows from the middle of the time on (0.03 s, 0.04 s, 0.05 s)."""
    table = read_table(swept / "sweep" / "sweep.csv")
    for i, name in enumerate(table["folder"]):
        history = read_table(swept / "sweep" / name / "history.csv")
        for title in ("hook_load [N]", "surface_torque [N m]", "bit_speed [rad/s]"):
            assert table[title][i] == pytest.approx(history[title][-1], rel=1e-12)
            assert table[f"mean_{title}"][i] == pytest.approx(history[title][3:].mean(), rel=1e-12)
        assert table["time [s]"][i] == 0.05
    torque = table["surface_torque [N m]"]
    assert (
        torque[1] > 1.3 * torque[0] and torque[3] > 1.3 * torque[2]
    )  # Coulomb: nearly in proportion to the friction


def test_a_member_is_the_run_of_its_case(swept):
    """The last member against `drillpetsc run` of a file with its values: the same history to the last
    digit."""
    (swept / "alone.yaml").write_text(
        CASE.replace("60 rpm", "90 rpm").replace("friction: 0.2", "friction: 0.3")
    )
    succeeds("run alone.yaml --out alone", cwd=swept)
    alone, member = (read_table(swept / name / "history.csv") for name in ("alone", "sweep/member-004"))
    assert all(np.array_equal(alone[title], member[title]) for title in alone)


def test_a_failing_member_is_told_and_does_not_stop_the_others(swept):
    options = f"petsc={{ts_rtol: 1e-3}},{HOPELESS}"
    done = drillpetsc(
        "sweep small.yaml", options, "top.rotation=60 rpm,90 rpm", "--out", "failing", cwd=swept
    )
    assert done.returncode == 1 and "Traceback" not in done.stderr
    assert "2 of 4 members done" in done.stdout and "member 3 failed: Newton's method failed" in done.stdout
    table = read_table(swept / "failing" / "sweep.csv")
    assert table["status"].tolist() == ["done"] * 2 + ["failed"] * 2
    assert all("Newton" in message for message in table["message"][2:])
    # the options of one member are gone when the next one runs
    for i, name in enumerate(("sweep/member-001", "sweep/member-003")):
        whole, after = (
            read_table(swept / name / "history.csv"),
            read_table(swept / f"failing/member-00{i + 1}" / "history.csv"),
        )
        assert np.array_equal(whole["hook_load [N]"], after["hook_load [N]"])


def test_a_second_job_in_the_folder_is_refused(swept):
    """Another process, which holds the folder as long as it lives, as a job does."""
    code = "import sys; from pathlib import Path; from drillpetsc.output.files import lock; lock.take(Path('sweep'))"
    code += "; print('held', flush=True); sys.stdin.read()"
    with subprocess.Popen(
        [sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, cwd=swept
    ) as other:
        assert other.stdout is not None and other.stdout.readline() == "held\n"
        for way in ("--restart", "--overwrite"):
            done = drillpetsc("sweep small.yaml", *WORDS, "--out", "sweep", way, cwd=swept)
            assert done.returncode == 2 and f"in use by process {other.pid}" in done.stderr
        other.communicate("")


def test_restart_runs_what_is_missing_and_continues_what_was_stopped(swept):
    """A member deleted, and one that was killed after its checkpoint at 0.04 s: the table ends as that of the
    whole sweep."""
    shutil.copytree(swept / "sweep", swept / "again")
    shutil.rmtree(swept / "again" / "member-002")
    (swept / "again" / "member-003" / "summary.json").unlink()
    untouched = (swept / "again" / "member-001" / "history.csv").stat().st_mtime_ns
    assert drillpetsc("sweep small.yaml", *WORDS, "--out", "again", cwd=swept).returncode == 2  # as with run
    done = succeeds("sweep small.yaml", *WORDS, "--out", "again", "--restart", cwd=swept)
    assert len([line for line in done.stderr.splitlines() if line.startswith("[")]) == 2  # two members ran
    assert (swept / "again" / "member-001" / "history.csv").stat().st_mtime_ns == untouched
    whole, again = read_table(swept / "sweep" / "sweep.csv"), read_table(swept / "again" / "sweep.csv")
    assert again["status"].tolist() == ["done"] * 4 and again["ranks"].tolist() == [0, 1, 1, 0]
    for title in ("hook_load [N]", "mean_surface_torque [N m]", "energy_error_share [-]"):
        assert again[title] == pytest.approx(whole[title], rel=1e-9), title


def test_a_petsc_option_does_not_swallow_a_key(swept):
    """-ts_monitor takes a value or none; KEY=... after it is not one."""
    answer = in_own_process(  # PETSc prints past Python
        "sweep small.yaml -ts_monitor 'top.rotation=60 rpm' --out monitored", cwd=swept
    )
    assert answer.returncode == 0 and "TS dt" in answer.stdout and "1 of 1 members done" in answer.stdout


def test_several_wells_at_once(swept):
    (swept / "other").mkdir()
    (swept / "other" / "small.yaml").write_text(CASE.replace("30 m", "25 m"))
    done = drillpetsc("run small.yaml other/small.yaml", cwd=swept)
    assert done.returncode == 0 and "2 of 2 members done" in done.stdout
    assert sorted(p.name for p in (swept / "results").iterdir()) == ["small-001", "small-2-001"]
    depths = [
        read_table(swept / "results" / name / "history.csv")["bit_depth [m]"][0]
        for name in ("small-001", "small-2-001")
    ]
    assert depths == pytest.approx([50, 45], abs=0.01)
    done = drillpetsc("run small.yaml other/small.yaml --out pad", cwd=swept)
    assert done.returncode == 0 and read_table(swept / "pad" / "wells.csv")["folder"].tolist() == [
        "small",
        "small-2",
    ]
    nothing = drillpetsc("run small.yaml other/small.yaml --out pad --restart", cwd=swept)
    assert nothing.returncode == 0 and "[" not in nothing.stderr  # all are done
    assert (
        drillpetsc("run small.yaml nowhere.yaml --out pad2", cwd=swept).returncode == 2
        and not (swept / "pad2").exists()
    )


def test_python_gives_the_same_table(swept):
    import drillpetsc as package

    result = package.sweep(
        swept / "small.yaml", {"top.rotation": ["60 rpm", 3 * np.pi]}, swept / "python", progress="silent"
    )
    whole = read_table(swept / "sweep" / "sweep.csv")
    assert result.failed == 0 and result.table == swept / "python" / "sweep.csv"
    assert [row["hook_load [N]"] for row in result.rows] == pytest.approx(
        whole["hook_load [N]"][[0, 2]], rel=1e-9
    )
