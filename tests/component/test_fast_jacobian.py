"""Jacobians by local derivatives against those that differentiate all rows by all unknowns
(kernels/core/element.hpp; manual: verif-fast-jacobians)."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc.kernels import function, pointer
from drillpetsc.kernels.parameters import Table, columns
from tests.helpers.component_models import build
from tests.helpers.tables import each_row

SIGMA = 7.3
TRIPLES = {
    "condensed": (1.0, SIGMA, SIGMA**2),
    "stiffness": (1.0, 0.0, 0.0),
    "rates": (0.0, 1.0, SIGMA),
    "mass": (0.0, 0.0, 1.0),
}


def _elements(count: int, unknowns: int, rng: np.random.Generator):
    """Bent, stretched, moving elements with separate nodes: index, nodes, params, x, y, a; d(omega)/dv of
    each node."""
    n = count * unknowns
    index = rng.permutation(n).astype(np.int32).reshape(count, unknowns)
    nodes = rng.permutation(2 * count).astype(np.int32).reshape(count, 2)
    names = columns("beam_parameters")
    p = Table.of(names, rng.uniform(0.5, 2.0, (count, names.width)))
    p["length"] *= 3.0
    p["beta"], p["alpha"] = rng.uniform(0.05, 0.2, (count, 2)).T
    tangent = rng.standard_normal((count, 3))
    tangent /= np.linalg.norm(tangent, axis=1)[:, None]
    for name in ("reference1", "reference2"):
        reference = tangent + 0.3 * rng.standard_normal((count, 3))
        p[name] = reference / np.linalg.norm(reference, axis=1)[:, None]
    state = rng.standard_normal((count, unknowns))
    state[:, 7:10] = state[:, :3] + p["length"][:, None] * (tangent + 0.1 * rng.standard_normal((count, 3)))
    for at in (3, 10):
        state[:, at : at + 3] = 1.1 * tangent + 0.3 * rng.standard_normal((count, 3))
    if unknowns == 15:
        state[:, 14] = rng.uniform(0.8, 1.2, count)
    x = np.zeros(n)
    x[index] = state
    y, a, spin = rng.standard_normal(n), rng.standard_normal(n), rng.standard_normal((2 * count, 3))
    return index, nodes, p.array, x, y, a, spin


def _jacobian(name, count, index, nodes, params, context, weights, spin, x, y, a) -> np.ndarray:
    """(count, d, d) of the entry ``name``, from memory with previous content."""
    K = np.full((count, index.shape[1], index.shape[1]), np.nan)
    jacobian = function(f"{name}_jacobian", "ipppppppppp")
    tables = map(pointer, (weights, spin, x, y, a, K))
    jacobian(count, pointer(index), pointer(nodes), pointer(params), context, *tables)
    return K


@each_row("triple", TRIPLES)
@each_row("kernel", ["beam", "beam_damped", "beam_junction", "beam_junction_damped"])
@each_row("count", [4, 7])
def test_local_derivatives_give_the_derivative_of_the_rows(kernel, triple, count):
    """Equal to rounding for any combination of positions, rates and accelerations, also in the last lanes of
    a pack."""
    unknowns = 15 if "junction" in kernel else 14
    rng = np.random.default_rng(5)
    for _ in range(20):
        index, nodes, params, x, y, a, spin = _elements(count, unknowns, rng)
        weights = np.array(TRIPLES[triple])
        fast, wide = (
            _jacobian(name, count, index, nodes, params, None, weights, spin, x, y, a)
            for name in (kernel, kernel + "_dual")
        )
        assert np.abs(wide).max() > 1e-2
        error = np.abs(fast - wide).max(axis=(1, 2)) / np.abs(wide).max(axis=(1, 2))
        assert error.max() < 1e-13


@pytest.mark.parametrize("triple", TRIPLES)
@pytest.mark.parametrize("kind", ["contact", "contact_hertz_stribeck", "contact_imposed", "contact_junction"])
def test_local_derivatives_of_the_contact(kind, triple):
    """Sliding and imposed friction, on touching and open points of a curved hole with a section change."""
    weights, seen = np.array(TRIPLES[triple]), set()
    for seed in range(20):
        system = build(kind.replace("_imposed", ""), seed)
        system.assembly.condense(SIGMA)
        if "imposed" in kind:
            system.components[1].impose_sliding_direction(0.3, 2.0, 0.5)
        asm = system.assembly
        kernel = "contact_junction" if "junction" in kind else "contact"
        block = next(b for b in asm.bound_blocks if b.block.kernel == kernel)
        spin = np.random.default_rng(seed).standard_normal(asm.spin_gradient.shape)
        arguments = (
            block.count, block.index, block.spins, block.block.params, block.block.context, weights, spin,
            asm.x, asm.y, asm.a,
        )  # fmt: skip
        fast, wide = (_jacobian(name, *arguments) for name in (kernel, kernel + "_dual"))
        scale = np.abs(wide).max(axis=(1, 2))
        assert (np.abs(fast - wide).max(axis=(1, 2)) <= 1e-13 * scale).all()
        seen |= set(scale > 0)
    expected = {"condensed", "stiffness"} if "imposed" in kind else {"condensed", "stiffness", "rates"}
    assert (True in seen) == (
        triple in expected
    )  # imposed friction does not depend on rates, contact has no mass


@pytest.mark.parametrize("kind", ["contact", "contact_hertz_stribeck", "contact_imposed"])
def test_contacts_side_by_side_are_those_of_single_elements(kind):
    """Rows and results of elements that touch, do not touch, or have no clearance, against elements below a junction without a rigid item and
    without stretch, which are evaluated one by one."""
    touching = 0
    for seed in range(20):
        system = build(kind.replace("_imposed", ""), seed)
        asm = system.assembly
        asm.condense(SIGMA)
        if "imposed" in kind:
            system.components[1].impose_sliding_direction(0.3, 2.0, 0.5)
        bound = next(b for b in asm.bound_blocks if b.block.kernel == "contact")
        params = bound.block.params.copy()
        Table.of(columns("contact_parameters"), params)["radius"][::3] *= 3.0
        n, size = bound.count, len(asm.x)
        x, y, a = np.append(asm.x, 1.0), np.append(asm.y, 0.0), np.append(asm.a, 0.0)
        below_junction = np.column_stack([bound.index, np.full(n, size)]).astype(np.int32)
        found = {}
        for name, index in {"contact": bound.index, "contact_junction": below_junction}.items():
            head = pointer(index), pointer(params), bound.block.context
            rows, results = np.zeros(size + 1), np.zeros((n, columns("contact_results").width))
            function(f"{name}_residual", "ipppppp" + "p")(n, *head, *map(pointer, (x, y, a, rows)))
            function(f"{name}_results", "iippppp" + "p")(
                n, index.shape[1], *head, *map(pointer, (x, y, results))
            )
            found[name] = rows[:size], results
        for packed, single in zip(*found.values(), strict=True):
            assert np.abs(packed - single).max() <= 1e-12 * np.abs(single).max()
        touching += int((np.abs(found["contact"][1]).max(axis=1) > 0.0).sum())
    assert touching > 20


@pytest.mark.parametrize("triple", TRIPLES)
def test_local_derivatives_of_a_mass_beside_the_axis(triple):
    """Seeded node by node, on bent and spinning elements whose mass centre is off the axis (kernels/beam/eccentric.hpp)."""
    weights = np.array(TRIPLES[triple])
    for seed in range(20):
        system = build("bodies", seed)
        system.assembly.condense(SIGMA)
        asm = system.assembly
        block = next(b for b in asm.bound_blocks if b.block.kernel == "eccentric")
        rng = np.random.default_rng(seed)
        asm.a[: system.layout.size] = rng.standard_normal(system.layout.size)
        spin = rng.standard_normal(asm.spin_gradient.shape)
        tables = block.block.params, block.block.context, weights, spin, asm.x, asm.y, asm.a
        arguments = block.count, block.index, block.spins, *tables
        fast, wide = (_jacobian(name, *arguments) for name in ("eccentric", "eccentric_dual"))
        scale = np.abs(wide).max(axis=(1, 2))
        assert (scale > 0.0).all()
        assert (np.abs(fast - wide).max(axis=(1, 2)) <= 1e-13 * scale).all()
