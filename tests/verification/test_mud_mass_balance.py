"""Conservation of mud mass, by the results of the program (manual: sec-mud-mass, verif-mud-mass-balance)."""

from __future__ import annotations

import numpy as np
import pytest

import drillpetsc
from drillpetsc.fem.quantity import OneStep
from drillpetsc.model.drilling_model import DrillingModel
from tests.helpers.motion import fixed, integrate
from tests.helpers.mud import hole, loop, started

PUMP = 0.03  # [m3/s]
STOPPED = {"time": [0.0, 0.5, 1.0, 9.0], "value": [PUMP, PUMP, 0.0, 0.0]}
MOVING = {
    "hold_string": False,
    "contact": "none",
    "bottom": {"kind": "free"},
    "length": 1000.0,
    "well": hole(1050.0),
    "top": {
        "kind": "top_drive",
        "rotation": 10.0,
        "lowering": {"time": [0.0, 0.2, 1.0], "value": [0.3, 0.3, 0.0]},
    },
}
MOTIONS = {"held": {}, "moving": MOVING}


def loop_of(kind: str, elements: int = 40, flow=STOPPED, **case) -> DrillingModel:
    """Circulation loop whose pump stops; the string is fixed, or lowered and rotated, with the flow line 2 m
    below the top."""
    return loop({"flow_rate": flow, "flow_line": 2.0}, elements, **{**MOTIONS[kind], **case})


def surplus(model: DrillingModel, t: float) -> float:
    """Storage rate of the channels, of the mud under the bit and of the hole above the string, from the
    integrator's y, minus pumped plus returned flow [m3/s at zero pressure].

    Under the bit: content (1/K + c/(1 + c p)) p' - theta A_w V, theta = exp(p/K)(1 + c p), with c the
    compliance of the wall and V the speed of the string.
    """
    f, asm = model.fluid, model.system.assembly
    assert f is not None and f.bore is not None and f.annulus is not None and f.bit is not None
    end, stored = (
        f.bit.end,
        sum(component.element_results(asm)[:, 5:7].sum() for component in (f.bore, f.annulus)),
    )
    at = model.system.layout.dofs["annulus.pressure"][-1, 0]
    p, rate, soft = asm.x[at], asm.y[at], 1 / f.constants.bulk_modulus
    stored += f.bit.element_results(asm)[4] * (soft + end.elasticity / (1 + end.elasticity * p)) * rate
    if model.beam.moves:
        speed = model.system.field("string.position", "y")[:, 2]
        stored -= np.exp(p * soft) * (1 + end.elasticity * p) * end.hole * speed[-1]
        stored += (f.annulus.annulus.hole[0] - f.annulus.annulus.outer[0]) * speed[0]
    pumped, returned = f.bore.pumped_of(OneStep(asm, t))[0], f.annulus.outflow(asm)
    assert pumped is not None and returned is not None
    return float(stored - pumped + returned)


@pytest.mark.parametrize("kind", MOTIONS)
def test_every_step_keeps_the_mass(kind):
    """storage = pumped - returned after every accepted step of a pump stop, within 1e-12 of the pump flow;
    Newton to rounding and steps of 20 ms (manual: verif-mud-mass-balance).

    The rounding of rates is that of x over the step; a string at 1000 m and steps of 1 ms would give 1e-11.
    """
    model, seen = started(loop_of(kind)), []
    integrate(
        model.system,
        1.5,
        fixed(0.02, q_snes_stol=1e-14),
        lambda t, dt: seen.append(surplus(model, t)),
        model.breaks,
    )
    assert len(seen) >= 75
    assert np.abs(seen).max() < 1e-12 * PUMP


@pytest.mark.parametrize("kind", MOTIONS)
def test_default_tolerances_bound_the_mass_error_of_a_step(kind):
    """Default steps and Newton: error of a few times 2e-8 m3/s, from Newton's tolerance (2e-6 of the flow
    scale, 1e-2 m3/s)."""
    model, seen = started(loop_of(kind)), []
    run = integrate(model.system, 1.5, {}, lambda t, dt: seen.append(surplus(model, t)), model.breaks)
    assert run.counters.steps > 20
    assert np.abs(seen).max() < 1e-7


def test_an_hour_of_pumping(tmp_path):
    """30 l/s for an hour with the longest possible steps: 108 m3 in, the same volume out, and an unchanged
    content within 1e-9 of that."""
    case = loop(
        {"flow_rate": PUMP}, 10, time={"end": 3600.0}, output={"history_every": 60.0, "field_every": 3600.0}
    ).case
    mass = drillpetsc.run(case, tmp_path / "hour", progress="silent").summary["mass"]
    for figure in ("pumped", "returned"):
        assert mass[figure] == pytest.approx(108.0, rel=1e-9)
    assert abs(mass["error"]) < 1e-9 * 108.0


@pytest.mark.parametrize("kind", MOTIONS)
def test_closing_balance_of_a_run(kind, tmp_path):
    """Pump stop: pumped and returned volumes and change of content match within 3e-5 of the largest with
    BDF at default tolerances and 3e-6 with a tenth of them (generalised-alpha takes longer steps here: 4e-5).

    The content is a nonlinear function of the pressure: second order in the step. The pumped volume is the
    scheduled one.
    """
    for most, petsc in ((3e-5, {"ts_type": "bdf"}), (3e-6, {"ts_type": "bdf", "ts_rtol": 1e-5})):
        case = loop_of(kind, 100, time={"end": 4.0}, petsc=petsc).case
        mass = drillpetsc.run(case, tmp_path / "stop", progress="silent", overwrite=True).summary["mass"]
        assert mass["pumped"] == pytest.approx(0.75 * PUMP, rel=1e-3)
        assert abs(mass["content_change"]) > 1e-2
        assert abs(mass["content_change"] - mass["pumped"] + mass["returned"]) < most * max(
            mass["pumped"], mass["returned"]
        )
