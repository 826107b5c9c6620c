"""Tripping: a string that moves along a hole full of mud (manual: sec-mud-string-speed,
verif-tripping-returns).

In the frame of the string the mud under a plugged end is displaced at A_w V and flows everywhere with w =
-A_w V/A_a; along the wall of the hole with w + V = -A_o V/A_a. The friction is that of w + V - 0.45 V,
because part of the mud clings to the pipe. V is positive downward.
"""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc import Case, run
from drillpetsc.analysis.statics.answer import static_summary
from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
from drillpetsc.model.drilling_model import DrillingModel, build_model
from drillpetsc.output.recorder import Recorder
from tests.helpers.motion import fixed, integrate
from tests.helpers.mud import (
    DENSITY,
    GRAVITY,
    HOLE,
    INNER,
    LENGTH,
    MUD,
    OPEN,
    OUTER,
    RIGID,
    SOLID,
    hole,
    loop,
    pressures,
    started,
    wall_stress,
)
from tests.helpers.wells import simple_well

STIFF = {
    "axial_stiffness": 1e13,
    "bending_stiffness": 1e6,
    "torsional_stiffness": 1e7,
    "mass": 26.7,
    "polar_inertia": 0.1,
}
TABLE = {0.5: (6.3338, 10.430), 1.0: (12.6677, 15.047)}  # return [l/s], surge [bar]


def pipe(length: float = LENGTH, elements: int = 20, od: float = OUTER) -> dict:
    """A string with negligible stretch."""
    return {
        "kind": "beam",
        "length": length,
        "od": od,
        "id": INNER,
        "element_length": length / elements,
        **STIFF,
    }


def tripping(
    speed, fluid: dict | None = None, plugged: bool = True, string=(), depth: float = LENGTH + 100, **case
) -> DrillingModel:
    """The string lowered at ``speed`` [m/s], a hundred metres above the bottom, ready to run."""
    top, bottom = {"kind": "top_drive", "lowering": speed}, {"kind": "free", "plugged": plugged}
    return started(
        loop(
            {**RIGID, **(fluid or {})},
            hold_string=False,
            top=top,
            bottom=bottom,
            contact="none",
            well=hole(depth),
            string=list(string) or [pipe()],
            **case,
        )
    )


def surge(model: DrillingModel, flow_line: float = 0.0) -> float:
    """Pressure under the string beyond that of still mud [Pa]."""
    return float(
        pressures(model, "annulus")[-1]
        - DENSITY * GRAVITY * (model.system.field("string.position")[-1, 2] - flow_line)
    )


def returned(model: DrillingModel) -> float:
    """Flow rate out of the flow line [m3/s]."""
    return float(model.fluid.annulus.outflow(model.system.assembly))  # type: ignore[union-attr, arg-type]


def friction(speed: float, outer: float = OUTER, clinging: float = 0.45) -> float:
    """Pressure per length [Pa/m] along a plugged pipe lowered at ``speed``."""
    w = -(outer**2 / (HOLE**2 - outer**2) + clinging) * speed
    return -4 / (HOLE - outer) * wall_stress(w, DENSITY, HOLE - outer, True)


@pytest.mark.parametrize("speed", [0.5, 1.0, -0.5, -1.0])
def test_return_and_surge_of_a_plugged_string(speed):
    """Return A_o V and surge of the friction above: all digits of the table, the formula within 1e-6 and
    1e-5; swab with the opposite sign (manual: verif-tripping-returns).

    At 1e14 Pa mud under 235 bar weighs 4 Pa more.
    """
    model = tripping(speed)
    back, bar = TABLE[abs(speed)]
    sign = np.sign(speed)
    assert returned(model) == pytest.approx(SOLID * speed, rel=1e-6)
    assert returned(model) == pytest.approx(sign * 1e-3 * back, rel=1e-5)
    assert surge(model) == pytest.approx(LENGTH * friction(speed), rel=1e-5)
    assert surge(model) == pytest.approx(sign * 1e5 * bar, rel=1e-4)


@pytest.mark.parametrize("clinging", [0.0, 1.0])
def test_clinging(clinging):
    """Fraction of the pipe's speed that the mud adopts, none or all, in the surge; the return is the same."""
    model = tripping(0.5, {"clinging": clinging})
    assert surge(model) == pytest.approx(LENGTH * friction(0.5, clinging=clinging), rel=1e-5)
    assert returned(model) == pytest.approx(0.5 * SOLID, rel=1e-6)


def test_return_of_a_string_of_two_diameters():
    """Collars of 171.5 mm under drill pipe of 127 mm: the return is the volume that enters at the top, A_o of
    the pipe times V. The surge is the friction of both parts, and rho (w2^2 - w1^2)/2 of the flow relative to
    the moving step."""
    speed, collar = 0.5, 0.1715
    model = tripping(speed, string=[pipe(1800.0, 18), pipe(200.0, 4, collar)])
    w1, w2 = (HOLE**2 / (HOLE**2 - d**2) * speed for d in (OUTER, collar))
    expected = 1800 * friction(speed) + 200 * friction(speed, collar)
    heads = 0.5 * DENSITY * (w2**2 - w1**2)
    assert heads > 3e-4 * expected  # it shows
    assert returned(model) == pytest.approx(SOLID * speed, rel=1e-6)
    assert surge(model) == pytest.approx(expected - heads, rel=1e-5)


