"""From the formation block of a case to the component of the bit that cuts rock (manual: sec-bit-start)."""

from __future__ import annotations

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.case.block import by_names
from drillpetsc.case.blocks.ends import BitBottom
from drillpetsc.case.blocks.formation import Formation, OwnBitLaw
from drillpetsc.case.blocks.items.string import Bit
from drillpetsc.case.case import Case
from drillpetsc.fem.string_mesh import StringMesh
from drillpetsc.geometry.growing_hole import GrowingHole
from drillpetsc.geometry.well import Well
from drillpetsc.model.wall import ITEM_LOAD, LEAST_CLEARANCE, rock_young
from drillpetsc.physics.bit.bit_laws import (
    BitContact,
    BitShape,
    DragBit,
    Layer,
    PatternOrder,
    Rock,
    Weakening,
)
from drillpetsc.physics.bit.bit_side import Gauge, SideLaw
from drillpetsc.physics.bit.rock_bit import RockBit
from drillpetsc.physics.contact import ROCK_POISSON, STEEL_YOUNG, damping_factor, line_stiffness
from drillpetsc.physics.own_law import BIT, ROCK, OwnLaw

ROCK_STRENGTH = 60e6  # of a bit that cuts sideways, if not given [Pa]


def build_rock_bit(case: Case, mesh: StringMesh, well: Well) -> RockBit:
    """Create the bit of a case with a formation, and the growing hole below it."""
    formation, bottom = case.formation, case.bottom
    assert formation is not None and isinstance(bottom, BitBottom) and case.well is not None
    item = next((b for b in reversed(mesh.bodies) if b.kind == "bit"), None)
    radius = item.radius if item is not None else 0.5 * float(mesh.outer_diameter[-1])
    length = item.length if item is not None else 0.0
    face = mesh.total_length - float(mesh.node_depth[-1])
    # the cutting part of a bit is about as high as wide; the part above it does not touch the hole
    shape = BitShape(face, radius, 0.5 * min(length, 2 * radius) or 0.5 * radius)
    start, friction = float(case.given_well.survey.md[-1]), float(case.given_well.sections[-1].friction)
    hole = GrowingHole(well, shape.half, radius + formation.overgauge, friction, formation.node_spacing)
    wall = friction if item is None or item.friction is None else item.friction
    c = case.contact
    if c is None:
        contact = BitContact(bottom.stiffness, bottom.friction, SideLaw(0.0, 0.0))  # the bottom only
    else:
        lateral = bottom.stiffness
        if c.stiffness == "physical":
            lateral = (length or 2 * radius) * _line_stiffness(case, radius, ITEM_LOAD)
        elif c.law == "linear" and length > 0:
            lateral = c.stiffness * length
        damping = damping_factor(c.restitution, c.restitution_speed)
        side, gauge = case.string[-1], None
        guided = not isinstance(side, Bit) or side.side == "guided"
        if isinstance(side, Bit) and side.side == "cutting":
            gauge = _gauge(side, formation)
            # its size matters little: the depth under N_y is small against the over-gauge of a bit that whirls, some mm
            lateral = gauge.length * _line_stiffness(case, radius, gauge.strength / gauge.length)
        contact = BitContact(
            bottom.stiffness, bottom.friction, SideLaw(lateral, wall, guided, gauge), c.slip_velocity, damping
        )
    rock = Rock(
        _layers(formation, start),
        formation.reference_speed,
        formation.reference_weight,
        formation.walk,
        formation.direction == "bit_axis",
        formation.growth == "post_step",
        _rock_law(formation, start),
    )
    inertia = case.time is None or case.time.mode == "dynamic"  # a bit without inertia cuts steadily
    law = formation.bit_law
    pattern = tuple(PatternOrder(q.order, q.amplitude, q.phase) for q in law.orders)
    chosen = _law(law.torque_law, radius, start)
    return RockBit(mesh.nodes - 1, shape, contact, chosen, rock, hole, inertia, pattern)


def _gauge(bit: Bit, formation: Formation) -> Gauge:
    """Strength of the rock times the part of the gauge in contact with it."""
    assert bit.gauge_width is not None
    strength = ROCK_STRENGTH if formation.strength is None else formation.strength
    return Gauge(strength * bit.gauge_length * bit.gauge_width, bit.gauge_length)


def _line_stiffness(case: Case, radius: float, load: float) -> float:
    """Stiffness [Pa] of the rock beside a bit in line contact under ``load`` [N/m]."""
    assert case.formation is not None
    hole = radius + max(case.formation.overgauge, LEAST_CLEARANCE * radius)
    return float(line_stiffness(load, radius, hole, STEEL_YOUNG, rock_young(case), ROCK_POISSON))


def _rock_law(formation: Formation, start: float) -> OwnLaw | None:
    """Create the user's law of the rock below ``start`` [m], None without one."""
    q = formation.rock_law
    if q is None:
        return None
    return OwnLaw(ROCK, q.function, q.call, q.parameters, {"depth": (start, start + 1.0, start + 10.0)})


def _law(law, radius: float, start: float) -> DragBit | Weakening | OwnLaw | None:
    """Create the torque law of a bit of ``radius`` [m] that begins to drill at ``start`` [m]; None for friction at the rock."""
    if isinstance(law, OwnBitLaw):
        depths = start, start + 1.0, start + 10.0
        return OwnLaw(BIT, law.function, law.call, law.parameters, {"depth": depths})
    if law.kind == "drag_bit":
        return DragBit(**by_names(DragBit, law))
    if law.kind == "velocity_weakening":
        if law.static is not None:
            return Weakening(law.static, law.dynamic, law.speed)
        arm = 2 / 3 * radius
        return Weakening(law.static_friction * arm, law.dynamic_friction * arm, law.speed, by_weight=True)
    return None


def _layers(formation, start: float) -> tuple[Layer, ...]:
    """Return the rock at and below the hole's end at ``start`` [m], from the top down."""
    rows = [(-np.inf, formation), *((q.from_, q) for q in formation.layers)]
    if formation.layers and formation.layers[-1].to is not None:
        rows.append((formation.layers[-1].to, formation))
    begins = max(i for i, (depth, _) in enumerate(rows) if depth <= start)
    # the first layer begins anywhere above the end of the hole
    tops = (depth - start if i else -1.0 for i, (depth, _) in enumerate(rows[begins:]))
    return tuple(
        Layer(start=top, rock=rock_matrix(q.rock_anisotropy), **by_names(Layer, q))
        for top, (_, q) in zip(tops, rows[begins:], strict=True)
    )


def rock_matrix(rock) -> FloatArray:
    """Compute the rock anisotropy matrix (3, 3), M_r = n n + I_1 d d + I_2 s s (manual: eq-bit-rock-matrix).

    n is the normal of the bedding, d its dip direction, s its strike direction, in north, east, down.
    The bedding dips by ``dip`` [rad] towards ``dip_azimuth`` [rad]; horizontal bedding has a vertical
    normal.
    """
    dip, azimuth = rock.dip, rock.dip_azimuth
    d = np.array([np.cos(dip) * np.cos(azimuth), np.cos(dip) * np.sin(azimuth), np.sin(dip)])
    s = np.array([-np.sin(azimuth), np.cos(azimuth), 0.0])
    n = np.cross(s, d)
    return np.outer(n, n) + rock.index_dip * np.outer(d, d) + rock.index_strike * np.outer(s, s)
