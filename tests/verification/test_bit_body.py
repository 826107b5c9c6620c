"""The body of a drag bit beside its cutters (manual: eq-bit-body, verif-bit-body).

By hand: cutters of the exposure h cut at most n h a turn, for W_c = zeta eps a n h + sigma a l. What is beyond W_c rubs:
T = eps a^2 n h/2 + (mu gamma a/2) (sigma a l + W - W_c).  Phase III of Detournay, Richard and Shepherd, Int. J. Rock Mech. Min.
Sci. 45(8):1347, 2008, without further depth.
"""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc.model.drilling_model import DrillingModel
from tests.helpers.bit_models import DRAG, RADIUS, TURNING, bit_of, drilling, lowered, rock_bit, unknowns
from tests.helpers.motion import sampled

EXPOSURE, BLADES, ENERGY = 2e-3, 4, 60e6
CUT, CONTACT = 0.6 * ENERGY * RADIUS, 60e6 * RADIUS * 1.2e-3  # W = CUT d + CONTACT [N/m], [N]
MOST = BLADES * EXPOSURE  # depth of cut a turn [m]
SATURATED = CUT * MOST + CONTACT  # 38.88 kN
WEIGHT = 200e3
TORQUE = 0.5 * ENERGY * RADIUS**2 * MOST + 0.5 * 0.6 * RADIUS * (CONTACT + WEIGHT - SATURATED)
RATE = MOST * TURNING / (2 * np.pi)
LAW = DRAG | {"exposure": EXPOSURE}
DOWN = np.array([0.0, 0.0, 1.0])


def pressed(law: dict, weight: float, turning: float = TURNING) -> DrillingModel:
    """A bit that turns under a weight [N]."""
    top = {"kind": "top_drive", "rotation": turning, "force": 0.0}
    return drilling({"bit_law": law}, top, loads=[{"at": 1.0, "force": [0, 0, weight]}], damping=1e-3)


def test_weight_beyond_the_exposure_rubs():
    """In motion: no more than 8 mm a turn under 200 kN, for which the cutters alone took 51 mm."""
    bit = bit_of(model := pressed(LAW, WEIGHT))

    def sample(system):
        return [*bit.element_results(system.assembly)[:3], unknowns(model, "hole.drilled")[0]]

    rows = sampled(model.system, 2.0, sample, model.breaks, ts_rtol=1e-5)
    late = rows[rows[:, 0] > 1.0]
    assert late[:, 1:4].mean(axis=0) == pytest.approx([WEIGHT, TORQUE, RATE], rel=1e-3)
    assert (rows[-1, 4] - late[0, 4]) / (rows[-1, 0] - late[0, 0]) == pytest.approx(RATE, rel=1e-3)


@pytest.mark.parametrize("weight", [20e3, WEIGHT])
def test_steady_cutting_divides_the_weight_alike(weight):
    """Without a profile (statics, quasi-static drilling): the same rate and torque, below the limit those without a body."""
    bit, free = rock_bit(bit_law=LAW), rock_bit(bit_law=DRAG | {"exposure": 0.1})
    rate, torque = bit.rate_under(weight * DOWN, DOWN, TURNING)[2], bit.torque_for(weight, TURNING)
    if weight > SATURATED:
        assert rate == pytest.approx(RATE, rel=1e-7) and torque == pytest.approx(TORQUE, rel=1e-9)
    else:
        assert rate == free.rate_under(weight * DOWN, DOWN, TURNING)[2]
        assert torque == free.torque_for(weight, TURNING)


def test_the_default_is_half_of_a_13_mm_cutter():
    assert rock_bit(bit_law="drag_bit")._made.exposure == 6.5e-3


@pytest.mark.parametrize("speed", [1e-3, 1e-2, 0.1, 1.0])
def test_a_slow_bit_cuts_for_its_specific_energy(speed):
    """Power of the cutters over the volume that they remove is eps at every speed: at 0.01 rad/s it was 7 % of eps."""
    formation = {"bit_law": DRAG | {"wear_flat": 0}}
    model = drilling(formation, lowered(0.0, speed), contact={"slip_velocity": 0.01}, clearance=0.01)
    bit, asm, dofs = bit_of(model), model.system.assembly, model.system.layout.dofs
    place = model.system.field("string.position").copy()
    place[-1, 2] += 1e-3  # a chip of 1 mm
    model.system.set_field("string.position", place)
    asm.y[dofs["string.spin"][-1, 0]] = speed
    _, torque, rate = bit.element_results(asm)[:3]
    assert rate > 0
    assert torque * speed / (np.pi * RADIUS**2 * rate) == pytest.approx(ENERGY, rel=1e-9)