def test_open_string_lowered_while_pumping():
    """The pump moves with the string, whose bore remains full: the return is 20 l/s plus A_o V."""
    model = tripping(0.5, {"flow_rate": 0.02}, plugged=False)
    assert returned(model) == pytest.approx(0.02 + 0.5 * SOLID, rel=1e-6)


def test_return_past_a_casing_shoe():
    """From casing of 244.5 mm into the open hole, 10 m above the shoe to 10 m below: the return is always A_o
    V (1e-6), the mud in the hole decreases by A_o V t, and the chamber under the bit is unchanged."""
    section = {"to": 600.0, "kind": "casing", "diameter": 0.2445, "friction": 0.2}
    well = {**hole(1100.0), "sections": [section, *hole(1100.0)["sections"]]}
    top, bottom = {"kind": "top_drive", "lowering": 0.5}, {"kind": "free", "plugged": True}
    model, seen = (
        started(
            loop(
                RIGID,
                hold_string=False,
                top=top,
                bottom=bottom,
                contact="none",
                well=well,
                string=[pipe(590.0, 12)],
            )
        ),
        [],
    )
    chamber, recorder = model.fluid.bit, Recorder(model)  # type: ignore[union-attr]
    recorder.start(0.0)
    first = chamber.element_results(model.system.assembly)[4]  # type: ignore[union-attr]

    def after(t: float, dt: float) -> None:
        recorder.step(t, dt, t, None, not seen)
        seen.append(returned(model))

    integrate(model.system, 40.0, fixed(0.1), after)
    assert np.array(seen) == pytest.approx(0.5 * SOLID, rel=1e-6)
    mass, narrow = recorder.mass_balance(), 0.25 * np.pi * HOLE**2
    assert mass["content_change"] == pytest.approx(-20.0 * SOLID, rel=1e-6)
    assert abs(mass["error"]) < 1e-9 * 20.0 * SOLID
    # 510 m of hole below at first, 490 m at the end; the transition at the shoe lies half above it, half
    # below
    assert chamber.element_results(model.system.assembly)[4] == pytest.approx(7e-3 + narrow * 490.0, rel=1e-6)  # type: ignore[union-attr]
    assert first == pytest.approx(7e-3 + narrow * 500.0 + 0.25 * np.pi * 0.2445**2 * 10.0, rel=1e-5)


BENT = {
    "survey": {"md": [0.0, 300.0, 700.0, 900.0], "inclination": [0.0, 0.0, 0.7, 0.7], "azimuth": [0.0] * 4},
    "sections": hole(900.0, friction=0.1)["sections"],
}


@pytest.mark.parametrize(("length", "speed"), [(250.0, 0.5), (500.0, -0.5), (850.0, 0.5)])
def test_return_far_above_the_bottom_of_a_bent_hole(length, speed):
    """A plugged string in the vertical, the build and the tangent of a hole whose bottom lies at 40 degrees: the return is
    A_o V wherever the lower end is, at the start and while the string moves by 2 m.  The mud under the bit is counted along
    the hole; with the direction of the hole's bottom, 68, 18 and 0 % of the return were missing.  Stretch takes part: 5e-4."""
    steel = {"kind": "pipe", "length": length, "od": OUTER, "id": INNER, "element_length": 10.0}
    model, seen = (
        started(
            loop(
                RIGID,
                hold_string=False,
                top={"kind": "top_drive", "lowering": speed},
                bottom={"kind": "free", "plugged": True},
                contact={"stiffness": 1e8},
                well=BENT,
                string=[steel],
            )
        ),
        [],
    )
    assert returned(model) == pytest.approx(SOLID * speed, rel=5e-4)
    integrate(model.system, 4.0, fixed(0.05), lambda t, dt: seen.append(returned(model)))
    assert np.mean(seen) == pytest.approx(SOLID * speed, rel=1e-3)


@pytest.mark.parametrize("speed", [0.5, -0.5])
def test_energy_of_tripping(speed, tmp_path):
    """Pipe of 250 m that is lowered or hoisted by 3 m in a bent hole 900 m long: the energy balance closes to 1e-5 of the
    energy exchanged.  Mud enters the space under the bit at the bit, and the upper end of the annulus moves against its
    pressure: without these, 1.3 % each of a hoist was missing, 34 % with the wrong direction of the hole."""
    case = {
        "well": BENT,
        "string": [{"kind": "pipe", "length": 250.0, "od": OUTER, "id": INNER, "element_length": 10.0}],
        "top": {"kind": "top_drive", "lowering": {"time": [0, 1, 6, 7], "value": [0, speed, speed, 0]}},
        "bottom": {"kind": "free", "plugged": True},
        "fluid": {**MUD, "flow_rate": 0.0},
        "time": {"end": 8.0},
    }
    energy = run(Case(**case), tmp_path / "run", progress="silent").summary["energy"]
    assert abs(energy["error_share"]) < 1e-5 and energy["gained_share"] < 1e-5


