"""A choke at the flow line above a string that moves; chokes that are too small (manual: sec-mud-ends)."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc.analysis.statics.placement import place_along_hole
from drillpetsc.analysis.statics.steady_flow import steady_flow
from drillpetsc.errors import CaseError
from tests.helpers.component_models import SHIFT, dense, differences, residual
from tests.helpers.mud import DENSITY, GRAVITY, MUD, RIGID, hole, loop, started
from tests.verification.test_hydraulics_steady import pressures
from tests.verification.test_mud_while_drilling import BACK, ROP, drilling

AREA, COEFFICIENT, OUTLET = 4e-4, 0.9, 1e5
VALVE = {"choke": {"area": AREA, "discharge_coefficient": COEFFICIENT}, "outlet_pressure": OUTLET}


def loss(flow: float) -> float:
    """Pressure drop [Pa] of an outflow [m3/s]: rho q |q|/(2 Cd^2 A^2), rounded below 0.025 m/s times Cd A."""
    return (
        0.5 * DENSITY * flow * float(np.hypot(flow, 0.025 * COEFFICIENT * AREA)) / (COEFFICIENT * AREA) ** 2
    )


@pytest.mark.parametrize("cuttings", BACK)
def test_a_choke_takes_the_outflow_of_a_string_that_drills(cuttings):
    """The flow out of the upper node, less what the hole above it gains while it moves down: the return, 1e-8."""
    model = started(drilling(cuttings, 500.0, valve=VALVE))
    system, n = model.system, model.mesh.nodes
    system.set_field("hole.end", np.tile([0.0, 0.0, ROP], (n, 1)), "y")
    system.set_field("hole.drilled", np.full((n, 1), ROP), "y")
    steady_flow(system)
    assert model.fluid.annulus.outflow(system.assembly) == pytest.approx(BACK[cuttings], rel=1e-8)
    depth = system.assembly.x[
        system.layout.dofs["string.position"][0, 2]
    ]  # of the node, stretched by the weight on bit
    head = OUTLET + DENSITY * GRAVITY * depth
    assert pressures(model, "annulus")[0] == pytest.approx(head + loss(BACK[cuttings]), rel=1e-8)


def lowered(speed: float) -> dict:
    """A closed-ended string that is lowered with ``speed`` [m/s]."""
    return {
        "hold_string": False,
        "well": hole(160.0),
        "contact": "none",
        "bottom": {"kind": "free", "plugged": True},
        "top": {"kind": "top_drive", "lowering": speed},
    }


@pytest.mark.parametrize("speed", [0.4, -0.25])
def test_a_choke_takes_what_a_closed_string_displaces(speed):
    """A_o V of the pipe that enters, not A_w V that passes the upper node: a loss (A_o/A_w)^2 as large, 1e-7."""
    model = started(loop({**RIGID, **VALVE}, 20, 150.0, **lowered(speed)))
    steady_flow(model.system)
    outer = 0.25 * np.pi * model.case.string[0].od ** 2
    assert pressures(model, "annulus")[0] == pytest.approx(OUTLET + loss(outer * speed), rel=1e-7)


@pytest.mark.parametrize(("area", "speed"), [(1e-5, 1e-2), (1e-6, 1e-3), (1e-6, -2e-4), (1e-7, 1e-4)])
def test_a_choke_that_is_nearly_closed_keeps_its_law(area, speed):
    """An orifice of a millionth of a square metre above a closed string that is lowered slowly: rho q |q|/(2 Cd^2 A^2) to 1e-4."""
    valve = {"choke": {"area": area, "discharge_coefficient": COEFFICIENT}, "outlet_pressure": OUTLET}
    model = started(loop({**RIGID, **valve}, 20, 150.0, **lowered(speed)))
    steady_flow(model.system)
    flow = 0.25 * np.pi * model.case.string[0].od ** 2 * speed
    wanted = 0.5 * DENSITY * flow * abs(flow) / (COEFFICIENT * area) ** 2
    assert pressures(model, "annulus")[0] - OUTLET == pytest.approx(wanted, rel=1e-4, abs=1.0)


def test_jacobian_of_the_choke_of_a_moving_string():
    """Derivatives by position through the rates, and by the flow: differences of fourth order, 1e-6."""
    top = {"kind": "top_drive", "force": 1e5}  # its position is an unknown
    case = lowered(0.0) | {"well": hole(40.0), "bottom": {"kind": "free"}, "top": top}
    model = loop({**MUD, **VALVE, "flow_rate": 0.02}, 3, 30.0, **case)
    place_along_hole(model)
    system = model.system
    asm, n = system.assembly, system.layout.size
    x = asm.x[:n].copy()
    x[system.layout.dofs["annulus.flow"][:, 0]] = -0.02
    asm.v0[:n], asm.v1[:n] = -SHIFT * x, 0.0
    asm.v0[system.layout.dofs["string.position"][0]] += 0.3  # the rates at x
    row = system.layout.dofs["annulus.pressure"][0, 0]
    residual(system, x, 0.2)
    asm.jacobian(0.2, (1.0, SHIFT, SHIFT**2), condensed=True)
    exact = dense(system)[row]
    found = differences(system, x, 0.2, 1e-6)[row]
    scale = np.abs(exact).max()
    assert np.abs(exact[system.layout.dofs["string.position"][0]]).max() > 0
    assert exact == pytest.approx(found, abs=1e-6 * scale)


def test_a_choke_too_small_for_the_pump_is_refused():
    with pytest.raises(CaseError) as error:
        loop({**MUD, "flow_rate": 0.02, "choke": {"area": 1e-8}}, 10)
    assert "fluid.choke.area" in str(error.value)
    assert "passes 0.02 m3/s" in str(error.value)
