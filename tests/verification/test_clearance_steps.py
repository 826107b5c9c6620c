"""Steps of the clearance between pipe and wall: elements beside them, and statics on fine meshes there.

Manual: eq-mesh-step, eq-statics-lateral.
"""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc import Case, statics
from drillpetsc.analysis.commands.check import describe
from drillpetsc.analysis.statics.answer import static_summary
from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
from drillpetsc.analysis.statics.placement import place_along_hole
from drillpetsc.analysis.statics.start.lateral_start import lateral_start
from drillpetsc.analysis.statics.start.march import march
from drillpetsc.doubts import doubts_at
from drillpetsc.doubts.moments import Built
from drillpetsc.model.drilling_model import build_model
from drillpetsc.model.element_length import free_length, step_moment
from drillpetsc.output.measured.bending import end_forces
from drillpetsc.solvers.static.search_limit import SearchLimit

PIPE = {"kind": "pipe", "od": 0.127, "id": 0.1086}
COLLAR = {"kind": "pipe", "od": 0.165, "id": 0.06}


def hole(md, inclination, diameters=(0.2159,), friction: float = 0.3) -> dict:
    survey = {"md": list(md), "inclination": list(np.radians(inclination)), "azimuth": [1.0] * len(md)}
    to = [*(0.5 * md[-1] for _ in diameters[1:]), md[-1]]
    sections = [
        {"to": t, "kind": "open_hole", "diameter": d, "friction": friction}
        for t, d in zip(to, diameters, strict=True)
    ]
    return {"survey": survey, "sections": sections}


def build_and_hold(refinement: float, friction: float = 0.3) -> Case:
    """900 m of pipe, 180 m of heavier pipe, 60 m of collars and 1360 m of pipe in a build to 90 degrees."""
    return Case(
        well=hole([0.0, 500.0, 1400.0, 3000.0], [0.0, 0.0, 90.0, 90.0], friction=friction),
        string=[
            {**PIPE, "length": 900.0},
            {**PIPE, "id": 0.06, "length": 180.0},
            {**COLLAR, "length": 60.0},
            {**PIPE, "length": 1360.0},
        ],
        top={"kind": "top_drive", "rotation": "120 rpm"},
        bottom={"kind": "free"},
        mesh={"refinement": refinement},
    )


def stress_near(model, depth: float) -> float:
    """Largest bending stress [Pa] at the element ends within 15 m of ``depth``."""
    mesh = model.mesh
    area = np.pi / 64 * (mesh.outer_diameter**4 - mesh.inner_diameter**4)
    stress = (0.5 * mesh.outer_diameter / area)[:, None] * end_forces(model).moment_size
    ends = np.column_stack([mesh.upper, mesh.lower])
    return float(stress[abs(ends - depth) < 15].max())


def test_moment_and_free_length_beside_a_step():
    """A stiff pipe on a level floor holds a thin one 20 mm above it: w L^4/72 EI = a and M = w L^2/6."""
    thin = {"kind": "pipe", "od": 0.127, "id": 0.1086, "length": 40.0, "element_length": 0.25}
    stiff = {"kind": "pipe", "od": 0.167, "id": 0.1, "length": 30.0, "element_length": 0.5}
    case = Case(
        well=hole([0.0, 70.0], [90.0, 90.0], friction=0.0),
        string=[{**stiff, "material": {"young": 9e13}}, thin],
        top={"kind": "clamped"},
        bottom={"kind": "free"},
        contact={"stiffness": 1e9},
        gravity=9.81,
    )
    model = build_model(case)
    find_equilibrium(model)
    mesh = model.mesh
    section = np.pi / 4 * (0.127**2 - 0.1086**2)
    bending = 2.1e11 * np.pi / 64 * (0.127**4 - 0.1086**4)
    side = float(mesh.mass[-1]) * 9.81
    assert side == pytest.approx(section * 7850 * 9.81, rel=0.02)
    moment = end_forces(model).moment_size[mesh.upper > 29.99][0, 0]
    expected = float(step_moment(np.array([bending]), 0.02, np.array([side]))[0])
    assert moment == pytest.approx(expected, rel=0.02)
    free = free_length(bending, 0.02, side)
    z = model.system.field("string.position")[:, 2]
    bottom = z[abs(mesh.node_depth - 60.0) < 5].max()
    above = mesh.node_depth[(mesh.node_depth > 30.0) & (bottom - z > 1e-4)]
    # deflection left at a share x of the free length: (1-x)^3 (1+...) is 0.5 % of the step beyond 0.85
    assert 0.7 * free < above.max() - 30.0 < free


def test_automatic_mesh_beside_a_step():
    """Bending stress at both ends of collars in a build section: within 8 % of a mesh four times as fine (20 % before)."""
    found = {}
    for refinement in (1.0, 4.0):
        model = build_model(build_and_hold(refinement))
        find_equilibrium(model)
        found[refinement] = [stress_near(model, depth) for depth in (1080.0, 1140.0)]
    assert found[1.0] == pytest.approx(found[4.0], rel=0.08)


