"""Rows of the parallel matrix with new hole, steerable tools and reamers."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from drillpetsc.output import read_table
from tests.parallel.rows.row import Columns, Row, equal_steps, steps
from tests.verification.test_reamer import reaming
from tests.verification.test_reamer_in_mud import in_mud

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
