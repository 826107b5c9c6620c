"""Rows of the parallel matrix: cases whose results must depend neither on the number of ranks nor on a restart.

A new tool adds one row; `test_matrix.py` runs them.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from drillpetsc.output import read_table
from drillpetsc.output.sensors.files import read_sensor
from tests.helpers import whole_string as whole
from tests.helpers.collar_in_mud import CASE as COLLAR_IN_MUD
from tests.helpers.ranks import OTHERWISE, run_here, same_histories
from tests.helpers.wells import simple_well
from tests.parallel import flow_rows as flow
from tests.parallel import sensor_rows as sensors
from tests.parallel.test_restart import CASE as WHIRL
from tests.verification import test_ends as ends
from tests.verification import test_sampled_law as sampled
from tests.verification.test_agitator import with_mud
from tests.verification.test_quaternion_scenes import MUD, ROCK, keys_of_scene
from tests.verification.test_reamer import reaming
from tests.verification.test_reamer_in_mud import in_mud

Columns = dict[str, np.ndarray]


def steps(length: str) -> tuple[str, ...]:
    """PETSc's options of fixed steps of ``length`` [s], with Newton's method to rounding."""
    return ("-ts_adapt_type", "none", "-ts_dt", length, "-q_snes_stol", "1e-12")


@dataclass(frozen=True)
class Row:
    """A case, what may differ between numbers of ranks, and the checkpoints from which it is restarted.

    case: text or keys of a case file.
    ranks: PETSc's options of the runs on 1, 2 and 3 ranks; None: no such runs.
    share, least, without: of `same_histories`.
    restarts: which of the checkpoints are continued; None: none.
    shows: asserts of run folders and the history of the first that the run does what its name says; called for both.
    begun: the runs go on from the state of one that is made first.
    """

    case: str | dict[str, Any]
    ranks: tuple[str, ...] | None = None
    share: float = 1e-7
    least: float = 0.0
    without: tuple[str, ...] = ()
    restarts: slice | None = None
    checkpoints: int = 3
    shows: Callable[[list[Path], Columns], object] = lambda folders, history: None
    begun: bool = False

    def written(self, folder: Path, name: str = "case") -> Path:
        """The case in a file."""
        path = folder / f"{name}.yaml"
        path.write_text(self.case if isinstance(self.case, str) else yaml.safe_dump(self.case))
        if self.begun and self.ranks is not None and not isinstance(self.case, str):
            run_here(path, folder / f"{name}-start", self.ranks)
            path.write_text(yaml.safe_dump(self.case | {"initial": {"from": str(folder / f"{name}-start")}}))
        return path


def summaries(folders: list[Path]) -> list[dict]:
    return [json.loads((folder / "summary.json").read_text()) for folder in folders]


def equal_steps(folders: list[Path]) -> None:
    """As many steps, and no start that is only found by relaxation on some ranks: such a one has many times the iterations."""
    found = summaries(folders)
    assert len({summary["steps"] for summary in found}) == 1
    starts = [summary["statics"]["iterations"] for summary in found if "statics" in summary]
    assert not starts or max(starts) <= 2 * min(starts)


# ---------------------------------------------------------------------- new hole
DRILLED = """
string:
  - {kind: pipe, length: 40.0, od: 0.127, id: 0.1086, element_length: 10}
  - {kind: bit, length: 0.2, od: 0.216, mass: 60}
well:
  survey: {md: [0, 40.2], inclination: [0.5, 0.5], azimuth: [1, 1]}
  sections: [{to: 40.2, kind: open_hole, diameter: 0.216, friction: 0.25}]
