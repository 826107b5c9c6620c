"""A run says that its steps damp the whirl of a stabilizer that would roll along the wall (manual: sec-time-whirl-steps)."""

from __future__ import annotations

import re

import pytest

from drillpetsc.analysis.placement import move_rigidly, place_along_hole, release
from drillpetsc.analysis.transient import run
from drillpetsc.analysis.whirl_steps import WhirlSteps
from drillpetsc.case import Case, load_case
from drillpetsc.model.drilling_model import build_model
from drillpetsc.output.time_error import damped_frequency

HOLE, BLADES, RPM = 0.2159, 0.209, 95.0
ROLLING = RPM / 60 * BLADES / (HOLE - BLADES)  # turns of the hole a second, by Jansen (1991)


def case(blades: float = BLADES, rpm: float = RPM, **keys) -> Case:
    return Case(
        **{
            "well": {
                "survey": {"md": [0, 60], "inclination": [0.2, 0.2], "azimuth": [0, 0]},
                "sections": [{"kind": "open_hole", "diameter": HOLE, "friction": 0.2}],
            },
            "string": [
                {"kind": "pipe", "length": 40.0, "od": 0.165, "id": 0.07, "element_length": 10.0},
                {"kind": "stabilizer", "name": "lower", "length": 2.0, "od": blades, "id": 0.07},
                {"kind": "pipe", "length": 10.0, "od": 0.165, "id": 0.07, "element_length": 10.0},
                {"kind": "bit", "length": 0.3, "od": HOLE, "mass": 50.0},
            ],
            "top": {"kind": "top_drive", "rotation": f"{rpm} rpm"},
            "bottom": "free",
            **keys,
        }
    )


def said(steps: float, **keys) -> list[str]:
    """Warnings of a string that turns, for steps of this length [s] of BDF 2."""
    model = build_model(case(**keys))
    place_along_hole(model)
    release(model)
    move_rigidly(model)
    return WhirlSteps(model).warnings(damped_frequency(2, steps), damped_frequency(2, 1.0))


@pytest.mark.parametrize("rpm", [40.0, 95.0, -140.0])
def test_frequency_and_step_of_rolling_whirl(rpm):
    """The frequency is the rotation times radius over clearance, whichever way the string turns; the step damps it by 1 %."""
    (line,) = said(0.02, rpm=rpm)
    whirl = abs(rpm) / RPM * ROLLING
    assert "lower at MD" in line
    found = float(re.search(r"at ([\d.]+) Hz \(", line)[1])  # type: ignore[index]
    assert found == pytest.approx(whirl, rel=0.05)
    step = float(re.search(r"-ts_adapt_dt_max (\S+) ", line)[1])  # type: ignore[index]
    assert damped_frequency(2, step) == pytest.approx(whirl, rel=0.05)  # two digits
    assert said(step, rpm=rpm) == []


@pytest.mark.parametrize(
    "keys", [{"rpm": 0.0}, {"blades": HOLE}, {"blades": 0.16}, {"contact": "none"}], ids=str
)
def test_nothing_is_said_where_nothing_would_roll_fast(keys):
    """Without rotation, for blades of full gauge, for thin ones (2.4 Hz), and without contact."""
    steps = 0.01  # 3 Hz
    assert said(steps, **keys) == []


def test_the_case_of_the_readme_says_so(tmp_path):
    """At the default tolerance its steps keep 2 Hz; fine steps have the whirl of the near-bit stabilizer of 47 Hz."""
    c = load_case("cases/vertical-2000m.yaml", ["time.end=1 s"])
    result = run(c, out=tmp_path / "run")
    (line,) = [w for w in result.summary["warnings"] if "whirl" in w]
    assert "near-bit at MD 1998 m" in line and "radial clearance 2.95 mm" in line
    assert float(re.search(r"at ([\d.]+) Hz \(", line)[1]) == pytest.approx(47.5, rel=0.03)  # type: ignore[index]
