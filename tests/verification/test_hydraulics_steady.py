"""Steady hydraulics of a fixed string: losses, hydrostatics, nozzles, ends (manual: sec-mud-steady,
verif-nozzles, verif-steady-loop)."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
from drillpetsc.case import Case
from drillpetsc.model.drilling_model import build_model
from drillpetsc.physics.fluid.rheology import Rheology, wall_shear
from drillpetsc.solvers.time.time_integrator import TimeIntegrator
from tests.helpers.moving import matrices
from tests.helpers.mud import (
    BORE,
    COEFFICIENT,
    DENSITY,
    GRAVITY,
    HOLE,
    INNER,
    INVISCID,
    LENGTH,
    MUD,
    NOZZLE,
    OPEN,
    OUTER,
    RIGID,
    bore,
    flows,
    friction,
    loop,
    pressures,
    started,
    string,
)
from tests.helpers.wells import newtonian, simple_well

HEAD = DENSITY * GRAVITY * LENGTH
TABLE = {
    5: (14.8392, 6.4570, 1.1510, 7.2311, 1236.856),
    30: (95.9407, 37.1428, 41.4361, 17.3618, 1288.490),
    60: (308.8715, 116.3963, 165.7446, 26.7307, 1336.242),
}  # pump, pipe, bit, annulus [bar], ECD [kg/m3]


def losses(model) -> np.ndarray:
    """(5,) pump pressure, losses in pipe, bit, annulus [Pa], equivalent circulating density [kg/m3]."""
    p, o = pressures(model, "bore"), pressures(model, "annulus")
    return np.array(
        [p[0], p[0] - p[-1] + HEAD, p[-1] - o[-1], o[-1] - o[0] - HEAD, o[-1] / (GRAVITY * LENGTH)]
    )


def nozzle_loss(
    q: float, density: float = DENSITY, coefficient: float = COEFFICIENT, area: float = NOZZLE
) -> float:
    """rho (q rho0/rho / A)^2 / 2 Cd^2 of a flow rate at zero pressure [Pa]; |q| is rounded at 1e-5 m3/s."""
    return DENSITY**2 / density * q * np.hypot(q, 1e-5) / (2 * coefficient**2 * area**2)


@pytest.mark.parametrize("q", [5, 30, 60, -30])
def test_losses_of_the_loop(q):
    """Losses [l/s]: the table within its printed digits (1e-4), each loss and their sum within 1e-5 of the
    blend formula in mud.py (manual: verif-steady-loop).

    At 1e14 Pa mud under 235 bar weighs 3 Pa more, 5e-6 of the smallest loss. Reverse flow has opposite
    losses.
    """
    flow = 1e-3 * q
    found = losses(started(loop({**RIGID, "flow_rate": flow})))
    pump, pipe, bit, annulus, ecd = TABLE[abs(q)]
    sign = np.sign(q)
    assert found[:4] == pytest.approx(sign * 1e5 * np.array([pump, pipe, bit, annulus]), rel=2e-5)
    if q > 0:
        assert found[4] == pytest.approx(ecd, abs=1e-3)
    exact = np.array(
        [
            LENGTH * friction(flow, BORE, INNER, False),
            nozzle_loss(flow),
            LENGTH * friction(flow, OPEN, HOLE - OUTER, True),
        ]
    )
    assert found[1:4] == pytest.approx(exact, rel=1e-5)
    assert found[0] == pytest.approx(exact.sum(), rel=1e-6)


@pytest.mark.parametrize("elements", [1, 3, 40])
@pytest.mark.parametrize("q", [0.002, 0.03])
def test_friction_is_exact_with_any_number_of_elements(q, elements):
    """Laminar and turbulent flow through a bore at 1e14 Pa: 4 tau L/d at the mean density within 1e-10; the
    remaining error, the square of the pressure over the bulk modulus, is below 1e-14 (manual:
    verif-friction-any-mesh)."""
    model = started(bore({**MUD, **RIGID, "flow_rate": q}, elements))
    p = pressures(model, "bore")
    density = DENSITY * (1 + 0.5 * p[0] / 1e14)
    assert p[0] - p[-1] == pytest.approx(LENGTH * friction(q, BORE, INNER, False, density), rel=1e-10)


@pytest.mark.parametrize("index", [0.6, 1.0])
@pytest.mark.parametrize("q", [1e-7, 1e-4, 0.004, 0.02, -0.06])
def test_the_exact_law_of_four_elements_at_once_is_that_of_one(q, index):
    """Gelled, laminar and turbulent flow: losses of bore and annulus against the law evaluated by itself, whose profile is that of
    Buckingham and of the slot (tests/unit/physics/test_rheology.py)."""
    numbers = {"yield_stress": 8.0, "consistency": 0.4, "index": index}
    law = Rheology("herschel_bulkley", "exact", **numbers)
    mud = {"rheology": {"model": "herschel_bulkley", **numbers, "law": "exact"}, "density": DENSITY}
    found = losses(started(loop({**mud, **RIGID, "flow_rate": q}, 6)))[[1, 3]]
    for loss, area, diameter, annulus in zip(
        found, (BORE, OPEN), (INNER, HOLE - OUTER), (False, True), strict=True
    ):
        exact = LENGTH * 4 / diameter * float(wall_shear(law, q / area, diameter, annulus, DENSITY))
        assert loss == pytest.approx(exact, rel=2e-5, abs=3.0)  # the mud weighs 3 Pa more by its own pressure


def test_second_order_in_the_mesh_with_a_compressible_mud():
    """Loop of mud of 2 GPa against p' = rho g - 4 tau/d with rho = rho0 exp(p/K), solved to 1e-12; elastic
    walls do not change a steady state.

    This omits d(rho w^2)/ds, as the model does: (w/c)^2 of the pressure's change, 6e-6. 100 elements: 1e-9.
    """
    q, K = 0.03, 2e9

    def slope(area: float, diameter: float, slot: bool, flow: float):
        def right(s, p):
            rho = DENSITY * np.exp(p[0] / K)
            return [rho * GRAVITY - friction(flow, area, diameter, slot, rho)]

        return right

    way = {"rtol": 1e-12, "atol": 1e-3, "method": "DOP853"}
    under = solve_ivp(slope(OPEN, HOLE - OUTER, True, -q), (0, LENGTH), [0.0], **way).y[0, -1]
    above = under + nozzle_loss(q, DENSITY * np.exp(under / K))
    exact = np.array(
        [solve_ivp(slope(BORE, INNER, False, q), (LENGTH, 0), [above], **way).y[0, -1], above, under]
    )
    errors = []
    for n in (2, 4, 8, 100):
        model = started(loop({"bulk_modulus": K, "flow_rate": q}, n))
        p, o = pressures(model, "bore"), pressures(model, "annulus")
        errors.append(np.abs(np.array([p[0], p[-1], o[-1]]) - exact))
    coarse, middle, fine, finest = errors
    assert np.all(np.log2(coarse / middle) > 1.99) and np.all(np.log2(middle / fine) > 1.99)
    assert np.all(finest < 2e-9 * exact)


def test_jacobian_of_turbulent_flow_of_a_soft_mud():
    """Friction depends on the pressure through the density (in the speed and in the Reynolds number): the
    derivative is that of central differences, at a modulus of 0.2 GPa, where this part is 1e-2 of the
    derivative."""
    system = started(bore({**MUD, "bulk_modulus": 2e8, "elastic_walls": False, "flow_rate": 0.03}, 2)).system
    asm, exact, vector = system.assembly, matrices(system)[0], system.new_condensed()

    def rows(j: int, step: float) -> np.ndarray:
        before = asm.x[j]
        asm.x[j] += step
        asm.invalidate_prescribed_values()
        system.sum_residual(0.0, vector)
        asm.x[j] = before
        return vector.getArray().copy()

    for j in range(system.layout.size):
        h = 1e-3 * system.scale[j]
        found = (rows(j, -2 * h) - 8 * rows(j, -h) + 8 * rows(j, h) - rows(j, 2 * h)) / (12 * h)
        assert found == pytest.approx(exact[:, j], rel=1e-6, abs=1e-9 * np.abs(exact[:, j]).max())


def test_density_grows_with_depth():
    """Still mud, rho = rho0 exp(p/K): p_b = -K ln(1 - rho0 g L/K), 1.4e6 Pa above rho0 g L at K = 2 GPa;
    second order in the mesh (manual: verif-hydrostatics)."""
    K = 2e9
    exact = -K * np.log1p(-DENSITY * GRAVITY * LENGTH / K)
    assert exact - HEAD > 1e5
    errors = []
    for n in (2, 4, 100):
        model = started(loop({"bulk_modulus": K}, n))
        for component in ("bore", "annulus"):
            errors.append(abs(pressures(model, component)[-1] - exact))
            assert np.abs(flows(model, component)).max() < 1e-9
    assert np.log2(errors[0] / errors[2]) > 1.99
    assert max(errors[4:]) < 1e-9 * exact


@pytest.mark.parametrize(("coefficient", "bar"), [(0.95, 130.938), (0.98, 123.044), (1.03, 111.388)])
def test_pressure_loss_of_nozzles(coefficient, bar):
    """Three nozzles of 12/32 in, 30 l/s of 1200 kg/m3: 213.767 mm2 and the pressure losses of the table;
    dissipated power dp q, 392.8 kW at 0.95 (manual: verif-nozzles)."""
    area = 3 * np.pi / 4 * (12 / 32 * 0.0254) ** 2
    assert area == pytest.approx(213.767e-6, rel=1e-5)
    parts = string(nozzle_area=area)
    model = started(loop({**RIGID, "flow_rate": 0.03, "discharge_coefficient": coefficient}, string=parts))
    assert losses(model)[2] == pytest.approx(1e5 * bar, rel=1e-5)
    assert model.fluid is not None and model.fluid.bit is not None
    lost, flow = model.fluid.bit.element_results(model.system.assembly)[:2]
    assert flow == pytest.approx(0.03, rel=1e-12)
    assert lost == pytest.approx(1e5 * bar * 0.03, rel=1e-5)


@pytest.mark.parametrize("q", [0.005, 0.03, -0.03])
def test_pump_pressure_of_a_flow_gives_that_flow(q):
    """The pump pressure of a flow rate, prescribed, gives that flow rate: another initial state, same
    solution (manual: verif-pump-choke-valve)."""
    p = pressures(started(loop({"flow_rate": q}, 20)), "bore")[0]
    model = started(loop({"pump_pressure": float(p)}, 20))
    assert flows(model, "bore") == pytest.approx(q, rel=1e-9)
    assert flows(model, "annulus") == pytest.approx(-q, rel=1e-9)


def test_check_valve_holds_back_flow():
    """Inviscid mud, 50 bar on the annulus and none on the bore: a back flow Cd A sqrt(2 dp/rho), which the valve holds;
    forward it resists nothing (q |q| is rounded at 1e-5 m3/s; manual: verif-pump-choke-valve)."""
    back = COEFFICIENT * NOZZLE * np.sqrt(2 * 50e5 / DENSITY)
    ends = {**INVISCID, **RIGID, "pump_pressure": 0.0, "outlet_pressure": 50e5}
    assert flows(started(loop(ends, 4)), "bore") == pytest.approx(-back, rel=1e-5)
    shut = flows(started(loop({**ends, "check_valve": True}, 4)), "bore")
    assert np.all(-1e-5 * back < shut) and np.all(shut < 0)
    ends |= {"pump_pressure": 50e5, "outlet_pressure": 0.0, "check_valve": True}
    assert flows(started(loop(ends, 4)), "bore") == pytest.approx(back, rel=1e-5)


@pytest.mark.parametrize("with_annulus", [False, True])
def test_sealed_bore_under_pump_pressure(with_annulus):
    """Plugged string under pump pressure: hydrostatic pressure, p = -K ln(exp(-p0/K) - rho0 g s/K), and no
    flow."""
    K, p0 = 2e9, 200e5
    fluid = {"bulk_modulus": K, "pump_pressure": p0, "annulus": with_annulus}
    model = started(loop(fluid, 100, bottom={"kind": "bit", "plugged": True}))
    s = model.mesh.node_depth
    assert pressures(model, "bore") == pytest.approx(
        -K * np.log(np.exp(-p0 / K) - DENSITY * GRAVITY * s / K), rel=1e-8
    )
    assert np.abs(flows(model, "bore")).max() < 1e-9
    if with_annulus:
        assert pressures(model, "annulus") == pytest.approx(
            -K * np.log1p(-DENSITY * GRAVITY * s / K), rel=1e-8
        )
        assert np.abs(flows(model, "annulus")).max() < 1e-9


def test_a_choke_holds_its_pressure_against_the_outflow():
    """rho q^2/(2 Cd^2 A^2) is added to the outlet pressure, forward and (inward) in reverse circulation; the
    pump pressure rises by it (manual: verif-pump-choke-valve)."""
    drop = DENSITY * 0.03**2 / (2 * 0.9**2 * 400e-6**2)
    valve = {"choke": {"area": 400e-6, "discharge_coefficient": 0.9}, "outlet_pressure": 2e5}
    for q in (0.03, -0.03):
        with_valve, without = (
            pressures(started(loop({**RIGID, "flow_rate": q, **more}, 20)), "bore")[0] for more in (valve, {})
        )
        top = pressures(started(loop({**RIGID, "flow_rate": q, **valve}, 20)), "annulus")[0]
        assert top == pytest.approx(2e5 + np.sign(q) * drop, rel=1e-6)
        assert with_valve - without == pytest.approx(2e5 + np.sign(q) * drop, rel=1e-6)


def test_the_pressure_outside_a_string_without_annulus_follows_its_input():
    """Stiff mud at rest in the bore alone: the open end has the outlet pressure, at the start and after its
    ramp in a run."""
    outlet = {"time": [0, 0.01, 0.02, 1], "value": ["2 bar", "2 bar", "5 bar", "5 bar"]}
    fluid = newtonian(DENSITY, 1.0, outlet_pressure=outlet)
    case = Case(
        string=[{"kind": "pipe", "length": 20, "od": 0.127, "id": 0.02, "element_length": 5}],
        hold_string=True,
        fluid=fluid,
        gravity=0.0,
    )
    model = build_model(case)
    find_equilibrium(model)
    assert pressures(model, "bore") == pytest.approx(2e5, rel=1e-9)
    assert model.breaks == (0.01, 0.02)
    TimeIntegrator(model.system).run(0.0, 1.0, model.breaks)
    assert pressures(model, "bore") == pytest.approx(5e5, rel=1e-3)


def test_a_string_that_reaches_below_the_end_of_its_hole_has_a_steady_flow():
    """The mud under the bit opens by a logistic function of the gap, whose exponential overflowed 0.3 m below
    the bottom; the message was that the flow is not determined."""
    case = Case(
        well=simple_well(2000.0, 0.3, friction=0.1),
        string=[
            {"kind": "pipe", "length": 1999.6, "od": 0.127, "id": 0.1086, "element_length": 50.0},
            {"kind": "bit", "length": 0.4, "od": 0.25, "mass": 60.0},
        ],
        top={"kind": "top_drive"},
        bottom="free",
        gravity=9.81,
        fluid=newtonian(1200.0, 0.02, bulk_modulus=2e9, flow_rate=0.01),
    )
    model = build_model(case)
    state = find_equilibrium(model)
    assert any("below the end of the hole" in w for w in state.warnings)
    flow = model.system.field("bore.flow")
    assert np.isfinite(model.system.assembly.x).all() and flow.size
