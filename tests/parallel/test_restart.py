"""Checkpoints: a restarted run reproduces an uninterrupted one, and damaged files are handled."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest

from drillpetsc.analysis.motion import checkpoint
from drillpetsc.analysis.motion.transient import after, run
from drillpetsc.analysis.statics.placement import place_along_hole
from drillpetsc.case import load_case
from drillpetsc.errors import CaseError
from drillpetsc.model.drilling_model import build_model
from drillpetsc.output import read_table
from drillpetsc.output.files.atomic import remove_leftovers, replace_file
from drillpetsc.output.recorder import Recorder
from drillpetsc.solvers.time.bdf_history import BdfHistory
from drillpetsc.solvers.time.time_integrator import TimeIntegrator
from tests.helpers.restarts import files, run_with_copies
from tests.helpers.tables import each_row

# a whirling string in contact, with a bend of the rotation at 40 ms and a jump of the lowering at 60 ms, and
# mud
CASE = """
well:
  survey: {md: [0 m, 60 m], inclination: [40 deg, 70 deg], azimuth: [0 deg, 10 deg]}
  sections: [{to: 60 m, kind: casing, diameter: 215.9 mm, friction: 0.2}]
string:
  - {kind: pipe, length: 30 m, od: 127 mm, id: 108.6 mm, element_length: 10 m}
  - {kind: pipe, length: 20 m, od: 171.5 mm, id: 71.4 mm, element_length: 10 m, eccentricity: 3 mm}
top:
  kind: top_drive
  rotation: {time: [0 s, 40 ms, 1 s], value: [60 rpm, 80 rpm, 80 rpm]}
  lowering: {time: [0 s, 60 ms, 60 ms, 1 s], value: [0 m/s, 0 m/s, 0.1 m/s, 0.1 m/s]}
bottom: free
fluid: {density: 1200 kg/m3, rheology: {model: newtonian, viscosity: 20 mPa s}, bulk_modulus: 2 GPa, flow_rate: 20 l/s}
time: {end: 0.1 s}
output: {history_every: 5 ms, field_every: 20 ms, probes: [40 m], checkpoint_every: 3 ms}
"""


KINDS = {
    "bdf2": {},
    "bdf3": {"ts_bdf_order": 3},
    "bdf1 with fixed steps": {"ts_bdf_order": 1, "ts_adapt_type": "none", "ts_dt": 2e-3},
    "cut fixed steps": {"ts_adapt_type": "none", "ts_dt": 1e-2},
    "assembled newton": {"q_pc_type": "lu"},
    "plain system": {"snes_type": "newtonls"},
    "generalised alpha": {"ts_type": "alpha2"},
    "generalised alpha with fixed steps": {"ts_type": "alpha2", "ts_adapt_type": "none", "ts_dt": 1e-3},
    "hermite mud": {"ts_type": "alpha2"},
}


@pytest.mark.parametrize("kind", KINDS)
def test_a_run_restarted_from_any_checkpoint_is_bit_identical(kind, tmp_path, monkeypatch, options):
    """Every file, from checkpoints in the start of the formula, at full order, at a bend, after a jump, and
    at the end."""
    options(**KINDS[kind])
    text = CASE
    if kind.startswith("hermite"):  # moves by more than the way after which the hole is read anew
        text = text.replace("fluid: {", "fluid: {formulation: hermite, ").replace("0.1 m/s", "0.6 m/s")
        text = text.replace(
            "sections: [", "sections: [{to: 25 m, kind: casing, diameter: 300 mm, friction: 0.2}, "
        )
    (tmp_path / "case.yaml").write_text(text)
    copies = run_with_copies(tmp_path / "case.yaml", tmp_path / "run", monkeypatch)
    assert len(copies) >= 8
    whole = files(tmp_path / "run")
    for copy in copies[:: max(1, len(copies) // 5)]:
        run(load_case(tmp_path / "case.yaml"), copy, restart=True, progress="silent")
        for name, content in files(copy).items():
            assert content == whole[name], (copy, name)


@pytest.mark.parametrize("kind", ["bdf", "alpha2"])
def test_a_run_restarted_at_a_bend_or_jump_of_an_input_is_bit_identical(kind, tmp_path, monkeypatch, options):
    """Checkpoints at the bend of the rotation and at the jump of the lowering themselves."""
    options(ts_type=kind)
    text = CASE.replace("checkpoint_every: 3 ms", "checkpoint_every: 20 ms")
    (tmp_path / "case.yaml").write_text(text)
    copies = run_with_copies(tmp_path / "case.yaml", tmp_path / "run", monkeypatch)
    times = [checkpoint.read(copy / "checkpoint.h5").time for copy in copies]
    assert {0.04, 0.06} <= set(times)
    whole = files(tmp_path / "run")
    for copy, time in zip(copies, times, strict=True):
        if time in (0.04, 0.06):
            run(load_case(tmp_path / "case.yaml"), copy, restart=True, progress="silent")
            for name, content in files(copy).items():
                assert content == whole[name], (time, name)


TAKES_OVER = """  motor: {inertia: 1000 kg m^2}
  control:
    - {kind: stiff}
    - {kind: soft_torque, from: 40 ms, damping: 0.25, frequency: 1 Hz, inertia_compensation: 0.5}
