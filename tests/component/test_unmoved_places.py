"""What is not projected onto the hole again must be what a projection would find: contact off the wall, nodes that stay."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from drillpetsc.case import load_case
from drillpetsc.geometry.well import Well
from drillpetsc.model.drilling_model import DrillingModel, build_model
from drillpetsc.physics.contact import Contact, ContactLaw
from drillpetsc.physics.fluid.moving_hole import REFRESH, SURELY_NEAR
from tests.helpers.component_models import SECTION
from tests.helpers.moving import straight_model
from tests.helpers.uniform_string import uniform_string

CASES = Path(__file__).parents[2] / "cases"


def model_of(name: str) -> DrillingModel:
    """A model whose string lies on the axis of the hole."""
    model = build_model(load_case(CASES / name))
    model.beam.place(model.system, model.position, model.tangent)
    if "string.ratio" in model.system.layout.dofs:
        model.system.set_field("string.ratio", np.ones((model.mesh.nodes, 1)))
    return model


@pytest.mark.parametrize("name", ["directional.yaml", "vertical-2000m-dry.yaml"])
def test_contact_rows_are_those_of_a_projection_at_every_evaluation(name):
    """In a random walk across and along the hole the rows are the same to the bit; many points need no projection."""
    model, other, rng = model_of(name), model_of(name), np.random.default_rng(1)
    asm, contact, always = model.system.assembly, model.contact, other.contact
    assert isinstance(contact, Contact) and isinstance(always, Contact)
    places = model.system.layout.dofs["string.position"]
    start, skipped, touched, points = asm.x.copy(), 0, 0, 0
    way = np.zeros(places.shape)
    for k in range(150):
        size = 10.0 ** rng.uniform(-5, -1.5)  # from far below the clearance to beyond it
        way = 0.9 * way + size * rng.standard_normal(places.shape)
        asm.x[:] = start
        asm.x[places] += way + 2e-3 * k * model.tangent
        before = np.vstack(contact._free)
        rows = asm.residual(0.0)
        open_points = np.concatenate(contact._touching) == 0
        skipped += int(((np.vstack(contact._free) == before).all(axis=1) & open_points).sum())
        touched += int((~open_points).sum())
        points += len(open_points)
        other.system.assembly.x[:] = asm.x
        always._forget_clearances()
        assert np.isfinite(rows).all()
        assert np.array_equal(rows, other.system.assembly.residual(0.0))
        assert np.array_equal(open_points, np.concatenate(always._touching) == 0)
    assert skipped > 0.2 * points
    assert touched > 0.02 * points


def test_a_wall_that_narrows_is_found_by_the_shortest_way():
    """A section that was 50 mm off the wall moves 0.998 of this across the hole and towards the narrow part: it touches."""
    gap, slope, pipe = 0.05, 1.5 * 0.1, 0.1  # of the smoothstep from 0.3 to 0.2 m over 1 m, in its middle
    hole = Well.from_survey([0.0, 20.0], [0.0, 0.0], [0.0, 0.0], [10.0, 20.0], [0.3, 0.2], [0.0, 0.0])
    mesh = uniform_string(1e-3, 1, **(SECTION | {"outer_diameter": 2 * pipe}))
    system = straight_model(mesh, [lambda f, p, t: Contact(mesh, hole, ContactLaw(stiffness=1e6))])
    contact, start = system.components[-1], system.field("string.position") + [0.25 - pipe - gap, 0.0, 10.0]
    assert isinstance(contact, Contact)
    way = np.array([1.0, 0.0, slope]) / np.hypot(1.0, slope)
    for distance, touches in ((0.0, False), (0.9 * gap, False), (0.998 * gap, True)):
        system.set_field("string.position", start + distance * way)
        system.assembly.residual(0.0)
        assert (np.concatenate(contact._touching) == touches).all()


def test_a_new_wall_is_found():
    """A point off the wall touches as soon as the hole is narrower there."""
    model = model_of("vertical-2000m-dry.yaml")
    asm, contact = model.system.assembly, model.contact
    assert isinstance(contact, Contact) and model.well is not None
    asm.residual(0.0)
    assert not np.concatenate(contact._touching).all()
    contact.follow_hole(replace(model.well, section_radius=0.3 * model.well.section_radius))
    asm.residual(0.0)
    assert np.concatenate(contact._touching).all()


def test_the_hole_is_evaluated_before_a_node_has_moved_a_centimetre():
    """While a string moves along a bent hole of several sizes, the hole of a node is never older than SURELY_NEAR of its way, and
    few steps project the nodes."""
    model, rng = model_of("directional.yaml"), np.random.default_rng(2)
    asm, around = model.system.assembly, model.fluid.annulus.moving_hole
    places = model.system.layout.dofs["string.position"]
    model.system.accept(0.0)
    start, furthest, stayed, first = asm.x.copy(), [], 0, around.depth.copy()
    for k in range(200):
        asm.x[:] = start
        asm.x[places] += 4e-4 * k * model.tangent + 5e-4 * rng.standard_normal(places.shape)
        stayed += around._stays(asm)
        model.system.accept(0.0)
        furthest.append(np.abs(model.well.project(asm.x[places]).md - around.depth).max())
    # the lateral noise of 0.5 mm on a curved hole adds some micrometres
    assert max(furthest) < SURELY_NEAR[0] + 1e-5 and max(furthest) > 0.9 * REFRESH
    assert 100 < stayed < 195
    assert (around.depth != first).all()


def test_a_continued_run_evaluates_the_hole_at_the_same_steps():
    """From a checkpoint between two evaluations: at its start no node has a new depth, and later all have
    those of the run before, with the same places from which their way is measured.

    The string moves across the curved hole as well, so that the places of the nodes at their depths are not those of the last evaluation.
    """
    model, other = model_of("directional.yaml"), model_of("directional.yaml")
    asm, places = model.system.assembly, model.system.layout.dofs["string.position"]
    around, continued = (m.fluid.annulus.moving_hole for m in (model, other))
    model.system.accept(0.0)
    start, renewed, continues = asm.x.copy(), 0, False
    across = np.cross(model.tangent, [0.0, 1.0, 0.0])
    for k in range(60):
        before = around.depth.copy()
        asm.x[places] = start[places] + 4e-4 * k * model.tangent + 0.05 * np.sin(0.3 * k) * across
        model.system.accept(0.0)
        other.system.assembly.x[:] = asm.x
        if REFRESH < 4e-4 * k < SURELY_NEAR[0] and not continues:
            other.fluid.annulus.set_local_state(model.fluid.annulus.get_local_state())
            continues = True
        if continues:
            other.system.accept(0.0)
            assert np.array_equal(continued.get_state(), around.get_state()), k
            renewed += int(not np.array_equal(before, around.depth))
    assert renewed > 1
