"""Derivatives of kernels times directions against their Jacobians (kernels/tangent/by_rates.hpp; manual: sec-sensitivities-steps)."""

from __future__ import annotations

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.fem.bound_parts import BoundBlock
from drillpetsc.kernels import address, function, pointer
from tests.helpers.component_models import SHIFT, build
from tests.helpers.tables import each_row

DIRECTIONS = 11  # more than the kernels take at once
KINDS = {
    "beam_damped": {"beam_damped"},
    "beam_junction": {"beam", "beam_junction"},
    "beam_damped_junction": {"beam_damped", "beam_junction_damped"},
    "bodies_junction": {"beam", "beam_junction", "eccentric", "eccentric_junction"},
    "curvature_junction": {"beam", "beam_junction", "curved", "curved_junction"},
    "contact": {"beam", "contact"},
    "contact_hertz_stribeck": {"beam", "contact"},
    "contact_junction_bodies_bit": {
        "beam", "beam_junction", "eccentric", "eccentric_junction", "contact", "contact_junction", "body_contact", "bit_contact",
    },
}  # fmt: skip


def _matrix(b: BoundBlock, state: list[FloatArray], weights: tuple[float, float, float]) -> FloatArray:
    """(count, d, d) derivatives with the weights, without the spin rates' dependence on the slopes."""
    K, spin = np.zeros((b.count, b.width, b.width)), np.zeros((len(state[0]), 3))
    jacobian = function(f"{b.block.kernel}_jacobian", "ipppppppppp")
    tables = map(pointer, (np.array(weights), spin, *state, K))
    jacobian(b.count, pointer(b.index), pointer(b.spins), pointer(b.block.params), b.block.context, *tables)
    return K


def _times(b: BoundBlock, K: FloatArray, directions: FloatArray) -> FloatArray:
    """(k, length) rows of the products with directions (k, length)."""
    rows = np.zeros_like(directions)
    for row, d in zip(rows, directions, strict=True):
        np.add.at(row, b.index.ravel(), np.einsum("eij,ej->ei", K, d[b.index]).ravel())
    return rows


@each_row("kind", KINDS)
def test_products_with_directions(kind):
    """Positions of every second direction, rates and accelerations of all; the rows are added to those that are there."""
    system, rng = build(kind), np.random.default_rng(3)
    asm, n = system.assembly, system.layout.size
    asm.condense(SHIFT)
    asm.a[:n] += rng.standard_normal(n)
    asm.residual(0.4)
    state, length = [asm.x, asm.y, asm.a], len(asm.x)
    dx, dy, da = (rng.standard_normal((DIRECTIONS, length)) for _ in range(3))
    for q in (dx, dy, da):
        q[:, n:] = 0.0
    chosen = (np.arange(DIRECTIONS) % 2).astype(np.int8)
    seen = set()
    for b in asm.bound_blocks:
        if not b.count or address(f"{b.block.kernel}_by_rates") is None:
            continue
        seen.add(b.block.kernel)
        by_position = b.block.context != 0  # of contacts: nothing else asks for it
        wanted = _times(b, _matrix(b, state, (0.0, 1.0, 0.0)), dy)
        wanted += _times(b, _matrix(b, state, (0.0, 0.0, 1.0)), da)
        if by_position:
            wanted += chosen[:, None] * _times(b, _matrix(b, state, (1.0, 0.0, 0.0)), dx)
        found = np.ones((DIRECTIONS, length))
        product = function(f"{b.block.kernel}_by_rates", "ippppppiippppp")
        head = b.count, pointer(b.index), pointer(b.block.params), b.block.context, *map(pointer, state)
        some = pointer(chosen) if by_position else None
        product(*head, DIRECTIONS, length, some, *map(pointer, (dx, dy, da, found)))
        scale = max(1.0, np.abs(wanted).max())
        assert np.abs(found - 1.0 - wanted)[:, :n].max() < 1e-12 * scale
    assert seen == KINDS[kind]
