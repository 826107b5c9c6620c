"""Rows of the matrix of commands: results that must not depend on the number of ranks.

`test_commands_mpi.py` runs them. What a row shows beyond that is computed by hand, or in a test of one rank.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from drillpetsc.output import read_table
from tests.cli import test_uncertain_cli as uncertain
from tests.cli.test_limits_cli import CASE as LIMITS
from tests.helpers import frequency_models as m
from tests.helpers import top_drive_models as t
from tests.helpers.bit_models import DRAG
from tests.helpers.wells import simple_well
from tests.verification import test_sensitivities_bit as bit
from tests.verification import test_sensitivities_run as run
from tests.verification.test_critical_map import critical, shaft
from tests.verification.test_stokes_modes import span

Compare = Callable[[Path, Path], None]


@dataclass(frozen=True)
class Row:
    """A command on a case, and how run folders of one and of several ranks are compared.

    words: without the case and ``--out``; case: text or keys of a case file; ranks: numbers beside one rank.
    same(one, other): asserts that two folders agree; shows(one): asserts that the command does what the row is for.
    log: text of a log, whose file the command gets as ``--log``; empty for none.
    """

    words: str
    case: str | dict[str, Any]
    same: Compare
    ranks: tuple[int, ...] = (2, 3)
    shows: Callable[[Path], object] = lambda folder: None
    log: str = ""

    def line(self, folder: Path, name: str, ranks: int) -> list[str]:
        """The words of the command for a number of ranks, with the case in a file."""
        file = folder / f"{name}.yaml"
        file.write_text(self.case if isinstance(self.case, str) else yaml.safe_dump(self.case))
        command, *rest = self.words.split("|")
        if self.log:
            (folder / f"{name}.csv").write_text(self.log)
            rest += ["--log", str(folder / f"{name}.csv")]
        return [command, str(file), *rest, "--out", str(out_folder(folder, name, ranks))]


def out_folder(folder: Path, name: str, ranks: int) -> Path:
    return folder / f"{name}-{ranks}"


# ---------------------------------------------------------------------- comparisons
def table(file: str, *columns: str, rel: float = 0.0, share: float = 0.0) -> Compare:
    """Columns, all without names, that differ by ``rel`` of a value or ``share`` of the column's largest; words are equal."""

    def same(one: Path, other: Path) -> None:
        a, b = read_table(one / file), read_table(other / file)
        assert list(a) == list(b)
        for name in columns or a:
            if a[name].dtype.kind != "f":
                assert (b[name] == a[name]).all(), name
            elif columns or not name.startswith(("energy_error", "step", "wall")):
                least = share * max(np.nanmax(np.abs(a[name]), initial=0.0), 1e-9)
                assert b[name] == pytest.approx(a[name], rel=rel, abs=least, nan_ok=True), name

    return same


def linear(share: float) -> Compare:
    """Responses of linear models: differences as a share of the largest of the output."""

    def same(one: Path, other: Path) -> None:
        a, b = (np.load(folder / "linear.npz")["response"] for folder in (one, other))
        assert np.all(np.abs(a - b).max(axis=(0, 2)) < share * np.abs(a).max(axis=(0, 2)))

    return same


def summary(folder: Path) -> dict[str, Any]:
    return json.loads((folder / "summary.json").read_text())


# ---------------------------------------------------------------------- over frequencies and rotary speeds
MUD = {"density": 1200, "rheology": {"model": "newtonian", "viscosity": 0.02}, "flow_rate": 0.02}
#: an eccentric string on the wall of a curved hole, in mud
ON_THE_WALL = {
    "string": [
        m.drill_pipe(30.0, 6, 1e-4, eccentricity=2e-3),
        m.collars(9.5, 3, 1e-4),
        {"kind": "bit", "length": 0.5, "od": 0.2, "mass": 60, "unbalance": 0.05, "nozzle_area": 4e-4},
    ],
    "well": simple_well(40, 0.2159, (0.5, 0.7), kind="casing", friction=0.2),
    "fluid": MUD,
    "top": {"kind": "top_drive", "rotation": 6.0},
    "bottom": "bit",
    "initial": {"wob": 2e4},
}
AMPLITUDES = table(
    "response.csv", "lateral_amplitude [m]", "axial_amplitude [m]", "axial_force_amplitude [N]", "bending_moment_amplitude [N m]",
    "stress_amplitude [Pa]", "shear_stress_amplitude [Pa]", "mean_stress [Pa]", rel=1e-5, share=1e-6,
)  # fmt: skip
TOOL = m.two_part_string() | {
    "string": [
        m.drill_pipe(300.0, 30, 1e-3), m.drill_pipe(200.0, 20, 1e-3, name="tool"), m.drill_pipe(500.0, 50, 1e-3),
    ]
}  # fmt: skip


