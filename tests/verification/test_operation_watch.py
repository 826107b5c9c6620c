"""What no rig and no tool does is told at the end of a run (manual: sec-outputs-watch), and a string that nothing holds is refused."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from drillpetsc import Case, run, statics
from drillpetsc.doubts.motion import motor_stalls
from drillpetsc.errors import SolveError
from drillpetsc.output.watches.operation_watch import OperationWatch
from tests.helpers.wells import simple_well

PIPE = {"kind": "pipe", "od": 0.127, "id": 0.1086, "element_length": 10.0}
COLLAR = {"kind": "pipe", "od": 0.1715, "id": 0.0714, "element_length": 5.0}
OFF = {"progress": "silent"}


def hole(inclination: float = 0.0) -> dict[str, Any]:
    return simple_well(100, 0.2159, inclination, friction=0.2)


@pytest.mark.parametrize(("lowered", "beyond"), [(0.25, 0.15), (0.05, 0.0)])
def test_a_free_end_that_passes_the_end_of_its_hole(tmp_path, lowered, beyond):
    """99.9 m of pipe in 100 m of hole, lowered: its end is ``lowered`` - 0.1 m below the hole at the end, and its own weight
    stretches it by rho g L^2/2E = 1.9 mm."""
    speed, time = lowered / 0.5, 0.5
    case = Case(
        well=hole(),
        string=[PIPE | {"length": 99.9}],
        top={"kind": "top_drive", "lowering": speed},
        bottom="free",
        time={"end": time},
        output={"history_every": 0.05},
    )
    said = [w for w in run(case, tmp_path / "run", **OFF).summary["warnings"] if "passes the end" in w]
    if not beyond:
        assert not said
        return
    stretch = 7850 * 9.80665 * 99.9**2 / 2 / 206e9
    words = said[0].split()
    assert float(words[words.index("from") + 1]) == pytest.approx((0.1 - stretch) / speed, abs=0.05)
    assert float(words[words.index("to") + 1]) == pytest.approx(beyond + stretch, abs=2e-3)


def pushed(end: float) -> Case:
    """Pipe of 10 kN, collars and a shock sub on a bit, lowered by up to 40 mm after 0.2 s."""
    return Case(
        well=hole(),
        string=[
            PIPE | {"length": 89.7},
            {
                "kind": "shock_sub",
                "name": "sub",
                "length": 4.0,
                "od": 0.1715,
                "id": 0.0714,
                "stiffness": 2e6,
                "damping": 2e4,
                "stroke": [-5e-3, 5e-3],
            },
            COLLAR | {"length": 6.0},
            {"kind": "bit", "length": 0.3, "od": 0.2159, "mass": 60},
        ],
        top={"kind": "top_drive", "lowering": {"time": [0, 0.2, 0.3], "value": [0, 0, 0.2]}},
        bottom="bit",
        initial={"wob": 5e3},
        time={"end": end},
        output={"history_every": 0.01, "checkpoint_every": 0.3},
    )


def test_a_top_that_pushes_and_a_shock_sub_on_its_stop(tmp_path):
    """Told with the time of the first row; a continued run tells the same, of all its rows.

    Nothing is said of the 0.2 s in which the string hangs.
    """
    whole = run(pushed(0.4), tmp_path / "whole", **OFF).summary["warnings"]
    push, stop = (next(w for w in whole if word in w) for word in ("top pushes", "sub: closed to its stop"))
    assert "a hook can only pull" in push and "acts as rigid" in stop
    run(pushed(0.33), tmp_path / "parts", **OFF)
    parts = run(pushed(0.4), tmp_path / "parts", restart=True, **OFF).summary["warnings"]
    assert parts == whole
    early = run(pushed(0.2), tmp_path / "early", **OFF).summary["warnings"]
    assert not [w for w in early if "pushes" in w or "stop" in w]


@pytest.mark.parametrize(("load", "on_stop"), [(8e3, False), (60e3, True)])
def test_statics_of_a_shock_sub_on_its_stop(tmp_path, load, on_stop):
    """Its spring carries 10 kN at 5 mm; the load is the weight on the bit less that of 8 m of collars and the bit below it.

    Below 10 kN the spring carries most of it; the force of 50 kN at the end of the travel is k e/2 of a stop of 1e9 N/m that sets
    in over 0.1 mm.
    """
    area = np.pi / 4 * (0.1715**2 - 0.0714**2)
    below = 9.80665 * (7850 * area * 8.0 + 60)
    case = pushed(0.4).model_copy(
        update={"initial": pushed(0.4).initial.model_copy(update={"wob": load + below})}
    )
    said = [w for w in statics(case, tmp_path / "s").summary["warnings"] if "the slider at MD" in w]
    assert bool(said) is on_stop
    if on_stop:
        carried = said[0].split("carries ")[1].split(" kN")[0]
        assert "closed to its stop at -5 mm" in said[0] and float(carried) == pytest.approx(
            (load - 10e3) / 1e3, rel=0.02
        )


def test_a_motor_near_its_stall():
    """Rows with torques of 13, 13.4 and 13.8 kN m under a stall torque of 14 kN m: two of four are above 95 % of it."""
    case = Case(
        string=[
            {
                "kind": "pdm",
                "length": 8.0,
                "od": 0.1715,
                "id": 0.1,
                "pdm": {"rev_per_volume": 70.0, "stall_torque": 14e3, "flow_rate": 0.03},
            }
        ],
        top="clamped",
        time={"end": 1},
    )
    watch = OperationWatch(case, [("time", "s"), ("motor_output_torque", "N m")])
    watch.update(np.array([[0.0, 13e3], [0.1, 13.2e3]]))

    def said(w: OperationWatch) -> list[str]:
        return motor_stalls.sentences(SimpleNamespace(watch=w, units="metric"))

    assert said(watch) == []
    watch.update(np.array([[0.2, 13.4e3], [0.3, 13.8e3]]))
    continued = OperationWatch(case, [("time", "s"), ("motor_output_torque", "N m")])
    continued.set_notes(watch.get_notes())
    for w in (watch, continued):
        assert len(said(w)) == 1
        assert all(word in said(w)[0] for word in ("95 %", "14 kN m", "from 0.2 s on in 50 % of the rows"))


@pytest.mark.parametrize("mud", [False, True])
@pytest.mark.parametrize("inclination", [np.radians(60.0), np.pi / 2])
def test_statics_of_a_string_that_nothing_holds(tmp_path, inclination, mud):
    """Cut pipe in its hole: friction has no motion to act against, so there is no state; a path from a held string is none."""
    fluid = {"density": 1200.0, "rheology": {"model": "newtonian", "viscosity": 0.01}, "flow_rate": 0.0}
    case = Case(
        well=hole(inclination),
        string=[PIPE | {"length": 60.0}],
        top="free",
        bottom="free",
        **({"fluid": fluid} if mud else {}),
    )
    with pytest.raises(SolveError, match="the string is not held along the hole"):
        statics(case, tmp_path / "statics")


def test_a_free_end_at_the_end_of_its_hole_is_named(tmp_path):
    """700 m of casing on pipe, run in at 0.2 m/s in mud to the last metre: the mud that it displaces has no place below it."""
    case = Case(
        well=simple_well([0, 500, 1000, 2000], 0.2159, list(np.radians([0, 0, 60, 60])), friction=0.0),
        string=[PIPE | {"length": 1300.0}, {"kind": "pipe", "length": 700.0, "od": 0.1778, "id": 0.157}],
        top={"kind": "top_drive", "lowering": 0.1},
        bottom="free",
        fluid={
            "density": 1260.0,
            "rheology": {"model": "bingham", "plastic_viscosity": 0.02, "yield_stress": 8.0},
            "flow_rate": 0.03,
        },
    )
    try:
        found = statics(case, tmp_path / "statics").summary
    except SolveError as error:
        assert "the free end of the string reaches the end of the hole, MD 2000 m" in str(error)
    else:  # a state is as good, if it says where its end is
        assert any("below the end of the hole" in w for w in found["warnings"])
