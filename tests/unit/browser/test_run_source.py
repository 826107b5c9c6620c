"""What the page of a run gets: numbers of the files in the units of the reader, and only what is new."""

from __future__ import annotations

import base64
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from drillpetsc.browser import run_source
from drillpetsc.browser.run_source import DISTANCE, RunSource, Tail
from drillpetsc.output import FieldWriter, Table
from drillpetsc.output.files import lock
from drillpetsc.output.files.tables import read_table
from tests.helpers.output_samples import AMPLITUDE, HOLE, LENGTH, PIPE, helix_frame, make_run


def numbers(text: str, kind: str = "<f4") -> np.ndarray:
    return np.frombuffer(base64.b64decode(text), dtype=kind)


def arrays(source: RunSource, number: int) -> dict[str, np.ndarray]:
    return {name: numbers(text) for name, text in source.frame(number)["arrays"].items()}


def test_histories_in_the_units_of_the_reader(tmp_path: Path) -> None:
    news = RunSource(make_run(tmp_path / "run").path, "field").news()
    assert news["rows"] == 101 and not news["more"] and not news["notes"]
    assert numbers(news["columns"]["time [s]"], "<f8")[-1] == 3.0
    torque = numbers(news["columns"]["surface_torque [N m]"])
    np.testing.assert_allclose(torque, 9e3 / 1.3558179483e3, rtol=1e-6)  # kft-lbf
    assert [list(panel["of"]) for panel in news["panels"]][0] == ["hook_load [N]"]
    assert {panel["of"].get("energy_error [J]") for panel in news["panels"] if panel["numerics"]} >= {
        "Energy error"
    }


def test_a_frame_has_the_helix_of_the_file(tmp_path: Path) -> None:
    source = RunSource(make_run(tmp_path / "run").path, "metric")
    found = arrays(source, 2)
    _, data = helix_frame(2.0)
    np.testing.assert_allclose(found["ox"], 1e3 * data["offset_x [m]"], rtol=1e-5, atol=1e-4)  # mm
    np.testing.assert_allclose(found["oy"], 1e3 * data["offset_y [m]"], rtol=1e-5, atol=1e-4)
    np.testing.assert_allclose(found["hole"], 1e3 * HOLE)
    np.testing.assert_allclose(found["radius"], 1e3 * PIPE)
    np.testing.assert_allclose(found[f"f:{DISTANCE}"], 1e3 * AMPLITUDE, rtol=1e-5)
    # in a vertical hole the high side is north and the centre of the hole is at zero
    np.testing.assert_allclose(found["l0"], data["offset_x [m]"], atol=1e-6)
    np.testing.assert_allclose(found["l1"], data["offset_y [m]"], atol=1e-6)
    np.testing.assert_allclose(found["c0"], 0.0, atol=1e-6)
    np.testing.assert_allclose(found["c2"], np.linspace(0, LENGTH, 81), rtol=1e-6)
    fields = source.news()["fields"]
    assert fields["axial_force [N]"] == {"label": "Axial force", "unit": "kN", "low": -50.0, "high": 800.0}


def test_without_a_hole_offsets_are_from_the_place_at_rest(tmp_path: Path) -> None:
    source = RunSource(make_run(tmp_path / "run", well=False).path, "metric")
    news, found = source.news(), arrays(source, 0)
    assert news["hole"] == "" and "wall" not in news and "hole" not in found
    np.testing.assert_allclose(np.hypot(found["ox"], found["oy"]), 1e3 * AMPLITUDE, rtol=1e-4)
    np.testing.assert_allclose(np.hypot(found["c0"], found["c1"]), 0.0, atol=1e-6)


def test_only_new_rows_frames_and_holes_are_sent(tmp_path: Path) -> None:
    run = make_run(tmp_path / "run")
    source = RunSource(run.path, "metric")
    first = source.news()
    again = source.news(first["series"], first["rows"], first["hole"])
    assert "wall" in first and "wall" not in again
    assert again["first"] == 101 and all(text == "" for text in again["columns"].values())
    with open(run.history, "a") as file:
        file.write("4,800001,1,2,3,4,5,2\n5,8000")  # the last row is being written
    FieldWriter(run.path, restart_time=10.0).write(4.0, *helix_frame(4.0))
    new = source.news(first["series"], first["rows"], first["hole"])
    assert new["rows"] == 102 and len(new["times"]) == len(first["times"]) + 1
    np.testing.assert_allclose(numbers(new["columns"]["hook_load [N]"]), [800.001])
    with open(run.history, "a") as file:
        file.write("02,1,2,3,4,5,2\n")
    last = source.news(first["series"], 102)
    np.testing.assert_allclose(numbers(last["columns"]["hook_load [N]"]), [800.002])


def test_a_run_begun_anew_is_another_series(tmp_path: Path) -> None:
    run = make_run(tmp_path / "run")
    source = RunSource(run.path)
    first = source.news()
    with Table(run.history, [("time", "s"), ("hook_load", "N")]) as table:
        table.add([0.0, 1e3])
    new = source.news(first["series"], first["rows"])
    assert new["series"] != first["series"] and (new["first"], new["rows"]) == (0, 1)
    np.testing.assert_allclose(numbers(new["columns"]["hook_load [N]"]), [1.0])