def same_branches(one: Path, other: Path) -> None:
    """Frequencies of four branches, in any order."""
    a, b = (
        np.sort(read_table(folder / "campbell.csv")["frequency [Hz]"].reshape(-1, 4), axis=0)
        for folder in (one, other)
    )
    assert b == pytest.approx(a, rel=1e-7)


def disc_is_critical(folder: Path) -> None:
    speeds = read_table(folder / "critical.csv")["critical_rotary_speed [rpm]"]
    assert speeds == pytest.approx([362.605, 376.346], rel=2e-3)


WALLS = np.array([1e6, 1e9])  # [Pa]


def shaft_is_critical(folder: Path) -> None:
    found = read_table(folder / "critical_map.csv")
    for wall, expected in zip(WALLS, critical(WALLS), strict=True):
        speeds = found["critical_rotary_speed [rpm]"][found["wall_stiffness [Pa]"] == wall]
        assert np.min(np.abs(speeds / expected - 1)) < 5e-3


def tool_twists(folder: Path) -> None:
    assert read_table(folder / "response.csv")["twist_amplitude [rad]"].max() > 0


FREQUENCY = {
    "response to unbalance": Row("response|--excite|unbalance|--speeds|60,120 rpm|--stress", ON_THE_WALL, AMPLITUDES, (3,)),
    "response to a moving bit": Row("response|--excite|bit|--amplitude|1 mm|--speeds|60,120 rpm|--stress", ON_THE_WALL, AMPLITUDES, (2,)),
    "response at a place": Row(
        "response|--excite|tool|--amplitude|1 kN m|--speeds|40,75 rpm", TOOL,
        table("response.csv", "twist_amplitude [rad]", "torque_amplitude [N m]", rel=1e-7, share=1e-9), (3,), tool_twists,
    ),
    "disc": Row("campbell|--speeds|0:600:200 rpm|--count|4|--lines|1", m.disc(), same_branches, (2,), disc_is_critical),
    "critical map": Row(
        "campbell|--speeds|10:150:35 rpm|--count|4|--kind|lateral|--lines|1|--stiffness|1e6,1e9 Pa", shaft(),
        table("critical_map.csv", "wall_stiffness [Pa]", "critical_rotary_speed [rpm]", rel=1e-6), (2,), shaft_is_critical,
    ),
    "modes refined in viscous mud": Row(
        "modes|--count|2", span(2e-2, 8),
        table("modes.csv", "frequency [Hz]", "damping_ratio [-]", "stokes_number [-]", rel=1e-6), (3,),
    ),
    "boundary of stick-slip": Row(
        "stability|--speeds|110:140:30 rpm|--wob|100 kN|--count|1|--kind|torsional",
        t.on_bottom(t.STIFF, 10.0, elements=10) | {"loads": []},
        table("stability_boundary.csv", "boundary_speed [rpm]", rel=1e-6), (3,),
    ),
}  # fmt: skip

