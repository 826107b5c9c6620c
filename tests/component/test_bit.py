"""The bit that cuts rock: exact Jacobian, energy balance, closed forms of its laws, growth of the hole
(manual: verif-bit-component)."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc.fem.discrete_system import DiscreteSystem
from drillpetsc.geometry.frames import transported_frames
from drillpetsc.geometry.growing_hole import GrowingHole
from drillpetsc.geometry.well import Well
from drillpetsc.physics.beam import AncfBeam
from drillpetsc.physics.bit.bit_laws import (
    BitContact,
    BitShape,
    DragBit,
    Layer,
    PatternOrder,
    Rock,
    Weakening,
)
from drillpetsc.physics.bit.bit_profile import CHIPS, chip_for
from drillpetsc.physics.bit.bit_side import Gauge, SideLaw
from drillpetsc.physics.bit.rock_bit import RockBit
from drillpetsc.physics.own_law import BIT, ROCK, OwnLaw
from tests.helpers.bit_models import DRAG, RADIUS, TURNING, drilling
from tests.helpers.component_models import (
    GRAVITY,
    SECTION,
    SHIFT,
    curved_tangents,
    dense,
    differences,
    residual,
)
from tests.helpers.tables import each_row
from tests.helpers.uniform_string import uniform_string

ANISOTROPIC = np.array([[1.0, 0.05, 0.02], [0.05, 0.9, -0.03], [0.02, -0.03, 1.1]])
KINDS = [
    "rop", "rop_layers", "rop_bitaxis", "rop_loose", "drag", "drag_backwards", "drag_body", "weakening",
    "weakening_byweight", "cone", "cone_loose", "cone_weakening", "cone_statics", "rop_poststep",
    "drag_statics", "drag_body_statics", "rop_statics", "rop_quasi", "drag_quasi", "drag_body_quasi",
    "rop_guided", "rop_loose_guided", "rop_guided_statics", "rop_cutting", "drag_cutting", "cone_cutting",
    "rop_cutting_statics", "rop_cutting_quasi", "own", "own_rate", "own_statics", "own_rate_quasi", "own_cutting", "cone_own", "rop_rocklaw",
    "drag_rocklaw", "drag_body_rocklaw", "drag_rocklaw_quasi", "drag_body_rocklaw_statics", "own_rate_rocklaw",
]  # fmt: skip


def own_torque(s):
    """A torque [N m] of every field of the state."""
    return 0.05 * s.weight * np.tanh(s.speed) * (1 + 0.2 * np.sin(s.angle) + 0.1 * s.depth) + 0.3 * s.advance


def bit(kind: str, hole: GrowingHole) -> RockBit:
    words = kind.split("_")
    layers = (Layer(-1.0, 2e-4, 1.3, 1.4, 3.0, 0.3, ANISOTROPIC),)
    if "layers" in words:
        layers += (Layer(0.25, 6e-4, 0.7, 1.0, 0.0, 0.5, np.eye(3)),)
    rock = Rock(
        layers,
        reference_speed=2.0,
        reference_weight=40.0,
        walk=0.2,
        bit_axis="bitaxis" in words,
        post_step="poststep" in words,
        law=OwnLaw(ROCK, "rock", lambda s: 1.2 + 0.5 * np.sin(4 * s.depth)) if "rocklaw" in words else None,
    )
    own = (
        (lambda s: {"torque": own_torque(s), "rate": 1e-3 * s.weight * s.speed})
        if "rate" in words
        else own_torque
    )
    law = {
        "drag": DragBit(3, 2e3, 0.6, 400.0, 0.05, 0.5, 4e-3 if "body" in words else np.inf),
        "weakening": Weakening(0.8, 0.3, 2.0, "byweight" in words),
        "own": OwnLaw(BIT, "own", own),
    }.get(words[-1] if "cone" in words else words[0])
    lobes = (PatternOrder(3.0, 0.03, 0.4), PatternOrder(1.7, 0.02)) if "cone" in words else ()
    damping = 0.0 if "statics" in words or "quasi" in words else 0.2
    gauge = Gauge(4.0, 0.5, 30.0) if "cutting" in words else None
    contact = BitContact(800.0, 0.4, SideLaw(500.0, 0.3, "guided" in words, gauge), 0.5, damping)
    return RockBit(4, BitShape(0.3, 0.2, 0.15), contact, law, rock, hole, "quasi" not in words, lobes)


def build(kind: str, seed: int = 7) -> tuple[DiscreteSystem, RockBit]:
    rng = np.random.default_rng(seed)
    mesh, tangents = uniform_string(4.0, 4, **SECTION), curved_tangents(6)
    frames = transported_frames(tangents[:5])
    well = Well.from_survey(
        np.arange(6.0),
        np.arccos(tangents[:, 2]),
        np.arctan2(tangents[:, 1], tangents[:, 0]),
        [5.0],
        [0.2],
        [0.3],
        max_step=1.0,
    ).cut(4.3)
    hole = GrowingHole(well, 0.15, 0.26 if "loose" in kind else 0.2, 0.3)
    component = bit(kind, hole)
    system = DiscreteSystem(mesh, frames, [AncfBeam(mesh, frames, GRAVITY), component])
    position, tangent, _ = well.at(np.arange(5.0))
    place = position + 0.02 * rng.standard_normal((5, 3))
    lean = tangent + 0.05 * rng.standard_normal((5, 3))
    if "loose" not in kind:
        place[4] = position[4] + [0.04, 0.03, 0.08]  # on the bottom and on the side
    system.set_field("string.position", place)
    system.set_field("string.tangent", lean)
    system.set_field("string.spin", 2 * rng.standard_normal((5, 1)))
    asm, where = system.assembly, system.layout.dofs
    asm.v0[:], asm.v1[:] = 0.3 * rng.standard_normal(len(asm.v0)), rng.standard_normal(len(asm.v1))
    spin = where["string.spin"][4]
    turning = -3.0 if "backwards" in kind else 3.0
    asm.v0[spin] = turning - SHIFT * asm.x[spin]
    last = where["string.position"][4]
    asm.v0[last] = tangent[4] * 0.4 + [0.1, 0, 0] - SHIFT * asm.x[last]  # on its way down
    drilled = where["hole.drilled"][4]
    asm.x[drilled], asm.x[where["hole.end"][4]] = 0.29, [0.01, -0.02, 0.03]
    ends = where["hole.end"][4]
    asm.v0[ends] = [0.1, 0.02, 0.05] - SHIFT * asm.x[ends]
    if "hole.overgauge" in where:
        asm.x[where["hole.overgauge"][4]] = 0.006
    if "bit.chips" in where:
        asm.x[where["bit.chips"][4]] = 0.29 + 0.01 * rng.standard_normal(CHIPS)
    for word, impose in (
        ("statics", component.impose_sliding_direction),
        ("quasi", component.impose_drilling),
    ):
        if word in kind:
            impose(0.2, 3.0, 0.7)
    if "cone" in kind:
        component.params["angle"] = 0.6
    return system, component


@each_row("kind", KINDS)
def test_jacobian_matches_central_differences(kind):
    system, component = build(kind)
    asm, n = system.assembly, system.layout.size
    x0, h = asm.x[:-1].copy(), 1e-5
    residual(system, x0, 0.4)
    figures = component.element_results(asm)
    assert figures[0] > 0 or "loose" in kind
    assert figures[3] > 0 or "loose" in kind
    assert figures[0] > 1.1 * component._made.saturated or "body" not in kind  # the body carries its part
    asm.jacobian(0.4, (1.0, SHIFT, SHIFT**2), condensed=True)
    J, F = dense(system), differences(system, x0, 0.4, h)
    size = np.abs(J).max(axis=1)
    assert (
        np.abs(J - F).max(axis=1) == pytest.approx(np.zeros(n), abs=1e-6 * max(1.0, float(np.median(size))))
        or (np.abs(J - F).max(axis=1) <= 2e-7 * np.maximum(size, np.median(size))).all()
    )


@each_row("kind", [k for k in KINDS if "statics" not in k and "quasi" not in k and "poststep" not in k])
def test_power_of_the_bit_is_stored_or_goes_into_the_rock(kind):
    """Rows of the string times its velocity = change of the energy of the springs along the motion +
    dissipation reported by the component."""
    system, component = build(kind)
    asm = system.assembly
    residual(system, asm.x[:-1].copy(), 0.4)
    rows = np.zeros_like(asm.r)
    ready = next(b for b in asm.bound_blocks if b.block.name == "bit_rock")
    rows[ready.index[0]] = asm.block_rows(ready, 0.4)[0]
    string = ready.index[0][:7]
    power = float(rows[string] @ asm.y[string])
    x0, flow = asm.x.copy(), asm.y.copy()
    flow[asm.spin_at[:, 0]] -= asm.transport()

    def stored(h):
        asm.x[:] = x0 + h * flow
        return float(component.element_results(asm)[4])

    h = 1e-4
    rate = (stored(-2 * h) - 8 * stored(-h) + 8 * stored(h) - stored(2 * h)) / (12 * h)
    asm.x[:] = x0
    heat = component.powers(0.4, asm).dissipated
    assert power == pytest.approx(rate + heat, rel=2e-2 if rate else 1e-9)
    assert heat > 0


def centred(kind: str) -> tuple[DiscreteSystem, RockBit]:
    """The bit on the axis of its hole, along it and at rest, on the bottom and off the side."""
    system, component = build(kind)
    asm, where = system.assembly, system.layout.dofs
    asm.condense(SHIFT)
    asm.y[:] = 0.0
    asm.x[where["hole.end"][4]] = 0.0
    axis, shape = component.hole.direction, component.shape
    asm.x[where["string.position"][4]] = component.hole.start_point + (0.05 - shape.face + shape.half) * axis
    asm.x[where["string.tangent"][4]] = axis
    return system, component


def rows_of(system: DiscreteSystem) -> np.ndarray:
    ready = next(b for b in system.assembly.bound_blocks if b.block.name == "bit_rock")
    return system.assembly.block_rows(ready, 0.4)[0].copy()


def test_friction_of_a_bit_that_only_turns_or_only_slides():
    """Even pressure: torque 2/3 mu W a on a bit that turns fast, force mu W against one that slides fast and does not turn."""
    system, component = centred("rop")
    asm, where = system.assembly, system.layout.dofs
    weight, mu = component.element_results(asm)[0], component.contact.friction
    assert weight > 10.0
    asm.y[where["string.spin"][4]] = 1e7
    assert rows_of(system)[6] == pytest.approx(2 / 3 * mu * weight * component.shape.radius, rel=1e-6)
    asm.y[where["string.spin"][4]] = 0.0
    across = np.cross(component.hole.direction, [0.0, 1.0, 0.0])
    across /= np.linalg.norm(across)
    asm.y[where["string.position"][4]] = 1e7 * across
    rows = rows_of(system)
    assert rows[:3] @ across == pytest.approx(mu * weight, rel=1e-6)
    assert abs(rows[6]) < 1e-6 * mu * weight


def test_over_gauge_shrinks_by_new_hole_over_the_length_of_the_gauge():
    """Off the side u' = -u |v|/l_g (manual: eq-bit-overgauge)."""
    system, component = centred("rop_cutting")
    asm, where = system.assembly, system.layout.dofs
    asm.y[where["string.spin"][4]] = 3.0
    place, results = where["hole.overgauge"][4], component.element_results(asm)
    assert results[2] > 0 and results[3] == 0  # it drills, and the side does not touch
    asm.y[place] = -asm.x[place] * results[2] / 0.5
    steady = rows_of(system)[-1]
    asm.y[place] = 0.0
    assert abs(steady) < 1e-9 * abs(rows_of(system)[-1])


