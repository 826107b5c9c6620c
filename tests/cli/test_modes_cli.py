"""The command `drillpetsc modes`."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from drillpetsc.output import read_frame, read_table
from tests.helpers.command import drillpetsc, succeeds

CASE = """
title: Hanging collar in mud
well:
  survey: {md: [0 m, 220 m], inclination: [0 deg, 0 deg], azimuth: [0 deg, 0 deg]}
  sections: [{to: 220 m, kind: casing, diameter: 300 mm, friction: 0.2}]
string:
  - {kind: pipe, length: 200 m, od: 127 mm, id: 108.6 mm, element_length: 10 m}
material: {damping: {stiffness: 1.0e-4 s}}
top: {kind: top_drive, rotation: 60 rpm}
fluid:
  swirl: none  # it feeds forward whirl here
  density: 1200 kg/m3
  rheology: {model: newtonian, viscosity: 10 mPa s}
  flow_rate: 10 l/s
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    """A folder with the case, its dry twin, and the modes of the case in run/."""
    folder = tmp_path_factory.mktemp("modes")
    (folder / "wet.yaml").write_text(CASE)
    (folder / "dry.yaml").write_text(CASE.split("fluid:")[0])
    done = succeeds("modes wet.yaml --out run --count 8", cwd=folder)
    assert "rotation at 60 rpm" in done.stdout and "results: run" in done.stdout
    return folder


def test_run_folder(folder):
    """The table, the summary and one shape for each row; frequencies ascend; the string in mud is stable."""
    run, table = folder / "run", read_table(folder / "run" / "modes.csv")
    for name in ("summary.json", "case.yaml", "string.pvd", "well.vtu", "trajectory.csv"):
        assert (run / name).exists(), name
    count = len(table["mode [-]"])
    assert np.sum(table["frequency [Hz]"] > 0) >= 8 and np.all(np.diff(table["frequency [Hz]"]) >= 0)
    assert sorted(f.name for f in (run / "modes").iterdir()) == [
        f"mode_{k:02d}.vtu" for k in range(1, count + 1)
    ]
    data = read_frame(run / "modes" / "mode_01.vtu").point_data
    assert {
        "displacement [m]",
        "spin_angle [rad]",
        "bore_pressure [Pa]",
        "annulus_flow_imaginary [m3/s]",
    } <= set(data)
    summary = json.loads((run / "summary.json").read_text())
    assert summary["stable"] and summary["margin"] < 0 and summary["modes"] == count
    assert summary["rotation"] == pytest.approx(2 * np.pi)


def test_modes_of_one_kind(folder):
    """--kind fluid leaves the lateral ones out.  Bore (closed by the pump) and annulus (open) of one length
    and areas A1, A2: tan^2(2 pi f L/a) = A2/A1, with 1291 m/s in the mud alone lowered by the walls' give, at
    most by a tenth."""
    succeeds("modes wet.yaml --out fluid --kind fluid --count 3", cwd=folder)
    table = read_table(folder / "fluid" / "modes.csv")
    assert set(table["kind [-]"]) == {"fluid"}
    phase = np.arctan(np.sqrt((0.3**2 - 0.127**2) / 0.1086**2))
    alone = phase * np.sqrt(2e9 / 1200) / (2 * np.pi * 200)
    lowest = table["frequency [Hz]"][table["frequency [Hz]"] > 0][0]
    assert 0.9 * alone < lowest < alone


def test_rest_and_nearest(folder):
    """--about rest has no rotation; --shift finds the torsion of a pipe held at the top, f =
    sqrt(G/rho)/4L."""
    wave = np.sqrt(206e9 / 2.6 / 7850) / 800
    done = succeeds(
        "modes dry.yaml --out near --about rest --shift",
        f"{wave:.4f}",
        "--count",
        "2",
        cwd=folder,
    )
    assert "modes about rest" in done.stdout
    table = read_table(folder / "near" / "modes.csv")
    here = list(table["kind [-]"]).index("torsional")
    assert table["frequency [Hz]"][here] == pytest.approx(wave, rel=1e-4)
    assert table["damping_ratio [-]"][here] == pytest.approx(1e-4 * np.pi * wave, rel=1e-3)


@pytest.mark.parametrize(
    "words, message",
    [
        (("--count", "0"), "--count"),
        (("--shift", "1", "--kind", "axial"), "--shift"),
        (("--kind", "sideways"), "sideways"),
        (("--out", "run"), "run"),
    ],
)
def test_bad_words(folder, words, message):
    answer = drillpetsc("modes wet.yaml", *words, cwd=folder)
    assert answer.returncode == 2 and message in answer.stderr
    assert "Traceback" not in answer.stderr
