"""Automatic element lengths: closed forms to 1 %, grading, reasons, limits (manual: sec-mesh)."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc import Case, run, statics
from drillpetsc.analysis.commands.check import describe
from drillpetsc.analysis.statics.answer import static_summary
from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
from drillpetsc.errors import CaseError
from drillpetsc.model import element_length
from drillpetsc.model.drilling_model import build_model
from drillpetsc.model.mesh import build_mesh, coarsened, element_lengths
from drillpetsc.output import read_table
from drillpetsc.output.measured.bending import end_forces
from tests.helpers.buckling import buckling_load
from tests.helpers.wells import simple_well

AREA, BENDING, WEIGHT, CLEARANCE = 3.4047325e-3, 1.2240289e6, 242.0, 0.04445
PIPE = {"kind": "pipe", "od": 0.127, "id": 0.1086, "material": {"density": WEIGHT / 9.81 / AREA}}


def hole(md, inclination, friction: float = 0.0, diameter: float = 0.2159) -> dict:
    survey = {"md": list(md), "inclination": list(np.radians(inclination)), "azimuth": [0.0] * len(md)}
    section = {"to": md[-1], "kind": "open_hole", "diameter": diameter, "friction": friction}
    return {"survey": survey, "sections": [section]}


def case(refinement: float = 1.0, **keys) -> Case:
    return Case(**{"top": {"kind": "top_drive"}, "gravity": 9.81, "mesh": {"refinement": refinement}, **keys})


@pytest.mark.parametrize("share", [0.6, 0.95])
def test_buckling_load_of_a_level_pipe(share):
    """200 m of pipe, hinged on the low side, on the mesh chosen for a push of ``share`` of the load of Dawson and
    Paslay, 2 sqrt(EI w/r) (SPE 11167; 16 half waves: 163.508 kN): first negative pivot within 1 % of it. Elements
    of 10 m, the default of 0.1.0, give 2.7 % more."""
    exact = 163.508e3
    made = case(
        well=hole([0.0, 200.0], [90.0, 90.0]),
        string=[{**PIPE, "length": 200.0}],
        bottom={"kind": "force", "force": [-share * exact, 0.0, 0.0]},
    )
    model = build_model(made)
    assert buckling_load(model, CLEARANCE, exact) == pytest.approx(exact, rel=1e-2)


@pytest.mark.parametrize("tension", [1e3, 1e5, 1e6])
def test_moment_at_a_clamped_end(tension):
    """A level beam of 30 m, clamped at both ends, under its weight w and a tension T: moment at the ends
    (w/k^2) ((kL/2) coth(kL/2) - 1), k^2 = T/EI (Roark's Formulas for Stress and Strain, table for beams under
    axial tension), within 1 %."""
    made = case(
        string=[{**PIPE, "length": 30.0}],
        top={"kind": "top_drive", "force": tension},
        bottom="clamped",
        initial={"inclination": 0.5 * np.pi},
    )
    model = build_model(made)
    find_equilibrium(model)
    moments = end_forces(model).moment_size
    k = np.sqrt(tension / BENDING)
    x = 15.0 * k
    exact = WEIGHT / k**2 * (x / np.tanh(x) - 1)
    assert moments[0, 0] == pytest.approx(exact, rel=1e-2)
    assert moments[-1, 1] == pytest.approx(exact, rel=1e-2)


def side_supported(refinement: float) -> tuple[np.ndarray, float]:
    """Moments beside a stabilizer and at the clamped bottom [N m], and its side force [N], of a level string."""
    pipe = {**PIPE, "length": 14.9}
    stabilizer = {"kind": "stabilizer", "length": 0.2, "od": 0.212, "mass": 50.0}
    made = case(
        refinement,
        well=hole([0.0, 30.0], [90.0, 90.0]),
        string=[pipe, stabilizer, pipe],
        top="clamped",
        bottom="clamped",
    )
    model = build_model(made)
    state = find_equilibrium(model)
    moments, node = end_forces(model).moment_size, model.mesh.bodies[0].node
    force = static_summary(model, state)["rigid_items"][0]["side_force [N]"]
    return np.array([moments[node - 1, 1], moments[node, 0], moments[-1, 1]]), force


def test_moments_beside_a_stabilizer():
    """Within 1 % of those on a mesh of a quarter of the length."""
    (coarse, force), (fine, exact) = side_supported(1.0), side_supported(4.0)
    assert coarse == pytest.approx(fine, rel=1e-2)
    assert force == pytest.approx(exact, rel=1e-2)


COIL = {
    "kind": "pipe",
    "length": 200.0,
    "od": 0.0603,
    "id": 0.0507,
    "curvature": 0.1,
    "curvature_angle": "45 deg",
}


def test_torque_of_coiled_tubing_with_residual_curvature():
    """Hook load and torque within 1 % of a mesh of half the length; elements of 4 m give 17 % more torque than of
    1 m."""
    found = []
    for refinement in (1.0, 2.0):
        made = case(
            refinement,
            well=hole([0.0, 220.0], [30.0, 30.0], friction=0.2, diameter=0.1143),
            string=[COIL],
            top={"kind": "top_drive", "lowering": 0.1},
        )
        model = build_model(made)
        found.append(static_summary(model, find_equilibrium(model, lateral_friction=False)))
    for key in ("hook_load", "surface_torque"):
        assert found[0][key] == pytest.approx(found[1][key], rel=1e-2)


@pytest.mark.parametrize(("motion", "exact"), [((-1.0, 0.0), 648.808e3), ((1.0, 0.0), 394.217e3)])
def test_hook_load_of_a_j_well(motion, exact):
    """5 deg/30 m to 60 deg, friction 0.25: hook load within 1 % of the soft string's (Johancsik, Friesen and
    Dawson 1984), and within 0.1 % of that on half the length."""
    md = [0.0, 1000.0, *np.arange(1030.0, 1361.0, 30.0), 2860.0]
    inclination = [0.0, 0.0, *np.arange(5.0, 61.0, 5.0), 60.0]
    found = []
    for refinement in (1.0, 2.0):
        made = case(
            refinement, well=hole(md, inclination, friction=0.25), string=[{**PIPE, "length": 2860.0}]
        )
        model = build_model(made)
        found.append(static_summary(model, find_equilibrium(model, motion, lateral_friction=False)))
    assert found[0]["hook_load"] == pytest.approx(exact, rel=1e-2)
    assert found[0]["hook_load"] == pytest.approx(found[1]["hook_load"], rel=1e-3)


# ---------------------------------------------------------------------- grading
BHA = [
    {**PIPE, "length": 1183.0},
    {"kind": "pipe", "length": 14.0, "od": 0.1715, "id": 0.0714},
    {"kind": "stabilizer", "length": 0.5, "od": 0.212, "mass": 100.0},
    {"kind": "pipe", "length": 1.7, "od": 0.1715, "id": 0.0714, "bend": {"angle": "1 deg"}},
    {"kind": "bit", "length": 0.3, "od": 0.2159, "mass": 40.0},
]
BUILD = hole([0.0, 900.0, 1000.0, 1199.5], [0.0, 0.0, 30.0, 50.0], friction=0.2)


def lengths_of(mesh) -> np.ndarray:
    return mesh.length[~mesh.is_joint]


@pytest.mark.parametrize(
    "keys",
    [
        {},
        {"initial": {"wob": "100 kN"}},
        {"joints": [{"kind": "universal", "at": 1185.0}]},
        {"loads": [{"at": 500.0, "force": [100.0, 0.0, 0.0]}, {"at": 500.4, "force": [0.0, 1.0, 0.0]}]},
        {"mesh": {"refinement": 3.0}},
        {"mesh": {"refinement": 0.2}},
        {"mesh": {"frequency": "30 Hz"}},
    ],
    ids=["plain", "wob", "joint", "loads", "refined", "coarsened", "frequency"],
)
def test_neighbouring_elements_differ_by_two_at_most(keys):
    made = Case(
        **{"well": BUILD, "string": BHA, "top": {"kind": "top_drive"}, "bottom": {"kind": "bit"}, **keys}
    )
    mesh = build_mesh(made)
    ratio = lengths_of(mesh)[1:] / lengths_of(mesh)[:-1]
    assert ratio.max() <= 2 * (1 + 1e-6) and ratio.min() >= 0.5 * (1 - 1e-6)
    assert mesh.length.max() <= 10.0 / made.mesh.refinement and len(mesh.upper) < 1200
    assert mesh.lower[:-1][~mesh.is_joint[1:]] == pytest.approx(
        (mesh.upper - mesh.rigid_above)[1:][~mesh.is_joint[1:]], abs=1e-9
    )


def test_named_lengths_are_untouched_and_neighbours_graded_to_them():
    """The items that name a length have equal elements; the automatic one beside 0.5 m elements begins with at
    most twice that."""
    string = [{**PIPE, "length": 300.0}, {**PIPE, "length": 50.0, "element_length": 0.5}]
    mesh = build_mesh(Case(string=string, top="clamped"))
    given = mesh.item == 1
    assert mesh.lower[given] == pytest.approx(np.linspace(300.5, 350.0, 100), abs=1e-12)
    assert mesh.length[~given][-1] <= 1.0 and mesh.length[~given].max() > 9.0
    named = build_mesh(Case(string=[{**q, "element_length": 10.0} for q in string], top="clamped"))
    assert np.array_equal(named.upper[:30], np.linspace(0.0, 300.0, 31)[:-1])


def test_refinement_halves_every_length():
    one, two = (build_mesh(case(r, well=BUILD, string=BHA, bottom={"kind": "bit"})) for r in (1.0, 2.0))
    assert len(two.upper) == pytest.approx(2 * len(one.upper), rel=0.06)
    assert lengths_of(two).min() < 0.6 * lengths_of(one).min()


def test_absent_physics_asks_for_nothing():
    """A straight vertical string without rotation, weight on bit and stabilizers has elements of 10 m below the
    layer at its top; without a beam (hydraulics alone) everywhere."""
    made = case(well=hole([0.0, 1000.0], [0.0, 0.0]), string=[{**PIPE, "length": 1000.0}])
    mesh = build_mesh(made)
    assert mesh.length[mesh.upper > 40.0] == pytest.approx(10.0, rel=0.02)
    mud = {"density": 1200.0, "rheology": {"model": "newtonian", "viscosity": 0.02}, "flow_rate": 0.02}
    held = Case(
        well=hole([0.0, 1000.0], [0.0, 0.0]), string=[{**PIPE, "length": 1000.0}], hold_string=True, fluid=mud
    )
    assert build_mesh(held).length == pytest.approx(10.0)


def test_lengths_follow_what_the_operation_asks_for():
    """A weight on bit above the helical load gives elements below a quarter of the pitch at the bit; a turning
    string in a well resolves bending waves at its speed where its tension is low."""
    heavy = case(
        well=hole([0.0, 1000.0], [60.0, 60.0], friction=0.2),
        string=[{**PIPE, "length": 1000.0}],
        bottom={"kind": "bit"},
        initial={"wob": 350e3},
    )
    mesh = build_mesh(heavy)
    pitch = 2 * np.pi * np.sqrt(2 * BENDING / 350e3)
    assert mesh.length[-10:].max() < pitch / 4
    turning = case(
        well=hole([0.0, 1000.0], [0.0, 0.0]),
        string=[{**PIPE, "length": 1000.0}],
        top={"kind": "top_drive", "rotation": "120 rpm"},
        time={"end": 1.0},
    )
    mesh = build_mesh(turning)
    wave = 2 * np.pi * (BENDING / (WEIGHT / 9.81 * (4 * np.pi) ** 2)) ** 0.25  # without tension
    assert mesh.length[-1] == pytest.approx(wave / 6, rel=0.1)


def test_frequency_asked_for():
    """Six elements a wave length of torsion at 100 Hz: c = sqrt(GJ/j) = sqrt(G/rho)."""
    made = Case(string=[{"kind": "pipe", "length": 500.0, "od": 0.127, "id": 0.1086}], top="clamped", gravity=0.0,
                mesh={"frequency": "100 Hz"})  # fmt: skip
    mesh = build_mesh(made)
    assert mesh.length.max() <= np.sqrt(206e9 / 2.6 / 7850.0) / 100.0 / 6
    bending = 2 * np.pi * (BENDING / (AREA * 7850.0 * (200 * np.pi) ** 2)) ** 0.25
    assert mesh.length.max() == pytest.approx(bending / 6, rel=0.02)


def test_the_number_of_elements_is_limited_and_said(monkeypatch):
    """A wire of 5 km with a strong residual curvature would need elements of centimetres; the limit, 20,000, is
    set to 500 here."""
    monkeypatch.setattr(element_length, "MOST_ELEMENTS", 500)
    wire = {"kind": "pipe", "length": 5000.0, "od": 0.002, "curvature": 5.0}
    made = Case(string=[wire], top="clamped")
    found = element_lengths(made)
    assert found.coarsened > 1.1
    assert sum(r.count for r in found.ranges) == pytest.approx(500, rel=0.02)
    assert "limited to 500 elements" in describe(made) and "residual curvature" in describe(made)


# ---------------------------------------------------------------------- commands
def test_check_prints_lengths_and_reasons():
    text = describe(Case(well=BUILD, string=BHA, top={"kind": "top_drive"}, bottom={"kind": "bit"}))
    assert "automatic element lengths" in text
    assert "beside the top: bending layer" in text and "beside stabilizer: free length" in text
    named = [{**q, "element_length": 5.0} if q["kind"] == "pipe" else q for q in BHA]
    assert "automatic" not in describe(
        Case(well=BUILD, string=named, top={"kind": "top_drive"}, bottom={"kind": "bit"})
    )


def test_a_run_that_continues_another_has_its_mesh(tmp_path):
    """Whatever its own loads ask for."""
    well = hole([0.0, 300.0], [40.0, 40.0])
    string = [{**PIPE, "length": 299.0}, {"kind": "bit", "length": 1.0, "od": 0.2159, "mass": 60.0}]
    keys = {"well": well, "string": string, "bottom": {"kind": "bit"}, "time": {"end": 0.05}}
    first = run(case(**keys, initial={"wob": 200e3}), tmp_path / "first", progress="silent")
    made = case(**keys, initial={"from": str(first.folder)})
    assert len(build_mesh(made).upper) == first.summary["elements"]
    alone = build_mesh(case(**keys, initial={"wob": 1e3}))
    assert len(alone.upper) < first.summary["elements"]
    second = run(made, tmp_path / "second", progress="silent")
    one, two = (read_table(q.folder / "history.csv")["wob [N]"] for q in (first, second))
    assert two[0] == pytest.approx(one[-1], rel=1e-6)


def test_statics_takes_the_mesh_of_its_motion(tmp_path):
    """A string that turns has little axial friction; asked for lowering, the push is larger, and so is the number
    of elements."""
    made = case(
        well=hole([0.0, 1000.0], [80.0, 80.0], friction=0.3),
        string=[{**PIPE, "length": 999.0}, {"kind": "bit", "length": 1.0, "od": 0.2159, "mass": 60.0}],
        top={"kind": "top_drive", "rotation": "100 rpm"},
        bottom={"kind": "bit"},
        initial={"wob": 60e3},
    )
    count = {}
    for motion in ("rotate", "lower"):
        statics(made, tmp_path / motion, motion=motion)
        count[motion] = len(read_table(tmp_path / motion / "statics.csv")["md [m]"])
    assert count["lower"] > count["rotate"]


@pytest.mark.parametrize("word", ["none", "automatic", 0.0, -1.0])
def test_other_words_are_refused(word):
    with pytest.raises(CaseError, match="element_length"):
        Case(string=[{**PIPE, "length": 10.0, "element_length": word}], top="clamped")


def test_a_coarse_mesh_run_has_about_half_the_elements():
    """`run --mesh-error` and `study --vary mesh` make every element twice as long, automatic ones by mesh.refinement."""
    made = case(well=BUILD, string=[{**BHA[0], "element_length": 5.0}, *BHA[1:]], bottom={"kind": "bit"})
    fine, coarse = build_mesh(made), build_mesh(coarsened(made, 2.0))
    assert np.sum(coarse.item == 0) == pytest.approx(0.5 * np.sum(fine.item == 0), abs=1)
    automatic = [np.sum(mesh.item == 1) for mesh in (fine, coarse)]
    assert 0.4 * automatic[0] <= automatic[1] <= 0.75 * automatic[0]


def test_a_beam_almost_without_stiffness_has_a_mesh_at_all():
    """Bending waves of a string with EI of 1e-33 N m2 are nanometres long; it had millions of elements, and check never ended."""
    beam = {
        "kind": "beam",
        "length": 8.0,
        "od": 0.15,
        "id": 0.07,
        "mass": 140.0,
        "bending_stiffness": 1e-33,
        "axial_stiffness": 4e9,
        "torsional_stiffness": 7.5e6,
        "polar_inertia": 0.6,
    }
    case = Case(
        well=simple_well(43, 0.2159, (0, 0.1), 0.3, friction=0.3),
        string=[{"kind": "pipe", "length": 30.0, "od": 0.127, "id": 0.1086, "element_length": 10.0}, beam],
        top={"kind": "top_drive", "rotation": "60 rpm"},
        time={"end": 1.0},
    )
    assert build_model(case).mesh.nodes < 25_000