@each_row("weight", [1.0, 20e3, 16066.040225503912, 64133.17558576836])
def test_first_chip_of_a_sharp_bit(weight):
    """Without a wear flat all of the weight cuts: d = W/(zeta eps a) for any weight, W = 0 cuts nothing
    (manual: eq-bit-drag with l_w = 0).  With the last two weights cut (W/cut) is below W by rounding."""
    cut = 0.6 * 60e6 * 0.108
    assert chip_for(weight, cut, 0.0, 1e-6) == pytest.approx(weight / cut, rel=1e-14)
    assert chip_for(0.0, cut, 0.0, 1e-6) == 0.0


@each_row("weight", [10e3, 50e3, 100e3])
def test_torque_of_a_drag_bit_under_a_weight(weight):
    """T = e a^2 d/2 + mu a W_f/2 with W = zeta e a d + W_f: cutters, and wear flats that carry W_f = a l sigma (Detournay and
    Defourny, Int. J. Rock Mech. 29 (1992) 13, with a bit of bluntness one)."""
    a, energy, ratio, flats = (
        RADIUS,
        DRAG["specific_energy"],
        DRAG["inclination_ratio"],
        RADIUS * 1.2e-3 * 60e6,
    )
    assert flats < 10e3
    model = drilling({"bit_law": DRAG}, {"kind": "top_drive", "rotation": TURNING})
    depth = (weight - flats) / (ratio * energy * a)
    expected = 0.5 * energy * a**2 * depth + 0.5 * DRAG["friction"] * a * flats
    assert model.drilling.torque_for(weight, TURNING) == pytest.approx(expected, rel=1e-9)


