"""The residual of a condensed step in one compiled call is that of its parts, to the bit."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from drillpetsc.case import load_case
from drillpetsc.fem.discrete_system import DiscreteSystem
from drillpetsc.kernels import pointer
from drillpetsc.model.drilling_model import build_model
from tests.helpers.component_models import KINDS, SHIFT, build
from tests.helpers.tables import each_row

CASES = Path(__file__).parents[2] / "cases"


def system_of(kind: str) -> DiscreteSystem:
    """A system of the contract; or a pendulum whose pinned top holds the spin, tilted."""
    if kind != "pinned":
        return build(kind)
    model = build_model(load_case(CASES / "benchmark" / "pendulum.yaml"))
    rng, asm = np.random.default_rng(6), model.system.assembly
    assert any(f.leans for f in asm.row_replacements)
    model.beam.place(model.system, model.position, model.tangent)
    for values in (asm.x, asm.y):
        values[: model.system.layout.size] += 0.1 * rng.standard_normal(model.system.layout.size)
    return model.system


@each_row("dead", [False, True])
@each_row("kind", [*KINDS, "pinned"])
def test_one_call_gives_state_and_rows_of_its_parts(kind, dead):
    """Unknowns, rates, accelerations, rows and reactions; refused where corrected rates take part."""
    one, parts = system_of(kind), system_of(kind)
    rng, t, second = np.random.default_rng(5), 0.4, 1.3 * SHIFT
    history = 0.1 * rng.standard_normal((2, one.layout.size))
    for system in (one, parts):
        system.assembly.v0[:], system.assembly.v1[:] = history
        if dead:  # zero at some unknowns, as that of an imperfection
            system.assembly.dead_load = np.where(history[0] > 0.0, 30.0 * history[0], 0.0)
    owned = parts.layout.local_of_owned
    q, rows, expected = parts.assembly.x[owned].copy(), np.zeros(len(owned)), parts.new_condensed()
    q += 1e-3 * rng.standard_normal(len(q))
    asm = one.assembly
    for k in range(2):  # prescribed motion along a path needs the state once at a time
        parts.assembly.x[owned] = q
        parts.assembly.condense(SHIFT, second)
        parts.assembly.apply_prescribed_rates(t, second)
        parts.sum_residual(t, expected)
        if k == 0:
            asm.x[owned] = q
            asm.condense(SHIFT, second)
            asm.apply_prescribed_rates(t, second)
    done = asm.step_rows(t, SHIFT, second, (pointer(q), pointer(rows)))
    assert done == (not asm.stabilized)
    if not done:
        return
    assert np.array_equal(rows, expected.getArray())
    for name in ("x", "y", "a"):
        assert np.array_equal(getattr(asm, name), getattr(parts.assembly, name)), name
    for a, b in zip(asm.row_replacements, parts.assembly.row_replacements, strict=True):
        assert np.array_equal(a.reaction, b.reaction)


def test_what_a_step_needs_beyond_it_is_refused():
    """Frozen or imposed unknowns."""
    system = build("contact")
    asm, owned = system.assembly, system.layout.local_of_owned
    q, rows = asm.x[owned].copy(), np.zeros(len(owned))
    call = (0.4, SHIFT, SHIFT, (pointer(q), pointer(rows)))
    assert asm.step_rows(*call)
    mask = np.zeros(system.layout.size, dtype=bool)
    mask[3] = True
    asm.freeze(mask)
    assert not asm.step_rows(*call)
    asm.freeze(None)
    asm.set_imposed_rates(np.zeros(system.layout.size + 1), mask)
    assert not asm.step_rows(*call)
    asm.set_imposed_rates(None)
    assert asm.step_rows(*call)