bottom: bit
contact: {stiffness: 1.0e+7}
formation: {node_spacing: 0.005, rock_anisotropy: {dip: 0.4, dip_azimuth: 2.5, index_dip: 0.9, index_strike: 0.95}, LAW}
top: {kind: top_drive, rotation: 12.0, lowering: 0.3}
initial: {from: straight}
time: {end: 0.1}
output: {history_every: 0.02, field_every: 0.1, item_forces: true}
"""
LAWS = {
    "rop": "drillability: 2.0e-6",
    "drag_bit": "bit_law: {kind: drag_bit, specific_energy: 3.0e+6, contact_stress: 3.0e+6}",
    "roller_cone": "drillability: 2.0e-6, bit_law: {kind: roller_cone, lobes: 2, amplitude: 1.0e-4, phase: 0.7}",
    "post_step": "drillability: 2.0e-6, growth: post_step",
    "cutting side": "drillability: 2.0e-6, strength: 5.0e+6",
    "of the user": "bit_law: {kind: python, function: tests.helpers.laws:warming}",
}


def same_hole(folders: list[Path], history: Columns) -> None:
    """The path of the hole is equal to rounding, and all ranks fix the same nodes of it."""
    path, *others = (read_table(folder / "trajectory.csv") for folder in folders)
    assert path["md [m]"][-1] > 40.202
    for other in others:
        for column, values in path.items():
            assert other[column] == pytest.approx(values, rel=1e-9, abs=1e-9), column
    equal_steps(folders)


#: 80 m in a hole that builds, with 20 kN on bit
BUILDING = """
well:
  survey: {md: [0, 80], inclination: [0.4, 0.55], azimuth: [1, 1]}
  sections: [{to: 80, kind: open_hole, diameter: 0.216, friction: 0.25}]
string:
  - {kind: pipe, length: 50, od: 0.127, id: 0.1086, element_length: 10}
  - {kind: pipe, length: 29.7, od: 0.1715, id: 0.0714, element_length: 5}
  - {kind: bit, length: 0.3, od: 0.216, mass: 60, nozzle_area: 4.0e-4}
bottom: bit
formation: {rock_anisotropy: {dip: 0.4, dip_azimuth: 2.5, index_dip: 0.95}, LAW}
initial: {from: statics, wob: 20.0e+3}
"""
QUASI_STATIC = """
time: {end: 40, mode: quasi_static}
output: {history_every: 2, field_every: 20, checkpoint_every: 6}
fluid: {density: 1200, rheology: {model: newtonian, viscosity: 0.02}, bulk_modulus: 2.0e+9, flow_rate: 0.02, cuttings: returned}
top: {kind: top_drive, rotation: 12.0, lowering: 3.0e-3}
"""
MOTION = """
time: {end: 0.12}
output: {history_every: 0.01, field_every: 0.04, checkpoint_every: 0.015}
top: {kind: top_drive, rotation: 12.0, lowering: 0.1}
"""
LAYERED = "drillability: 5.0e-8, node_spacing: 0.02, layers: [{from: 80.03, drillability: 3.0e-8}]"
RESTARTED_LAWS = {
    "plain rate": "drillability: 2.0e-6, node_spacing: 0.002",
    "cutting side": "drillability: 2.0e-6, strength: 5.0e+6, node_spacing: 0.002",
    "chips": "bit_law: {kind: drag_bit, specific_energy: 3.0e+6, contact_stress: 3.0e+6}, node_spacing: 0.002",
    "weakening": "drillability: 2.0e-6, bit_law: {kind: velocity_weakening, static: 900, dynamic: 500, speed: 1}",
    "lobes": "drillability: 2.0e-6, bit_law: {kind: roller_cone, amplitude: 2.0e-4, phase: 0.7}, node_spacing: 0.002",
    "of the user": "node_spacing: 0.002, bit_law: {kind: python, function: tests.helpers.laws:warming}",
    "moved after steps": "drillability: 2.0e-6, growth: post_step, node_spacing: 0.002",
}


def new_hole(folders: list[Path], history: Columns) -> None:
    assert read_table(folders[0] / "trajectory.csv")["md [m]"][-1] > 80.002


def building(more: str, law: str, **row: Any) -> Row:
    """State, fixed nodes of the new hole, moving end and rock profile are those of the run that was not interrupted."""
    case = BUILDING.replace("LAW", law) + more
    return Row(case, restarts=slice(1, -1, 2), checkpoints=6, shows=new_hole, **row)


def quasi_static(folders: list[Path], history: Columns) -> None:
    """Twelve seconds with mud: the energy error agrees as well."""
    equal_steps(folders)
    assert history["hole_depth [m]"][-1] > 80.012
    for folder in folders:
        for column, values in read_table(folder / "history.csv").items():
            if column.startswith("energy_error"):
                assert np.abs(values - history[column]).max() <= 1e-8 * np.abs(history[column]).max()


TWELVE = QUASI_STATIC.replace("end: 40", "end: 12") + "petsc: {q_snes_stol: 1.0e-10}\n"
ROWS = {
    f"new hole, {law}": Row(DRILLED.replace("LAW", keys), steps("2e-3"), 5e-8, shows=same_hole)
    for law, keys in LAWS.items()
}
ROWS |= {f"restarted hole, {law}": building(MOTION, keys) for law, keys in RESTARTED_LAWS.items()}
ROWS |= {
    "restarted hole, quasi-static with mud": building(QUASI_STATIC, LAYERED),
    "quasi-static with mud": Row(BUILDING.replace("LAW", LAYERED) + TWELVE, (), 1e-8, shows=quasi_static),
}  # fmt: skip


# ---------------------------------------------------------------------- steerable tools and reamers
#: 40 m in an inclined hole, the tool 0.2 m above the bottom
STEERED = """
string:
  - {kind: pipe, length: 36.0, od: 0.127, id: 0.1086, element_length: 9}
  - {kind: rss, length: 4.0, od: 0.1715, id: 0.0714, element_length: 1, mass: 560, rss: {TOOL}}
  - {kind: bit, length: 0.2, od: 0.216, mass: 60}
