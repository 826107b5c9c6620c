"""A top drive with motor, hoist, heave and an autodriller that drills: restarts bit for bit, and several ranks."""

from __future__ import annotations

from pathlib import Path

import pytest

from drillpetsc import load_case
from drillpetsc.analysis.transient import run
from tests.helpers.ranks import FIXED, runs_on_ranks, same_histories
from tests.parallel.test_restart import files, run_with_copies

#: the autodriller begins at 0.04 s, its set point bends at 0.06 s; the torque is a sample
CASE = """
well:
  survey: {md: [0 m, 60 m], inclination: [10 deg, 25 deg], azimuth: [0 deg, 10 deg]}
  sections: [{to: 60 m, kind: casing, diameter: 215.9 mm, friction: 0.2}]
string:
  - {kind: pipe, length: 40 m, od: 127 mm, id: 108.6 mm, element_length: 10 m}
  - {kind: pipe, length: 19.5 m, od: 171.5 mm, id: 71.4 mm, element_length: 6.5 m, eccentricity: 3 mm}
  - {kind: bit, length: 0.5 m, od: 215.9 mm, mass: 60 kg}
top:
  kind: top_drive
  rotation: 60 rpm
  motor: {inertia: 300 kg m2, max_torque: 20 kN m}
  control: {kind: stiff}
  lowering: 5 mm/s
  hoist:
    block_mass: 25 t
    line: {diameter: 35 mm}
    heave: {amplitude: 0.1 m, period: 3 s, compensation: 0.9}
  autodriller: {mode: [wob, rop, torque], wob: {time: [0 s, 60 ms, 1 s], value: [12 kN, 15 kN, 15 kN]}, rop: 30 m/h, torque: 3 kN m,
                measure: MEASURE, filter: 20 ms, sample: SAMPLE, ramp: 100 kN/s, from: 40 ms}
bottom: {kind: bit, friction: 0.2}
formation: {drillability: 2.8e-8 m/(s N), bit_law: {kind: rop}}
initial: {wob: 10 kN}
time: {end: 0.1 s}
petsc: {q_snes_stol: 1.0e-10}
output: {history_every: 5 ms, field_every: 50 ms, checkpoint_every: 7 ms}
"""


def written(folder: Path, measure: str, sample: str) -> Path:
    """The case in a file."""
    path = folder / f"{measure}.yaml"
    path.write_text(CASE.replace("MEASURE", measure).replace("SAMPLE", sample))
    return path


@pytest.mark.parametrize(("measure", "sample"), [("surface", "0 s"), ("bit", "4 ms")])
def test_restarts_reproduce_the_run(measure, sample, tmp_path, monkeypatch):
    case = written(tmp_path, measure, sample)
    copies = run_with_copies(case, tmp_path / "run", monkeypatch)
    whole = files(tmp_path / "run")
    for copy in copies[:: max(1, len(copies) // 6)]:
        run(load_case(case), copy, restart=True, progress="silent")
        assert files(copy) == whole


@pytest.mark.parallel
def test_ranks_agree(tmp_path):
    """Fixed steps on two and three ranks, against one.  The error of the speed is a small difference of large numbers."""
    case = written(tmp_path, "bit", "0 s")
    one = same_histories(runs_on_ranks(case, tmp_path, FIXED), without=("speed_error",))
    assert set(one["autodriller_mode [-]"]) >= {0.0, 1.0}


@pytest.mark.parallel
def test_ranks_agree_on_steps_that_adapt(tmp_path):
    """The local error is a difference of positions whose rounding, 1e-14 m, is 1e-4 of the first errors: steps differ as much."""
    case = written(tmp_path, "bit", "0 s")
    same_histories(runs_on_ranks(case, tmp_path, []), share=1e-5)
