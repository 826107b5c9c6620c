"""Requirements of the fluid components of formulation hermite: exact Jacobian, conservation of mass by
construction (manual: sec-mud-hermite)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from drillpetsc.fem.discrete_system import DiscreteSystem
from drillpetsc.fem.string_mesh import RigidItem, uniform_string
from drillpetsc.geometry.frames import transported_frames
from drillpetsc.geometry.well import Well
from drillpetsc.physics.beam import AncfBeam
from drillpetsc.physics.end_conditions import EndPlace, TopDrive
from drillpetsc.physics.fluid.annulus_flow import FlowLine, HoleAround, LateralCoefficients
from drillpetsc.physics.fluid.bit_flow import BitEnd
from drillpetsc.physics.fluid.channel_flow import FluidConstants
from drillpetsc.physics.fluid.channels import Annulus, Bore
from drillpetsc.physics.fluid.hermite.flow import WINDOW, HermiteAnnulus, HermiteBit, HermiteBore, Reference
from drillpetsc.physics.fluid.rheology import Rheology
from drillpetsc.time_function import Constant, PiecewiseLinear, Ramp
from tests.helpers.component_models import GRAVITY, SECTION, both_jacobians, meet_conditions, residual
from tests.helpers.flow_models import give_shoulders, give_swirl
from tests.helpers.tables import each_row

KINDS = (
    "pipe", "pipe_junction", "pipe_closed", "annulus_bit", "annulus_bit_junction", "pipe_annulus_bit",
    "pipe_annulus_bit_junction_topdrive", "pipe_bit", "pipe_held", "pipe_annulus_bit_held", "pipe_bit_held",
    "annulus_bit_held", "annulus_bit_swirl", "annulus_bit_junction_swirl",
)  # fmt: skip


def build(kind: str, seed: int = 5) -> DiscreteSystem:
    """DiscreteSystem of ``kind`` (words joined by _) in a random moving state: fluid of density 3, bulk
    modulus 60, in a curved hole."""
    rng, n = np.random.default_rng(seed), np.ones(4)
    mesh = uniform_string(4.0, 4, **SECTION, inner_diameter=0.3)
    if "junction" in kind:
        body = RigidItem("stabiliser", "stabilizer", 1, 0.0, 0.3, 1.3, 0.15, (0.0, 0.0), 0.2, 0.4, 0.25)
        mesh = replace(
            mesh,
            junction=np.array([0, 1, 0, 0, 0], bool),
            rigid_above=np.array([0, 0.3, 0, 0.0]),
            bodies=(body,),
        )
    inclination = np.array([0.0, 0.05, 0.15, 0.3, 0.4, 0.5])
    well = Well.from_survey(np.arange(6.0), inclination, 0.3 * np.ones(6), [10.0], [0.3], [0.3], max_step=1.0)
    position, tangents, _ = map(np.asarray, well.at(np.arange(5.0)))
    frames = transported_frames(tangents)
    law = Rheology("power_law", law="blend", consistency=0.8, index=0.7, yield_stress=0.0, shear_rate_eps=1.0)
    fluid = FluidConstants(3.0, 60.0, GRAVITY, law.parameters(), 0.4)
    held = position if "held" in kind else None
    components: list = [] if held is not None else [AncfBeam(mesh, frames, GRAVITY)]
    if "topdrive" in kind:
        components.append(TopDrive(EndPlace(position[0], tangents[0]), Ramp(1.0, 2.0), Constant(0.3)))
    pump, pipe, annulus = Ramp(1.0, 0.03), None, None
    if "pipe" in kind:
        bore = Bore(
            np.array([0.07, 0.07, 0.05, 0.05]),
            1e-3 * n,
            0.06 * n,
            0.05 * n,
            np.array([0.0, 0.06, 0.0, 0.2]),
            0.03 * n,
        )
        pipe = HermiteBore(mesh, bore, fluid, 0.3 * n, pump, "closed" in kind, held)
    if "annulus" in kind:
        sizes = Annulus(
            0.126 * n,
            np.array([0.28, 0.28, 0.3, 0.3]),
            2e-3 * n,
            0.15 * n,
            0.12 * n,
            np.array([0.0, 0.06, 0.0, 0.2]),
            0.2 * n,
        )
        side = LateralCoefficients(np.array([2.0, 2.0, 1.5, 1.5]), 0.3 * n, 0.2 * n, 0.0 * n)
        annulus = HermiteAnnulus(
            mesh, HoleAround(sizes, well), fluid, 0.3 * n, side, FlowLine(Constant(0.4), 0.1), held, pump=pump
        )
    components += [r for r in (pipe, annulus) if r is not None]
    if "bit" in kind:
        end, axis, _ = map(np.asarray, well.at(np.array([4.6])))
        lower = BitEnd(
            bore=0.05 if pipe else 0.0,
            nozzle=0.03,
            discharge_coefficient=0.9,
            check_valve=False,
            ambient=Constant(0.2),
            hole=0.3 if annulus else 0.0,
            open=0.17,
            outer=0.126,
            elasticity=1e-3,
            volume=0.05,
            face=0.2,
            added=1.5,
            metal=0.02,
            end=end[0],
            axis=axis[0],
        )
        components.append(HermiteBit(4, lower, fluid, pump, (pipe, annulus), position[-1], held))
    system = DiscreteSystem(mesh, frames, components)
    if "swirl" in kind:
        give_swirl(annulus)
    asm, size = system.assembly, system.layout.size
    if held is None:
        system.set_field("string.position", position + 0.05 * rng.standard_normal((5, 3)))
        system.set_field("string.tangent", tangents + 0.1 * rng.standard_normal((5, 3)))
        system.set_field("string.spin", rng.standard_normal((5, 1)))
        if "junction" in kind:
            system.set_field("string.ratio", np.full((5, 1), 1.05))
    for f in system.layout.fields:
        if not f.name.startswith("string"):
            system.set_field(
                f.name, (0.002 if f.name.endswith("volume") else 2.0) * rng.standard_normal((5, 1))
            )
    asm.y[:-1] = 0.2 * rng.standard_normal(size)
    asm.v0[:] = asm.y[:-1] - 2.3 * asm.x[:-1]
    asm.v1[:] = 0.3 * rng.standard_normal(size)
    return system


@each_row("kind", KINDS)
def test_condensed_jacobian_matches_central_differences(kind):
    """Every block of every kernel against fourth-order differences, relative to the largest entry of its
    row."""
    system, t = build(kind), 0.4
    give_shoulders(system)
    free = meet_conditions(system, t)
    names = [system.layout.fields[k].name for k in system.layout.field_of]
    h = np.array([1e-5 if name.endswith("volume") else 1e-4 for name in names])
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
    asm, components = system.assembly, [r for r in system.components if hasattr(r, "upper_flow")]
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
    through = sum(r.upper_flow(asm) for r in components) - (
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