well:
  survey: {md: [0, 40.2], inclination: [0.5, 0.55], azimuth: [1, 1]}
  sections: [{to: 40.2, kind: open_hole, diameter: 0.216, friction: 0.25}]
bottom: bit
contact: {stiffness: 1.0e+7}
formation: {drillability: 2.0e-6, node_spacing: 0.005}
top: {kind: top_drive, rotation: 12.0, lowering: 0.3}
initial: {from: statics, wob: 10.0e+3}
time: {end: 0.1}
output: {history_every: 0.01, field_every: 0.05, checkpoint_every: 0.02}
"""
TOOLS = {
    "push": ("kind: push, force: 3.0e+3, pad_offset: 1.0, pads: rotating, steer: {tool_face: 1.0}", "steering_force [N]", 3e3),
    "point": ("kind: point, tilt: 0.003, steer: {ratio: {ramp: 0.05, value: 1.0}, tool_face: -1.0}", "steering_tilt [rad]", 0.003),
}  # fmt: skip


def steered(keys: str, column: str, final: float, case: str = STEERED) -> Row:
    """The direction of the tool face is part of a checkpoint."""

    def shows(folders: list[Path], history: Columns) -> None:
        assert history[column][-1] == pytest.approx(final)
        assert history["hole_depth [m]"][-1] > 40.201
        equal_steps(folders)

    return Row(case.replace("TOOL", keys), steps("2e-3"), restarts=slice(None, -1, 2), shows=shows)


def reamed(mud: str) -> Row:
    """A tenth of a second of drilling with contact; ``mud``: what becomes of the cuttings, or dry."""
    case = reaming(0.2159, 0.2667, 30e6, 0.6, 120.0, 0.05, 40e3, "dynamic", contact={"stiffness": 1e7})
    case |= {"time": {"end": 0.1}, "output": {"history_every": 0.01, "checkpoint_every": 0.02}}
    if mud != "dry":  # 10 mm of new hole, after which the mud reads it anew, within 50 ms
        case = in_mud(case, 0.02, cuttings=mud)
        case["top"]["lowering"] = 0.2

    def shows(folders: list[Path], history: Columns) -> None:
        assert history["hole_depth_reamer [m]"][-1] > 53.7 + 1e-3

    return Row(case, steps("2e-3"), least=1e-9, restarts=slice(None, -1, 2), shows=shows)


#: friction of the user at pipe, collars and tool, and a flow curve of the user in the string and around it
OF_THE_USER = (
    STEERED.replace(
        "{stiffness: 1.0e+7}",
        "{stiffness: 1.0e+7, friction_law: {kind: python, function: tests.helpers.laws:stribeck}}",
    )
    + "fluid: {density: 1200, flow_rate: 0.02, rheology: {model: python, function: tests.helpers.laws:shear_stress}}\n"
)
ROWS |= {
    "steerable, push, friction and rheology of the user": steered(*TOOLS["push"], OF_THE_USER),
    "steerable, point": steered(*TOOLS["point"]),
}
ROWS |= {f"reamer, {mud}": reamed(mud) for mud in ("dry", "returned")}

# ---------------------------------------------------------------------- machines
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


ROWS |= {
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

# ---------------------------------------------------------------------- joints and ends
#: three ranks have common nodes above a stabilised joint and below another
JOINTS = """
well: {survey: {md: [0, 40], inclination: [0.5, 0.5], azimuth: [0, 0]},
       sections: [{to: 40, kind: casing, diameter: 0.2, friction: 0.2}]}
