"""Requirements of the fluid components: exact Jacobian, conservation of mass, balance of momentum and energy
(manual: verif-component-contract, verif-flow-energy)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from drillpetsc.physics.fluid.channel_flow import RESULT_NAMES, FluidConstants
from drillpetsc.physics.fluid.rheology import Rheology
from tests.helpers.component_models import GRAVITY, SHIFT, both_jacobians, lengths, meet_conditions
from tests.helpers.flow_models import KINDS, build, give_shoulders
from tests.helpers.tables import each_row
from tests.helpers.wells import newtonian, simple_well


def stiff_fluid() -> FluidConstants:
    law = Rheology("newtonian", law="blend", consistency=0.1, index=1.0, yield_stress=0.0, shear_rate_eps=1.0)
    return FluidConstants(3.0, 1e7, GRAVITY, law.parameters(), 0.4)


@each_row("kind", KINDS)
def test_condensed_jacobian_matches_central_differences(kind):
    """Every block of every flow kernel against fourth-order differences, relative to the largest entry of its
    row."""
    system, t = build(kind), 0.4
    give_shoulders(system)
    free = meet_conditions(system, t)
    J, F = both_jacobians(system, t, lengths(system, 1e-4))
    scale = np.abs(J).max(axis=1, keepdims=True)
    scale[scale == 0] = 1.0  # rows of another component's unknowns
    assert np.abs((J - F) @ free / scale).max() < 3e-7


@each_row("kind", ["pipe", "pipe_junction"])
def test_a_string_that_accelerates_as_one_is_one_in_other_gravity(kind):
    """Rows with gravity g and an acceleration A of all nodes are those with gravity g - A, in any motion (equivalence)."""
    acceleration, rows = np.array([3.0, -2.0, 1.5]), []
    for gravity, extra in ((GRAVITY, acceleration), (GRAVITY - acceleration, np.zeros(3))):
        system = build(kind, fluid=replace(stiff_fluid(), gravity=gravity))
        asm, bore = system.assembly, system.components[-1]
        asm.condense(SHIFT)
        asm.a[system.layout.dofs["string.position"]] += extra
        found = np.zeros_like(asm.r)
        for ready in (b for b in asm.bound_blocks if b.block in bore._blocks):
            np.add.at(found, ready.index.ravel(), asm.block_rows(ready, 0.4).ravel())
        rows.append(found[:-1])
    assert rows[0] == pytest.approx(rows[1], rel=1e-9, abs=1e-9 * np.abs(rows[0]).max())
    flow = system.layout.dofs["bore.flow"][1:, 0]
    assert rows[0][flow] == pytest.approx(rows[1][flow], rel=1e-9)


def mean_speeds(system) -> np.ndarray:
    """(4,) mean speed of the elements along the hole (integral of the cubic shapes), starting at the lower
    end of a rigid item above."""
    mesh, component = system.mesh, system.components[-1]
    u, v, w = (
        system.field("string.position", "y"),
        system.field("string.tangent"),
        system.field("string.tangent", "y"),
    )
    ratio, rate = np.ones(5), np.zeros(5)
    if len(mesh.junction) and mesh.junction.any():
        ratio, rate = system.field("string.ratio")[:, 0], system.field("string.ratio", "y")[:, 0]
    size = np.linalg.norm(v, axis=1, keepdims=True)
    turning = (w - v * np.sum(v * w, axis=1, keepdims=True) / size**2) / size
    upper = u[:-1] + mesh.rigid_above[:, None] * turning[:-1]
    slope = np.where(mesh.junction[:-1, None], w[:-1] * ratio[:-1, None] + v[:-1] * rate[:-1, None], w[:-1])
    mean = (upper + u[1:]) / 2 + (slope - w[1:]) * mesh.length[:, None] / 12
    p = component.parameters(np.arange(4))
    tangents = p["tangent1"] + p["tangent2"]
    return np.sum(mean * tangents, axis=1) / np.linalg.norm(tangents, axis=1)


@each_row("kind", [k for k in KINDS if not {"held", "bit", "pump"} & set(k.split("_"))])
def test_mass_rows_add_up_to_the_change_of_content(kind):
    """Sum of the storage of all elements = d(content)/dt by central differences of the content along the
    motion, with the hole's area at the moving mean point of each element."""
    system = build(kind)
    component = system.components[-1]
    asm, h = system.assembly, 1e-5
    x0, y = asm.x.copy(), asm.y.copy()
    y[-1] = 0.0
    widening = [b for b in component._blocks if "widening" in kind]
    content, areas = [], [b.named["hole"].copy() for b in widening]
    around = [b.named["hole_above"].copy() for b in widening]
    speed = mean_speeds(system) if "widening" in kind else np.zeros(4)
    for k in (-2, -1, 1, 2):
        asm.x[:] = x0 + k * h * y
        for b, area, above in zip(widening, areas, around, strict=True):
            wider = k * h * speed[b.points] * b.named["widening"]
            b.named["hole"], b.named["hole_above"] = area + wider, above + wider
        content.append(component.element_results(asm)[:, RESULT_NAMES.index("content")].sum())
    for b, area, above in zip(widening, areas, around, strict=True):
        b.named["hole"], b.named["hole_above"] = area, above
    asm.x[:] = x0
    rate = (content[0] - 8 * content[1] + 8 * content[2] - content[3]) / (12 * h)
    storage = sum(
        component.element_results(asm)[:, RESULT_NAMES.index(f"storage_{end}")].sum()
        for end in ("upper", "lower")
    )
    # content of the motion at constant theta' (the mean pressure's): exact for the string, to the rounding of
    # differences for pressure
    assert storage == pytest.approx(rate, rel=1e-6)


