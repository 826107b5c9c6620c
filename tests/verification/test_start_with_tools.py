"""Start of statics with tools, joints and a bit that cuts (manual: sec-statics-march, sec-statics-lateral-start)."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc import Case
from drillpetsc.analysis.statics.answer import static_summary
from drillpetsc.analysis.statics.checks.slider_travel import travels
from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
from drillpetsc.analysis.statics.placement import place_along_hole, top_depth
from drillpetsc.analysis.statics.start import lateral_start
from drillpetsc.analysis.statics.start.march import march, nodal_loads
from drillpetsc.analysis.statics.static_problem import StaticState
from drillpetsc.errors import CaseError
from drillpetsc.fem.string_mesh import JarLaw, StringJoint
from drillpetsc.model.drilling_model import build_model
from drillpetsc.output.static_table import static_table
from drillpetsc.physics.tools.reamer import Reamer
from drillpetsc.solvers.static.search_limit import SearchLimit
from drillpetsc.solvers.static.static_newton import StaticNewton
from tests.helpers.wells import simple_well
from tests.helpers.whole_string import COLLAR, JAR, MOTOR, SHOCK, combined, whole_string
from tests.verification.test_lateral_start import MUD, counted


def with_tools(*tools: dict, wob: float, inclination: float, mud: bool = True) -> Case:
    """A string of 500 m that turns with 30 rpm, in a hole that builds to ``inclination`` [deg]."""
    data = combined(*tools, flow_rate="30 l/s")
    data["initial"] = {"wob": wob}
    data["well"]["survey"]["inclination"] = [0, 0, np.radians(inclination), np.radians(inclination)]
    if not mud:
        del data["fluid"]
    return Case(**data)


def jointed(*joints: float, element: float, mud: bool = False, **top: float) -> Case:
    """A vertical string of 3000 m with 80 kN on its bit and universal joints at depths [m]."""
    pipe = {"kind": "pipe", "element_length": element}
    return Case(
        well=simple_well(3000.0, 0.2159, friction=0.25),
        string=[
            {**pipe, "length": 2800.0, "od": 0.127, "id": 0.1086},
            {**pipe, "length": 199.5, "od": 0.1715, "id": 0.0714},
            {"kind": "bit", "length": 0.5, "od": 0.2159, "mass": 60.0},
        ],
        top={"kind": "top_drive", **top},
        bottom="bit",
        joints=[{"at": at, "kind": "universal"} for at in joints],
        gravity=9.81,
        initial={"from": "statics", "wob": 80e3},
        **({"fluid": MUD} if mud else {}),
    )


@pytest.mark.parametrize(
    ("case", "most"),
    [
        (jointed(2990.0, element=5.0, rotation=8.4), 75),  # 1339 before
        (jointed(2990.0, element=5.0, mud=True, lowering=0.1), 25),  # 175
        (jointed(2950.0, 2990.0, element=10.0, mud=True, lowering=0.1), 27),  # 239
        (with_tools(JAR, COLLAR, SHOCK, MOTOR, wob=40e3, inclination=0.0), 50),  # refused after 977
        (with_tools(MOTOR, COLLAR, SHOCK, JAR, wob=80e3, inclination=0.0), 105),  # refused after 873
        (with_tools(JAR, COLLAR, SHOCK, MOTOR, wob=80e3, inclination=40.0), 30),  # 144
        (with_tools(SHOCK, COLLAR, MOTOR, JAR, wob=20e3, inclination=20.0), 30),  # 80
        (with_tools(JAR, COLLAR, SHOCK, wob=40e3, inclination=0.0, mud=False), 20),  # 106
        (Case(**whole_string(), title="every tool"), None),
    ],
)
def test_factorisations(case, most, monkeypatch):
    """A stable state within few factorisations, with the weight on bit of the case within 0.01 %.  Up to 40 of them show that the side
    force of friction would make a string whirl."""
    if most is None:  # two rounds of the motor's speed, 40 kN on a reamer that takes twice that
        data = whole_string()
        data["initial"] = {"wob": 20e3}
        survey = data["well"]["survey"]
        survey["inclination"] = [0, 0, np.radians(20.0), np.radians(20.0)]
        case, most = Case(**data), 35
    _, figures, count = counted(case, monkeypatch)
    assert figures["stable"] and figures["wob"] == pytest.approx(case.initial.wob, rel=1e-4)
    assert count <= most


@pytest.mark.parametrize(("wob", "buckles"), [(30e3, False), (37e3, True)])
def test_weight_at_which_a_string_on_a_bit_that_cuts_buckles(wob, buckles, monkeypatch):
    """The lateral equilibrium and the whole model buckle at the same weight: the side of the hole holds such a bit at one point,
    so it may tilt.  Before, the lateral equilibrium held it by three points as a rigid item, and was straight up to 47 kN."""
    model, found = build_model(with_tools(COLLAR, wob=wob, inclination=0.0, mud=False)), []
    place_along_hole(model, top_depth(model))
    straight = march(model, (0.0, 3.0))
    original = lateral_start.lateral_state

    def noted(*arguments):
        state = original(*arguments)
        assert state is not None
        found.append(state.disturbed)
        return state

    monkeypatch.setattr(lateral_start, "lateral_state", noted)
    lateral_start.lateral_start(straight, straight, SearchLimit())
    assert found[-1] == buckles
    # the whole model, straight
    solver = StaticNewton(model.system, clearance=0.05)
    bit, top = model.bit, model.top
    assert bit is not None and top is not None
    top.shift(straight.top_motion)
    for name, value in (("position", straight.position), ("tangent", straight.tangent)):
        model.system.set_field(f"string.{name}", value)
    for component in model.components:
        component.impose_sliding_direction(0.0, 0.0)
    assert (solver.negative_pivots() > 0) == buckles


def test_bending_of_the_hole_is_no_load():
    """A survey station inside an element: the march's loads are the weight and the mud, at most 3 kN a node here.  Before, the
    elastic forces of the element, 37 kN, pressed the string to the wall and were rubbed."""
    model = build_model(with_tools(JAR, COLLAR, SHOCK, wob=80e3, inclination=40.0, mud=False))
    place_along_hole(model, top_depth(model))
    force, _ = nodal_loads(model)
    weight = 9.81 * np.append(model.mesh.mass * model.mesh.length, 0.0)
    items = np.zeros(model.mesh.nodes)
    for body in model.mesh.bodies:
        items[body.node] += 9.81 * body.mass
    most = weight + np.append(0.0, weight[:-1]) + items
    assert (np.linalg.norm(force, axis=1) <= most + 200.0).all()


@pytest.mark.parametrize(
    ("law", "tension", "expected"),
    [
        ({"spring": 6e6, "preload": 12e3}, -60e3, -8e-3),
        ({"spring": 0.0, "stroke": (-0.01, 0.18), "stop_stiffness": 1e9}, 50e3, 0.18 + 5e-5),
        ({"spring": 0.0, "stroke": (-0.01, 0.18), "stop_stiffness": 1e9}, -50e3, -0.01 - 5e-5),
        ({"spring": 2e6, "stroke": (-0.01, 0.01), "stop_stiffness": 1e9}, 1e4, 5e-3),
        ({"spring": 2e6, "stroke": (-0.01, 0.01), "stop_stiffness": 1e9}, 1.02e6, 0.01 + 1e6 / 1.002e9),
        ({"jar": JarLaw(2e5, 0.1, 2e6, 1e9, True, False, 0)}, 5e4, 5e-5),
    ],
)
def test_travel_of_a_slider(law, tension, expected):
    """Spring with preload, stops, latch of a jar: by hand."""

    class Mesh:
        length = np.ones(3)
        joints = (StringJoint(1.0, "slider", 1, **law),)

    assert travels(Mesh(), np.full(3, tension)) == pytest.approx([0.0, expected, 0.0], rel=1e-9)  # type: ignore[arg-type]


def reaming(inclination: float, **keys) -> Case:
    """A string with jar, reamer, shock sub and steerable tool without mud, which turns and is lowered; ``keys`` over those of its case."""
    data = whole_string()
    survey = data["well"]["survey"]
    survey["inclination"] = [0, 0, np.radians(inclination), np.radians(inclination)]
    del data["fluid"]
    data["string"] = [q for q in data["string"] if q["kind"] not in ("pdm", "agitator")]
    data["string"][0]["length"] += 500.0 - sum(q["length"] for q in data["string"])
    depth = 0.0
    for item in data["string"]:
        if item["kind"] == "reamer":
            data["well"]["sections"][0]["to"] = (
                depth + item["length"] - item["blade_position"] + 0.5 * item["blade_length"]
            )
        depth += item["length"]
    return Case(**(data | keys))


def test_march_knows_the_weight_of_a_reamer():
    """A shock sub gives way under 20 kN, so the reamer above it stands deeper on its shoulder: the force above it, by the march,
    is that of the equilibrium within 10 %; before, the march knew 2.5 kN of it."""
    case = reaming(0.0, initial={"wob": 20e3}, top={"kind": "top_drive", "rotation": "60 rpm"})
    model = build_model(case)
    place_along_hole(model, top_depth(model))
    found = march(model, (0.0, 6.0))
    state = find_equilibrium(model, (0.0, 6.0))
    assert isinstance(state, StaticState) and state.stable
    node = model.parts(Reamer)[0].node
    weight = model.parts(Reamer)[0].element_results(model.system.assembly)[0]
    assert weight > 30e3
    jump = found.axial_force[node + 1] - found.axial_force[node]
    assert jump == pytest.approx(weight, rel=0.1)


def test_torque_of_a_reamed_hole():
    """The surface torque is that of bit, reamer and friction.  Before, a path of steady sliding answered with less than bit and
    reamer take (30.6 of 31.6 kN m), and with 20 kN more hook load."""
    model = build_model(reaming(40.0))
    state = find_equilibrium(model)
    figures = static_summary(model, state)
    assert state.stable and state.path is None
    rock = figures["bit_torque"] + model.parts(Reamer)[0].element_results(model.system.assembly)[1]
    columns, values = static_table(model)
    assert values is not None
    contact = values[:, [c[0].split(" ")[0] for c in columns].index("contact_force")]
    mesh = model.mesh
    pipe = float((0.5 * (contact[1:] + contact[:-1]) * mesh.length) @ (0.5 * mesh.contact_diameter))
    items = sum(
        item["contact_force_sum [N]"] * body.radius
        for item, body in zip(figures["rigid_items"], mesh.bodies, strict=True)
    )
    assert figures["surface_torque"] == pytest.approx(rock + 0.25 * (pipe + items), rel=0.02)


def test_a_path_with_a_reamer_is_refused():
    with pytest.raises(CaseError, match="reamer"):
        find_equilibrium(build_model(reaming(40.0)), (1.0, 0.0), path="sliding")