string:
  - {kind: pipe, length: 9, od: 0.127, id: 0.1, element_length: 3}
  - {kind: stabilizer, length: 0.4, od: 0.19, mass: 40, unbalance: 0.05}
  - {kind: pipe, length: 9, od: 0.127, id: 0.1, element_length: 3}
  - {kind: body, length: 0.5, mass: 30, od: 0.15}
  - {kind: pipe, length: 6, od: 0.127, id: 0.1, element_length: 3}
joints:
  - {at: 3, kind: revolute, axis: [0, 1, 1], constraint: stabilised}
  - {at: 9.4, kind: universal, constraint: stabilised}
  - {at: 15.4, kind: slider, spring: 1e6, damping: 1e3, seal_area: 50 cm2}
  - {at: 18.4, kind: universal}
material: {damping: {stiffness: 1.0e-3}}
top: {kind: top_drive, rotation: 6}
time: {end: 0.04}
output: {history_every: 0.02}
fluid: {density: 1200, rheology: {model: newtonian, viscosity: 0.02}, flow_rate: {time: [0, 0.02, 0.04], value: [0.01, 0.01, 0.02]}}
"""
#: a rigid item as the first of the string, on automatic elements: the mesh does not depend on the number of ranks
RIGID_TOP = """
well: {survey: {md: [0, 60], inclination: [0.5, 0.6], azimuth: [0, 0]},
       sections: [{to: 60, kind: casing, diameter: 0.2, friction: 0.2}]}
string:
  - {kind: stabilizer, length: 2, od: 0.19, mass: 100}
  - {kind: pipe, length: 30, od: 0.127, id: 0.1}
  - {kind: pipe, length: 9, od: 0.14, id: 0.07, element_length: 3}
