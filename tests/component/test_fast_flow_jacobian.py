"""Closed-form Jacobians of the channels against those that differentiate all rows by all unknowns; friction
of packed elements (manual: verif-fast-jacobians)."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc.kernels import function, pointer
from drillpetsc.kernels.parameters import parameters_of
from drillpetsc.physics.fluid.channel_flow import FluidConstants
from drillpetsc.physics.fluid.rheology import Rheology
from tests.component.test_fast_jacobian import SIGMA, TRIPLES, _jacobian
from tests.helpers.component_models import GRAVITY
from tests.helpers.flow_models import build
from tests.helpers.tables import each_row

LAWS = {
    "water": Rheology(
        "newtonian", law="blend", consistency=1e-3, index=1.0, yield_stress=0.0, shear_rate_eps=1.0
    ),
    "power_law": Rheology(
        "power_law", law="blend", consistency=0.5, index=0.7, yield_stress=0.0, shear_rate_eps=1.0
    ),
    "bingham": Rheology(
        "bingham", law="blend", consistency=0.02, index=1.0, yield_stress=5.0, shear_rate_eps=1.0
    ),
    "exact": Rheology(
        "herschel_bulkley", law="exact", consistency=0.3, index=0.6, yield_stress=4.0, shear_rate_eps=1.0
    ),
    "inviscid": Rheology(
        "newtonian", law="blend", consistency=0.0, index=1.0, yield_stress=0.0, shear_rate_eps=1.0
    ),
}


def _elements(
    kernel: str, law: str, seed: int, count: int, turbulent: bool, weights: np.ndarray
) -> tuple[FluidConstants, list]:
    """Four elements of a moving string, some of them repeated, with minor losses and one given pressure.

    Returns the fluid, which must outlive the rest, and the arguments of ``_jacobian`` after the number of
    elements.
    """
    fluid = FluidConstants(3.0, 60.0, GRAVITY, LAWS[law].parameters(), 0.4)
    system = build("pipe_annulus_bit", seed, fluid)
    asm, rng = system.assembly, np.random.default_rng(seed)
    asm.condense(SIGMA)
    if turbulent:
        for name in ("bore.flow", "annulus.flow"):
            system.set_field(name, 300.0 * rng.standard_normal((5, 1)))
    block = next(b for b in asm.bound_blocks if b.block.kernel == kernel)
    chosen = np.arange(count) % block.count
    index, spins = (
        np.ascontiguousarray(table[chosen]) for table in (block.index, block.spins.reshape(block.count, -1))
    )
    p = parameters_of(kernel, np.ascontiguousarray(block.block.params[chosen]))
    p["step"], p["loss"] = rng.uniform(-2.0, 2.0, (count, 2)).T
    p["control"][0], p["controlled"][0] = 1.0, 0.7
    if kernel == "annulus_flow":
        swirling = (np.arange(count) != 2) * (seed % 3 != 2)
        p["share"] = rng.uniform(0.1, 0.5, count) * swirling
        p["swirl"], p["swirl_rate"] = rng.uniform(-2.0, 2.0, (2, count)) * swirling
        p["widening"], p["shoulder"] = rng.uniform(-0.5, 0.5, count), rng.uniform(-5.0, 5.0, count)
    if seed % 2:
        p["poisson"] = 0.0
    spin, a = rng.standard_normal(asm.spin_gradient.shape), asm.a + 0.3 * rng.standard_normal(asm.a.size)
    return fluid, [index, spins, p.array, block.block.context, weights, spin, asm.x, asm.y, a]


@pytest.mark.parametrize("triple", TRIPLES)
@pytest.mark.parametrize("kernel", ["bore_flow", "annulus_flow"])
@pytest.mark.parametrize("count", [4, 7])
def test_closed_form_gives_the_derivative_of_the_rows(kernel, triple, count):
    """Equal to rounding, row by row, for any combination of positions, rates and accelerations, with elastic
    and rigid walls, laminar and turbulent, for fluids with and without a stress explicit in the speed."""
    for seed, law in enumerate(LAWS):
        for turbulent in (False, True):
            fluid, arguments = _elements(kernel, law, seed, count, turbulent, np.array(TRIPLES[triple]))
            fast, wide = (_jacobian(name, count, *arguments) for name in (kernel, kernel + "_dual"))
            assert np.abs(wide).max() > 1e-2
            assert (np.abs(fast - wide) <= 1e-13 * np.abs(wide).max(axis=2, keepdims=True)).all()


@pytest.mark.parametrize("kernel", ["bore_flow", "annulus_flow"])
@pytest.mark.parametrize("count", [4, 7])
def test_products_with_rates_and_accelerations(kernel, count):
    """Products of all directions at once are those of the matrices, row by row (kernels/tangent/flow_by_rates.hpp)."""
    rng, directions = np.random.default_rng(4), 3
    product = function(f"{kernel}_by_rates", "ippppppiippppp")
    for seed, law in enumerate(LAWS):
        for turbulent in (False, True):
            parts, d = [], rng.standard_normal((2, directions, 100))
            for weights in np.eye(3)[1:]:
                fluid, arguments = _elements(kernel, law, seed, count, turbulent, weights)
                index, _, params, context, _, spin, *state = arguments
                arguments[5] = np.zeros_like(spin)
                parts.append(_jacobian(kernel, count, *arguments))
            found, wanted, sizes = np.zeros((3, directions, 100))
            tables = map(pointer, (d[0], d[0], d[1], found))
            head = count, pointer(index), pointer(params), context
            product(*head, *map(pointer, state), directions, 100, None, *tables)
            for k in range(directions):
                for K, q in zip(parts, d[:, k], strict=True):
                    np.add.at(wanted[k], index, np.einsum("eij,ej->ei", K, q[index]))
                    np.add.at(sizes[k], index, np.einsum("eij,ej->ei", np.abs(K), np.abs(q[index])))
            assert sizes.max() > 1e-2
            assert (np.abs(found - wanted) <= 1e-13 * sizes).all()


@each_row("law", LAWS)
@each_row("alpha", [0.0, 1.0])
def test_friction_of_packed_elements(law, alpha):
    """Stress, slope and derivative by the density equal those of a single element, from no flow to far beyond
    turbulence."""
    rng, n = np.random.default_rng(2), 2000
    w = 10.0 ** rng.uniform(-9, 5, n) * rng.choice([-1.0, 1.0], n)
    w[:4] = 0.0
    d, density, kind = rng.uniform(0.03, 0.4, n), rng.uniform(800.0, 2200.0, n), np.full(n, alpha)
    p, many = LAWS[law].parameters(), np.full((3, n), np.nan)
    function("wall_shears_of_packs", "pippdpppp")(
        pointer(p), n, pointer(w), pointer(d), alpha, pointer(density), *map(pointer, many)
    )

    def one_by_one(density: np.ndarray) -> np.ndarray:
        """(2, n) stress [Pa] and slope [Pa s/m]."""
        out = np.full((2, n), np.nan)
        function("rheology_wall_shear", "pipppppp")(
            pointer(p), n, *map(pointer, (w, d, kind, density)), *map(pointer, out)
        )
        return out

    stress, slope = one_by_one(density)
    assert (np.abs(many[0] - stress) <= 1e-13 * np.abs(stress)).all()
    assert (np.abs(many[1] - slope) <= 1e-13 * np.abs(slope)).all()
    h = 1e-5  # the derivative by the density by differences
    change = (one_by_one(density * (1 + h))[0] - one_by_one(density * (1 - h))[0]) / (2 * h)
    assert (np.abs(many[2] * density - change) <= 1e-8 * np.abs(stress)).all()
