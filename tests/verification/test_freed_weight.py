"""The weight on bit that rotation frees (drillpetsc/analysis/statics/checks/freed_weight.py): closed form of a straight incline.

A sliding string at the inclination I has mu w sin I of friction per length, a turning one none along the hole.  With top and bit where
they are, the mean tension stays: the bit takes half of the friction, W + mu w L sin I/2.
"""

from __future__ import annotations

import math

import pytest

from drillpetsc import Case, run
from drillpetsc.analysis.statics.checks.freed_weight import freed_weight
from drillpetsc.doubts import motion
from drillpetsc.doubts.moments import Start
from drillpetsc.model.drilling_model import build_model

LENGTH, WEIGHT, ANGLE, FRICTION, WOB = 500.0, 242.0, math.radians(60), 0.3, 5e3
FREED = WOB + 0.5 * FRICTION * WEIGHT * LENGTH * math.sin(ANGLE)  # 20.7 kN


def case(**top) -> Case:
    area = math.pi / 4 * (0.127**2 - 0.1086**2)
    pipe = {"kind": "pipe", "length": LENGTH - 0.3, "od": 0.127, "id": 0.1086, "element_length": 10.0}
    survey = {"md": [0, LENGTH], "inclination": [ANGLE] * 2, "azimuth": [0, 0]}
    return Case(
        string=[
            pipe | {"material": {"density": WEIGHT / 9.81 / area}},
            {"kind": "bit", "length": 0.3, "od": 0.2159, "mass": 7.0},
        ],
        well={
            "survey": survey,
            "sections": [{"kind": "open_hole", "diameter": 0.2159, "friction": FRICTION}],
        },
        top={"kind": "top_drive", "lowering": 1e-3} | top,
        bottom="bit",
        initial={"wob": WOB},
        gravity=9.81,
        time={"end": 0.01},
    )


LATER = {"time": [0.0, 1.0], "value": [0.0, 10.0]}


def test_the_bit_takes_half_of_the_friction():
    model = build_model(case(rotation=LATER))
    assert freed_weight(model) == pytest.approx(FREED, rel=2e-2)
    (said,) = motion.freed_weight.sentences(Start(model=model, freed_weight=freed_weight(model)))
    assert "5 kN" in said and "about 21 kN" in said


@pytest.mark.parametrize("top", [{"rotation": 10.0}, {"rotation": 0.0}, {"rotation": LATER, "lowering": 0.0}])
def test_nothing_is_freed_without_a_change_from_sliding_to_turning(top):
    assert freed_weight(build_model(case(**top))) is None


def test_a_run_says_so(tmp_path):
    warnings = run(case(rotation=LATER), tmp_path / "run", progress="silent").summary["warnings"]
    assert any("rotation frees its friction" in text for text in warnings)