def test_motion_at_one_speed_is_steady_from_the_start():
    """Lowered at .5 m/s from t = 0: return and surge are those of steady motion from the first step (1e-3: a
    string in equilibrium with mud at rest is displaced by the surge, here by 2.5 micrometres), and remain
    constant for 2 s, while the string moves by a metre (1e-6; manual: verif-tripping-in-motion)."""
    model, seen = tripping(0.5), []
    integrate(model.system, 2.0, fixed(0.02), lambda t, dt: seen.append((returned(model), surge(model))))
    flow, pressure = np.array(seen).T
    assert model.system.field("string.position")[0, 2] == pytest.approx(1.0, rel=1e-9)
    assert flow == pytest.approx(SOLID * 0.5, rel=1e-3)
    assert flow[20:] == pytest.approx(SOLID * 0.5, rel=1e-6)
    assert pressure[20:] == pytest.approx(LENGTH * friction(0.5), rel=1e-5)


def test_start_and_stop_of_tripping():
    """Lowered from rest to .5 m/s in 2 s and back to rest in 2 s; mud of 1e14 Pa: return A_o V(t), surge of
    friction and of the inertia of the mud, rho L (A_o/A_a) dV/dt (3.2 bar), within 50 Pa; zero at the end.

    From 0.35 s after each kink; before, the string oscillates.
    """
    rate = 0.25
    model, seen = tripping({"time": [0.0, 2.0, 4.0], "value": [0.0, 0.5, 0.0]}), []
    integrate(
        model.system,
        5.0,
        fixed(0.02),
        lambda t, dt: seen.append((t, returned(model), surge(model))),
        model.breaks,
    )
    t, flow, pressure = np.array(seen).T
    speed = np.interp(t, [0, 2, 4], [0, 0.5, 0])
    for begin, sign in ((0.0, 1.0), (2.0, -1.0), (4.0, 0.0)):
        k = (t > begin + 0.35) & (t < begin + 1.8)
        expected = (
            np.array([LENGTH * friction(v) if v else 0.0 for v in speed[k]])
            + sign * DENSITY * LENGTH * SOLID / OPEN * rate
        )
        assert k.sum() > 30
        assert flow[k] == pytest.approx(SOLID * speed[k], abs=2e-5 * SOLID)
        assert pressure[k] == pytest.approx(expected, abs=50.0)


@pytest.mark.parametrize("speed", [0.0, 0.5])
def test_flow_line_below_the_rotary_table(speed):
    """The mud level is at the flow line, 30 m down: rho g (z - 30 m) under the string, 40 bar more with that
    outlet pressure, for a string at rest or lowered by half a metre; the return is that of a hole full to the
    top."""
    for outlet in (0.0, 40e5):
        model = tripping(speed, {"flow_line": 30.0, "outlet_pressure": outlet})
        if speed:
            integrate(model.system, 1.0, fixed(0.02))
            assert model.system.field("string.position")[0, 2] == pytest.approx(0.5, rel=1e-9)
        moving = LENGTH * friction(speed) if speed else 0.0
        assert surge(model, 30.0) - outlet == pytest.approx(moving, abs=30.0)
        assert returned(model) == pytest.approx(SOLID * speed, abs=1e-5 * SOLID)


@pytest.mark.parametrize("speed", [1.4, 2.0])
def test_statics_of_a_string_that_is_lowered_fast(speed):
    """Running in through a build with a bit of hole size at stand speed: the surge of the moving string loads it from the start.

    The string's start was found about the mud of a string at rest, from which Newton's method took 80 iterations at 1.4 m/s,
    and at 2 m/s found no state ("statics did not converge in 40 iterations").  Halved elements agree.
    """
    loads = []
    for length in (8.0, 4.0):
        case = Case(
            well=simple_well([0, 600, 900], "8.75 in", ["0 deg", "80 deg", "80 deg"], ["0 deg", "35 deg", "35 deg"], friction=0.28),
            string=[
                {"kind": "drill_pipe", "length": 500, "pipe": "4in 14.00 E NC40 premium", "element_length": length},
                {"kind": "drill_collar", "length": 49, "od": "6.25 in", "id": "2.25 in", "element_length": length / 4},
                {"kind": "bit", "length": "0.3 m", "od": "8.75 in", "nozzles": "3 x 12/32 in"},
            ],
            top={"kind": "top_drive", "lowering": f"{speed} m/s"},
            bottom="free",
            fluid={"density": 1250, "flow_rate": "20 l/s", "rheology": {"pv": "20 cP", "yp": "8 Pa"}},
        )  # fmt: skip
        model = build_model(case)
        state = find_equilibrium(model)
        assert state.stable
        assert state.equilibrium.iterations <= 30
        loads.append(static_summary(model, state)["hook_load"])
    assert loads[0] == pytest.approx(loads[1], rel=0.005)
