"""Strings pushed beyond their buckling loads: statics refuses one that has fallen over, a quasi-static run says that its buckles jump."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc import Case, run, statics
from drillpetsc.case.writer import case_data
from drillpetsc.errors import SolveError
from drillpetsc.output import read_table
from tests.helpers.wells import simple_well

G = 9.80665
PIPE, COLLAR = (0.127, 0.1086), (0.2032, 0.0714)


def on_bottom(wob: float) -> Case:
    def pipe(size, length):
        return {"kind": "pipe", "length": length, "od": size[0], "id": size[1], "element_length": 10}

    return Case(
        well=simple_well(1150, 0.31115),
        string=[
            pipe(PIPE, 1000),
            pipe(COLLAR, 149.6),
            {"kind": "bit", "length": 0.4, "od": 0.31115, "mass": 150},
        ],
        top={"kind": "top_drive"},
        bottom="bit",
        contact="none",
        initial={"wob": wob},
    )


def test_a_fallen_string_is_refused(tmp_path):
    """Collars of 2.19 kN/m buckle at 1.94 (EI w^2)^(1/3) = 84 kN (Lubinski) at the latest: 90 kN in free space is no state of a bit
    that stands.  30 kN is: the hook carries the weight less 30 kN."""
    weight = sum(
        7850 * np.pi / 4 * (od**2 - bore**2) * length * G
        for (od, bore), length in ((PIPE, 1000), (COLLAR, 149.6))
    )
    hook = statics(on_bottom(30e3), tmp_path / "stands").summary["hook_load"]
    assert hook == pytest.approx(weight + 150 * G - 30e3, rel=1e-6)
    with pytest.raises(SolveError, match="falls over"):
        statics(on_bottom(90e3), tmp_path / "falls")


def test_quasi_static_run_says_that_its_buckles_jump(tmp_path):
    """The second buckling load of the collars is 3.75 (EI w^2)^(1/3) = 163 kN (Lubinski): beyond it the state of one bow ends."""
    given = case_data(on_bottom(140e3))
    del given["contact"]
    given["well"]["sections"][0]["friction"] = 0.2
    for pipe in given["string"][:2]:
        del pipe["element_length"]
    pushed = Case(
        **given
        | {
            "top": {"kind": "top_drive", "rotation": 11.5, "lowering": 0.0025},
            "formation": {"drillability": 0},
            "time": {"mode": "quasi_static", "end": 30},
        }
    )
    with pytest.raises(SolveError, match="buckles jump"):
        run(pushed, tmp_path / "run", progress="silent")
    assert 155e3 < read_table(tmp_path / "run" / "history.csv")["wob [N]"][-1] < 250e3


@pytest.mark.parametrize(
    ("bottom", "share", "words"), [("bit", 1.2, "lifted off"), ("free", 0.8, "nothing holds")]
)
def test_a_pull_that_is_not_the_weight_is_named(bottom, share, words, tmp_path):
    """The top pulls with more than rho A g L, or with less and no bottom: pull and weight stand in the message."""
    area, length = np.pi / 4 * (PIPE[0] ** 2 - PIPE[1] ** 2), 200.0
    weight = 7850 * area * G * length
    case = Case(
        well=simple_well(length, 0.2159, friction=0.2),
        string=[{"kind": "pipe", "length": length, "od": PIPE[0], "id": PIPE[1], "element_length": 10}],
        top={"kind": "top_drive", "force": share * weight},
        bottom=bottom,
    )
    with pytest.raises(SolveError, match=words) as found:
        statics(case, tmp_path / "pulled")
    for force in (share * weight, weight):
        assert f"{force / 1e3:.4g} kN" in str(found.value)
