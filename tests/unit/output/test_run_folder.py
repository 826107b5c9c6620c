"""Run folders: numbering, refusal, restart, overwrite (case-format.md, "Commands" and "Run folder")."""

from __future__ import annotations

import multiprocessing
from pathlib import Path

import pytest

from drillpetsc.output import RunFolder, RunFolderExists, RunFolderMissing


def test_numbers_start_at_one_and_follow_the_highest(tmp_path: Path) -> None:
    first = RunFolder.create("vertical-2000m", results=tmp_path)
    assert first.path == tmp_path / "vertical-2000m-001"
    (tmp_path / "vertical-2000m-007").mkdir()
    (tmp_path / "vertical-2000m-fine-040").mkdir()  # another case whose name begins alike
    assert RunFolder.create("vertical-2000m", results=tmp_path).path.name == "vertical-2000m-008"
    assert RunFolder.latest("vertical-2000m", tmp_path).path.name == "vertical-2000m-008"


def test_numbers_pass_999(tmp_path: Path) -> None:
    (tmp_path / "a-999").mkdir()
    assert RunFolder.create("a", results=tmp_path).path.name == "a-1000"
    assert RunFolder.create("a", results=tmp_path).path.name == "a-1001"


def _create(results: Path) -> str:
    return RunFolder.create("race", results=results).path.name


def test_runs_that_start_together_get_folders_of_their_own(tmp_path: Path) -> None:
    with multiprocessing.get_context("fork").Pool(4) as pool:
        names = pool.map(_create, [tmp_path] * 24, chunksize=1)
        pool.close()  # its processes end by themselves: a handler of signals that they inherit may let them outlive a termination
        pool.join()
    assert sorted(names) == [f"race-{k:03d}" for k in range(1, 25)]


def test_explicit_folder_that_exists_is_refused_and_untouched(tmp_path: Path) -> None:
    out = tmp_path / "result"
    run = RunFolder.create("a", out=out)
    run.history.write_text("time [s]\n1\n")
    with pytest.raises(RunFolderExists, match="result exists.*--restart.*--overwrite"):
        RunFolder.create("a", out=out)
    assert issubclass(RunFolderExists, FileExistsError)
    assert run.history.read_text() == "time [s]\n1\n"


def test_an_empty_folder_is_refused_too(tmp_path: Path) -> None:
    with pytest.raises(RunFolderExists):
        RunFolder.create("a", out=tmp_path)


def test_a_file_in_the_way_is_refused_even_with_overwrite(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("precious")
    with pytest.raises(RunFolderExists, match="not a folder"):
        RunFolder.create("a", out=tmp_path / "file", overwrite=True)
    assert (tmp_path / "file").read_text() == "precious"


def test_overwrite_removes_the_contract_and_nothing_else(tmp_path: Path) -> None:
    run = RunFolder.create("a", out=tmp_path / "run")
    for file in (run.history, run.summary, run.checkpoint, run.path / "notes.txt"):
        file.write_text("old")
    run.string_frames.mkdir()
    (run.string_frames / "000000.vtu").write_text("old")
    RunFolder.create("a", out=run.path, overwrite=True).release()
    assert [entry.name for entry in run.path.iterdir()] == ["notes.txt"]


def test_restart_keeps_everything_and_needs_a_folder(tmp_path: Path) -> None:
    with pytest.raises(RunFolderMissing, match="nowhere does not exist"):
        RunFolder.create("a", out=tmp_path / "nowhere", restart=True)
    with pytest.raises(RunFolderMissing, match="a-NNN"):
        RunFolder.create("a", restart=True, results=tmp_path)
    run = RunFolder.create("a", results=tmp_path)
    run.history.write_text("kept")
    assert RunFolder.create("a", restart=True, results=tmp_path) == run
    assert RunFolder.create("a", out=run.path, restart=True).history.read_text() == "kept"
    with pytest.raises(ValueError, match="exclude each other"):
        RunFolder.create("a", out=run.path, restart=True, overwrite=True)


def test_names_of_the_contract(tmp_path: Path) -> None:
    run = RunFolder(tmp_path)
    files = (
        run.history, run.probes, run.trajectory, run.statics, run.string_series, run.well, run.summary,
        run.checkpoint, run.case,
    )  # fmt: skip
    assert [file.name for file in files] == [
        "history.csv", "probes.csv", "trajectory.csv", "statics.csv", "string.pvd", "well.vtu",
        "summary.json", "checkpoint.h5", "case.yaml",
    ]  # fmt: skip


def test_a_case_name_that_would_leave_the_results_folder_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="no folder name"):
        RunFolder.create("../outside", results=tmp_path / "results")
    assert list(tmp_path.iterdir()) == []