material: {damping: {stiffness: 1.0e-3}}
top: {kind: top_drive, rotation: 6}
time: {end: 0.04}
output: {history_every: 0.02}
"""


def slider_loaded(folders: list[Path], history: Columns) -> None:
    assert np.abs(history["joint_15.4_force [N]"]).min() > 100.0


def end(ranks: bool = True, share: float = 1e-7, restarts: slice | None = None, **case: Any) -> Row:
    """Every column of the history of 0.06 s to rounding; checkpoints at samples and between them."""
    case |= {"time": {"end": 0.06}, "output": {"history_every": 0.01, "checkpoint_every": 6e-3}}
    return Row(case, steps("1e-3") if ranks else None, share, 1e-2, restarts=restarts)


def turning(element: str) -> Row:
    """A pipe that hangs on a universal joint at depth 0 and is pulled aside."""
    return end(
        string=[ends.PIPE],
        top={"kind": "top_drive", "rotation": 5.0},
        bottom="free",
        joints=[ends.UNIVERSAL],
        loads=[{"at": ends.LENGTH, "force": [500.0, 300.0, 0.0]}],
        beam={"formulation": element},
    )


def across(hinged: bool) -> Row:
    """A pipe whose top moves across under a pull, shaken by a force that starts at once."""
    return end(
        string=[ends.PIPE],
        top={"kind": "top_drive", "force": 2e4, "guided": False, "hinged": hinged, "rotation": 3.0},
        bottom="clamped",
        gravity=0.0,
        loads=[
            {"at": 10.0, "force": [300, 100, 0], "value_over": {"time": [0, 0.02, 1], "value": [0, 1, 1]}}
        ],
    )


def controlled(law: dict, motor: dict | None = None, **row: Any) -> Row:
    """The pipe of the checks of sampled laws, in six elements so that every rank has some."""
    return end(
        string=[{**sampled.PIPE, "element_length": 10.0 / 6}],
        top=sampled.m.top(law | {"sample": 4e-3}, {"ramp": 0.05, "value": 10.0}, **(motor or {})),
        gravity=0.0,
        initial={"from": "rest"},
        **row,
    )


ALPHA = {"petsc": {"ts_type": "alpha2"}}
LATE = sampled.SOFT | {"delay": 8e-3}
OWN_CONTROL = {"kind": "python", "function": "tests.helpers.laws.speed_control"}
#: a weight on bit with a top force that does not hold it: the string starts to move
WEIGHT_AND_FORCE = end(
    string=[
        {"kind": "pipe", "length": 500.0, "od": 0.127, "id": 0.1086},
        {"kind": "pipe", "length": 99.5, "od": 0.1715, "id": 0.0714},
        {"kind": "bit", "length": 0.5, "od": 0.2159, "mass": 60},
    ],
    well=ends.WELL,
    bottom="bit",
    top={"kind": "top_drive", "rotation": 5.0, "force": 1e5},
    initial={"from": "statics", "wob": 30e3},
)
ROWS |= {
    "joints in mud": Row(JOINTS, steps("1e-3"), least=1e-3, shows=slider_loaded),
    "rigid top": Row(RIGID_TOP, steps("1e-3"), least=1e-3),
    "universal joint, ancf": turning("ancf"),
    "universal joint, quaternion": turning("quaternion"),
    "top across": across(False),
    "hinged top across": across(True),
    "weight and top force": WEIGHT_AND_FORCE,
    "sampled pi, limited": controlled(sampled.PI, {"max_torque": 2e4, "min_torque": 0.0}),
    "sampled soft torque": controlled(LATE, restarts=slice(None, -1, 2)),
    "sampled soft torque, generalised alpha": controlled(
        LATE, ranks=False, restarts=slice(None, -1, 2), **ALPHA
    ),
    "sampled z torque": controlled(sampled.Z_TORQUE | {"delay": 8e-3}, restarts=slice(1, -1, 3)),
    "controller of the user": controlled(OWN_CONTROL, restarts=slice(None, -1, 2)),
    "controller of the user, generalised alpha": controlled(
        OWN_CONTROL, share=1e-6, restarts=slice(None, -1, 2), **ALPHA
    ),
}

# ---------------------------------------------------------------------- mud
#: a string in a hole that builds slowly, with a pump that is turned down
PUMPED = """
string: STRING
well:
  survey: {md: [0, 210], inclination: [0.0, 0.1], azimuth: [0, 0]}
  sections: [{to: 210, kind: open_hole, diameter: 0.22}]
