"""Rows of the parallel matrix about whole strings: sensors, elements, integrators, and several tools together."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from drillpetsc.output import read_table
from drillpetsc.output.sensors.files import read_sensor
from tests.helpers import whole_string as whole
from tests.helpers.ranks import OTHERWISE, same_histories
from tests.helpers.wells import simple_well
from tests.parallel.rows import sensors
from tests.parallel.rows.row import Columns, Row, equal_steps, steps, summaries
from tests.parallel.test_restart import CASE as WHIRL
from tests.verification.test_agitator import with_mud
from tests.verification.test_quaternion_scenes import MUD, ROCK, keys_of_scene

CASES = Path(__file__).parents[3] / "cases"
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
ROWS = {
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
