"""Fluid formulation hermite against closed forms and against formulation mixed (manual: sec-mud-hermite,
verif-hermite-frequencies, verif-hermite-pump-stop)."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import eigh

from drillpetsc import run as run_of_case
from drillpetsc import statics
from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
from drillpetsc.analysis.statics.placement import move_rigidly, release
from drillpetsc.case import Case
from drillpetsc.errors import CaseError
from drillpetsc.fem.discrete_system import DiscreteSystem
from drillpetsc.fem.quantity import Sample
from drillpetsc.geometry.frames import transported_frames
from drillpetsc.model.drilling_model import build_model
from drillpetsc.output.balances.mass_balance import MassBalance
from drillpetsc.output.measured.flow_recorder import FlowRecorder
from drillpetsc.output.recorder import Recorder
from drillpetsc.physics.fluid.bit_flow import BitFlow
from drillpetsc.physics.fluid.channel_flow import FluidConstants
from drillpetsc.physics.fluid.channels import Bore
from drillpetsc.physics.fluid.hermite.flow import HermiteBore
from drillpetsc.physics.fluid.rheology import Rheology
from drillpetsc.solvers import petsc_options as options
from drillpetsc.solvers.time.time_integrator import TimeIntegrator
from drillpetsc.time_function import Constant
from tests.helpers.uniform_string import uniform_string
from tests.helpers.wells import newtonian, simple_well
from tests.verification.test_closed_bottom_modes import case as closed_bottom

BOTH = ("mixed", "hermite")
MUD = {"model": "herschel_bulkley", "yield_stress": 3, "consistency": 0.3, "index": 0.75}
WATER = {"model": "newtonian", "viscosity": 0}
HOLE = simple_well(2000, 0.2159, kind="casing", friction=0.2)


def pipe(length: float, element: float, bore: float = 0.1086, outer: float = 0.127) -> dict:
    return {"kind": "pipe", "length": length, "od": outer, "id": bore, "element_length": element}


def loop(formulation: str, element: float = 50.0, **fluid) -> Case:
    """2000 m of pipe, collars and nozzles in a hole of 215.9 mm."""
    string = [
        pipe(1800, element),
        pipe(199, element, 0.0714, 0.1778),
        {"kind": "bit", "length": 1, "od": 0.2159, "mass": 60, "nozzle_area": 380e-6},
    ]
    mud = {
        "density": 1200,
        "rheology": MUD,
        "bulk_modulus": 2.5e9,
        "flow_rate": 0.03,
        "formulation": formulation,
    }
    return Case(string=string, hold_string=True, well=HOLE, bottom="bit", fluid=mud | fluid)


def begun(case: Case, **settings):
    """Initial model and integrator of a case."""
    with options.applied({name: str(value) for name, value in settings.items()}):
        model = build_model(case)
        integrator = TimeIntegrator(model.system)
    find_equilibrium(model)
    release(model)
    move_rigidly(model)
    return model, integrator


def measured(model, t: float) -> np.ndarray:
    """(7,) pressures at pump and bit, flow rates out of the flow line, of the pump and through the bit, content,
    cuttings."""
    mud, sample = FlowRecorder(model.system, model.fluid), Sample(model.system, t)
    ends = mud.pump_pressure, mud.bit_pressure, mud.outlet_flow, mud.pump_flow, mud.bit_flow
    return np.concatenate([value(sample) for value in (*ends, mud.content, mud.cuttings_flow)])


def history(case: Case, dt: float, end: float):
    """Times (k,), samples (k, 7) of ``measured`` and the model, with steps of ``dt`` [s]."""
    model, integrator = begun(case, ts_adapt_type="none", ts_dt=dt)
    rows = [(0.0, measured(model, 0.0))]
    integrator.after_step.append(lambda t, h: rows.append((t, measured(model, t))))
    run(integrator, model, end)
    return np.array([t for t, _ in rows]), np.array([v for _, v in rows]), model


def run(integrator: TimeIntegrator, model, end: float) -> None:
    integrator.run(0.0, end, model.breaks)


def half_cosine(start: float, duration: float, flow: float) -> dict:
    """Pump flow that decreases from ``flow`` to zero as a half cosine."""
    t = np.linspace(0, duration, 41)
    return {"time": [0, *(start + t)], "value": [flow, *(0.5 * flow * (1 + np.cos(np.pi * t / duration)))]}


# ---------------------------------------------------------------------- steady
def test_steady_pressures_of_an_almost_incompressible_mud():
    """At a bulk modulus of 1e14 Pa and with rigid walls both forms have the exact sum of losses, also across
    the change of section (manual: verif-hermite-steady)."""
    found = {}
    for form in BOTH:
        model = build_model(loop(form, bulk_modulus=1e14, elastic_walls=False))
        find_equilibrium(model)
        found[form] = np.concatenate(
            [component.pressures(model.system) for component in (model.fluid.bore, model.fluid.annulus)]
        )
    assert found["mixed"][0] > 1e7
    assert np.abs(found["hermite"] - found["mixed"]).max() < 1e-10 * np.abs(found["mixed"]).max()


# ---------------------------------------------------------------------- waves
def frequencies(elements: int) -> np.ndarray:
    """Angular frequencies over the exact a (k - 1/2) pi/L of a frictionless pipe, closed at its upper end and
    open at the lower."""
    length, bulk, density, area = 2000.0, 2e9, 1200.0, np.full(elements, 0.0093)
    mesh = uniform_string(length, elements, outer_diameter=0.127, inner_diameter=0.1086)
    straight = np.linspace(0, length, elements + 1)[:, None] * [0, 0, 1.0]
    law = Rheology(
        "newtonian", law="blend", consistency=1e-9, index=1.0, yield_stress=0.0, shear_rate_eps=1.0
    )
    fluid = FluidConstants(density, bulk, np.zeros(3), law.parameters())
    component = HermiteBore(mesh, Bore(area, 0 * area, area), fluid, 0 * area, Constant(0.0), False, straight)
    system = DiscreteSystem(mesh, transported_frames(np.tile([0, 0, 1.0], (elements + 1, 1))), [component])
    asm, place, n = system.assembly, system.layout.dofs, system.layout.size

    def matrix(*weights: float) -> np.ndarray:
        asm.residual(0.0)
        asm.jacobian(0.0, weights, condensed=False)
        (rows, columns), out = asm.places(), np.zeros((n, n))
        keep = (rows >= 0) & (columns >= 0)
        np.add.at(out, (rows[keep], columns[keep]), asm.values[keep])
        return out

    pressure, free = place["bore.pressure"][:, 0], np.setdiff1d(np.arange(n), place["bore.volume"][:1, 0])
    right, left = (
        np.ones(n),
        np.ones(n),
    )  # rows of pressures scaled by -1/bulk modulus are symmetric to those of slopes
    right[pressure], left[pressure] = bulk / length, -1 / length
    K, M = ((left[:, None] * A * right)[np.ix_(free, free)] for A in (matrix(1, 0, 0), matrix(0, 0, 1)))
    for A in (K, M):
        assert np.abs(A - A.T).max() < 1e-12 * np.abs(A).max()
    found = np.sqrt(np.abs(eigh(0.5 * (K + K.T), 0.5 * (M + M.T), eigvals_only=True)))
    return found / (np.sqrt(bulk / density) * np.pi / length * (np.arange(len(found)) + 0.5))


def test_frequencies_are_of_sixth_order():
    """Errors +9.1e-10, +4.1e-6, +1.5e-4 of modes 3, 11, 21 with 40 elements, order 5.8; the largest frequency
    is 3.1 times that of mode 40 (manual: verif-hermite-frequencies)."""
    coarse, fine, finer = frequencies(20) - 1, frequencies(40) - 1, frequencies(80) - 1
    assert fine[[2, 10, 20]] == pytest.approx([9.1e-10, 4.1e-6, 1.5e-4], rel=0.03)
    assert (fine[-1] + 1) * (len(fine) - 0.5) / 39.5 == pytest.approx(3.1, rel=0.02)
    assert np.log2(coarse[2] / fine[2]) == pytest.approx(5.9, abs=0.15)
    assert np.log2(fine[10] / finer[10]) == pytest.approx(5.8, abs=0.15)


def water(string: list, flow: dict, formulation: str = "hermite") -> Case:
    """A frictionless pipe with an open end, without weight."""
    fluid = {
        "density": 1200,
        "rheology": WATER,
        "bulk_modulus": 2e9,
        "elastic_walls": False,
        "flow_rate": flow,
        "formulation": formulation,
    }
    return Case(string=string, hold_string=True, gravity=[0, 0, 0], fluid=fluid)


def test_a_wave_through_an_area_step():
    """A smooth front of pressure p continues with 2 A1/(A1 + A2) p; both nodes beside the step have it within
    0.1 % (manual: verif-area-step)."""
    flow, bores = 0.02, (0.1086, 0.0714)
    stop = half_cosine(0.05, 0.4, flow)
    model, integrator = begun(
        water([pipe(1000, 25), pipe(1000, 25, bores[1])], stop), ts_adapt_type="none", ts_dt=0.002
    )
    before = model.fluid.bore.pressures(model.system).copy()
    rows = []
    integrator.after_step.append(
        lambda t, h: rows.append(model.fluid.bore.pressures(model.system)) if 1.5 < t < 1.7 else None
    )
    run(integrator, model, 1.7)
    change = np.array(rows).mean(axis=0) - before
    a, (one, two) = np.sqrt(2e9 / 1200), np.pi / 4 * np.array(bores) ** 2
    through = -1200 * a * flow / one * 2 * one / (one + two)
    after = flow + through * two / (1200 * a)  # the transmitted flow
    speed = (
        600 * (1 / two**2 - 1 / one**2) * (after**2 - flow**2)
    )  # heads that the narrow part no longer costs (Bernoulli)
    assert change[39:42] == pytest.approx(through - np.array([0, 0, speed]), rel=1e-3)


# ---------------------------------------------------------------------- against the mixed form
def test_pump_stop_in_both_forms():
    """Pump pressure after a half-cosine stop of 0.5 s within 0.5 % of the swing in the mean square, with
    equal change of content (manual: verif-hermite-pump-stop)."""
    (t, mixed, _), (other, hermite, _) = (
        history(loop(form, flow_rate=half_cosine(0.2, 0.5, 0.03)), 0.01, 4.0) for form in BOTH
    )
    swing = np.ptp(mixed[:, 0])
    assert swing > 5e6
    gap = np.interp(t, other, hermite[:, 0]) - mixed[:, 0]
    assert np.sqrt(np.mean(gap**2)) < 5e-3 * swing
    content = [rows[-1, 5] - rows[0, 5] for rows in (mixed, hermite)]
    assert content[1] == pytest.approx(content[0], rel=1e-3)


def test_a_pump_that_stops_at_once():
    """The reference flow follows a jump slowly, the inflow jumps nevertheless; the volume balance closes,
    except for restarts of the formula."""
    stop = {"time": [0, 0.1, 0.1], "value": [0.03, 0.03, 0.0]}
    model, integrator = begun(loop("hermite", flow_rate=stop), ts_adapt_type="none", ts_dt=0.01)
    balances, rows = MassBalance(), []
    balances.start(measured(model, 0.0)[5])

    def after(t: float, dt: float) -> None:
        rows.append((t, *measured(model, t)))
        balances.step(measured(model, t)[[3, 2, 6]], dt, integrator.fresh)

    integrator.after_step.append(after)
    run(integrator, model, 2.0)
    table = np.array(rows)
    assert table[:, 4] == pytest.approx(np.where(table[:, 0] < 0.1 + 1e-9, 0.03, 0.0), abs=3e-5)
    balances.content = table[-1, 6]
    balance = balances.balance()
    assert balance["content_change"] < -0.01
    assert abs(balance["error"]) < 1e-6 * abs(balance["content_change"])
    assert model.system.field("bore.volume")[0, 0] == pytest.approx(
        -0.015, rel=1e-6
    )  # half a window of the jump


def test_volumes_stay_bounded_over_hours_of_pumping():
    """Ten hours at 30 l/s are 1080 m3 through the bit; the volumes at the nodes remain bounded."""
    case = loop("hermite", 200.0)
    model, integrator = begun(case, ts_adapt_type="none", ts_dt=600.0)
    start = [model.system.field(f"{name}.volume").copy() for name in ("bore", "annulus")]
    run(integrator, model, 36000.0)
    for name, before in zip(("bore", "annulus"), start, strict=True):
        now = model.system.field(f"{name}.volume")
        assert np.abs(now).max() < 0.5
        assert np.abs(now - before).max() < 1e-8
    assert measured(model, 36000.0)[2:5] == pytest.approx([0.03] * 3, rel=1e-9)


@pytest.mark.parametrize("held", [True, False], ids=["held", "hanging"])
@pytest.mark.parametrize(
    "kind", ["reverse", "bore only", "annulus only", "plugged", "no chamber", "check valve", "back pressure"]
)
def test_steady_states_of_other_models(kind, held):
    """Pressures at both ends and hook load as with formulation mixed."""
    nozzles = {"kind": "bit", "length": 0.5, "od": 0.2159, "mass": 60, "nozzle_area": 380e-6}
    well = simple_well(320, 0.2159, (0.2, 0.4), kind="casing", friction=0.2)
    mud = {"density": 1200, "rheology": MUD, "flow_rate": 0.02}
    more: dict = {"bottom": "bit", "string": [pipe(200, 20), pipe(100, 20, 0.0714, 0.1778), nozzles]}
    if kind == "reverse":
        mud["flow_rate"] = -0.02
    elif kind == "bore only":
        mud["annulus"] = False
    elif kind in ("annulus only", "plugged"):
        mud["flow_rate"] = 0.0
        bore = 0.0 if kind == "annulus only" else 0.1
        more = {"bottom": {"kind": "free", "plugged": True}, "string": [pipe(300, 20, bore)]}
    elif kind == "no chamber":
        mud["bit_volume"] = 0.0
    elif kind == "check valve":
        mud["check_valve"] = True
    elif kind == "back pressure":
        mud["outlet_pressure"] = 5e6
    found = []
    for form in BOTH:
        model = build_model(
            Case(top="clamped", hold_string=held, well=well, fluid=mud | {"formulation": form}, **more)
        )
        find_equilibrium(model)
        recorder = Recorder(model)
        names = [] if held else ["hook_load"]
        load = [recorder.value(recorder.sample(0.0), name) for name in names]
        found.append(
            np.concatenate(
                [
                    load,
                    measured(model, 0.0)[1:3],
                    [
                        r.pressures(model.system)[0]
                        for r in (model.fluid.bore, model.fluid.annulus)
                        if r is not None
                    ],
                ]
            )
        )
    assert found[1] == pytest.approx(found[0], rel=2e-4, abs=500.0)


def test_coupled_with_a_string_that_is_lowered():
    """Inclined, with collars and a stabilizer: hook load and pressures at the start, and returned flow in the
    first tenth of a second."""
    survey = {"md": [0, 700], "inclination": [0.1, 0.6], "azimuth": [0, 0]}
    well = {
        "survey": survey,
        "sections": [{"to": 700, "kind": "casing", "diameter": 0.2159, "friction": 0.2}],
    }
    string = [
        pipe(500, 25),
        {"kind": "stabilizer", "length": 1.5, "od": 0.21, "id": 0.0714, "mass": 200},
        pipe(100, 25, 0.0714, 0.1778),
        {"kind": "bit", "length": 0.5, "od": 0.2159, "mass": 60, "nozzle_area": 380e-6},
    ]
    found, lowering = (
        {},
        {"ramp": 1.0, "value": 0.5},
    )  # from rest: hermite does not include the surge of a moving string at the start
    for form in BOTH:
        mud = {"density": 1200, "rheology": MUD, "flow_rate": 0.02, "formulation": form}
        case = Case(
            string=string,
            top={"kind": "top_drive", "lowering": lowering, "rotation": 1.0},
            well=well,
            bottom="bit",
            fluid=mud,
        )
        model, integrator = begun(case)
        recorder = Recorder(model)
        names = ("hook_load", "surface_torque", "pump_pressure", "bit_pressure", "outlet_flow")
        start = [recorder.value(recorder.sample(0.0), name) for name in names]
        run(integrator, model, 0.1)
        later = recorder.sample(0.1)
        found[form] = np.array([start, [recorder.value(later, name) for name in names]])
    load, torque, pump, bit, returned = range(5)
    mixed, hermite = found["mixed"], found["hermite"]
    # at the start, then in motion, where a mesh of 25 m causes waves in both forms
    for column, start, later in (
        (load, 1e-5, 1e-3),
        (torque, 1e-5, 1e-3),
        (pump, 1e-4, 1e-3),
        (bit, 1e-4, 1e-3),
        (returned, 2e-4, 1e-3),
    ):
        assert hermite[0, column] == pytest.approx(mixed[0, column], rel=start)
        assert hermite[1, column] == pytest.approx(mixed[1, column], rel=later)
    assert hermite[0, returned] == pytest.approx(0.02, rel=1e-6)


def test_a_buckled_column_in_mud_is_that_of_the_other_formulation():
    """A pipe of 100 m with 4 kN on its lower end, free sideways: it leaves its axis by metres, and mud moves it further.

    String and flow in turn went from 5.5 to 1.7 m and back without end; the change in shares finds the state.
    """
    ends = []
    # the side loads that lead off the saddle are taken away, so their strength leaves no trace
    for formulation, weak in (("mixed", 1e-3), ("hermite", 1e-3), ("hermite", 1e-2)):
        model = build_model(
            closed_bottom(
                formulation,
                100.0,
                0.0,
                {"kind": "bit", "stiffness": 4e6, "friction": 0.0},
                initial={"wob": 4e3, "imperfection": weak},
            )
        )
        state = find_equilibrium(model)
        assert state.stable
        assert model.bit.weight_and_torque(model.system.assembly)[0] == pytest.approx(4e3, rel=1e-6)
        x, y, _ = model.system.field("string.position")[-1]
        ends.append(float(np.hypot(x, y)))
    assert ends[0] > 1.0 and ends[1] == pytest.approx(ends[0], rel=0.01)
    assert ends[2] == pytest.approx(ends[1], rel=1e-6)


@pytest.mark.parametrize("formulation", BOTH)
def test_energy_of_a_pump_that_slows_down(formulation, tmp_path):
    """Energy balances within 0.1 % in both forms, with walls that give; hermite left 2 % open and blames no numerical damping."""
    result = run_of_case(
        Case(
            string=[pipe(600, 20)],
            well=simple_well(620, 0.3111, friction=0.0),
            top={"kind": "top_drive"},
            bottom="free",
            fluid={
                "density": 1800,
                "rheology": MUD,
                "flow_rate": {"time": [0.1, 0.7], "value": [0.05, 0.025]},
                "formulation": formulation,
            },
            time={"end": 1.5},
        ),
        tmp_path / "run",
        progress="silent",
    ).summary
    energy, named = (
        result["energy"],
        any("formulation: hermite leaves" in text for text in result["warnings"]),
    )
    assert abs(energy["error_share"]) < 1e-3 and not named
    assert ("damped" in energy) == (formulation == "mixed")


@pytest.mark.parametrize("formulation", BOTH)
def test_a_free_end_that_stretch_and_lowering_bring_below_its_hole_keeps_its_buoyancy(formulation, tmp_path):
    """A free string of 1500 m stretches by 0.3 m below the end of its hole, and is lowered by a metre more: the hook goes on to carry
    (rho_s - rho_m) A g L, though the mud at its bit is less than that (0.2 m at the default bit_volume)."""
    length, steel, mud = 1500.0, 7850.0, 1200.0
    case = Case(
        string=[pipe(length - 0.3, 50.0), {"kind": "bit", "length": 0.3, "od": 0.127, "id": 0.1086}],
        well=simple_well(length, 0.2159),
        contact="none",
        top={
            "kind": "top_drive",
            "rotation": 0.0,
            "lowering": {"time": [0.0, 10.0, 110.0], "value": [0.0, 0.01, 0.01]},
        },
        material={"damping": {"mass": 2.0}},
        fluid={
            "density": mud,
            "rheology": WATER | {"viscosity": 0.005},
            "bulk_modulus": 1e12,
            "formulation": formulation,
        },
        initial={"imperfection": 0.0},
        time={"end": 110.0},
    )
    weight = (steel - mud) * np.pi / 4 * (0.127**2 - 0.1086**2) * 9.80665 * length
    assert statics(case, out=tmp_path / "still").summary["hook_load"] == pytest.approx(weight, rel=1e-3)
    summary = run_of_case(case, tmp_path / "lowered").summary
    # the string displaces its volume, as in a deeper hole
    returned = np.pi / 4 * 0.127**2 * (0.05 + 1.0)
    assert summary["mass"]["returned"] == pytest.approx(returned, rel=0.02)
    assert summary["final"]["bit_depth [m]"] > length + 1.2
    assert summary["final"]["hook_load [N]"] == pytest.approx(weight, rel=5e-3)


@pytest.mark.parametrize("formulation", BOTH)
def test_a_lowered_free_end_goes_on_in_the_hole_that_its_run_was_begun_in(formulation):
    """The hole below a free end is as deep as the whole run needs: a restart that ends earlier keeps it, and one that ends later is refused.

    Its mud would be mud that was not there before: the pressure at the bit jumped, or mud was drawn in at the flow line.
    """

    def bit(end: float, lowering: object = 0.1) -> BitFlow:
        case = Case(
            string=[pipe(100.0, 50.0)],
            well=simple_well(100.0, 0.2159),
            contact="none",
            top={"kind": "top_drive", "rotation": 0.0, "lowering": lowering},
            fluid={"density": 1200.0, "rheology": WATER, "formulation": formulation},
            time={"end": end},
        )
        found = build_model(case).part(BitFlow)
        assert found is not None
        return found

    begun, shorter = bit(20.0), bit(10.0)
    shorter.set_state(begun.get_state())
    if formulation == "hermite":
        assert shorter.travel == pytest.approx(begun.travel, rel=1e-12)
        assert shorter._block.named["travel"] == pytest.approx(begun._block.named["travel"], rel=1e-12)
    else:
        assert shorter.end.end == pytest.approx(begun.end.end, rel=1e-12) and begun.end.end[
            2
        ] == pytest.approx(102.5)
    with pytest.raises(CaseError, match="not later than the run was begun for"):
        bit(30.0).set_state(begun.get_state())
    # 0.5 m down in 10 s, then up again: the lowest place is between the times that the case gives; and 0.5 % of stretch
    assert bit(20.0, {"time": [0.0, 20.0], "value": [0.1, -0.1]}).end.more == pytest.approx(0.5 + 0.5)


@pytest.mark.parametrize("kind", ["on a node", "between nodes", "beside a rigid item", "pressed", "curved"])
def test_the_pressure_on_ledges_of_the_hole_does_not_load_the_string(kind, tmp_path):
    """The hole carries p (A_1 - A_2), 160 kN at 400 m: the hook load is the weight in mud, and that of `mixed`, whose hole does not go along."""
    ledge, inclination, outlet = 405.0 if kind == "between nodes" else 400.0, [0.0, 0.0], 0.0
    if kind == "curved":
        inclination = [0.0, 1.2]
    string = [pipe(850.0, 10.0)]
    if kind == "beside a rigid item":  # from 5 m above the ledge to 4 m below it
        item = {"kind": "body", "length": 9.0, "od": 0.16, "id": 0.0714, "mass": 900.0}
        string = [pipe(395.0, 10.0), item, pipe(446.0, 10.0)]
    if kind == "pressed":
        outlet = 2e7
    well = simple_well([0.0, 450.0, 900.0], 0.2159, [0.0, *inclination], friction=0.3)
    well["sections"] = [{"to": ledge, "kind": "casing", "diameter": 0.3, "friction": 0.3}, *well["sections"]]
    load = {}
    for formulation in BOTH:
        mud = {"density": 1200, "rheology": WATER, "flow_rate": 0.0, "formulation": formulation}
        case = Case(
            string=string,
            well=well,
            top="clamped",
            bottom="free",
            fluid=mud | {"outlet_pressure": outlet},
            gravity=9.81,
        )
        load[formulation] = statics(case, tmp_path / formulation).summary["hook_load"]
    assert load["hermite"] == pytest.approx(load["mixed"], rel=2e-5)
    if kind in ("on a node", "between nodes"):
        buoyed = (7850 - 1200) * 9.81 * 850 * np.pi / 4 * (0.127**2 - 0.1086**2)
        assert load["hermite"] == pytest.approx(buoyed, rel=2e-3)


def test_the_hole_below_an_end_that_hangs_free_is_not_part_of_its_chamber():
    """A string of 100 m stretches by less than the 5 m that are below it: the chamber has its own volume alone.  Lowered by 8 m the
    end goes 3 m, and the 0.5 m of the largest stretch, beyond the hole."""
    hole = np.pi / 4 * 0.2159**2
    for lowering, more in ((None, 0.0), ({"time": [0, 8], "value": [1.0, 1.0]}, 3.5)):
        case = Case(
            well=simple_well(105, 0.2159),
            string=[{"kind": "pipe", "length": 100, "od": 0.127, "id": 0.1086, "element_length": 20}],
            top={"kind": "top_drive", **({} if lowering is None else {"lowering": lowering})},
            bottom="free",
            time={"end": 8.0},
            fluid=newtonian(1200, 0.02, flow_rate=0.02, formulation="hermite", bit_volume=0.03),
        )
        travel = build_model(case).fluid.bit.travel  # of the end, until 0.1 l are left of the chamber
        assert travel == pytest.approx((0.03 - 1e-4) / hole + more, rel=1e-6)
