"""Laws and sizes of a bit that cuts rock, as records: rock and its layers, drag bit, torque, roller cones, shape, contact (manual: sec-bit)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.physics.bit.bit_side import SideLaw
from drillpetsc.physics.own_law import OwnLaw


@dataclass(frozen=True)
class Layer:
    """Rock of a layer (manual: sec-bit-layers, eq-bit-rate).

    start: length of new hole at its top [m].
    drillability: D [m/(s N)].
    rotary_exponent, weight_exponent: of rotary speed and weight [-] (manual: eq-bit-speed-factor).
    threshold: of the weight [N] (manual: eq-bit-threshold).
    bit_anisotropy: I_b [-].
    rock: (3, 3) M_r, symmetric (manual: eq-bit-rock-matrix).
    """

    start: float
    drillability: float
    rotary_exponent: float
    weight_exponent: float
    threshold: float
    bit_anisotropy: float
    rock: FloatArray


@dataclass(frozen=True)
class DragBit:
    """Drag bit (manual: eq-bit-drag; Detournay and Defourny, Int. J. Rock Mech. Min. Sci. 29(1):13, 1992).

    W = zeta eps a d + sigma a l, T = eps a^2 d/2 + mu gamma sigma a^2 l/2, with the radius a and the depth of
    cut d per turn, up to the exposure of the cutters for each blade; the body carries the rest of the weight (manual: eq-bit-body).

    blades: their number.
    specific_energy: eps [Pa]; inclination_ratio: zeta [-].
    contact_stress: sigma [Pa]; wear_flat: l [m]; friction: mu gamma [-].
    exposure: of the cutters beyond the body [m], infinite: the body never touches.
    """

    blades: int = 4
    specific_energy: float = 60e6
    inclination_ratio: float = 0.6
    contact_stress: float = 60e6
    wear_flat: float = 1.2e-3
    friction: float = 0.6
    exposure: float = np.inf


@dataclass(frozen=True)
class Weakening:
    """Torque that falls from ``static`` to ``dynamic`` over ``speed`` [rad/s].

    Manual: eq-bit-torque-weakening.

    static, dynamic: torques [N m], or lever arms of the weight on bit [m] where ``by_weight``.
    """

    static: float
    dynamic: float
    speed: float
    by_weight: bool = False


@dataclass(frozen=True)
class PatternOrder:
    """A wave of the bottom's surface that the bit climbs as it turns (manual: eq-bit-pattern).

    order: waves per turn [-]; amplitude [m]; phase [rad], at the start.
    """

    order: float
    amplitude: float
    phase: float = 0.0


@dataclass(frozen=True)
class Rock:
    """Formation, and the growth of the hole in it (manual: sec-bit-growth).

    layers: from the start on.
    reference_speed [rad/s], reference_weight [N]: manual: eq-bit-speed-factor.
    walk: walk angle [rad].
    bit_axis: the hole grows along the bit's axis, otherwise along the rate of penetration.
    law: of the user for the strength by depth, None: the layers alone.
    post_step: the end moves between the steps, as in the reference formulation (manual: sec-paper-source);
    otherwise the end is a state of the integrator.
    """

    layers: tuple[Layer, ...]
    reference_speed: float = 4 * np.pi
    reference_weight: float = 1e5
    walk: float = 0.0
    bit_axis: bool = False
    post_step: bool = False
    law: OwnLaw | None = None


@dataclass(frozen=True)
class BitShape:
    """Shape of the bit, an ellipsoid (manual: sec-bit-shape).

    face: distance of the face below the node [m]; radius: a [m]; half: half height c [m].
    """

    face: float
    radius: float
    half: float


@dataclass(frozen=True)
class BitContact:
    """Contact of the bit with its hole.

    stiffness: of the bottom [N/m]; friction: coefficient of the bottom [-]; side: law of the side.
    slip: regularisation of both [m/s]; damping: c of ``damping_factor`` [s/m].
    """

    stiffness: float
    friction: float
    side: SideLaw
    slip: float = 0.01
    damping: float = 0.0
