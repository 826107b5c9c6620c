"""Derivatives of kernels times directions against their Jacobians (kernels/tangent/by_rates.hpp; manual: sec-sensitivities-steps)."""

from __future__ import annotations

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.fem.bound_parts import BoundBlock
from drillpetsc.kernels import address, function, pointer
from tests.helpers import flow_models
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
IN_MUD = {
    "pipe_annulus_bit": {"bore_flow", "annulus_flow", "bit_flow"},
    "pipe_annulus_bit_junction_topdrive": {
        "bore_flow", "bore_flow_junction", "annulus_flow", "annulus_flow_junction", "bit_flow", "beam_junction",
    },
    "annulus_widening": {"annulus_flow"},
    "annulus_swirl": {"annulus_flow"},
    "annulus_junction_swirl": {"annulus_flow", "annulus_flow_junction", "beam_junction"},
    "annulus_junction_swirl_aside": {"annulus_flow_aside", "annulus_flow_aside_junction", "beam_junction"},
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


@each_row("kind", KINDS | IN_MUD)
def test_products_with_directions(kind):
    """Positions of every second direction, rates and accelerations of all; the rows are added to those that are there."""
    system, rng = (flow_models.build if kind in IN_MUD else build)(kind), np.random.default_rng(3)
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
        # of contacts: nothing else asks for it
        by_position = b.block.context != 0 and "flow" not in b.block.kernel
        factors = [((0.0, 1.0, 0.0), dy), ((0.0, 0.0, 1.0), da)]
        if by_position:
            factors.append(((1.0, 0.0, 0.0), chosen[:, None] * dx))
        matrices = [(_matrix(b, state, weights), d) for weights, d in factors]
        wanted = sum(_times(b, K, d) for K, d in matrices)
        sizes = sum(_times(b, np.abs(K), np.abs(d)) for K, d in matrices)
        found = np.ones((DIRECTIONS, length))
        product = function(f"{b.block.kernel}_by_rates", "ippppppiippppp")
        head = b.count, pointer(b.index), pointer(b.block.params), b.block.context, *map(pointer, state)
        some = pointer(chosen) if by_position else None
        product(*head, DIRECTIONS, length, some, *map(pointer, (dx, dy, da, found)))
        assert (np.abs(found - 1.0 - wanted) <= 1e-12 * np.maximum(1.0, sizes))[:, :n].all()
    assert seen == (KINDS | IN_MUD)[kind] | ({"beam"} if kind in IN_MUD else set())
