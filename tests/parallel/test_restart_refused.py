"""A restart is refused, with the reason, where the run cannot be continued as it was begun."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pytest
from petsc4py import PETSc

from drillpetsc import version
from drillpetsc.analysis.motion import checkpoint, provenance, summary
from drillpetsc.analysis.motion.transient import run
from drillpetsc.case import load_case
from drillpetsc.errors import CaseError
from drillpetsc.output import read_table
from tests.helpers.restarts import files
from tests.helpers.tables import each_row

CASE = """
string: [{kind: pipe, length: 30 m, od: 127 mm, id: 108.6 mm, element_length: 10 m}]
top: {kind: top_drive, rotation: 60 rpm}
time: {end: 20 ms}
output: {history_every: 1 ms, field_every: 5 ms, probes: [10 m]}
"""


@pytest.fixture(scope="module")
def done(tmp_path_factory) -> Path:
    """A finished run of 20 ms, in run/ beside its case.yaml."""
    folder = tmp_path_factory.mktemp("refused")
    (folder / "case.yaml").write_text(CASE)
    return run(load_case(folder / "case.yaml"), folder / "run", progress="silent").folder


def restarted(done: Path, tmp_path: Path, text: str = CASE, **keywords):
    """Restart a copy of the run with the case ``text``; the copy is tmp_path/run."""
    if not (tmp_path / "run").exists():
        shutil.copytree(done, tmp_path / "run")
    (tmp_path / "case.yaml").write_text(text)
    return run(
        load_case(tmp_path / "case.yaml"), tmp_path / "run", restart=True, progress="silent", **keywords
    )


@pytest.mark.parametrize(
    "change, words",
    [
        (("60 rpm", "90 rpm"), ["top.rotation: 6.283185", "-> 9.424777"]),  # 2 pi and 3 pi rad/s
        (("id: 108.6 mm", "id: 100 mm"), ["string[0].id: 0.1086 -> 0.1"]),
        (("output:", "petsc: {ts_rtol: 1.0e-3}\noutput:"), ["petsc option -ts_rtol: absent -> 0.001"]),
        (("probes: [10 m]", "probes: [20 m]"), ["output.probes[0]: 10 -> 20"]),
        (("60 rpm}", "60 rpm}\ngravity: 0 m/s2"), ["gravity", "9.80665 -> 0"]),
    ],
)
def test_a_changed_case_is_refused_with_the_changed_keys(change, words, done, tmp_path):
    text = CASE.replace("end: 20 ms", "end: 40 ms").replace(*change)
    with pytest.raises(CaseError) as refusal:
        restarted(done, tmp_path, text)
    message = str(refusal.value)
    assert all(
        word in message
        for word in [*words, "--accept-changes", "changed since the checkpoint (numbers in SI units)"]
    )
    assert "time.end:" not in message.split("allowed:")[0]
    assert files(tmp_path / "run") == files(done)


def test_accepted_changes_are_recorded(done, tmp_path):
    """A finer tolerance from 20 ms on: the summaries of the continued run and of its own continuation say so."""
    text = CASE.replace("end: 20 ms", "end: 30 ms") + "petsc: {ts_rtol: 1.0e-5}\n"
    result = restarted(done, tmp_path, text, accept_changes=True)
    assert result.summary["accepted_changes"] == ["at 0.02 s: petsc option -ts_rtol: absent -> 1e-05"]
    assert any("accepted at a restart act at once" in w for w in result.summary["warnings"])
    assert result.summary["time"] == pytest.approx(0.03)
    again = restarted(done, tmp_path, text.replace("30 ms", "40 ms"))
    assert again.summary["accepted_changes"] == result.summary["accepted_changes"]
    assert "0.04" in (tmp_path / "run" / "case.yaml").read_text()


def test_intervals_of_output_and_a_later_end_may_change(done, tmp_path):
    """Rows every 1 ms up to 20 ms, every 4 ms from there; a second continuation finds its rows complete."""
    text = CASE.replace("end: 20 ms", "end: 30 ms").replace("history_every: 1 ms", "history_every: 4 ms")
    restarted(done, tmp_path, text.replace("field_every: 5 ms", "field_every: 8 ms"))
    restarted(
        done, tmp_path, text.replace("field_every: 5 ms", "field_every: 8 ms").replace("30 ms", "31 ms")
    )
    times = read_table(tmp_path / "run" / "history.csv")["time [s]"]
    assert times == pytest.approx([*np.arange(21) * 1e-3, 0.024, 0.028])


def test_an_end_before_the_checkpoint_is_refused(done, tmp_path):
    with pytest.raises(CaseError) as refusal:
        restarted(done, tmp_path, CASE.replace("end: 20 ms", "end: 10 ms"), accept_changes=True)
    message = str(refusal.value)
    assert "time.end" in message and "0.01 s" in message and "at least 0.02 s" in message


def test_an_end_before_the_checkpoint_is_told_with_the_changed_keys(done, tmp_path):
    """Both reasons at once, and no hint to accept changes that would be refused after all."""
    text = CASE.replace("end: 20 ms", "end: 10 ms") + "gravity: 9.7 m/s2\n"
    with pytest.raises(CaseError) as refusal:
        restarted(done, tmp_path, text)
    message = str(refusal.value)
    assert "gravity" in message and "at least 0.02 s" in message
    assert "--accept-changes continues" not in message


def test_a_deleted_checkpoint_is_refused(done, tmp_path):
    """A finished run whose checkpoint is gone was run again from its start, over its results."""
    shutil.copytree(done, tmp_path / "run")
    (tmp_path / "run" / "checkpoint.h5").unlink()
    before = files(tmp_path / "run")
    with pytest.raises(CaseError, match=r"(?s)checkpoint.h5.*no such file"):
        restarted(done, tmp_path, CASE.replace("end: 20 ms", "end: 40 ms"))
    assert files(tmp_path / "run") == before


@pytest.mark.parametrize("name", ["history.csv", "probes.csv", "string.pvd", "string/000002.vtu"])
def test_a_deleted_file_is_refused(name, done, tmp_path):
    shutil.copytree(done, tmp_path / "run")
    (tmp_path / "run" / name).unlink()
    before = files(tmp_path / "run")
    with pytest.raises(CaseError) as refusal:
        restarted(done, tmp_path, CASE.replace("end: 20 ms", "end: 40 ms"))
    assert f"run/{name}" in str(refusal.value) and "no such file" in str(refusal.value)
    assert files(tmp_path / "run") == before


def test_a_history_that_ends_early_is_refused(done, tmp_path):
    shutil.copytree(done, tmp_path / "run")
    file = tmp_path / "run" / "history.csv"
    file.write_text("".join(file.read_text().splitlines(keepends=True)[:11]))  # the header and 0 to 9 ms
    with pytest.raises(CaseError, match=r"rows up to 0.009 s, not up to 0.02 s"):
        restarted(done, tmp_path, CASE.replace("end: 20 ms", "end: 40 ms"))


def test_another_version_of_drillpetsc_is_refused(done, tmp_path, monkeypatch):
    monkeypatch.setattr(provenance, "__version__", "99.1")
    text = CASE.replace("end: 20 ms", "end: 25 ms")
    with pytest.raises(CaseError, match=f"version of drillpetsc: {version.__version__} -> 99.1"):
        restarted(done, tmp_path, text)
    restarted(done, tmp_path, text, accept_changes=True)


def test_another_petsc_continues_with_a_warning(done, tmp_path):
    shutil.copytree(done, tmp_path / "run")
    file = tmp_path / "run" / "checkpoint.h5"
    c = checkpoint.read(file)
    c.provenance["versions"]["petsc"] = "3.0.1"
    checkpoint.write(file, c)
    result = restarted(done, tmp_path, CASE.replace("end: 20 ms", "end: 25 ms"))
    assert any("its checkpoint was written with petsc 3.0.1" in text for text in result.summary["warnings"])


def test_a_finished_run_has_nothing_left(done, tmp_path):
    """The summary of the run stays; the report says that the run had already ended."""
    result = restarted(done, tmp_path)
    lines = summary.closing_lines(result.summary, result.folder)
    assert "the run had already reached its end" in lines[0] and "simulated" not in "\n".join(lines)
    assert (tmp_path / "run" / "summary.json").read_bytes() == (done / "summary.json").read_bytes()


def test_provenance_stands_in_checkpoint_and_summary(done):
    """The digest is that of an independent serialisation of the case, and differs for another case."""
    import hashlib

    case = load_case(done.parent / "case.yaml")
    kept = checkpoint.read(done / "checkpoint.h5").provenance
    summary = json.loads((done / "summary.json").read_text())
    expected = hashlib.sha256(json.dumps(kept["case"], sort_keys=True).encode()).hexdigest()
    assert summary["case_digest"] == kept["case_digest"] == expected
    assert kept["case"]["string"][0]["od"] == 0.127 and kept["case"]["time"]["end"] == 0.02
    assert kept["versions"] == summary["versions"]
    assert summary["versions"]["petsc"] == ".".join(map(str, PETSc.Sys.getVersion()))
    other = case.model_copy(update={"title": "another"})
    assert provenance.digest(other) != kept["case_digest"]


@each_row(
    "what, words",
    [
        ("damaged", "a damaged line 9, after 7 of 21 rows"),
        ("shortened", "a damaged line 9, after 7 of 21 rows"),
        ("twice", "22 rows up to 0.02 s, 21 were written"),
        ("swapped", "in another order"),
        ("changed", "rows that are changed"),
        ("removed", "20 rows up to 0.02 s, 21 were written"),
    ],
)
def test_rows_that_are_not_those_of_the_run(what, words, done, tmp_path):
    """No row is lost at a restart without a word: rows and their digest stand in the checkpoint."""
    folder = tmp_path / what
    shutil.copytree(done, folder)
    for name in ("history.csv", "probes.csv"):
        lines = (done / name).read_text().splitlines(keepends=True)
        if what == "damaged":
            lines[8] = lines[8].replace(",", ";")
        elif what == "shortened":
            lines[8] = lines[8].split(",")[0] + "\n"
        elif what == "twice":
            lines.insert(8, lines[8])
        elif what == "swapped":
            lines[8], lines[9] = lines[9], lines[8]
        elif what == "changed":
            first, _, rest = lines[8].partition(",")
            lines[8] = f"{first},1{rest}"
        else:
            del lines[8]
        (folder / name).write_text("".join(lines))
        before = files(folder)
        (tmp_path / "later.yaml").write_text(CASE.replace("end: 20 ms", "end: 40 ms"))
        with pytest.raises(CaseError) as refusal:
            run(load_case(tmp_path / "later.yaml"), folder, restart=True, progress="silent")
        assert (
            name in str(refusal.value)
            and words in str(refusal.value)
            and "copy of the run folder" in str(refusal.value)
        )
        assert files(folder) == before
        shutil.copy(done / name, folder / name)