@each_row("contact", ["none", {"slip_velocity": 0.5}])
@each_row("dynamic", [0.0, 5e3])
def test_the_weakening_torque_reaches_its_static_value(contact, dynamic):
    """The law is T_d + (T_s - T_d) exp(-(W/W_w)^2) from a hundredth of W_w on, and its largest torque is T_s to 1e-4 of T_s - T_d, with
    and without a contact block (manual: eq-bit-torque-weakening)."""
    law = {"kind": "velocity_weakening", "static": 10e3, "dynamic": dynamic, "speed": 2.0}
    top = {"kind": "top_drive", "rotation": 1.0}
    model = drilling({"drillability": 0, "bit_law": law}, top, contact=contact, clearance=0.01)
    bit, asm = model.drilling, model.system.assembly
    place = model.system.field("string.position").copy()
    place[-1, 2] += 1e-3  # on the bottom
    model.system.set_field("string.position", place)
    spin = model.system.layout.dofs["string.spin"][-1, 0]

    def torque(speed: float) -> float:
        asm.y[spin] = speed
        return bit.weight_and_torque(asm)[1]

    near = np.unique(
        np.concatenate([np.linspace(0.0, 0.1, 2001), bit._made.turn_rounding * np.linspace(0.9, 1.1, 201)])
    )
    torques = np.array([torque(w) for w in near])
    # the fall over the speed of breaking loose, a hundredth of that of the law, is all that is missing
    assert 10e3 - 1.01e-4 * (10e3 - dynamic) < torques.max() <= 10e3
    assert torque(-near[torques.argmax()]) == pytest.approx(-torques.max(), rel=1e-12)
    for speed in (0.0201, 1.0, 4.0):
        assert torque(speed) == pytest.approx(
            dynamic + (10e3 - dynamic) * np.exp(-((speed / 2) ** 2)), rel=1e-12
        )
    assert bit.torque_for(5e3, 4.0) == pytest.approx(torque(4.0), rel=1e-12)  # not that of reference_speed
