"""Bending moments in tables and fields are those relative to the stress-free shape."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
from drillpetsc.case import Case
from drillpetsc.model.drilling_model import build_model
from drillpetsc.output.measured.bending import curvatures, end_forces
from drillpetsc.output.measured.field_output import FieldOutput
from drillpetsc.output.static_table import static_table


def test_a_bent_pipe_that_is_held_straight_has_no_curvature():
    """M/EI = -kappa_0 there, for a stress-free curvature in any direction: curvature 0, and a moment of EI kappa_0."""
    pipe = {"kind": "pipe", "length": 20, "od": 0.127, "id": 0.1086, "element_length": 2}
    model = build_model(Case(string=[pipe | {"curvature": 0.01, "curvature_angle": 0.7}], top="clamped"))
    model.beam.place(model.system, model.position, model.tangent)
    moment = end_forces(model).moment
    size = np.linalg.norm(moment, axis=2)
    assert size == pytest.approx(0.01 * model.mesh.bending_stiffness[0], rel=1e-9)
    assert np.abs(curvatures(model, moment)).max() < 1e-9 * 0.01


def test_a_bent_pipe_at_rest_has_no_bending_moment():
    """A clamped pipe of stress-free curvature 0.01 1/m without gravity keeps its free shape, an arc (manual:
    verif-bent-pipe-at-rest). Its moment is zero; EI times the whole curvature is 12 kN m."""
    pipe = {"kind": "pipe", "length": 20, "od": 0.127, "id": 0.1086, "curvature": 0.01, "element_length": 2}
    model = build_model(Case(string=[pipe], top="clamped", gravity=0.0))
    find_equilibrium(model)
    _, data = FieldOutput(model).fields(0.0)
    columns, values = static_table(model)
    moments = values[:, [name for name, _ in columns].index("bending_moment")]
    curvature = values[:, [name for name, _ in columns].index("curvature")]
    assert curvature == pytest.approx(np.full(11, 0.01), rel=2e-3)
    whole = 0.5 * model.mesh.bending_stiffness[0] * 0.01**2 * 20  # the energy that would straighten it
    assert abs(model.system.energies(0.0)[1]) < 1e-4 * whole
    assert np.abs(moments).max() < 30 and np.abs(data["bending_moment [N m]"]).max() < 30
    assert data["bending_moment [N m]"] == pytest.approx(moments, abs=1e-6)