@each_row("kind", ["annulus", "annulus_junction"])
def test_motion_across_a_bent_hole_moves_no_mud(kind):
    """The hole between two nodes keeps its volume while they move at right angles to it: their measured depths stay.

    Only the string gives way, by its stretch, so the storage is the same in a hole of any size.
    """
    system = build(kind)
    asm, component = system.assembly, system.components[-1]
    _, tangents, _ = map(np.asarray, component.well.at(np.arange(5.0)))
    across = np.cross(tangents, [0.3, -0.5, 0.8])
    asm.y[:] = 0.0
    asm.y[system.layout.dofs["string.position"]] = across
    stored = []
    for hole in (0.3, 0.5):
        for block in component._blocks:
            block.named["hole"], block.named["tangent0"] = hole, tangents[block.points]
        results = component.element_results(asm)
        stored.append(results[:, [RESULT_NAMES.index(f"storage_{q}") for q in ("upper", "lower")]].sum())
    along = np.abs(np.diff(across @ tangents[2])).sum()  # a fixed direction would count this as longer hole
    assert abs(stored[1] - stored[0]) < 1e-12 < 1e-2 < along


@pytest.mark.parametrize("kind", ["pipe", "annulus"])
def test_energy_balance_of_an_almost_incompressible_fluid(kind):
    """V.F + (q + A V) R_q + (p - rho g.r) R_p over all rows = d(energy)/dt + dissipated + [p A_w V], for any
    motion of string and fluid (manual: eq-mud-energy, verif-flow-energy).

    V: speed of the string along the hole, in the annulus only, where the speed of the mud is w + V; A, A_w:
    areas of annulus and hole.

    The rows are equations of motion; multiplied by their velocities (heads for the mass rows) they give the
    energy balance. It holds up to the neglected (flow speed / wave speed)^2, to squares of flow speeds times
    rows of mass that are not zero in a random state, and to products of shape functions evaluated at element
    means.
    """
    system = build(kind, fluid=stiff_fluid(), noise=0.003)
    asm, component = system.assembly, system.components[-1]
    for b in component._blocks:
        b.update = None
        b.named["control"] = 0.0  # no end with a given pressure
        if kind == "annulus":
            b.named["hole"] = 0.3  # a hole of one size
    asm.condense(SHIFT)
    pressure, flow = (
        system.layout.dofs[f"{component.name}.pressure"][:, 0],
        system.layout.dofs[f"{component.name}.flow"][1:, 0],
    )
    string = np.setdiff1d(np.arange(system.layout.size), np.concatenate([pressure, flow]))
    x, y, a = asm.x.copy(), asm.y.copy(), asm.a.copy()

    def energy(step: float) -> float:
        asm.x[:] = x + step * y
        asm.x[-1] = 1.0
        asm.y[string] = y[string] + step * a[string]
        return component.element_results(asm)[:, :3].sum()

    h = 1e-5
    e = [energy(k * h) for k in (-2, -1, 1, 2)]
    rate = (e[0] - 8 * e[1] + 8 * e[2] - e[3]) / (12 * h)
    asm.x[:], asm.y[:], asm.a[:] = x, y, a
    rows = np.zeros(system.layout.size)
    for ready in (b for b in asm.bound_blocks if b.block in component._blocks):
        np.add.at(rows, ready.index.ravel(), asm.block_rows(ready, 0.4).ravel())
    speed, ends = np.zeros(4), 0.0
    if kind == "annulus":
        u, w = system.field("string.position", "y"), system.field("string.tangent", "y")
        p = component.parameters(np.arange(4))
        t = p["tangent1"] + p["tangent2"]
        t /= np.linalg.norm(t, axis=1, keepdims=True)
        speed = np.sum(((u[:-1] + u[1:]) / 2 + (w[:-1] - w[1:]) / 12) * t, axis=1)
        ends = 0.3 * (x[pressure[-1]] * u[-1] @ p["tangent2"][-1] - x[pressure[0]] * u[0] @ p["tangent1"][0])
    head = x[pressure] - 3.0 * (system.field("string.position") @ GRAVITY)
    parts = (
        rows[string] * y[string],
        1e2 * rows[flow] * (x[flow] + 0.174 * speed),
        1e-6 * rows[pressure] * head,
    )
    size, lost = sum(np.abs(q).sum() for q in parts), component.element_results(asm)[:, 3].sum()
    print(kind, sum(q.sum() for q in parts), rate + lost + ends, rate, lost, ends, size)
    assert sum(q.sum() for q in parts) == pytest.approx(rate + lost + ends, abs=0.01 * size)


