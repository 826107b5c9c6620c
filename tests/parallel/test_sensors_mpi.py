"""Samples of sensors after a signal between two checkpoints; `matrix.py` has them on several ranks."""

from __future__ import annotations

import os
import signal
from pathlib import Path

import pytest

from drillpetsc import load_case, run
from drillpetsc.errors import Interrupted
from drillpetsc.output.sensors.sensors import Sensors

CASE = """
string:
  - {kind: pipe, name: upper, length: 2 m, od: 127 mm, id: 108.6 mm, element_length: 0.5 m}
  - {kind: body, name: sub, length: 0.3 m, mass: 40 kg, od: 150 mm}
  - {kind: pipe, name: lower, length: 1 m, od: 127 mm, id: 108.6 mm, element_length: 0.5 m}
top: {kind: top_drive, rotation: {time: [0 s, 0.2 s], value: [120 rpm, 60 rpm]}}
initial: {from: statics, inclination: 90 deg}
fluid:
  density: 1200 kg/m3
  rheology: {model: newtonian, viscosity: 1 mPa s}
  flow_rate: {ramp: 0.2 s, value: 5 l/s}
  annulus: false
loads: [{at: 3 m, force: [0, 0, 50 N], value_over: {time: [0 s, 0.1 s, 0.1 s, 1 s], value: [0, 0, 1, 1]}}]
time: {end: 0.3 s}
output:
  checkpoint_every: 0.1 s
  sensors:
    - name: filtered
      at: 1.3 m
      rate: 400 Hz
      radius: 50 mm
      filter: {cutoff: 50 Hz, order: 4}
      channels: [ax, ay, az, rpm, torque, wob, bending, pressure]
    - {name: in-the-sub, at: sub, rate: 333 Hz, radius: 60 mm}
    - {name: lowest, at: 3.3 m, rate: 100 Hz, channels: [ay, rpm]}
"""
NAMES = ("filtered", "in-the-sub", "lowest")


@pytest.fixture(scope="module")
def whole(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("sensors")
    (folder / "case.yaml").write_text(CASE)
    run(folder / "case.yaml", folder / "whole", progress="silent")
    return folder / "whole"


@pytest.mark.parametrize("at", [0.04, 0.17, 0.23])
def test_a_signal_does_not_change_the_samples(whole, at, monkeypatch, tmp_path):
    """SIGTERM between two checkpoints, restarted: the files are those of a run that was not stopped, byte for byte."""
    original, sent = Sensors.step, []

    def step(self, t: float, dt: float, fresh: bool) -> bool:
        if t > at and not sent:
            sent.append(t)
            os.kill(os.getpid(), signal.SIGTERM)
        return original(self, t, dt, fresh)

    monkeypatch.setattr(Sensors, "step", step)
    case = load_case(whole.parent / "case.yaml")
    with pytest.raises(Interrupted):
        run(case, tmp_path / "r", progress="silent")
    run(case, tmp_path / "r", restart=True, progress="silent")
    for name in NAMES:
        file = Path("sensors") / f"{name}.csv"
        assert (tmp_path / "r" / file).read_bytes() == (whole / file).read_bytes()