top: {kind: top_drive, rotation: 1.0}
fluid: {density: 1200, rheology: {model: newtonian, viscosity: 0.02}, flow_rate: {time: [0.02, 0.06], value: [0.03, 0.02]}}
time: {end: 0.1}
output: {history_every: 0.02}
"""
PIPE = "{kind: pipe, od: 0.127, id: 0.1086, element_length: 20.0, "
BIT = "{kind: bit, length: 0.3, od: 0.2159, mass: 50.0, nozzle_area: 4.0e-4}"
NOZZLES = "{kind: stabilizer, length: 1.0, od: 0.2159, body_od: 0.17, id: 0.0714, blade_length: 0.5, "
LOSS = (
    "pressure_loss: {curve: {flow_rate: [0.01, 0.02, 0.04], loss: [2.0e+5, 9.0e+5, 1.2e+6]}, density: 1000.0}"
)
#: nozzles above the bit, and tools whose losses have curves and whose mud has its own sections, a flexible and a rigid one
NOZZLES_AND_LOSSES = f"""
  - {PIPE}length: 60.0}}
  - {PIPE}length: 40.0, name: tool, {LOSS}, bore_volume: 0.25, annulus_od: 0.14}}
  - {NOZZLES}nozzle_area: 2.0e-4}}
  - {{kind: body, length: 1.0, od: 0.17, id: 0.07, {LOSS}, bore_volume: 0.003, annulus_od: 0.19}}
  - {PIPE}length: 60.0}}
  - {NOZZLES}nozzle_area: 1.0e-4}}
  - {PIPE}length: 40.0}}
  - {BIT}"""


def side_flow(folders: list[Path], history: Columns) -> None:
    flow, pressure = history["side_flow [m3/s]"], history["pump_pressure [Pa]"]
    assert 0.005 < flow[-1] < flow[0] < 0.02 and pressure[-1] < pressure[0] - 5e5


def whirls(folders: list[Path], history: Columns) -> None:
    """Mud that swirls about a turning string, its rigid items and its bit: probes and energy errors agree, too."""
    probes = same_histories(folders, least=1e-9, table="probes.csv")
    for depth in ("6", "12.5", "20"):
        assert np.hypot(probes[f"x_{depth} [m]"], probes[f"y_{depth} [m]"]).max() > 1e-5
    error = [summary["energy"]["error_share"] for summary in summaries(folders)]
    assert error == pytest.approx([error[0]] * len(error), rel=1e-3)


def swirling(**fluid: Any) -> Row:
    case = COLLAR_IN_MUD | {"fluid": COLLAR_IN_MUD["fluid"] | fluid}
    return Row(case, ("-ts_type", "bdf", *steps("5e-3")), least=1e-9, shows=whirls)


ROWS |= {
    "side nozzles, tool losses": Row(
        PUMPED.replace("STRING", NOZZLES_AND_LOSSES), steps("5e-3"), least=1e-9, shows=side_flow
    ),
    "swirl with its lag": swirling(),
    "swirl at once": swirling(swirl=0.4, swirl_lag=False),
}

# ---------------------------------------------------------------------- whole strings
CASES = Path(__file__).parents[2] / "cases"
CURVE = """
well:
  survey: {md: [0 m, 700 m], inclination: [0 deg, 70 deg], azimuth: [20 deg, 60 deg]}
  sections: [{to: 700 m, kind: open_hole, diameter: 215.9 mm, friction: 0.2}]
string:
  - {kind: pipe, length: 299.5 m, od: 127 mm, id: 108.6 mm, element_length: 20 m}
  - {kind: bit, length: 0.5 m, od: 215.9 mm, mass: 60 kg}
