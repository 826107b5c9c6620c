"""Bending moments in tables and fields are those relative to the stress-free shape."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
from drillpetsc.case import Case
from drillpetsc.model.drilling_model import build_model
from drillpetsc.output.measured.field_output import FieldOutput
from drillpetsc.output.static_table import static_table


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
    assert np.abs(moments).max() < 30 and np.abs(data["bending_moment [N m]"]).max() < 30
    assert data["bending_moment [N m]"] == pytest.approx(moments, abs=1e-6)
