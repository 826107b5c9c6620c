"""Strings whose static state takes a search: what ends it, and what it finds (manual: sec-statics-limit-of-search)."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from drillpetsc import Case, load_case, statics
from drillpetsc.analysis.statics.answer import static_summary
from drillpetsc.analysis.statics.equilibrium import MOTIONS
from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
from drillpetsc.model.drilling_model import build_model
from drillpetsc.output.static_table import static_table
from drillpetsc.solvers.chain.chain_lu import ChainFactor
from drillpetsc.solvers.static import search_limit

G, HOLE = 9.81, 0.2159
PIPE = {"kind": "pipe", "od": 0.127, "id": 0.1086}
COLLAR = {"kind": "pipe", "od": 0.1714, "id": 0.0714}
BENDING, CLEARANCE = 206e9 * np.pi / 64 * (0.127**4 - 0.1086**4), 0.5 * (HOLE - 0.127)
BIT = {"kind": "bit", "length": 0.3, "od": HOLE, "mass": 60.0}


def case(
    wob: float, friction: float, inclination: float = 0.0, element: float = 5.0, length: float = 1000.0
) -> Case:
    """Bare pipe on a bit in a straight hole; inclination [deg]."""
    angle = [float(np.radians(inclination))] * 2
    return Case(
        well={
            "survey": {"md": [0.0, length], "inclination": angle, "azimuth": [0.0, 0.0]},
            "sections": [{"to": length, "kind": "open_hole", "diameter": HOLE, "friction": friction}],
        },
        string=[{**PIPE, "length": length - 0.3, "element_length": element}, BIT],
        top={"kind": "top_drive"},
        bottom="bit",
        gravity=G,
        initial={"from": "statics", "wob": wob},
    )


@pytest.fixture
def factorisations(monkeypatch) -> list[int]:
    """Number of factorisations so far, as a list of one."""
    count, factor = [0], ChainFactor.factor

    def one_more(self, *arguments):
        count[0] += 1
        return factor(self, *arguments)

    monkeypatch.setattr(ChainFactor, "factor", one_more)
    return count


@pytest.mark.parametrize(("wob", "friction"), [(120e3, 0.15), (200e3, 0.35)])
def test_a_coiled_string_is_hoisted_with_weight_on_its_bit(wob, friction, factorisations):
    """Refused after 5918 and 7093 factorisations, as friction "did not converge in 12 rounds".

    Hook load = weight - weight on bit + friction times the contact forces; where the helix has one hand, they are r F^2/4EI
    (Lubinski, Althouse and Logan 1962).
    """
    model = build_model(case(wob, friction))
    figures = static_summary(model, find_equilibrium(model, MOTIONS["hoist"]))
    assert factorisations[0] <= 90
    assert figures["wob"] == pytest.approx(wob, rel=1e-3)
    columns, values = static_table(model)
    names = [c[0].split(" ")[0] for c in columns]
    contact, force = (values[:, names.index(n)] for n in ("contact_force", "axial_force"))
    mesh = model.mesh
    side = float(0.5 * (contact[1:] + contact[:-1]) @ mesh.length)
    side += sum(item["contact_force_sum [N]"] for item in figures["rigid_items"])
    weight = G * (float(mesh.mass @ mesh.length) + sum(b.mass for b in mesh.bodies))
    assert figures["hook_load"] + wob - weight == pytest.approx(friction * side, rel=0.03)
    helix = (mesh.node_depth > 750.0) & (mesh.node_depth < 900.0)
    theory = CLEARANCE * force[helix] ** 2 / (4 * BENDING)
    assert contact[helix].mean() == pytest.approx(theory.mean(), rel=0.02)


def test_a_small_string_with_a_band_has_a_state_within_it(factorisations):
    """A string at 10 degrees that no Newton iteration from its lateral equilibrium brings to a state: it slides on from there, in some
    60 factorisations (1669 for its paths, which ended outside the band).  The state is stable, and its hook load within the band by theory."""
    angle = {"md": [0.0, 500.0, 950.0, 1500.0], "inclination": list(np.radians([0.0, 0.0, 10.0, 10.0]))}
    plain = case(200e3, 0.35, length=1500.0, element=5.0)
    data = plain.replace({"well": {"survey": {**angle, "azimuth": [0.0] * 4},
                                   "sections": [{"to": 1500.0, "kind": "open_hole", "diameter": HOLE, "friction": 0.35}]}})  # fmt: skip
    model = build_model(data)
    state = find_equilibrium(model, MOTIONS["lower"])
    assert state.stable and state.band is not None
    assert state.band.low < static_summary(model, state)["hook_load"] < state.band.high
    assert factorisations[0] < 150


def test_a_hoisted_string_with_a_band_is_sent_to_no_path_that_is_refused(tmp_path):
    """`--path` is refused while the bit bears a weight; the band of theory names it for strings that are lowered."""
    for motion, offered in (("hoist", False), ("lower", True)):
        summary = statics(case(200e3, 0.15, 10.0, 5.0, 600.0), tmp_path / motion, motion=motion).summary
        band = [text for text in summary["warnings"] if "is not unique" in text]
        states = any("a band:" in text for text in summary["warnings"])
        assert band or states
        assert any("--path sliding" in text for text in band) == (offered and bool(band))


@pytest.mark.parametrize(("wob", "most"), [(200e3, 160), (250e3, 100)])
def test_a_motor_slides_under_much_weight(wob, most, factorisations):
    """Friction of the start as a dead load helps strings with a motor, too."""
    slide = load_case(Path(__file__).parents[2] / "cases" / "motor-slide.yaml").replace({"initial.wob": wob})
    model = build_model(slide)
    state = find_equilibrium(model, MOTIONS["lower"])
    assert state.stable and factorisations[0] <= most
    assert static_summary(model, state)["wob"] == pytest.approx(wob, rel=1e-3)


def test_a_search_ends_with_a_reason(monkeypatch):
    """The limit counts all methods of a search; the message says where the string coils, and what helps."""
    monkeypatch.setattr(search_limit, "MOST_WORK", 30 * (101 + search_limit.FIXED_NODES))
    model = build_model(case(200e3, 0.35, 10.0, 10.0))
    with pytest.raises(
        search_limit.SearchEnded, match="no static state was found in 30 factorisations"
    ) as caught:
        find_equilibrium(model, MOTIONS["lower"])
    assert "by the march the string coils from MD" in caught.value.hint
    assert "times the push at which it coils" in caught.value.hint
    assert "less weight" in caught.value.hint


def test_a_state_that_was_found_outlives_the_limit(monkeypatch):
    """A column under 3.9 buckling loads: straight, it is an unstable state, and the search beyond it ends at its limit."""
    rod = {"kind": "beam", "length": 30.0, "element_length": 1.5, "mass": 30.0, "polar_inertia": 0.1}
    stiffness = {"axial_stiffness": 1e9, "bending_stiffness": 1e6, "torsional_stiffness": 8e5}
    top = {"kind": "top_drive", "rotation": 0.0, "hinged": True, "force": -3.9 * np.pi**2 * 1e6 / 30**2}
    initial = {"imperfection": 1e-3}
    column = Case(string=[rod | stiffness], gravity=0.0, initial=initial, top=top, bottom="pinned")
    monkeypatch.setattr(search_limit, "MOST_WORK", 5 * (21 + search_limit.FIXED_NODES))
    state = find_equilibrium(build_model(column))
    assert state.equilibrium.negative_pivots == 2 and not state.stable


def test_a_path_that_was_asked_for_has_no_limit(monkeypatch):
    """A user who asks for a path waits for it."""
    monkeypatch.setattr(search_limit, "MOST_WORK", 1)
    model = build_model(case(60e3, 0.2, 45.0, 10.0, length=300.0))
    assert find_equilibrium(model, MOTIONS["lower"], path="sliding").path is not None


def test_a_reamer_on_its_shoulder_does_not_hold_up_the_bit(factorisations):
    """The bit of a string whose reamer stands comes to its depth in few steps, although it follows the top by a hundredth only."""
    reamed = case(20e3, 0.0, length=400.0)
    data = reamed.replace(
        {
            "string": [
                {**PIPE, "length": 288.2, "element_length": 10.0},
                {**COLLAR, "length": 100.0, "element_length": 5.0},
                {"kind": "reamer", "length": 1.5, "od": 0.3111, "mass": 400.0},
                {**COLLAR, "length": 10.0},
                BIT,
            ],
            "well.sections": [
                {"to": 389.7, "kind": "open_hole", "diameter": 0.3111, "friction": 0.0},
                {"to": 400.0, "kind": "open_hole", "diameter": HOLE, "friction": 0.0},
            ],
            "formation": {"drillability": 4e-8},
        }
    )
    model = build_model(data)
    figures = static_summary(model, find_equilibrium(model))
    assert figures["wob"] == pytest.approx(20e3, rel=1e-3)
    assert factorisations[0] <= 60


def test_a_string_that_friction_alone_holds_slides_with_a_steady_force():
    """Its state has negative pivots and is given with a warning."""
    level = {"md": [0.0, 500.0, 950.0, 2000.0], "inclination": list(np.radians([0.0, 0.0, 90.0, 90.0]))}
    plain = case(120e3, 0.35, length=2000.0)
    data = plain.replace({"well.survey": {**level, "azimuth": [0.0] * 4}, "string[0].element_length": 5.0})
    model = build_model(data)
    state = find_equilibrium(model, MOTIONS["lower"])
    assert state.path is not None and not state.stable
    end = state.path.ends[0]
    assert end.steady and end.negative_pivots
    assert static_summary(model, state)["hook_load"] == pytest.approx(end.hook_load, rel=1e-9)
    assert any("held by friction only" in text for text in state.warnings)


def test_a_coiled_state_does_not_hang_on_the_size_of_the_imperfection():
    """Side loads of 1e-4 of the weight ended on the straight saddle, with 18 negative pivots and no torque."""
    torque = []
    for imperfection in (1e-4, 1e-2):
        model = build_model(
            load_case("cases/benchmark/buckled-collar.yaml", [f"initial.imperfection={imperfection}"])
        )
        state = find_equilibrium(model, None, False)
        assert state.stable
        torque.append(static_summary(model, state)["surface_torque"])
    assert torque[0] == pytest.approx(torque[1], rel=1e-6) and torque[0] > 100.0


def test_a_saddle_has_its_own_residual():
    """Without a wall a column far beyond its buckling load stays straight: its residual is its own, not that of the last search."""
    model = build_model(case(200e3, 0.2, 0.0, 10.0, length=300.0).replace({"contact": "none"}))
    report = find_equilibrium(model).equilibrium
    assert report.negative_pivots > 0 and report.converged and report.residual < 1.0