top: {kind: top_drive, lowering: 0.5 m/s, rotation: 20 rpm}
bottom: free
initial: {from: statics}
time: {end: 0.1 s}
output: {history_every: 10 ms}
"""


def before_the_impact(folders: list[Path], history: Columns) -> None:
    """After the jump at 60 ms the string strikes the wall, which multiplies rounding a thousandfold."""
    same_histories(folders, share=5e-8, until=0.06)


def equal_work(folders: list[Path], history: Columns) -> None:
    equal_steps(folders)
    first, *others = (summary["newton_iterations"] for summary in summaries(folders))
    # solves to rounding end where rounding decides; at the default tolerance the counts are equal
    assert others == pytest.approx([first] * len(others), rel=0.05)
    assert (folders[-1] / "checkpoint.h5").stat().st_size > 0


#: small differences of large forces and of large pressures: within 1e-7 of those
SMALL = {"bearing_load": "_force [N]", "motor_differential_pressure": "_pressure [Pa]"}


def tools_agree(folders: list[Path], history: Columns, share: float = 1e-7) -> None:
    """Torque and angles of joints that carry none are rounding themselves."""
    equal_steps(folders)
    others = [read_table(folder / "history.csv") for folder in folders[1:]]
    for name, values in history.items():
        if name.startswith(OTHERWISE):
            continue
        unit = SMALL.get(name.split()[0])
        alike = [values] if unit is None else [q for n, q in history.items() if n.endswith(unit)]
        size = max(np.abs(q).max() for q in alike)
        for other in others:
            assert np.abs(other[name] - values).max() <= share * size + 1e-10, name


def tools(case: dict, every: float = 4e-3, **row: Any) -> Row:
    """Three intervals of output, with a checkpoint after each; `tools_agree` has the tolerances."""
    output = {"history_every": every, "checkpoint_every": every}
    return Row(
        case | {"time": {"end": 3 * every}, "output": output},
        share=1.0,
        least=np.inf,
        shows=tools_agree,
        **row,
    )


def samples_agree(folders: list[Path], history: Columns) -> None:
    """All columns within 1e-7 of the largest value of their unit, which the static start leaves; rows at the same times."""
    for name in sensors.NAMES:
        one, *others = (read_sensor(folder, name) for folder in folders)
        for several in others:
            assert list(one) == list(several)
            assert np.array_equal(one["time [s]"], several["time [s]"])
            for title in list(one)[1:]:
                same = [q for other, q in one.items() if other.partition(" ")[2] == title.partition(" ")[2]]
                size = max(float(np.abs(same).max()), 1e-3)
                assert several[title] == pytest.approx(one[title], abs=1e-7 * size), title


#: the string of the agitator lies on its wall
LEANING = simple_well(110, 0.2159, 0.5, kind="casing", friction=0.0)
ROWS |= {
    "sensors": Row(sensors.CASE, (), share=1.0, least=np.inf, shows=samples_agree),
    "quaternion string in mud with a bit that drills": Row(
        keys_of_scene("quaternion", fluid=MUD, formation=ROCK)
        | {"time": {"end": 0.06}, "output": {"history_every": 0.01, "checkpoint_every": 0.01}},
        steps("2e-3"),
        restarts=slice(None, -1, 2),
    ),
    # contact, mud, a bend and a jump of the top's motion
    "generalised alpha": Row(WHIRL, (*steps("1e-3"), "-ts_type", "alpha2"), 2e-6, shows=before_the_impact),
    "string that lies": Row(
        (CASES / "lying-string.yaml").read_text().replace("end: 1 s", "end: 0.3 s"),
        steps("2e-3"),
        5e-8,
        shows=equal_work,
    ),
    "top that goes down a curve": Row(CURVE, steps("2e-3"), 5e-8),
    "agitator": tools(with_mud() | {"well": LEANING}, ranks=steps("1e-3"), restarts=slice(None, -1, 2)),
    "jar, shock sub, motor, steering": tools(
        whole.combined(whole.JAR, whole.COLLAR, whole.SHOCK, whole.MOTOR, whole.STEERED), ranks=steps("1e-3")
    ),
    "two of some tools": tools(whole.whole_string(two=True), every=2e-4, restarts=slice(None, -1, 2)),
}


def whole_agrees(folders: list[Path], history: Columns) -> None:
    tools_agree(folders, history, 1e-6)


# Its buckles have more than one place, and which of them a search of 170 factorisations ends at is rounding: it goes on from
# another run.  A few steps, before one is repeated: stops of 1e9 N/m let Newton's method shrink a step by 1e-10; whether it
# reaches 1e-12 is rounding, too.
WHOLE = ("-ts_adapt_type", "none", "-ts_dt", "2e-4", "-q_snes_stol", "1e-10")
ROWS |= {
    f"whole string, two of some tools: {two}": replace(
        tools(whole.whole_string(two), every=2e-4, ranks=WHOLE), shows=whole_agrees, begun=True
    )
    for two in (False, True)
}
ROWS |= {
    f"mud, {kind}": Row(
        flow.keys(**case),
        steps("2e-3"),
        1.0,
        np.inf,
        shows=partial(flow.same_flow, kind in ("drilling", "moving")),
    )
    for kind, case in flow.CASES.items()
}
