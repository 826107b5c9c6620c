"""Requirements of the fluid components of formulation hermite: exact Jacobian, conservation of mass by
construction (manual: sec-mud-hermite)."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc.fem.discrete_system import DiscreteSystem
from drillpetsc.fem.quantity import OneStep
from drillpetsc.geometry.frames import transported_frames
from drillpetsc.physics.beam import AncfBeam
from drillpetsc.physics.end_conditions import EndPlace, TopDrive
from drillpetsc.physics.fluid.annulus_flow import FlowLine, HoleAround, LateralCoefficients
from drillpetsc.physics.fluid.hermite.flow import WINDOW, HermiteAnnulus, HermiteBit, HermiteBore, Reference
from drillpetsc.time_function import Constant, PiecewiseLinear, Ramp
from tests.helpers.component_models import GRAVITY, both_jacobians, meet_conditions, residual
from tests.helpers.flow_models import (
    ANNULUS,
    BORE,
    MUD,
    ONE,
    bit_end,
    curved_hole,
    give_shoulders,
    give_swirl,
    mesh_of,
    set_rates,
    set_string,
)  # fmt: skip
from tests.helpers.tables import each_row

KINDS = (
    "pipe", "pipe_junction", "pipe_closed", "annulus_bit", "annulus_bit_junction", "pipe_annulus_bit",
    "pipe_annulus_bit_junction_topdrive", "pipe_bit", "pipe_held", "pipe_annulus_bit_held", "pipe_bit_held",
    "annulus_bit_held", "annulus_bit_swirl", "annulus_bit_junction_swirl",
)  # fmt: skip


def build(kind: str, seed: int = 5) -> DiscreteSystem:
    """DiscreteSystem of ``kind`` (words joined by _) in a random moving state: fluid of density 3, bulk
    modulus 60, in a curved hole."""
    rng, n, fluid = np.random.default_rng(seed), ONE, MUD
    mesh, well = mesh_of(kind), curved_hole()
    position, tangents, _ = map(np.asarray, well.at(np.arange(5.0)))
    frames = transported_frames(tangents)
    held = position if "held" in kind else None
    components: list = [] if held is not None else [AncfBeam(mesh, frames, GRAVITY)]
    if "topdrive" in kind:
        components.append(TopDrive(EndPlace(position[0], tangents[0]), Ramp(1.0, 2.0), Constant(0.3)))
    pump, pipe, annulus = Ramp(1.0, 0.03), None, None
    if "pipe" in kind:
        pipe = HermiteBore(mesh, BORE, fluid, 0.3 * n, pump, "closed" in kind, held)
    if "annulus" in kind:
        side = LateralCoefficients(np.array([2.0, 2.0, 1.5, 1.5]), 0.3 * n, 0.2 * n, 0.0 * n)
        annulus = HermiteAnnulus(
            mesh,
            HoleAround(ANNULUS, well),
            fluid,
            0.3 * n,
            side,
            FlowLine(Constant(0.4), 0.1),
            held,
            pump=pump,
        )
    components += [r for r in (pipe, annulus) if r is not None]
    if "bit" in kind:
        lower = bit_end(well, pipe is not None, annulus is not None)
        components.append(HermiteBit(4, lower, fluid, pump, (pipe, annulus), position[-1], held))
    system = DiscreteSystem(mesh, frames, components)
    if "swirl" in kind:
        give_swirl(annulus)
    if held is None:
        set_string(system, rng, kind)
    for f in system.layout.fields:
        if not f.name.startswith("string"):
            system.set_field(
                f.name, (0.002 if f.name.endswith("volume") else 2.0) * rng.standard_normal((5, 1))
            )
    set_rates(system, rng)
    return system


@each_row("kind", KINDS)
def test_condensed_jacobian_matches_central_differences(kind):
    """Every block of every kernel against fourth-order differences, relative to the largest entry of its
    row."""
    system, t = build(kind), 0.4
    give_shoulders(system)
    free = meet_conditions(system, t)
    names = [system.layout.fields[k].name for k in system.layout.field_of]
    h = np.array([1e-6 if name.endswith("volume") else 1e-5 for name in names])
    J, F = both_jacobians(system, t, h)
    scale = np.abs(J).max(axis=1, keepdims=True)
    assert np.isfinite(J).all()
    assert np.abs((J - F) @ free / scale).max() < 3e-7


@each_row(
    "kind", ["pipe_bit", "pipe_annulus_bit", "pipe_annulus_bit_held", "pipe_annulus_bit_junction_topdrive"]
)
def test_content_changes_by_the_flow_through_the_ends(kind):
    """Mass is conserved by construction: d(content)/dt, by differences along any motion, is the inflow at the
    pump minus the outflow."""
    system = build(kind)
    asm, components = system.assembly, [r for r in system.components if hasattr(r, "upper_flow_of")]
    bit = system.components[-1]
    residual(system, asm.x[:-1].copy(), 0.4)
    x0, y, h, content = asm.x.copy(), asm.y.copy(), 1e-5, []
    y[-1] = 0.0
    for k in (-2, -1, 1, 2):
        asm.x[:] = x0 + k * h * y
        content.append(
            sum(r.element_results(asm)[:, 4].sum() for r in components) + bit.element_results(asm)[4]
        )
    asm.x[:] = x0
    rate = (content[0] - 8 * content[1] + 8 * content[2] - content[3]) / (12 * h)
    through = sum(r.upper_flow_of(OneStep(asm, 0.0))[0] for r in components) - (
        0.0 if len(components) == 2 else bit.element_results(asm)[1]
    )
    assert abs(through) > 0.01
    assert rate == pytest.approx(through, rel=1e-8)


def test_reference_flow_has_no_jumps():
    """Equal to the pump flow except for a second after a jump, continuous with its stated rate, and exact
    compared with differences."""
    flow = PiecewiseLinear((0.0, 2.0, 2.0, 4.0, 4.0), (0.03, 0.02, 0.0, 0.01, 0.04))
    reference, h = Reference(flow), 1e-6
    for t in (1.0, 3.5, 5.5):
        assert reference.value(t) == pytest.approx(flow.value(t))
    for t in (2.0, 2.0 + WINDOW, 4.0):
        assert reference.value(t) == pytest.approx(reference.value(t - 1e-12), abs=1e-12)
    for t in (0.5, 2.3, 4.7):
        assert reference.rate(t) == pytest.approx(
            (reference.value(t + h) - reference.value(t - h)) / (2 * h), rel=1e-6
        )


def test_the_chamber_ends_where_the_face_is():
    """Its volume is that about the bit and the hole's area times the gap, also for a bit that goes on into rock that gives way,
    until a tenth of a litre is left."""
    bit = build("pipe_annulus_bit").components[-1]
    about = bit_end(curved_hole(), True, True).volume
    for gap in (2.0, 0.0, -0.1):
        assert bit._chamber_volume(gap) == pytest.approx(about + gap * bit.end.hole, rel=1e-12)
    assert bit._chamber_volume(-2.0) == pytest.approx(1e-4, rel=1e-12)