def test_status_of_runs_that_are_written_finished_stopped_and_broken_off(tmp_path: Path) -> None:
    run = make_run(tmp_path / "run")  # its lock is held by this process
    source = RunSource(run.path)

    def status() -> str:
        return str(source.news()["status"]["word"])

    assert status() == "running"
    run.release()
    assert status() == "done"
    run.summary.write_text('{"status": "stopped by SIGINT at 2 s", "interrupted": true}')
    assert source.news()["status"] == {"word": "stopped", "text": "stopped by SIGINT at 2 s"}
    run.summary.write_text('{"status": "failed: no convergence"}')
    assert source.news()["status"] == {"word": "failed", "text": "failed: no convergence"}
    run.summary.unlink()
    assert source.news()["status"]["text"] == "broken off: no process writes here any more"
    run.checkpoint.touch()
    assert source.news()["status"]["text"].endswith("run --restart continues it")
    assert lock.writer_of(run.path) is None and not (run.path / lock.NAME).exists()


def test_an_empty_folder_fills_and_a_removed_one_comes_back(tmp_path: Path) -> None:
    folder = tmp_path / "run"
    folder.mkdir()
    source = RunSource(folder)
    assert source.news()["status"]["word"] == "empty"
    folder.rmdir()
    assert source.news()["status"]["word"] == "missing" and source.news()["notes"] == []
    make_run(folder)
    assert source.news()["rows"] == 101
    os.rename(folder, tmp_path / "moved")
    gone = source.news()
    assert gone["status"]["word"] == "missing" and gone["rows"] == 0 and gone["times"] == []
    os.rename(tmp_path / "moved", folder)
    assert source.news()["rows"] == 101


def damage_history(folder: Path) -> None:
    lines = (folder / "history.csv").read_text().splitlines(keepends=True)
    lines[5] = "0.1,what,is,this\n"
    (folder / "history.csv").write_text("".join(lines))


def cut_frame(folder: Path) -> None:
    file = folder / "string" / "000001.vtu"
    file.write_bytes(file.read_bytes()[:700])


def damage(name: str, content: str = "<VTK") -> Any:
    return lambda folder: (folder / name).write_text(content)


@pytest.mark.parametrize(
    ("change", "named"),
    [
        (damage_history, "history.csv"),
        (cut_frame, "000001.vtu"),
        (lambda folder: shutil.rmtree(folder / "string"), "000000.vtu"),
        (damage("string.pvd"), "string.pvd"),
        (damage("well.vtu"), "well.vtu"),
        (damage("summary.json", "{"), "summary.json"),
        (damage("case.yaml", "a: [b"), "case.yaml"),
        (damage("history.csv", ""), "history.csv"),
        (damage("statics.csv", ""), "statics.csv"),
    ],
)
def test_damage_is_named_and_the_rest_is_shown(tmp_path: Path, change: Any, named: str) -> None:
    run = make_run(tmp_path / "run")
    run.release()
    change(run.path)
    source = RunSource(run.path)
    first, news = source.news(), source.news()
    assert news["notes"] == first["notes"], "a note stays"
    assert any(named in note for note in news["notes"]), news["notes"]
    assert news["rows"] or named == "history.csv"
    if change is damage_history:
        assert news["rows"] == 100 and news["notes"] == ["history.csv: damaged rows that are left out: 1"]


def test_a_tail_reads_each_byte_once(tmp_path: Path) -> None:
    file = tmp_path / "t.csv"
    file.write_text("time [s],x [m]\n0,1\n1,2\n2,")
    tail = Tail(file)
    tail.read()
    assert len(tail) == 2 and tail.last_time == 1.0
    with open(file, "a") as more:
        more.write("3\n")
    tail.read()
    np.testing.assert_array_equal(tail.rows(0, 9), [[0, 1], [1, 2], [2, 3]])
    file.unlink()
    assert tail.read() == "" and len(tail) == 0


def test_long_histories_come_in_parts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(run_source, "MOST_ROWS", 40)
    source = RunSource(make_run(tmp_path / "run").path)
    parts = [source.news()]
    while parts[-1]["more"]:
        parts.append(source.news(parts[0]["series"], parts[-1]["rows"]))
    assert [part["rows"] for part in parts] == [40, 80, 101]
    time = np.concatenate([numbers(part["columns"]["time [s]"], "<f8") for part in parts])
    np.testing.assert_allclose(time, np.linspace(0, 3, 101))


@pytest.mark.slow
def test_a_run_of_another_process_is_followed_to_its_end(tmp_path: Path) -> None:
    folder = tmp_path / "run"
    folder.mkdir()
    source = RunSource(folder)
    case = Path(__file__).parents[3] / "cases" / "lying-string.yaml"
    changes = [
        "--set",
        "time.end=3 s",
        "--set",
        "output.field_every=0.05 s",
        "--set",
        "output.history_every=0.001 s",
    ]
    command = [
        sys.executable,
        "-P",
        "-m",
        "drillpetsc",
        "run",
        str(case),
        "--out",
        str(folder),
        "--overwrite",
        *changes,
    ]
    parts: list[dict[str, Any]] = []
    words = []
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as run:
        while run.poll() is None or not parts:
            news = source.news(parts[-1]["series"] if parts else "", parts[-1]["rows"] if parts else 0)
            words.append(news["status"]["word"])
            parts += [news] if news["series"] else []
            time.sleep(0.1)
        assert run.returncode == 0
    parts.append(source.news(parts[-1]["series"], parts[-1]["rows"]))
    assert "running" in words and parts[-1]["status"]["word"] == "done"
    assert len({part["rows"] for part in parts}) > 2, "rows came in several parts"
    got = np.concatenate([numbers(part["columns"]["hook_load [N]"]) for part in parts])
    whole = read_table(folder / "history.csv")["hook_load [N]"]
    np.testing.assert_allclose(got, whole / 1e3, rtol=1e-6, atol=1e-6)
    assert len(parts[-1]["times"]) == 61 and parts[-1]["notes"] == []
