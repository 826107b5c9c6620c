"""What is not projected onto the hole again must be what a projection would find: contact off the wall, nodes that stay."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from drillpetsc.case import load_case
from drillpetsc.model.drilling_model import DrillingModel, build_model
from drillpetsc.physics.contact import Contact

CASES = Path(__file__).parents[2] / "cases"


def model_of(name: str) -> DrillingModel:
    """A model whose string lies on the axis of the hole."""
    model = build_model(load_case(CASES / name))
    assert model.beam is not None
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


def test_the_hole_is_evaluated_at_the_steps_at_which_a_projection_of_all_nodes_asks_for_it():
    """While a string moves along a bent hole of several sizes, volumes and areas are the same to the bit."""
    depths = []
    for forget in (False, True):
        model, rng = model_of("directional.yaml"), np.random.default_rng(2)
        asm = model.system.assembly
        annulus = model.fluid.annulus
        around = annulus.moving_hole
        places = model.system.layout.dofs["string.position"]
        model.system.accept(0.0)
        start, found, stayed = asm.x.copy(), [], 0
        for k in range(200):
            asm.x[:] = start
            asm.x[places] += 4e-4 * k * model.tangent + 5e-4 * rng.standard_normal(places.shape)
            if forget:
                around._from = None
            stayed += around._stays(asm)
            model.system.accept(0.0)
            found.append(around.get_state())
        depths.append(np.array(found))
        assert (stayed == 0) if forget else (20 < stayed < 180)
    assert np.array_equal(*depths)
    assert (np.diff(depths[0][:, :, 0], axis=0) != 0).any()
