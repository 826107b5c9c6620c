"""Swirl of the mud about a turning string: its forces have no power of their own, and vanish for a string that is carried
along (manual: sec-mud-swirl; Fritz, J. Basic Eng. 92 (1970) 923)."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc.fem.component import ElementBlock
from drillpetsc.kernels.parameters import columns
from drillpetsc.physics.fluid.added_mass import chi_confined
from drillpetsc.physics.fluid.channel_flow import FluidConstants
from drillpetsc.physics.fluid.mud_items import end_leakage
from drillpetsc.physics.fluid.rheology import Rheology
from drillpetsc.physics.fluid.swirl import Swirl, steady_share
from tests.helpers.component_models import SHIFT
from tests.helpers.component_models import build as build_component
from tests.helpers.flow_models import build
from tests.helpers.tables import each_row

SHARE = 0.37
STRING = ("string.position", "string.tangent", "string.spin")


def _width() -> int:
    return columns("annulus_flow_parameters").width


def _in_straight_hole(seed: int = 5, flow: float = 0.0, noise: float = 0.05, aside: bool = False):
    """System and annulus (``aside``: with an added mass by the place) of a string in a straight, vertical hole about its axis, at rest in mud of that flow [m3/s]."""
    law = Rheology("power_law", consistency=0.8, index=0.7)
    fluid = FluidConstants(3.0, 60.0, np.array([0.0, 0.0, 9.0]), law.parameters(), 0.4)
    system = build("annulus_aside" if aside else "annulus", seed, fluid, noise=noise)
    asm, component = system.assembly, system.components[-1]
    asm.condense(SHIFT)
    for block in component._blocks:
        block.update = None
        p, k = block.named, len(block.points)
        p["tangent1"] = p["tangent2"] = [0.0, 0.0, 1.0]
        p["bend"], p["turning"], p["control"], p["hole"] = 0.0, 0.0, 0.0, 0.3
        p["axis1"], p["axis2"], p["level"] = np.zeros((k, 3)), np.zeros((k, 3)), 0.0
        p["share"] = SHARE
    asm.x[:], asm.y[:], asm.a[:], asm.x[-1] = 0.0, 0.0, 0.0, 1.0
    system.set_field("string.position", np.arange(5.0)[:, None] * [0.0, 0.0, 1.0])
    system.set_field("string.tangent", np.tile([0.0, 0.0, 1.0], (5, 1)))
    system.set_field("annulus.flow", np.full((5, 1), flow))
    return system, component


def _set(component, **values) -> None:
    for block in component._blocks:
        for name, value in values.items():
            block.named[name] = value


def _rows(system, component) -> np.ndarray:
    """Rows of the annulus by unknown."""
    asm = system.assembly
    rows = np.zeros(system.layout.size)
    for bound in (b for b in asm.bound_blocks if b.block in component._blocks):
        np.add.at(rows, bound.index.ravel(), asm.block_rows(bound, 0.4).ravel())
    return rows


def _across(rng, size: float) -> tuple[np.ndarray, np.ndarray]:
    """Random motion across the hole, of the nodes and of their slopes, (5, 3) each."""
    return tuple(size * rng.standard_normal((5, 3)) * [1.0, 1.0, 0.0] for _ in range(2))


@pytest.mark.parametrize("damping", [0.0, 0.8])
def test_string_that_whirls_with_the_mud_feels_no_force(damping):
    """On a circle at the rate of the swirl the mud about the string is carried along: no force and no couple."""
    system, component = _in_straight_hole()
    rng, rate, asm = np.random.default_rng(1), SHARE * 2.0, system.assembly
    place, slope = _across(rng, 0.05)
    turn = lambda u: np.cross([0.0, 0.0, 1.0], u)  # noqa: E731
    _set(component, damping=damping)
    for name, offset in (("string.position", place), ("string.tangent", slope)):
        system.set_field(name, system.field(name) + offset)
    still = _rows(system, component)  # buoyancy and the pressure on the bent string
    for name, offset in (("string.position", place), ("string.tangent", slope)):
        system.set_field(name, rate * turn(offset), "y")
        asm.a[system.layout.dofs[name]] = -(rate**2) * offset
    rows = []
    for swirl in (0.0, rate):
        _set(component, swirl=swirl)
        rows.append(
            (_rows(system, component) - still)[np.r_[tuple(system.layout.dofs[n].ravel() for n in STRING)]]
        )
    assert np.abs(rows[0]).max() > 1e-3
    assert np.abs(rows[1]).max() < 1e-12 * np.abs(rows[0]).max() + 1e-15


def test_mud_swirls_about_one_element_alone():
    """Four elements are evaluated at once, and any of them may be the only one with swirl: their rows add up to those of all four."""
    system, component = _in_straight_hole()
    rng = np.random.default_rng(2)
    for name in ("string.position", "string.tangent"):
        place, speed = _across(rng, 0.05)
        system.set_field(name, system.field(name) + place)
        system.set_field(name, speed, "y")

    def rows(share: np.ndarray) -> np.ndarray:
        for block in component._blocks:
            block.named["share"], block.named["swirl"] = share[block.points], 4.0 * share[block.points]
        return _rows(system, component)

    none, each = rows(np.zeros(4)), SHARE * np.eye(4)
    alone = [rows(share) - none for share in each]
    together = rows(each.sum(axis=0)) - none
    assert min(np.abs(part).max() for part in alone) > 0.1 * np.abs(together).max()
    assert np.abs(sum(alone) - together).max() < 1e-12 * np.abs(together).max()


@each_row("lagging, flow", [(False, 0.0), (True, 0.0), (False, 0.02), (True, -0.02)])
def test_swirl_takes_and_gives_no_energy(lagging, flow):
    """Power of rows and couple = rate of the energies + dissipated - exchanged with the stored swirl and with the flow along the hole,
    for any motion across the hole with a spin and a flow that vary (manual: eq-mud-swirl-energy, eq-mud-energy-across)."""
    system, component = _in_straight_hole(flow=flow)
    asm, rng, layout = system.assembly, np.random.default_rng(3), system.layout
    small = (
        0.02 if flow else 1.0
    )  # the content of the hole about a bent string, of third order, makes its own flow
    for name in ("string.position", "string.tangent"):
        for array, size in ((asm.x, 0.02), (asm.y, 0.3), (asm.a, 0.5)):
            array[layout.dofs[name]] += small * _across(rng, size)[0]
    asm.y[layout.dofs["annulus.flow"]] = 4.0 * flow
    spin, spin_rate = 2.3, 0.9
    asm.y[layout.dofs["string.spin"]], asm.a[layout.dofs["string.spin"]] = spin, spin_rate
    swirl, rate = (1.4, -0.7) if lagging else (SHARE * spin, SHARE * spin_rate)
    _set(component, swirl=swirl, swirl_rate=rate, spin_rate=spin_rate)
    x, y, a = asm.x.copy(), asm.y.copy(), asm.a.copy()

    def energy(step: float) -> float:
        asm.x[:-1], asm.y[:-1] = (x + step * y + 0.5 * step**2 * a)[:-1], (y + step * a)[:-1]
        _set(component, swirl=swirl + step * rate)
        return float(component.element_results(asm)[:, :3].sum())

    power = []
    for share, chi in (
        (SHARE, 1.5),
        (0.0, 0.0 if flow else 1.5),
    ):  # the difference is the swirl's, and with flow that of the added mass
        _set(component, share=share, chi=chi)
        h = 1e-4
        e = [energy(k * h) for k in (-2, -1, 1, 2)]
        asm.x[:], asm.y[:], asm.a[:] = x, y, a
        _set(component, swirl=swirl)
        results = component.element_results(asm)
        booked = (e[0] - 8 * e[1] + 8 * e[2] - e[3]) / (12 * h) + results[:, 3].sum() - results[:, 9].sum()
        power.append((float(_rows(system, component) @ y[:-1]), booked))
    (own, booked), (own_still, booked_still) = power
    assert abs(own - own_still) > 1e-3 * small**2
    assert own - own_still == pytest.approx(booked - booked_still, rel=1e-6 if flow else 1e-7)


@pytest.mark.parametrize("flow", [0.0, 0.02])
def test_added_mass_that_varies_across_the_hole_keeps_the_energy(flow):
    """Both terms of the gradient belong to L = M(|y|)|W|^2/2: power of rows and couple = rate of energies + what the swirl and the flow
    exchange, for a string well aside in its hole that moves at random while the swirl lags."""
    system, component = _in_straight_hole(flow=flow, aside=True)
    asm, rng, layout = system.assembly, np.random.default_rng(7), system.layout
    coefficients = np.array([0.3, 2.1, -0.9, 0.4, -0.2])
    for name, sizes in (("string.position", (0.12, 0.3, 0.5)), ("string.tangent", (0.004, 0.1, 0.2))):
        for array, size in zip((asm.x, asm.y, asm.a), sizes, strict=True):
            array[layout.dofs[name]] += _across(rng, size)[0]
    asm.y[layout.dofs["annulus.flow"]] = 2.0 * flow
    spin, spin_rate, swirl, rate = 2.3, 0.9, 1.4, -0.7
    asm.y[layout.dofs["string.spin"]], asm.a[layout.dofs["string.spin"]] = spin, spin_rate
    _set(component, swirl=swirl, swirl_rate=rate, spin_rate=spin_rate, share=SHARE, clearance=0.25)
    x, y, a = asm.x.copy(), asm.y.copy(), asm.a.copy()

    def energy(step: float) -> float:
        asm.x[:-1], asm.y[:-1] = (x + step * y + 0.5 * step**2 * a)[:-1], (y + step * a)[:-1]
        _set(component, swirl=swirl + step * rate)
        return float(component.element_results(asm)[:, :3].sum())

    own, booked = [], []
    for size in (1.0, 0.0):
        _set(component, chi_by=size * coefficients)
        h = 1e-4
        e = [energy(k * h) for k in (-2, -1, 1, 2)]
        asm.x[:], asm.y[:], asm.a[:] = x, y, a
        _set(component, swirl=swirl)
        results = component.element_results(asm)
        own.append(float(_rows(system, component) @ y[:-1]))
        booked.append(
            (e[0] - 8 * e[1] + 8 * e[2] - e[3]) / (12 * h) + results[:, 3].sum() - results[:, 9].sum()
        )
    assert abs(own[0] - own[1]) > 1e-2
    # with flow, its area about a bent string changes, which is of third order
    assert own[0] - own[1] == pytest.approx(booked[0] - booked[1], rel=1e-3 if flow else 1e-8)


def test_mirrored_motion_has_mirrored_forces():
    """A reflection turns the spin and the swirl round: the forces are mirrored, the couple changes its sign."""
    found = []
    for sign in (1.0, -1.0):
        system, component = _in_straight_hole(flow=0.02)
        asm, rng, layout = system.assembly, np.random.default_rng(4), system.layout
        mirror = np.array([1.0, sign, 1.0])
        for name in ("string.position", "string.tangent"):
            for array, size in ((asm.x, 0.02), (asm.y, 0.3), (asm.a, 0.5)):
                array[layout.dofs[name]] += _across(rng, size)[0] * mirror
        asm.y[layout.dofs["string.spin"]] = 2.0 * sign
        _set(component, swirl=0.6 * sign, swirl_rate=0.3 * sign)
        rows = _rows(system, component)
        found.append(
            [rows[layout.dofs[n]] * mirror for n in ("string.position", "string.tangent")]
            + [rows[layout.dofs["string.spin"]] * sign]
        )
    for a, b in zip(*found, strict=True):
        assert np.abs(a - b).max() <= 1e-12 * np.abs(a).max()


def test_swirl_follows_the_spin_as_its_equation_says():
    """d(swirl)/dt = k (share spin - swirl), integrated exactly while the spin goes along a straight line; order 2 for a spin
    that does not, and at once without a rate (manual: eq-mud-swirl-lag)."""
    share, k, omega = 0.4, 1.7, 3.0

    def exact(t: float) -> float:
        turned = k * np.sin(omega * t) - omega * np.cos(omega * t) + omega * np.exp(-k * t)
        return share * k / (k**2 + omega**2) * turned

    errors = []
    for steps in (20, 40, 80):
        swirl = Swirl(np.full(1, share))
        swirl.follow[:] = k
        block = ElementBlock(
            "annulus", "annulus_flow", "cell", np.zeros(1, np.int32), (), (), np.zeros((1, _width()))
        )
        swirl.attach(block)
        swirl.start(0.0, np.zeros(1))
        for t in np.linspace(0.0, 2.0, steps + 1)[1:]:
            swirl.accept(float(t), np.sin([omega * t]))
        errors.append(abs(float(swirl.swirl[0]) - exact(2.0)))
    assert errors[-1] < 1e-3
    assert 1.7 < np.log2(errors[0] / errors[1]) < 2.3 and 1.7 < np.log2(errors[1] / errors[2]) < 2.3
    swirl.follow[:] = np.inf
    swirl.accept(2.5, np.array([5.0]))
    block.update(2.5)
    assert swirl.at(2.5)[0] == pytest.approx(share * 5.0)
    assert block.named["swirl"][0] == pytest.approx(share * 5.0)


def test_swirl_that_nothing_drives_stays():
    """Without viscosity the rate at which the swirl follows is zero: it keeps what it has, and has no other by itself."""
    swirl = Swirl(np.full(1, 0.4))
    swirl.follow[:] = 0.0
    swirl.start(0.0, np.full(1, 2.0))
    for t in (0.5, 1.0):
        swirl.accept(t, np.full(1, 2.0 + t))
        assert swirl.at(t + 0.3) == (pytest.approx([0.8]), pytest.approx([0.0]))


def test_share_is_the_mean_of_couettes_flow():
    """int w r^3 dr/(Omega int r^3 dr) over the gap with w = A - B/r^2, w(a) = Omega, w(b) = 0 (manual: eq-mud-swirl-share)."""
    for inner, outer in ((0.127, 0.2159), (0.1778, 0.2159)):
        a, b = inner / 2, outer / 2
        r, weight = np.polynomial.legendre.leggauss(8)
        r, weight = a + (b - a) * 0.5 * (r + 1), 0.5 * (b - a) * weight
        w = a**2 / (b**2 - a**2) * (b**2 / r**2 - 1)
        mean = float((weight * w * r**3).sum() / (weight * r**3).sum())
        assert steady_share(np.array([inner]), np.array([outer]))[0] == pytest.approx(mean, rel=1e-12)


def test_mud_about_rigid_items_takes_and_gives_no_energy():
    """As about the string: power of rows and couple = rate of the energy + dissipated - exchanged with the stored swirl."""
    system = build_component("mud_items")
    asm, component, layout = system.assembly, system.components[-1], system.layout
    asm.condense(SHIFT)
    component.locate_hole(asm)
    rng = np.random.default_rng(5)
    asm.a[:-1] = rng.standard_normal(layout.size)
    spin_rate, swirl, rate = (
        asm.a[layout.dofs["string.spin"]][[1, 4], 0],
        np.array([0.9, -0.4]),
        np.array([0.3, 0.8]),
    )
    p = component._block.named
    p["share"], p["swirl"], p["swirl_rate"], p["spin_rate"] = 0.37, swirl, rate, spin_rate
    x, y, a = asm.x.copy(), asm.y.copy(), asm.a.copy()
    flow = y.copy()  # the rate of a spin angle is not its spin
    flow[asm.spin_at[:, 0]] -= asm.transport()

    def energy(step: float) -> float:
        asm.x[:-1], asm.y[:-1] = (x + step * flow + 0.5 * step**2 * a)[:-1], (y + step * a)[:-1]
        p["swirl"] = swirl + step * rate
        return sum(component.energies(0.0, asm))

    h = 1e-4
    e = [energy(k * h) for k in (-2, -1, 1, 2)]
    asm.x[:], asm.y[:], asm.a[:], p["swirl"] = x, y, a, swirl
    bound = next(b for b in asm.bound_blocks if b.block is component._block)
    rows = np.zeros(layout.size)
    np.add.at(rows, bound.index.ravel(), asm.block_rows(bound, 0.0).ravel())
    powers = component.powers(0.0, asm)
    booked = (e[0] - 8 * e[1] + 8 * e[2] - e[3]) / (12 * h) + powers.dissipated - powers.supplied
    assert float(rows @ y[:-1]) == pytest.approx(booked, rel=1e-7)


def test_mud_about_a_bit():
    """Added mass of a bit of 215.9 mm and 0.5 m in mud of 1200 kg/m3, with a quarter of the hole open: chi 7, leakage 0.60, 70 kg
    (thin-gap pressure with its ends at constant pressure; manual: eq-mud-item-leakage)."""
    hole = np.array([0.2159])
    outer = np.sqrt(0.75) * hole
    leakage = end_leakage(np.array([0.5]), outer, hole)
    mass = leakage * chi_confined(outer, hole) * 1200 * np.pi / 4 * outer**2 * 0.5
    assert chi_confined(outer, hole)[0] == pytest.approx(7.0)
    assert leakage[0] == pytest.approx(0.60, abs=0.005)
    assert mass[0] == pytest.approx(70.0, abs=1.0)
    assert end_leakage(np.array([1e4]), outer, hole)[0] == pytest.approx(
        1.0, abs=1e-3
    )  # of a long body nothing leaks