def test_casing_shoe_is_a_step():
    """The hole's diameter steps at a shoe: short elements there, with the reason; none where nothing presses."""

    def reasons(inclination: float) -> list[str]:
        case = Case(
            well=hole([0.0, 1000.0], [inclination, inclination], (0.2445, 0.2159)),
            string=[{**PIPE, "length": 1000.0}],
            top={"kind": "top_drive", "rotation": "60 rpm"},
            bottom={"kind": "free"},
        )
        return [
            line for line in describe(case).splitlines() if "a step of 14 mm on the wall at MD 500 m" in line
        ]

    assert len(reasons(50.0)) == 1
    assert reasons(0.0) == []


def test_rough_wall_is_no_row_of_steps():
    """Diameters that change by 3 mm each 2 m ask for as many elements as a smooth wall; a washout of 30 m for steps."""

    def count(diameters: list[float], every: float) -> int:
        well = hole([0.0, 600.0], [50.0, 50.0])
        well["sections"] = [
            {"to": min(600.0, every * (k + 1)), "kind": "open_hole", "diameter": d, "friction": 0.3}
            for k, d in enumerate(diameters)
        ]
        case = Case(
            well=well,
            string=[{**PIPE, "length": 600.0}],
            top={"kind": "top_drive", "rotation": "60 rpm"},
            bottom={"kind": "free"},
        )
        return len(build_model(case).mesh.length)

    smooth = count([0.2159], 600.0)
    rough = [0.2159 + 0.003 * (k % 2) for k in range(300)]
    washed = [0.2159] * 10 + [0.2459] + [0.2159] * 9
    assert count(rough, 2.0) <= 1.02 * smooth
    assert count(washed, 30.0) > smooth + 10


def test_long_elements_beside_a_step_are_reported(tmp_path):
    """Elements of 10 m beside collars: reported with a length that does; those of 1 m are not."""

    def lines(length: float) -> list[str]:
        case = Case(
            well=hole([0.0, 300.0], [60.0, 60.0]),
            string=[
                {**PIPE, "length": 150.0, "element_length": length},
                {**COLLAR, "length": 100.0, "element_length": length},
            ],
            top={"kind": "top_drive", "rotation": "60 rpm"},
            bottom={"kind": "free"},
        )
        found = statics(case, tmp_path / f"{length:g}")
        return [w for w in found.summary["warnings"] if "step of the clearance" in w]

    (line,) = lines(10.0)
    assert "elements of 10 m beside a step of the clearance between pipe and wall at MD 150 m" in line
    assert lines(1.0) == []


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_fine_meshes_find_the_state_of_coarse_ones(friction):
    """Elements as they are and 8 times as fine (6 cm beside the ends of the build): 45 iterations at most and the same loads.

    Before, 90 and 512 iterations, and no state on the finest.
    """
    loads = []
    for refinement in (1.0, 8.0):
        model = build_model(build_and_hold(refinement, friction))
        state = find_equilibrium(model)
        assert state.equilibrium.iterations <= 45
        assert state.stable
        summary = static_summary(model, state)
        loads.append((summary["hook_load"], summary["surface_torque"]))
    assert loads[0][0] == pytest.approx(loads[1][0], rel=1e-5)
    assert loads[0][1] == pytest.approx(loads[1][1], rel=5e-4, abs=1.0)


def test_start_has_the_arc_length_of_its_elements():
    """Marched to the inside of a bend, the start strains no element by more than its tension does and 2e-5."""
    model = build_model(build_and_hold(2.0))
    place_along_hole(model)
    marched, mesh = march(model, (0.0, 10.0)), model.mesh
    assert marched is not None
    start = lateral_start(marched, marched, SearchLimit())
    assert start is not None and start.side_loads is None
    found = start.march
    chord = np.linalg.norm(np.diff(found.position, axis=0), axis=1)
    turn = np.linalg.norm(np.diff(found.tangent, axis=0), axis=1)
    length = chord * (1 + turn**2 / 24)  # of a flat arc
    tension = found.axial_force[1:-1] / mesh.axial_stiffness
    assert np.max(abs(length / mesh.length - 1 - tension)) < 2e-5


@pytest.mark.parametrize(("collar", "reported"), [(0.1207, False), (0.105, True)])
def test_a_collar_of_the_diameter_of_the_tool_joints_is_no_support(tmp_path, collar, reported):
    """A step of 25 um bends the pipe by sqrt(2 EI a w) = 90 N m, 1.5 MPa: its elements need not resolve it.

    The warning named 0.71 m "(or auto)" on the automatic mesh itself.  A step of 8 mm bends it by 18 times as much.
    """
    case = Case(
        well=hole([0.0, 350.0, 620.0, 1000.0], [0.0, 0.0, 78.0, 92.0], (0.1524,)),
        string=[
            {"kind": "drill_pipe", "length": 880.0, "pipe": "3 1/2in 13.30 E NC38 premium", "element_length": 6.0},
            {"kind": "drill_collar", "length": 60.0, "od": collar, "id": 0.0572, "element_length": 6.0},
        ],
        top={"kind": "top_drive", "lowering": 0.5},
        bottom={"kind": "free"},
    )  # fmt: skip
    for told in (
        statics(case, tmp_path / "run").summary["warnings"],
        doubts_at(Built(model=build_model(case))),
    ):
        assert any("step of the clearance" in w for w in told) == reported