bottom: free
"""


@pytest.mark.parametrize("kind", ["bdf", "alpha2"])
def test_a_run_restarted_where_a_controller_takes_over_is_bit_identical(kind, tmp_path, monkeypatch, options):
    """It takes over without a jump of the torque, which follows from the speed and its rate."""
    options(ts_type=kind)
    text = CASE.replace("bottom: free\n", TAKES_OVER).replace(
        "checkpoint_every: 3 ms", "checkpoint_every: 40 ms"
    )
    (tmp_path / "case.yaml").write_text(text.replace("end: 0.1 s", "end: 45 ms"))
    copies = run_with_copies(tmp_path / "case.yaml", tmp_path / "run", monkeypatch)
    assert checkpoint.read(copies[1] / "checkpoint.h5").time == 0.04
    run(load_case(tmp_path / "case.yaml"), copies[1], restart=True, progress="silent")
    assert files(copies[1]) == files(tmp_path / "run")


def test_checkpoints_change_no_number(tmp_path):
    """With a checkpoint every 3 ms and with the first and the last only."""
    results = []
    for every in ("3 ms", "10 s"):
        (tmp_path / "case.yaml").write_text(
            CASE.replace("checkpoint_every: 3 ms", f"checkpoint_every: {every}")
        )
        results.append(
            files(
                run(load_case(tmp_path / "case.yaml"), tmp_path / every[:2].strip(), progress="silent").folder
            )
        )
    for name in results[0].keys() - {"case.yaml"}:
        assert results[0][name] == results[1][name], name


@each_row("interval", [0.1, 0.01, 1e-3, 1 / 3])
def test_the_next_output_is_the_same_for_a_run_that_starts_there(interval):
    """Successive output times equal those computed for a single time, also where steps end beside multiples
    by rounding."""
    counted, t = 0, 0.0
    for k in range(1, 200):
        for t in (k * interval * (1 - 3e-10), k * interval * (1 + 2e-16), k * interval + 0.3 * interval):
            while counted * interval <= t * (1 + 1e-12) + 1e-15:
                counted += 1
            assert after(t, interval) == counted


# ---------------------------------------------------------------------- the file
@pytest.fixture(scope="module")
def saved(tmp_path_factory) -> Path:
    """A short run with its checkpoint."""
    folder = tmp_path_factory.mktemp("saved")
    (folder / "case.yaml").write_text(CASE.replace("end: 0.1 s", "end: 2 ms"))
    return run(load_case(folder / "case.yaml"), folder / "run", progress="silent").folder


def _cut(share: float):
    return lambda data: data[: int(share * len(data))]


def _flip(share: float):
    def change(data: bytes) -> bytes:
        i = int(share * len(data))
        return data[:i] + bytes([data[i] ^ 1]) + data[i + 1 :]

    return change


DAMAGE = {
    "empty": (lambda data: b"", "an empty file"),
    "first bytes only": (lambda data: data[:100], "cut short or damaged"),
    "half": (_cut(0.5), "cut short or damaged"),
    "last byte missing": (lambda data: data[:-1], "cut short or damaged"),
    "one bit in the middle": (_flip(0.5), "cut short or damaged"),
    "one bit at the end": (_flip(0.9999), "cut short or damaged"),
    "one bit of the checksum": (
        lambda data: data[:40] + bytes([data[40] ^ 1]) + data[41:],
        "cut short or damaged",
    ),
    "no checksum": (lambda data: data[:22] + b"\n" * 490 + data[512:], "a damaged first block"),
    "longer": (lambda data: data + b"\0", "cut short or damaged"),
    "text": (lambda data: b"time,hook_load\n0,1\n", "something else"),
    "plain HDF5": (lambda data: b"\x89HDF\r\n\x1a\n" + data, "something else"),
    "version 99": (
        lambda data: data.replace(f"checkpoint {checkpoint.VERSION}".encode(), b"checkpoint 99", 1),
        "version 99",
    ),
}


@each_row("damage", DAMAGE)
def test_a_damaged_checkpoint_is_refused_with_a_message(damage, saved, tmp_path):
    change, words = DAMAGE[damage]
    file = tmp_path / "checkpoint.h5"
    file.write_bytes(change((saved / "checkpoint.h5").read_bytes()))
    with pytest.raises(CaseError) as refusal:
        checkpoint.read(file)
    assert words in str(refusal.value) and str(file) in str(refusal.value)


def test_a_checkpoint_of_another_string_is_refused(saved, tmp_path):
    """With the same number of nodes elsewhere, and with more nodes; also where changes are accepted."""
    for change in (("length: 30 m", "length: 29 m"), ("length: 20 m", "length: 29 m")):
        (tmp_path / "other.yaml").write_text(CASE.replace(*change))
        shutil.copytree(saved, tmp_path / "run", dirs_exist_ok=True)
        before = files(tmp_path / "run")
        with pytest.raises(CaseError, match="a checkpoint of the same string"):
            run(
                load_case(tmp_path / "other.yaml"),
                tmp_path / "run",
                restart=True,
                accept_changes=True,
                progress="silent",
            )
        assert files(tmp_path / "run") == before


def test_without_a_checkpoint_a_restart_is_a_start(saved, tmp_path):
    """Killed before its first checkpoint, a run starts from the beginning.  (A run that has ended has lost it: test_restart_refused.)"""
    shutil.copytree(saved, tmp_path / "run")
    for name in ("checkpoint.h5", "summary.json"):
        (tmp_path / "run" / name).unlink()
    run(load_case(saved.parent / "case.yaml"), tmp_path / "run", restart=True, progress="silent")
    assert files(tmp_path / "run") == files(saved)


def test_incomplete_rows_and_frames_are_written_again(tmp_path, monkeypatch):
    """Half a row, rows after the checkpoint, a frame missing in the list, temporary files: all are removed
    and written again."""
    (tmp_path / "case.yaml").write_text(CASE)
    copies = run_with_copies(tmp_path / "case.yaml", tmp_path / "run", monkeypatch)
    copy, whole = copies[len(copies) // 2], files(tmp_path / "run")
    for name in ("history.csv", "probes.csv"):
        written = len((copy / name).read_bytes())
        (copy / name).write_bytes(
            whole[name][: written + 150]
        )  # the run continued: one more row, and part of the next
    (copy / "string" / "000099.vtu").write_bytes(b"half a frame")
    (copy / "string" / ".123-000100.vtu").write_bytes(b"half a frame")
    (copy / ".123-checkpoint.h5").write_bytes(b"half a checkpoint")
    (copy / ".own-notes").write_text("kept")
    run(load_case(tmp_path / "case.yaml"), copy, restart=True, progress="silent")
    continued = files(copy)
    assert continued.pop(".own-notes") == b"kept"
    assert continued == whole


def test_the_old_checkpoint_stays_until_the_new_one_is_whole(tmp_path):
    file = tmp_path / "checkpoint.h5"
    replace_file(file, lambda target: target.write_bytes(b"old"), lasting=True)

    def fail(target: Path) -> None:
        target.write_bytes(b"ne")
        raise OSError(28, "No space left on device")

    with pytest.raises(OSError):
        replace_file(file, fail, lasting=True)
    assert [p.name for p in tmp_path.iterdir()] == ["checkpoint.h5"] and file.read_bytes() == b"old"
    (tmp_path / ".77-checkpoint.h5").write_bytes(b"ne")
    remove_leftovers(tmp_path)
    assert [p.name for p in tmp_path.iterdir()] == ["checkpoint.h5"]


def test_the_state_of_a_component_is_restored(tmp_path):
    """The state of a component is restored by its name."""
    (tmp_path / "case.yaml").write_text(CASE)
    models = [build_model(load_case(tmp_path / "case.yaml")) for _ in range(2)]
    for model in models:
        place_along_hole(model)
    restored: dict[str, np.ndarray] = {}
    models[0].contact.get_state = lambda: {"worn": np.array([1.0, 2.5]), "count": np.array(3)}
    models[1].contact.set_state = restored.update
    recorder, integrator = Recorder(models[0]), TimeIntegrator(models[0].system)
    recorder.start(0.0)
    c = checkpoint.take(models[0], recorder, integrator, 0.0, {"share": 0.5})
    assert c is not None
    checkpoint.write(tmp_path / "checkpoint.h5", c)
    back = checkpoint.read(tmp_path / "checkpoint.h5")
    checkpoint.restore(models[1], back)
    assert np.array_equal(restored["worn"], [1.0, 2.5]) and int(restored["count"]) == 3
    assert back.notes == {"share": 0.5}
    assert np.array_equal(models[1].system.assembly.x, models[0].system.assembly.x)


def test_the_summary_of_every_run_has_the_balances(saved):
    """Energy and mud mass balance close; the values are those of the history and the flow rates."""
    import json

    summary = json.loads((saved / "summary.json").read_text())
    history = read_table(saved / "history.csv")
    assert set(summary["energy"]) >= {
        "kinetic", "strain", "potential", "dissipated", "supplied", "error", "error_share", "gained", "flag",
    }  # fmt: skip
    assert (
        summary["energy"]["error"] == history["energy_error [J]"][-1]
        or summary["time"] > history["time [s]"][-1]
    )
    assert abs(summary["energy"]["error_share"]) < 0.05 and not summary["energy"]["flag"]
    assert summary["mass"]["pumped"] == pytest.approx(0.02 * 2e-3, rel=1e-6)  # 20 l/s for 2 ms
    assert (
        abs(summary["mass"]["error_share"]) < 5e-3
    )  # 0.1 ml in a start of 40 ml: the jump from flow at rest to flow in motion


def test_the_record_of_a_first_step_has_the_half_step():
    """PETSc solves the half of a first step, then the whole one; a rejected first step is forgotten."""
    record = BdfHistory(3)
    record.start(0.0, np.zeros(1), np.zeros(1))
    for value in (7.0, 8.0, 1.0, 2.0):  # the first two were rejected
        record.add_stage(np.array([value]), np.array([-value]))
    record.add_step(0.1, 0.1, np.array([2.0]), np.array([-2.0]))
    assert record.half is not None and [q[0] for q in record.half] == [1.0, -1.0]
    assert [x[0] for x, _ in record.states] == [0.0, 2.0]
