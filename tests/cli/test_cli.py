"""The commands as a user types them: results, refusals, restart."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from drillpetsc import cli
from drillpetsc.operations import OPERATIONS
from drillpetsc.output import read_frame, read_series, read_table
from tests.helpers.command import drillpetsc, in_own_process, succeeds

CASE = """
title: small
well:
  survey: {md: [0 m, 60 m], inclination: [60 deg, 60 deg], azimuth: [0 deg, 0 deg]}
  sections: [{to: 60 m, kind: casing, diameter: 215.9 mm, friction: 0.2}]
string:
  - {kind: pipe, length: 30 m, od: 127 mm, id: 108.6 mm}
  - {kind: pipe, length: 20 m, od: 171.5 mm, id: 71.4 mm}
top: {kind: top_drive, rotation: {ramp: 0.1 s, value: 60 rpm}}
time: {end: 0.2 s}
output: {history_every: 0.02 s, field_every: 0.1 s, probes: [25 m], checkpoint_every: 0.1 s}
"""


@pytest.fixture(scope="module")
def finished(tmp_path_factory) -> Path:
    """A folder with a case that was run once, into run/."""
    folder = tmp_path_factory.mktemp("cli")
    (folder / "small.yaml").write_text(CASE)
    done = in_own_process("run small.yaml --out run -ts_rtol 1e-3", cwd=folder)
    assert done.returncode == 0, done.stderr
    assert (
        "real-time factor" in done.stdout and "energy error" in done.stdout and "results: run" in done.stdout
    )
    return folder


def test_run_folder_holds_the_contract(finished):
    run = finished / "run"
    for name in (
        "history.csv",
        "probes.csv",
        "trajectory.csv",
        "string.pvd",
        "well.vtu",
        "summary.json",
        "checkpoint.h5",
        "case.yaml",
    ):
        assert (run / name).exists(), name
    history = read_table(run / "history.csv")
    assert np.allclose(history["time [s]"], np.arange(11) * 0.02)
    assert history["bit_speed [rad/s]"][-1] > 0
    probes = read_table(run / "probes.csv")
    assert set(probes) == {"time [s]", "x_25 [m]", "y_25 [m]", "spin_25 [rad/s]", "contact_25 [N]"}
    # on the low side, between the clearance of the collar below it and its own
    assert -(0.2159 - 0.127) / 2 < probes["x_25 [m]"][0] < -(0.2159 - 0.1715) / 2
    summary = json.loads((run / "summary.json").read_text())
    assert summary["status"] == "done" and summary["petsc_options"]["ts_rtol"] == "1e-3"
    assert summary["steps"] > 0 and abs(summary["energy"]["error_share"]) < 0.05
    frames = read_series(run)
    assert len(frames) == 3
    assert {"axial_force [N]", "torque [N m]", "contact_force [N/m]", "displacement [m]"} <= set(
        read_frame(frames[-1][1]).point_data
    )


def test_hook_load_of_the_start_is_the_weight_along_the_hole(finished):
    """At rest on the incline without motion there is no friction: hook load = W cos 60 deg."""
    area = np.pi / 4 * np.array([0.127**2 - 0.1086**2, 0.1715**2 - 0.0714**2])
    weight = 7850 * 9.80665 * (area @ [30, 20])
    history = read_table(finished / "run" / "history.csv")
    assert history["hook_load [N]"][0] == pytest.approx(0.5 * weight, rel=2e-4)


def test_an_existing_folder_is_refused_and_untouched(finished):
    before = (finished / "run" / "history.csv").read_bytes()
    again = drillpetsc("run small.yaml --out run", cwd=finished)
    assert again.returncode == 2 and "--restart" in again.stderr and "--overwrite" in again.stderr
    assert (finished / "run" / "history.csv").read_bytes() == before


def test_runs_without_out_are_numbered(finished):
    short = CASE.replace("end: 0.2 s", "end: 0.002 s").replace(
        "checkpoint_every: 0.1 s", "checkpoint_every: 1 s"
    )
    short = short.replace(
        "history_every: 0.02 s, field_every: 0.1 s", "history_every: 0.001 s, field_every: 0.002 s"
    )
    (finished / "short.yaml").write_text(short)
    for _ in range(2):
        succeeds("run short.yaml", cwd=finished)
    assert len(list((finished / "results").glob("short-*"))) == 2


def test_a_run_stopped_at_a_checkpoint_goes_on_identically(finished):
    """The first half, then --restart with the whole case: the history equals the uninterrupted one to the
    last digit."""
    (finished / "half.yaml").write_text(CASE.replace("end: 0.2 s", "end: 0.1 s"))
    succeeds("run half.yaml --out parts -ts_rtol 1e-3", cwd=finished)
    succeeds("run small.yaml --out parts --restart -ts_rtol 1e-3", cwd=finished)
    whole, parts = (read_table(finished / name / "history.csv") for name in ("run", "parts"))
    for column in whole:
        assert np.array_equal(whole[column], parts[column]), column


@pytest.mark.parametrize(
    "words, status, message",
    [
        (("run", "nowhere.yaml"), 2, "nowhere.yaml"),
        (("run", "small.yaml", "-ts_rtoll", "1e-3"), 2, "did you mean -ts_rtol?"),
        (("run", "small.yaml", "--ouch"), 2, "--ouch"),
        (("run", "small.yaml", "--companion"), 2, "--companion is now called --mesh-error"),
        (("surge", "small.yaml", "--speed", "60 ft/min"), 2, "--speed is now called --speeds"),
        (("stability", "small.yaml", "--rpm=60rpm", "--wob", "1 kN"), 2, "--rpm is now called --speeds"),
        (("fmu", "small.yaml", "-o", "small.fmu"), 2, "-o is now called --out"),
        (("run", "small.yaml", "small.yaml", "--mesh-error"), 2, "one case"),
        (("run", "small.yaml", "small.yaml", "--check-tolerance"), 2, "one case"),
        (("run", "small.yaml", "--restart", "--check-tolerance"), 2, "no --restart"),
        (("plot", "run", "-ts_rtol", "1e-3"), 2, "no PETSc options with plot"),
        (("statics", "small.yaml", "--motion", "sideways"), 2, "hoist"),
        (("plot", "nowhere"), 2, "nowhere"),
        (("run", "small.yaml", "--out", "new", "--restart"), 2, "new"),
    ],
)
def test_bad_words_get_status_2_and_a_reason(finished, words, status, message):
    answer = drillpetsc(*words, cwd=finished)
    assert answer.returncode == status and message in answer.stderr
    assert not (finished / "new").exists()


def test_check_says_what_is_there_and_what_is_not(finished):
    text = drillpetsc("check small.yaml", cwd=finished).stdout
    assert "contact with the hole" in text.split("leaves out")[0]
    assert "drilling fluid" in text.split("leaves out")[1]
    assert "7 per node" in text


def test_statics_motion_changes_the_hook_load(finished):
    """Incline at 60 degrees, friction 0.2: hoisting adds mu W sin, lowering takes it off (soft string,
    exact)."""
    area = np.pi / 4 * np.array([0.127**2 - 0.1086**2, 0.1715**2 - 0.0714**2])
    weight = 7850 * 9.80665 * float(area @ [30, 20])
    for motion, sign in (("hoist", 1), ("lower", -1)):
        succeeds("statics small.yaml --motion", motion, "--out", f"statics-{motion}", cwd=finished)
        summary = json.loads((finished / f"statics-{motion}" / "summary.json").read_text())
        expected = weight * (0.5 + sign * 0.2 * np.sin(np.pi / 3))
        # the top drive itself carries a little of the side load: 1 % (a soft string has no such end)
        assert summary["hook_load"] == pytest.approx(expected, abs=0.01 * weight)
    assert (finished / "statics-hoist" / "statics.csv").exists()


def test_help_names_the_commands_and_petsc():
    text = drillpetsc("--help", cwd=Path.cwd()).stdout
    for word in ("run", "check", "statics", "view", "plot", "-ts_rtol", "Exit status"):
        assert word in text


def test_every_command_has_a_help_of_its_own():
    from drillpetsc.cli import parser
    from drillpetsc.operations import OPERATIONS

    names = [operation.command() for operation in OPERATIONS]
    assert len(set(names)) == len(names)
    for name in names:
        with pytest.raises(SystemExit) as ended:
            parser().parse_args([name, "--help"])
        assert ended.value.code == 0


@pytest.mark.parametrize("options", [(), ("--outputs",)])
def test_a_schema_that_cannot_be_written_is_one_message(tmp_path, options):
    refused = drillpetsc("schema no-folder/file.json", *options, cwd=tmp_path)
    assert refused.returncode == 2
    assert "no-folder/file.json" in refused.stderr and "No such file" in refused.stderr


def test_schema_is_that_of_the_case_or_a_list_of_outputs(finished, tmp_path):
    case = json.loads(drillpetsc("schema", cwd=tmp_path).stdout)
    assert "string" in case["properties"]
    listed = json.loads(drillpetsc("schema --outputs", cwd=tmp_path).stdout)
    written = drillpetsc("schema outputs.json --outputs", cwd=tmp_path)
    assert written.returncode == 0 and not written.stdout
    assert json.loads((tmp_path / "outputs.json").read_text()) == listed
    assert {tuple(entry) for entry in listed} == {
        ("file", "name", "unit", "label", "mnemonic", "sign", "doc", "condition")
    }
    history = {f"{q['name']} [{q['unit']}]": q for q in listed if q["file"] == "history.csv"}
    assert set(read_table(finished / "run" / "history.csv")) <= set(history)
    assert history["wob [N]"]["condition"] == "bit on bottom" and not history["time [s]"]["condition"]


def test_an_old_option_is_not_a_new_one_too():
    from drillpetsc.cli import parser
    from drillpetsc.operations import RENAMED_OPTIONS

    subs = parser()._subparsers._group_actions[0].choices.values()
    known = {option for sub in subs for option in sub._option_string_actions}
    for old, new in RENAMED_OPTIONS.items():
        assert new in known and old not in known


def test_python_face():
    """The names that `import drillpetsc` promises, imported when they are used."""
    import drillpetsc as package
    from drillpetsc import api

    assert all(getattr(package, name) is value for name, value in api.PUBLIC.items())
    assert set(api.PUBLIC) <= set(dir(package))
    with pytest.raises(AttributeError):
        package.simulate  # noqa: B018


def test_statics_and_modes_from_python(finished, tmp_path):
    from drillpetsc import load_case, modes, statics

    state = statics(finished / "small.yaml", tmp_path / "statics", motion="hoist")
    assert state.summary == json.loads((state.folder / "summary.json").read_text())
    assert any("hook load" in line for line in state.lines)
    found = modes(load_case(finished / "small.yaml"), tmp_path / "modes", count=2, about="rest")
    assert (found.folder / "modes.csv").exists() and found.summary["modes"] >= 2


@pytest.mark.parametrize(
    "command", ["modes", "statics", "sensitivities --to gravity", "follow --log none.csv"]
)
def test_a_folder_that_exists_is_refused_before_the_computation(
    command, finished, tmp_path, capsys, monkeypatch
):
    """Minutes of work were lost to it; `follow --restart` goes on with the folder."""
    name, *words = command.split()
    operation = next(q for q in OPERATIONS if q.command() == name)
    monkeypatch.setattr(operation, "compute", lambda self, job: pytest.fail("computed"))
    assert cli.main([name, str(finished / "small.yaml"), *words, "--out", str(tmp_path)]) == 2
    assert "--overwrite" in capsys.readouterr().err
    with pytest.raises(pytest.fail.Exception, match="computed"):
        more = "--restart" if name == "follow" else "--overwrite"
        cli.main([name, str(finished / "small.yaml"), *words, "--out", str(tmp_path), more])


def test_python_gives_the_same_run(finished, tmp_path):
    """drillpetsc.run(Case) from Python, PETSc already started by the tests."""
    from petsc4py import PETSc

    from drillpetsc import load_case, run

    PETSc.Options().setValue("ts_rtol", "1e-3")
    try:
        result = run(load_case(finished / "small.yaml"), tmp_path / "run", progress="silent")
    finally:
        PETSc.Options().delValue("ts_rtol")
    here, there = read_table(result.folder / "history.csv"), read_table(finished / "run" / "history.csv")
    assert np.allclose(here["hook_load [N]"], there["hook_load [N]"], rtol=1e-9)
