"""Controllers in Python, loops of an autodriller, surge runs and runs of the stability map on several ranks; an FMU on one alone."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

from drillpetsc.output import read_table
from tests.helpers.mpi import have_mpi, run_mpi

pytestmark = [pytest.mark.parallel, pytest.mark.skipif(not have_mpi(), reason="no mpirun")]
COMMAND = Path(__file__).parent / "run_command.py"
LAW = """
def pi(t, measured, memory):
    error = measured["set_point"] - measured["top_speed"]
    memory["integral"] = memory.get("integral", 0.0) + 0.01 * error
    return 8e3 * error + 12e3 * memory["integral"]
"""
PYTHON = """
string: [{kind: pipe, length: 60 m, od: 127 mm, id: 108.6 mm, element_length: 10 m}]
top:
  kind: top_drive
  rotation: {ramp: 0.2 s, value: 60 rpm}
  motor: {inertia: 2900 kg m2}
  control: {kind: python, function: laws.pi, sample: 10 ms}
initial: {from: rest}
time: {end: 0.3 s}
output: {history_every: 0.05 s}
"""
DRILLING = """
well:
  survey: {md: [0 m, 60 m], inclination: [2 deg, 2 deg], azimuth: [0 deg, 0 deg]}
  sections: [{to: 60 m, kind: open_hole, diameter: 215.9 mm, friction: 0.2}]
string:
  - {kind: pipe, length: 59.7 m, od: 171 mm, id: 71 mm, element_length: 6 m}
  - {kind: bit, length: 0.3 m, od: 215.9 mm, mass: 60 kg}
material: {damping: {stiffness: 1.0e-3 s}}
bottom: {kind: bit, friction: 0.3}
formation: {drillability: 4e-8, rotary_exponent: 0}
initial: {from: statics, wob: 2 kN}
"""
LOOP = """
top:
  kind: top_drive
  rotation: 60 rpm
  hoist: {block_mass: 25 t, lines: 10, line: {diameter: 35 mm}, height: 20 m}
  autodriller: {wob: 2 kN, measure: bit}
"""
SURGE = """
well:
  survey: {md: [0 m, 400 m], inclination: [0 deg, 0 deg], azimuth: [0 deg, 0 deg]}
  sections: [{to: 400 m, kind: open_hole, diameter: 215.9 mm, friction: 0.2}]
string: [{kind: pipe, length: 300 m, od: 127 mm, id: 108.6 mm, element_length: 50 m}]
top: clamped
bottom: free
fluid: {density: 1200 kg/m3, rheology: {model: newtonian, viscosity: 20 mPa s}, flow_rate: 0 l/s}
"""
CASES = [
    (PYTHON, ["run"], 2, "history.csv"),
    (PYTHON + "petsc: {ts_type: alpha2}\n", ["run"], 3, "history.csv"),
    (DRILLING + LOOP, ["linearise", "--inputs", "top.autodriller.wob", "--outputs", "hook_load"], 3, ""),
    (DRILLING + LOOP, ["campbell", "--speeds", "30,60rpm", "--count", "3"], 3, "campbell.csv"),
    (SURGE, ["surge", "--speeds", "0.3 m/s", "--operation", "trip_in", "--pipe", "closed", "--dynamic"], 2, "surge.csv"),
    (
        # without contact: friction against a string that turns makes its bending grow from rounding
        DRILLING.replace("2 deg, 2 deg", "0 deg, 0 deg") + "contact: none\ntop: {kind: top_drive, rotation: 60 rpm}",
        ["stability", "--speeds", "60rpm", "--wob", "2 kN", "--count", "2", "--kind", "torsional", "--method", "time", "--duration", "1 s"],
        2,
        "stability_runs.csv",
    ),
]  # fmt: skip


@pytest.mark.parametrize(
    ("text", "words", "ranks", "file"),
    CASES,
    ids=["python", "python with alpha", "loop", "campbell", "surge", "runs"],
)
def test_one_and_several_ranks(text, words, ranks, file, tmp_path, monkeypatch):
    """Numbers of one rank and of several agree within 1e-6 of the largest of their column."""
    (tmp_path / "case.yaml").write_text(text)
    (tmp_path / "laws.py").write_text(LAW)
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([os.environ.get("PYTHONPATH", ""), str(tmp_path)]))
    for n, out in ((1, "one"), (ranks, "many")):
        run_mpi(n, COMMAND, [words[0], str(tmp_path / "case.yaml"), *words[1:], "--out", str(tmp_path / out)])
    if not file:
        one, many = (np.load(tmp_path / out / "linear.npz")["response"] for out in ("one", "many"))
        assert many == pytest.approx(one, abs=1e-6 * np.abs(one).max())
        return
    one, many = (read_table(tmp_path / out / file) for out in ("one", "many"))
    assert list(one) == list(many)
    for name, values in one.items():
        if values.dtype.kind == "f" and not name.startswith(("energy_error", "step", "wall")):
            assert many[name] == pytest.approx(
                values, abs=1e-6 * max(np.nanmax(np.abs(values), initial=0.0), 1e-9), nan_ok=True
            ), name
        elif values.dtype.kind != "f":
            assert (many[name] == values).all(), name


def test_an_fmu_is_written_on_one_rank(tmp_path):
    """Refused before anything is written, by all ranks."""
    (tmp_path / "case.yaml").write_text(DRILLING + LOOP)
    with pytest.raises(AssertionError) as error:
        run_mpi(2, COMMAND, ["fmu", str(tmp_path / "case.yaml"), "--out", str(tmp_path / "well.fmu")])
    assert "one rank: an FMU" in str(error.value)
    assert not (tmp_path / "well.fmu").exists()
