"""`--units` and the units of a case: figures on the screen and in pictures; files stay in SI."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from drillpetsc.cli import main
from drillpetsc.output.files.tables import read_table
from drillpetsc.plotting import style
from tests.helpers.command import main_succeeds

FOOT, LBF = 0.3048, 4.4482216152605

CASE = """
units: field
well:
  survey: {md: [0, 1000], inclination: [0, 0], azimuth: [0, 0]}
  sections: [{kind: open_hole, diameter: 8 1/2}]
string:
  - {kind: pipe, length: 990, od: 5, id: 4.276, element_length: 33}
top: {kind: top_drive, rotation: 0}
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "case.yaml").write_text(CASE)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_check_in_units(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    main_succeeds("check", "case.yaml")
    assert "990 ft" in capsys.readouterr().out
    main_succeeds("check", "case.yaml", "--units", "metric")
    assert f"{990 * FOOT:g} m" in capsys.readouterr().out


def test_statics_prints_units_and_writes_si(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Hook load: 17.93 lb/ft times 990 ft in air, 7850 kg/m3 (section 3.3996 A)."""
    weight = 7850 * np.pi / 4 * (0.127**2 - (4.276 * 0.0254) ** 2) * 990 * FOOT * 9.80665
    for units, size, text in (
        ("", 1e3 * LBF, "klbf"),
        ("SI", 1.0, "N"),
        ("metric_t", 9806.65, "t"),
        ("metric", 1e3, "kN"),
    ):
        main_succeeds("statics", "case.yaml", "--out", f"run-{units}", *(["--units", units] if units else []))
        row = next(line.split() for line in capsys.readouterr().out.splitlines() if "hook load" in line)
        assert row[-1] == text and float(row[-2]) == pytest.approx(weight / size, rel=2e-3)
        summary = json.loads((folder / f"run-{units}" / "summary.json").read_text())
        assert summary["hook_load"] == pytest.approx(weight, rel=2e-3)
        assert max(read_table(folder / f"run-{units}" / "statics.csv")["md [m]"]) == pytest.approx(990 * FOOT)
        assert style.units_of_run(folder / f"run-{units}" / "case.yaml") == (units or "field")


def test_pictures_have_the_units_of_the_case(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from drillpetsc.plotting.run import plot

    seen: list[str] = []
    drawn = plot._along_depth

    def spy(table: dict[str, np.ndarray], title: str) -> object:
        drawing = drawn(table, title)
        axes = drawing.axes
        seen.extend([axes[0].get_ylabel(), *(one.get_xlabel() for one in axes)])
        seen.append(f"{axes[0].get_ylim()[0]:.1f}")
        return drawing

    monkeypatch.setattr(plot, "_along_depth", spy)
    main_succeeds("statics", "case.yaml", "--out", "run")
    main_succeeds("plot", "run")
    assert seen[0] == "Measured depth [ft]" and seen[-1] == "990.0"
    assert any("[klbf]" in text for text in seen) and any("[kft-lbf]" in text for text in seen)
    assert any(text.startswith("Bending stress") and "[ksi]" in text for text in seen)
    seen.clear()
    main_succeeds("plot", "run", "--units", "metric")
    assert seen[0] == "Measured depth [m]" and any("[kN]" in text for text in seen)
    assert style.UNITS.get() is None


def test_a_case_without_units_keeps_its_display(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "si.yaml").write_text("string: [{kind: pipe, length: 90, od: 0.127, id: 0.1}]\ntop: clamped\n")
    main_succeeds("statics", "si.yaml", "--out", "run")
    row = next(line.split() for line in capsys.readouterr().out.splitlines() if "hook load" in line)
    assert row[-1] == "N"
    assert "units" not in (folder / "run" / "case.yaml").read_text()


def test_units_of_several_cases_are_their_own(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "case.yaml", "case.yaml", "--units", "field"]) == 2
    assert "one case" in capsys.readouterr().err


def test_a_sweep_tells_the_units_of_bare_values(folder: Path) -> None:
    """10 and 11 are ppg in a case in field units: the table must not call them kg/m3."""
    fluid = "fluid: {density: 10, flow_rate: 100, rheology: {pv: 20, yp: 10}}\ntime: {end: 0.01}\n"
    (folder / "wet.yaml").write_text(CASE + fluid)
    main_succeeds("sweep", "wet.yaml", "fluid.density=10,11", "--out", "sweep", "--progress", "silent")
    lines = (folder / "sweep" / "sweep.csv").read_text().splitlines()
    head, row = lines[0].split(","), lines[2].split(",")
    assert row[head.index("fluid.density")] == "11 ppg"
    assert float(row[head.index("fluid.density (SI)")]) == pytest.approx(11 * 119.826427)


def test_notes_are_in_the_units_of_the_option(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """What `roadmap` assumes for a metric case, and its depths, in ft, ft/min and kft-lbf alone: 18.29 m/min is 60 ft/min."""
    metric = (
        CASE.replace("units: field", "units: metric")
        .replace("8 1/2", "216")
        .replace("id: 4.276", "id: 108.6")
    )
    metric = metric.replace("od: 5", "od: 127").replace("md: [0, 1000]", "md: [0, 1100]")
    (tmp_path / "case.yaml").write_text(metric.replace("element_length: 33", "element_length: 30"))
    monkeypatch.chdir(tmp_path)
    main_succeeds("roadmap", "case.yaml", "--units", "field", "--out", "r")
    screen = capsys.readouterr()
    notes = [line for line in screen.out.splitlines() if "note:" in line]
    assert any("trip_speed 60 ft/min assumed" in note for note in notes)
    for note in notes:
        assert not {"m", "m,", "m:", "m/min", "m/h", "kN", "kN m"} & set(note.split()), note