# ---------------------------------------------------------------------- statics with a history
LEVEL = """
title: pipe in a level hole
well:
  survey: {md: [0 m, 80 m], inclination: [90 deg, 90 deg], azimuth: [20 deg, 20 deg]}
  sections: [{to: 80 m, kind: open_hole, diameter: 215.9 mm, friction: 0.25}]
string: [{kind: pipe, length: 80 m, od: 127 mm, id: 108.6 mm, element_length: 4 m}]
top: {kind: top_drive, force: -350 kN}
bottom: {kind: bit, friction: 0}
"""
COILED = """
title: coiled pipe with weight on its bit
well:
  survey: {md: [0 m, 400 m], inclination: [0 deg, 0 deg], azimuth: [20 deg, 20 deg]}
  sections: [{to: 400 m, kind: open_hole, diameter: 215.9 mm, friction: 0.3}]
string:
  - {kind: pipe, length: 399.7 m, od: 127 mm, id: 108.6 mm, element_length: 5 m}
  - {kind: bit, length: 0.3 m, od: 215.9 mm, mass: 60 kg}
top: {kind: top_drive}
bottom: {kind: bit}
formation: {drillability: 4.0e-8}
initial: {from: statics, wob: 150 kN}
"""
STUCK = """
title: stuck string that is pulled  # rates of even stretch, manual eq-statics-share-of-top
well:
  survey: {md: [0 m, 300 m], inclination: [0 deg, 30 deg], azimuth: [0 deg, 0 deg]}
  sections: [{to: 300 m, kind: open_hole, diameter: 215.9 mm, friction: 0.2}]
string:
  - {kind: pipe, length: 200 m, od: 127 mm, id: 108.6 mm, element_length: 10 m}
  - {kind: pipe, length: 100 m, od: 171.4 mm, id: 71.4 mm, element_length: 10 m}
top: {kind: top_drive, lowering: -0.3 m/s}
bottom: clamped
fluid: {density: 1200 kg/m3, flow_rate: 20 l/s, rheology: {model: bingham, plastic_viscosity: 20 mPa s, yield_stress: 4 Pa}}
initial: {from: statics}
time: {end: 0.05 s}
output: {history_every: 10 ms}
"""


def same_path(one: Path, other: Path) -> None:
    """The same steps; forces to 1e-7 of the push, places to 1e-7 m: Newton's tolerance (manual: sec-statics-path)."""
    for a, b in zip(summary(one)["path_states"], summary(other)["path_states"], strict=True):
        assert [a[key] - b[key] for key in ("steps", "negative_pivots")] == [0, 0] and a["start"] == b[
            "start"
        ]
        assert b["wob"] == pytest.approx(a["wob"], abs=1e-7 * 350e3)
        assert b["surface_torque"] == pytest.approx(a["surface_torque"], rel=1e-6)
    a, b = (read_table(folder / "statics.csv") for folder in (one, other))
    for name in ("offset_x [m]", "offset_y [m]"):
        assert np.abs(a[name] - b[name]).max() < 1e-7


def buckled(folder: Path) -> None:
    found = summary(folder)["buckling"]
    assert found["helical"] or found["sinusoidal"]


def same_slide(one: Path, other: Path) -> None:
    """The same slide of the coiled string; hook load to Newton's tolerance."""
    a, b = summary(one), summary(other)
    assert b["path_states"][0]["steps"] == a["path_states"][0]["steps"]
    assert b["hook_load"] == pytest.approx(a["hook_load"], abs=1e-6 * 150e3)


def from_a_buckled_start(folder: Path) -> None:
    assert summary(folder)["path_states"][0]["start"] == "buckled"


STATICS = {
    "sliding path": Row("statics|--path|sliding|--motion|lower", LEVEL, same_path, (3,), buckled),
    "path of slacking off": Row("statics|--path|slack_off|--motion|lower", LEVEL, same_path, (2,), buckled),
    "turning path": Row(
        "statics|--path|sliding|--motion|rotate", LEVEL.replace("80 m", "40 m"), same_path, (3,), buckled
    ),
    "coil that is hoisted": Row("statics|--motion|hoist", COILED, same_slide, (2,), from_a_buckled_start),
    "coil that is lowered": Row("statics|--motion|lower", COILED, same_slide, (3,), from_a_buckled_start),
    "start of a stuck string": Row(
        "run|--progress|silent", STUCK, table("history.csv", "hook_load [N]", share=1e-6), (3,)
    ),
}

# ---------------------------------------------------------------------- readings of a rig
#: pipe of 242 N/m in air in a hole of 45 degrees below 400 m, with readings about those of friction 0.2 and 0.3 and of mud of 1260 kg/m3
MEASURED = """
well:
  survey: {md: [0 m, 100 m, 400 m, 900 m], inclination: [0 deg, 0 deg, 45 deg, 45 deg], azimuth: [0 deg, 0 deg, 0 deg, 0 deg]}
  sections: [{to: 500 m, kind: casing, diameter: 224 mm, friction: 0.25}, {kind: open_hole, diameter: 215.9 mm, friction: 0.25}]
string: [{kind: pipe, od: 127 mm, id: 108.6 mm, length: 900 m, element_length: 20 m}]
top: {kind: top_drive}
bottom: {kind: free}
fluid: {density: 1200 kg/m3, rheology: {model: newtonian, viscosity: 20 cP}}
roadmap:
  measured:
    - {bit_depth: 480 m, operation: trip_out, hook_load: 101.2 kN, sigma: 0.5 kN}
    - {bit_depth: 480 m, operation: trip_in, hook_load: 87.0 kN, sigma: 0.5 kN}
    - {bit_depth: 700 m, operation: rotate_off_bottom, hook_load: 128.3 kN, torque: 1.3 kN m, sigma: 0.5 kN}
    - {bit_depth: 880 m, operation: trip_out, hook_load: 192.2 kN, sigma: 0.5 kN}
    - {bit_depth: 880 m, operation: trip_in, hook_load: 127.9 kN, sigma: 0.5 kN}
"""


