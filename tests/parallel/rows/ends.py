"""Rows of the parallel matrix with joints, ends of the string and laws of its top."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from tests.parallel.rows.row import Columns, Row, steps
from tests.verification import test_ends as ends
from tests.verification import test_sampled_law as sampled

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
ROWS = {
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
