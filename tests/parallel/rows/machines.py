"""Rows of the parallel matrix with a hoist, a top drive, a mud motor and a jar."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from tests.parallel.rows.row import Columns, Row, steps

#: the autodriller begins at 0.04 s, its set point bends at 0.06 s; the torque is a sample
HOIST = """
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


def hoist(measure: str, sample: str, **row: Any) -> Row:
    return Row(HOIST.replace("MEASURE", measure).replace("SAMPLE", sample), **row)


def both_modes(folders: list[Path], history: Columns) -> None:
    assert set(history["autodriller_mode [-]"]) >= {0.0, 1.0}


#: the controller changes at 40 ms, the torque meets its limit before; the set point bends at 60 ms
TOP_DRIVE = """
well:
  survey: {md: [0 m, 60 m], inclination: [40 deg, 70 deg], azimuth: [0 deg, 10 deg]}
  sections: [{to: 60 m, kind: casing, diameter: 215.9 mm, friction: 0.2}]
string:
  - {kind: pipe, length: 30 m, od: 127 mm, id: 108.6 mm, element_length: 10 m}
  - {kind: pipe, length: 20 m, od: 171.5 mm, id: 71.4 mm, element_length: 10 m, eccentricity: 3 mm}
top:
  kind: top_drive
  rotation: {time: [0 s, 60 ms, 1 s], value: [60 rpm, 80 rpm, 80 rpm]}
  motor: {inertia: 300 kg m2, max_torque: 2 kN m, power: 30 kW, time_constant: 2 ms, torque_rate: 200 kN m/s}
  control:
    - {kind: z_torque, high_pass: 1 s}
    - {kind: soft_torque, damping: 4, frequency: 2 Hz, inertia_compensation: 0.5, delay: 4 ms, from: 40 ms}
bottom: free
time: {end: 0.1 s}
petsc: {q_snes_stol: 1.0e-10}
output: {history_every: 5 ms, field_every: 50 ms, checkpoint_every: 7 ms}
"""


def limited_and_changed(folders: list[Path], history: Columns) -> None:
    assert 0 < history["torque_limited [-]"].sum() < len(history["time [s]"])
    assert set(history["control_mode [-]"]) == {4.0, 3.0}


#: the joint of the motor lies between ranks of three; the rotor is out of balance
MUD_MOTOR = """
well:
  survey: {md: [0 m, 60 m], inclination: [40 deg, 45 deg], azimuth: [0 deg, 0 deg]}
  sections: [{to: 60 m, kind: open_hole, diameter: 215.9 mm, friction: 0.2}]
string:
  - {kind: pipe, length: 30 m, od: 127 mm, id: 108.6 mm, element_length: 10 m}
  - kind: pdm
    length: 29.7 m
    od: 171.5 mm
    id: 90 mm
    element_length: 10 m
    joint_at: 15.7 m
    bend: {angle: 0.5 deg, position: 20 m, tool_face: 40 deg}
    pdm: {rev_per_volume: 0.29 rev/gal, no_load_pressure: 0.6 MPa, stall_torque: 14 kN m, lobes: [5, 6], rotor_mass: 300 kg,
      eccentricity: 6 mm, rotor_inertia: 3 kg m2}
  - {kind: bit, length: 0.3 m, od: 215.9 mm, mass: 60 kg, nozzle_area: 400 mm2}
top: {kind: top_drive, rotation: {ramp: 0.5 s, value: 30 rpm}, lowering: 20 m/h}
bottom: {kind: bit}
fluid: {density: 1200 kg/m3, rheology: {model: newtonian, viscosity: 20 mPa s}, flow_rate: 25 l/s}
formation: {drillability: 4.0e-8}
initial: {from: statics, wob: 30 kN}
time: {end: 0.1 s}
petsc: {q_snes_stol: 1.0e-10}
output: {history_every: 5 ms, field_every: 50 ms, checkpoint_every: 7 ms}
"""


def motor_turns(folders: list[Path], history: Columns) -> None:
    assert 5 < history["motor_speed [rad/s]"].min() < history["motor_speed [rad/s]"].max() < 15
    assert np.ptp(history["tool_face [rad]"]) > 1e-4


#: meters, fires and hits
JAR = """
string:
  - {kind: pipe, length: 10 m, od: 177.8 mm, id: 71.4 mm, element_length: 5 m}
  - {kind: jar, length: 2 m, od: 177.8 mm, id: 71.4 mm, jar: {stroke: 40 mm, threshold: 15 kN, metering_stroke: 2 mm, metering_resistance: 100 kN s/m}}
  - {kind: pipe, length: 5 m, od: 177.8 mm, id: 71.4 mm, element_length: 5 m}
  - {kind: body, length: 0.5 m, mass: 2 t}
top: clamped
material: {damping: {stiffness: 1.0e-3}}
time: {end: 0.14 s}
petsc: {ts_type: KIND, q_snes_stol: 1.0e-11}
output: {history_every: 2 ms, field_every: 50 ms, checkpoint_every: 9 ms}
"""


def jar_hits(folders: list[Path], history: Columns) -> None:
    assert set(history["jar_state [-]"]) == {0, 1, 2} and history["jar_impact_force [N]"].max() > 1e5


def jar(kind: str, share: float) -> Row:
    """Generalised-alpha: 2e-5.  Its accelerations are differences of positions of 17 m, which are rounded to 2e-15 m, over half a step
    squared.  Up to an event it takes steps of 1 us: 4e-3 m/s2 of noise, 1e-5 of those of a shot.  How much of it a table shows hangs on the
    order of sums (1e-7 to 7e-6 were seen), not on Newton's tolerance.
    """
    return Row(JAR.replace("KIND", kind), (), share, 1e-3, restarts=slice(None, None, 3), shows=jar_hits)


ROWS = {
    # the error of the speed is a small difference of large numbers
    "hoist": hoist("bit", "0 s", ranks=steps("1e-3"), without=("speed_error",), shows=both_modes),
    "hoist, measured at surface": hoist("surface", "0 s", restarts=slice(None, None, 2)),
    "hoist, sampled at the bit": hoist("bit", "4 ms", restarts=slice(None, None, 2)),
    "top drive": Row(TOP_DRIVE, steps("1e-3"), restarts=slice(None, None, 2), shows=limited_and_changed),
    # a joint that carries no torque: its angles are rounding
    "mud motor": Row(
        MUD_MOTOR,
        steps("1e-3"),
        without=("joint_45.7_torque", "joint_45.7_angle", "joint_45.7_travel"),
        restarts=slice(None, None, 3),
        shows=motor_turns,
    ),
    "jar, bdf": jar("bdf", 1e-6),
    "jar, generalised alpha": jar("alpha2", 2e-5),
}
