"""Rows of a run wait to be written together, but not for long."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from drillpetsc.output.files import run_writer
from drillpetsc.output.files.run_folder import RunFolder
from drillpetsc.output.files.run_writer import RunWriter
from drillpetsc.output.recorder import Recorder
from tests.helpers.motion import beam, straight


class Errors:
    def report_write_error(self, error: OSError, what: str) -> None:
        raise AssertionError(what)


@pytest.fixture
def writer(tmp_path):
    model = straight(
        string=[beam(10.0, 2, 1e8, 1e6, 1e6, 100.0, 1.0)],
        top={"kind": "top_drive", "rotation": 0.0},
        bottom="free",
        contact="none",
        time={"end": 1.0},
        output={"history_every": 0.01, "field_every": 10.0, "probes": [5.0]},
    )
    recorder = Recorder(model)
    recorder.start(0.0)
    made = RunWriter(model, recorder, RunFolder.create("run", tmp_path / "run", overwrite=True), None)
    yield made
    made.close()


def rows(writer: RunWriter) -> int:
    text = writer.folder.history.read_text()  # type: ignore[union-attr]
    assert text.count("\n") == writer.folder.probes.read_text().count("\n")  # type: ignore[union-attr]
    return text.count("\n") - 1


def test_rows_wait_for_others_but_not_long(writer, monkeypatch):
    """A step without output writes those that have waited long enough; a flush and the end write all."""
    now = SimpleNamespace(monotonic=lambda: now.time, time=100.0)
    monkeypatch.setattr(run_writer, "clock", now)
    writer._written = now.time
    writer.write(0.0, 0.0, 0, Errors())
    writer.write(0.011, 0.01, 1, Errors())
    assert rows(writer) == 0
    assert not writer.write(0.012, 0.001, 1, Errors())
    assert rows(writer) == 0
    now.time += 1.1 * run_writer.ROWS_WAIT
    assert not writer.write(0.013, 0.001, 1, Errors())
    assert rows(writer) == 2
    writer.write(0.021, 0.01, 1, Errors())
    assert rows(writer) == 2
    writer.flush()
    assert rows(writer) == 3
    writer.write(0.031, 0.01, 1, Errors())
    writer.close()
    assert rows(writer) == 4


def test_many_rows_are_written_at_once(writer, monkeypatch):
    monkeypatch.setattr(run_writer, "ROWS_WAIT", 1e9)
    count = run_writer.ROWS_AT_ONCE
    for k in range(count - 1):
        writer.write(0.01 * k + 1e-3, 0.01, 1, Errors())
    assert rows(writer) == 0
    writer.write(0.01 * (count - 1) + 1e-3, 0.01, 1, Errors())
    assert rows(writer) == count
    times = np.loadtxt(writer.folder.history, delimiter=",", skiprows=1)[:, 0]
    assert times == pytest.approx(0.01 * np.arange(count), abs=1e-12)
