"""From the case's formation block to the room of the bit that cuts rock, and how drilling begins."""

from __future__ import annotations

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.case.blocks.ends import BitBottom
from drillpetsc.case.case import Case
from drillpetsc.fem.string_mesh import StringMesh
from drillpetsc.geometry.growing_hole import GrowingHole
from drillpetsc.geometry.well import Well
from drillpetsc.physics.contact import damping_factor
from drillpetsc.physics.rock_bit import BitContact, BitShape, DragBit, Layer, Rock, RockBit, Weakening


def build_rock_bit(case: Case, mesh: StringMesh, well: Well) -> RockBit:
    """The bit of a case with a formation."""
    formation, bottom = case.formation, case.bottom
    assert formation is not None and isinstance(bottom, BitBottom) and case.well is not None
    item = next((b for b in reversed(mesh.bodies) if b.kind == "bit"), None)
    radius = item.radius if item is not None else 0.5 * float(mesh.outer_diameter[-1])
    length = item.length if item is not None else 0.0
    face = mesh.total_length - float(mesh.node_depth[-1])
    # the cutting part of a bit is about as high as it is wide; what is above it does not touch the hole
    shape = BitShape(face, radius, 0.5 * min(length, 2 * radius) or 0.5 * radius)
    start, friction = float(case.well.survey.md[-1]), float(case.well.sections[-1].friction)  # type: ignore[arg-type]
    hole = GrowingHole(well, shape.half, radius + formation.overgauge, friction, formation.freeze_interval)
    wall = friction if item is None or item.friction is None else item.friction
    c = case.contact
    if c is None:
        contact = BitContact(bottom.stiffness, bottom.stiffness, bottom.friction, wall)
    else:
        side = c.stiffness * length if c.law == "linear" and length > 0 else bottom.stiffness
        damping = damping_factor(c.restitution, c.restitution_speed)
        contact = BitContact(bottom.stiffness, side, bottom.friction, wall, c.slip_velocity, damping)
    rock = Rock(
        _layers(formation, start),
        formation.reference_speed,
        formation.reference_weight,
        formation.walk,
        formation.direction == "bit_axis",
        formation.growth == "post_step",
    )
    inertia = case.time is None or case.time.mode == "dynamic"  # a bit without inertia cuts steadily
    return RockBit(mesh.nodes - 1, shape, contact, _law(formation.bit_law, radius), rock, hole, inertia)


def _law(law, radius: float) -> DragBit | Weakening | None:
    if law.kind == "drag_bit":
        return DragBit(
            law.blades,
            law.specific_energy,
            law.inclination_ratio,
            law.contact_stress,
            law.wear_flat,
            law.friction,
        )
    if law.kind == "velocity_weakening":
        if law.static is not None:
            return Weakening(law.static, law.dynamic, law.speed)
        arm = 2 / 3 * radius
        return Weakening(law.static_friction * arm, law.dynamic_friction * arm, law.speed, by_weight=True)
    return None


def _layers(formation, start: float) -> tuple[Layer, ...]:
    """The rock that lies at and below the hole's end at ``start`` [m], from the top down."""
    rows = [(-np.inf, formation), *((q.from_, q) for q in formation.layers)]
    if formation.layers and formation.layers[-1].to is not None:
        rows.append((formation.layers[-1].to, formation))
    begins = max(i for i, (depth, _) in enumerate(rows) if depth <= start)
    return tuple(_layer(q, depth - start if i else -1.0) for i, (depth, q) in enumerate(rows[begins:]))


def _layer(q, start: float) -> Layer:
    return Layer(
        start,
        q.drillability,
        q.rotary_exponent,
        q.weight_exponent,
        q.threshold,
        q.bit_anisotropy,
        rock_matrix(q.rock_anisotropy),
    )


def rock_matrix(rock) -> FloatArray:
    """(3, 3) M_r = n n + I_1 d d + I_2 s s with the bedding's normal n, the direction of dip d and of strike
    s (north, east, down).

    The bedding dips by ``dip`` towards ``dip_azimuth``: a level bed has its normal upright.
    """
    dip, azimuth = rock.dip, rock.dip_azimuth
    d = np.array([np.cos(dip) * np.cos(azimuth), np.cos(dip) * np.sin(azimuth), np.sin(dip)])
    s = np.array([-np.sin(azimuth), np.cos(azimuth), 0.0])
    n = np.cross(s, d)
    return np.outer(n, n) + rock.index_dip * np.outer(d, d) + rock.index_strike * np.outer(s, s)