def beam_is_fitted(folder: Path) -> None:
    found = summary(folder)
    assert found["model"] == "stiff" and found["readings"] == 6


#: rotor inertia at the end of a shaft whose top is turned with a ramp; the case says 374 kg m2
TRUE_INERTIA = 350.0


def speed_of_bit() -> str:
    """A log of the torsional pendulum's bit by its closed form, a row each 0.1 s."""
    t, w = np.arange(0.2, 3.0, 0.1), np.sqrt(run.STIFFNESS / TRUE_INERTIA)
    speeds = run.SPEED * (1 - (np.sin(w * t) - np.sin(w * (t - run.RAMP))) / (w * run.RAMP))
    return "\n".join(
        ["time [s],bit speed [rad/s]", *(f"{a:.1f},{b:.6f}" for a, b in zip(t, speeds, strict=True))]
    )


def inertia_is_found(folder: Path) -> None:
    assert summary(folder)["fit"]["string[1].inertia.axial"]["value"] == pytest.approx(TRUE_INERTIA, rel=2e-3)


READINGS = {
    "run of a calibration": Row(
        "calibrate|--model|dynamic|--fit|string[1].inertia.axial", run.pendulum("bdf", time={"end": 3.0})._given.keys,
        table("calibration_series.csv", share=1e-6), (2,), inertia_is_found, speed_of_bit(),
    ),
    "beam of a calibration": Row(
        "calibrate|--model|stiff|--fit|cased,open_hole,fluid.density", MEASURED,
        table("calibration.csv", "computed [N or N m]", "residual [N or N m]", rel=1e-6, share=1e-6), (2,), beam_is_fitted,
    ),
}  # fmt: skip

# ---------------------------------------------------------------------- loops, surge, linear models
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
#: without contact: friction against a string that turns makes its bending grow from rounding
FREE = (
    DRILLING.replace("2 deg, 2 deg", "0 deg, 0 deg")
    + "contact: none\ntop: {kind: top_drive, rotation: 60 rpm}"
)
SURGE = """
well:
  survey: {md: [0 m, 400 m], inclination: [0 deg, 0 deg], azimuth: [0 deg, 0 deg]}
  sections: [{to: 400 m, kind: open_hole, diameter: 215.9 mm, friction: 0.2}]
string: [{kind: pipe, length: 300 m, od: 127 mm, id: 108.6 mm, element_length: 50 m}]
top: clamped
bottom: free
fluid: {density: 1200 kg/m3, rheology: {model: newtonian, viscosity: 20 mPa s}, flow_rate: 0 l/s}
"""
LYING = """
well:
  survey: {md: [0 m, 110 m], inclination: [90 deg, 90 deg], azimuth: [0 deg, 0 deg]}
  sections: [{to: 110 m, kind: casing, diameter: 216 mm, friction: 0.2}]
string: [{kind: pipe, length: 100 m, od: 127 mm, id: 108.6 mm, element_length: 10 m}]
material: {damping: {stiffness: 1.0e-3 s}}
top: {kind: top_drive, rotation: 60 rpm, motor: {inertia: 500 kg m2}, control: {kind: pi, p: 2000 N m s/rad, i: 3000 N m/rad}}
"""
CONTROLS = {
    "loop of an autodriller": Row(
        "linearise|--inputs|top.autodriller.wob|--outputs|hook_load", DRILLING + LOOP, linear(1e-6), (3,)
    ),
    "modes with an autodriller": Row(
        "campbell|--speeds|30,60rpm|--count|3", DRILLING + LOOP, table("campbell.csv", share=1e-6), (3,)
    ),
    "surge": Row(
        "surge|--speeds|0.3 m/s|--operation|trip_in|--pipe|closed|--dynamic",
        SURGE,
        table("surge.csv", share=1e-6),
        (2,),
    ),
    "runs of the stability map": Row(
        "stability|--speeds|60rpm|--wob|2 kN|--count|2|--kind|torsional|--method|time|--duration|1 s",
        FREE,
        table("stability_runs.csv", share=1e-6),
        (2,),
    ),
    # differences of the outputs, sums in another order
    "linear model in contact": Row(
        "linearise|--inputs|top.rotation|--outputs|bit_speed,motor_torque,surface_torque",
        LYING,
        linear(1e-5),
        (2,),
    ),
}

