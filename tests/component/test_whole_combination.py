"""Motor, shock sub, jar, reamer, agitator and steerable tool in one string with mud, and several of a kind: Jacobian and energy."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc import Case
from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
from drillpetsc.analysis.statics.placement import move_rigidly, release
from drillpetsc.model.drilling_model import build_model
from tests.helpers.component_models import SHIFT, dense, residual
from tests.helpers.whole_string import whole_string


@pytest.mark.parametrize("more", [False, True], ids=["one of each", "two of some"])
def test_jacobian_of_the_whole_combination(more):
    """Along random changes of each kind of unknown, on the static start in motion: differences of fourth order, 1e-6.

    The error is over the sum of the magnitudes in a row, |J| |e|: what rounding leaves of it.
    """
    model = build_model(Case(**whole_string(more)))
    find_equilibrium(model)
    move_rigidly(model)
    release(model)
    system, t, rng = model.system, 0.0, np.random.default_rng(3)
    asm, layout = system.assembly, system.layout
    names = {f.name for f in layout.fields}
    wanted = {"joint.load", "motor.torque", "agitator.angle", "hole.reamer", "bore.flow", "annulus.pressure"}
    assert wanted | ({"agitator_2.angle", "hole.reamer_2"} if more else set()) <= names
    x0 = asm.x[:-1].copy()
    residual(system, x0, t)
    asm.jacobian(t, (1.0, SHIFT, SHIFT**2), condensed=True)
    J = dense(system)
    held = {int(i) for name in ("position", "tangent", "spin") for i in layout.dofs[f"string.{name}"][0]}
    for f in layout.fields:
        places = np.array([i for i in layout.dofs[f.name].ravel() if i >= 0 and i not in held])
        e = np.zeros(len(x0))
        e[places] = f.scale * rng.uniform(0.5, 1.0, len(places)) * rng.choice([-1.0, 1.0], len(places))
        size, along, errors = np.abs(J) @ np.abs(e), J @ e, []
        for h in (
            1e-2,
            1e-3,
            1e-4,
            1e-5,
        ):  # short enough for the rounded corners of contact, long enough for rounding errors
            r = [residual(system, x0 + k * h * e, t) for k in (-2, -1, 1, 2)]
            slope = (r[0] - 8 * r[1] + 8 * r[2] - r[3]) / (12 * h)
            errors.append(np.abs(along - slope) / (size + NOISE / h))
        error = np.min(errors, axis=0)
        assert error.max() < 1e-5, (f.name, int(error.argmax()), error.max())


NOISE = 0.02  # of the rows, whose terms are of the size of 1e7 N, over the step [N]