def test_added_mass_follows_the_position_in_the_hole():
    """added_mass: eccentric is the potential flow between eccentric circles at the place of each element's middle (manual:
    eq-mud-chi-eccentric): the inertia of an element that is pushed aside as a whole is that mass."""
    from drillpetsc.physics.fluid.added_mass import chi_eccentric

    for eccentricity in (0.0, 0.3, 0.6, 0.9, 0.97):
        component, rows, size = accelerated_aside(0.127, 0.2159, eccentricity)
        assert rows / size == pytest.approx(chi_eccentric(0.127, 0.2159, eccentricity), rel=5e-4)


def accelerated_aside(outer: float, hole: float, eccentricity: float):
    """(annulus, sum of the rows across the hole per acceleration, mass that the string displaces) of a straight string aside in its hole."""
    from drillpetsc.analysis.statics.placement import place_along_hole
    from drillpetsc.case import Case
    from drillpetsc.model.drilling_model import build_model

    well = simple_well(60, hole, kind="casing", friction=0.2)
    fluid = newtonian(1200, 0.02, added_mass="eccentric")
    string = [{"kind": "pipe", "length": 40, "od": outer, "id": 0.1086, "element_length": 10.0}]
    model = build_model(Case(string=string, top="clamped", well=well, fluid=fluid))
    place_along_hole(model)
    system, component = model.system, model.fluid.annulus
    aside, along = np.array([0.6, 0.8, 0.0]), system.layout.dofs["string.position"]
    system.set_field("string.position", model.position + 0.5 * (hole - outer) * eccentricity * aside)
    asm, rows = system.assembly, []
    for size in (0.0, 1.0):
        asm.a[along] = size * aside
        found = np.zeros(system.layout.size)
        for bound in (b for b in asm.bound_blocks if b.block in component._blocks):
            np.add.at(found, bound.index.ravel(), asm.block_rows(bound, 0.0).ravel())
        rows.append(found[along].sum(axis=0) @ aside)
    return component, rows[1] - rows[0], 1200 * np.pi / 4 * outer**2 * 40.0