# ---------------------------------------------------------------------- derivatives and samples
CASES = Path(__file__).parents[2] / "cases"
PATH_OF_SURVEY = "  well.survey: {path: {inclination: 0.1 deg, lateral: 0.2 deg, length: 800 m}}\n"
#: a string that turns on the wall of a curved hole and is lowered
IN_MUD = {
    "well": simple_well([0, 60, 120], 0.2159, [0.3, 0.3, 0.6], friction=0.2),
    "string": [m.drill_pipe(100.0, 10, 1e-3), {"kind": "bit", "length": 0.5, "od": 0.2, "mass": 60, "nozzle_area": 4e-4}],
    "fluid": MUD,
    "top": {"kind": "top_drive", "rotation": 6.0, "lowering": 0.2},
    "bottom": "free",
    "initial": {"from": "statics"},
    "time": {"end": 0.2},
}  # fmt: skip


def same_derivatives(one: Path, other: Path) -> None:
    """Relative derivatives agree to 1e-5: those of the residual have a rounding of 1e-7 over a small step."""
    a, b = (
        {
            (row["output"], row["key"]): row["relative"]
            for row in summary(folder)["sensitivities"]
            if row["relative"]
        }
        for folder in (one, other)
    )
    assert len(a) >= 2 and b == pytest.approx(a, rel=0, abs=1e-5)


def same_samples(one: Path, other: Path) -> None:
    """To the last bit."""
    a, b = ((folder / "uncertain.csv").read_bytes() for folder in (one, other))
    assert len(a) > 500 and a == b


def derivatives(case: str, words: str, ranks: tuple[int, ...]) -> Row:
    return Row(f"sensitivities|--to|{words}", (CASES / case).read_text(), same_derivatives, ranks)


SENSITIVITIES = {
    "derivatives of hoisting": derivatives(
        "verification/p16-j-well.yaml",
        "well.sections[0].friction,string[0].material.density|--motion|hoist",
        (3,),
    ),
    "derivatives in mud": derivatives(
        "directional.yaml", "well.sections[0].friction,material.density,fluid.density,initial.wob", (2,)
    ),
    "derivatives of a run": derivatives(
        "stick-slip-2000m.yaml",
        "formation.bit_law.static,string[0].od,top.rotation.value,material.density|--analysis|run|--set|time.end=2 s"
        "|--of|surface_torque.mean,bit_speed.max,hook_load.final",
        (3,),
    ),
    # the hole grows, and the bit cuts into the groove of the blade before
    "derivatives of a run that drills": Row(
        "sensitivities|--analysis|run|--to|formation.bit_law.specific_energy,top.lowering,string[0].od"
        "|--of|wob.mean,rop.mean,hook_load.mean,surface_torque.mean",
        bit.drilling("bdf", {"bit_law": DRAG}, 0.4)._given.keys,
        same_derivatives,
        (2, 3),
    ),
    # hole and swirl are renewed on the way
    "derivatives of a run in mud": Row(
        "sensitivities|--analysis|run|--to|fluid.density,fluid.rheology.viscosity,fluid.flow_rate,well.sections[0].friction"
        "|--of|pump_pressure.mean,bit_pressure.max,surface_torque.mean,hook_load.mean",
        IN_MUD,
        same_derivatives,
        (3,),
    ),
    # a number of samples that the ranks do not divide
    "uncertain": Row(
        "uncertain|--samples|20",
        LIMITS + uncertain.ROADMAP + "uncertain:\n" + uncertain.FRICTION + uncertain.DENSITY + PATH_OF_SURVEY,
        same_samples,
        (3,),
    ),
}
ROWS = FREQUENCY | STATICS | READINGS | CONTROLS | SENSITIVITIES
