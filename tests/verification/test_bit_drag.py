"""Drag bit: steady cutting, wear flat, standstill and reverse rotation, lift-off, small vibrations (manual:
sec-bit-drag, verif-drag-bit-steady).

Law: Detournay and Defourny, Int. J. Rock Mech. Min. Sci. 29(1):13, 1992, W = zeta eps a d + sigma a l and T =
eps a^2 d/2 + mu gamma sigma a^2 l/2, with the depth of cut d per turn. Every blade cuts into the groove of
the preceding blade.
"""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.physics.bit.bit_profile import CHIPS, profile_derivative
from drillpetsc.physics.end_conditions import TopDrive
from drillpetsc.solvers.petsc_options import applied
from drillpetsc.solvers.time.time_integrator import TimeIntegrator
from tests.helpers.bit_models import DRAG, RADIUS, TURNING, bit_of, drilling, lowered, unknowns
from tests.helpers.delay_roots import Regenerative, fitted_exponents
from tests.helpers.motion import beam, fixed, sampled, straight
from tests.helpers.wells import simple_well

CUT, CONTACT = 0.6 * 60e6 * RADIUS, 60e6 * RADIUS * 1.2e-3  # W = CUT d + CONTACT [N/m], [N]
RUB = 0.5 * 0.6 * CONTACT * RADIUS  # torque of the wear flats [N m]


def feed(depth: float, turning: float = TURNING) -> float:
    """Speed [m/s] at which the bit removes ``depth`` [m] per turn."""
    return depth * turning / (2 * np.pi)


def figures(model: DrillingModel, end: float, **petsc) -> np.ndarray:
    """Rows (t, weight, torque, rate, drilled) of all steps."""
    bit = bit_of(model)
    return sampled(
        model.system,
        end,
        lambda m: [*bit.element_results(m.assembly)[:3], unknowns(model, "hole.drilled")[0]],
        model.breaks,
        **petsc,
    )


def iterations(model: DrillingModel, end: float, step: float) -> tuple[list[int], int, int]:
    """Newton iterations of every step of a run with fixed steps, number of rejected steps, number of failed
    Newton solves."""
    counts: list[int] = []
    with applied(fixed(step)):
        integrator = TimeIntegrator(model.system)
        integrator.after_step.append(lambda t, dt: counts.append(integrator.newton_iterations()))
        integrator.run(0.0, end, model.breaks)
    return np.diff([0, *counts]).tolist(), integrator.counters.rejected, integrator.failure_count()


@pytest.mark.parametrize(
    ("depth", "weight", "torque", "rate"), [(4e-3, 23.328e3, 1651.62, 28.8), (8e-3, 38.880e3, 3051.30, 57.6)]
)
def test_steady_cutting(depth, weight, torque, rate):
    """Steady cutting at 120 rpm, a few quarter turns after the contact with a smooth bottom (manual:
    verif-drag-bit-steady)."""
    last = figures(drilling({"bit_law": DRAG}, lowered(feed(depth))), 0.8, **fixed(2e-3))[-1]
    assert last[1:4] == pytest.approx([weight, torque, rate / 3600], rel=1e-3)


def test_wear_flat_in_incomplete_contact():
    """Wear flat at a depth of cut below that of full contact (manual: verif-wear-flat).

    The flat has the fraction 3u^2 - 2u^3 of its full force (kernels/bit/bit.hpp), times (1 + s(U'))/2 with s
    = v/sqrt(v^2 + e^2), e = 0.1 mm/s (manual: eq-bit-flat). Full contact stress needs a depth of cut
    (Detournay and Defourny 1992); the fraction is an assumption of this package, and the test checks its
    implementation.
    """
    depth, onset = 1e-4, CONTACT / 1e8
    u = depth / 4 / onset
    share = u * u * (3 - 2 * u) * 0.5 * (1 + feed(depth) / np.hypot(feed(depth), 1e-4))
    last = figures(drilling({"bit_law": DRAG}, lowered(feed(depth))), 1.0, **fixed(2e-3))[-1]
    assert 0.2 < share < 0.8
    assert last[1:4] == pytest.approx(
        [CUT * depth + share * CONTACT, 0.5 * 60e6 * RADIUS**2 * depth + share * RUB, feed(depth)], rel=1e-3
    )


@pytest.mark.parametrize("turning", [-TURNING, 0.0])
def test_a_bit_that_does_not_turn_forward_cuts_nothing(turning):
    """30 kN on a bit at standstill or in reverse rotation (manual: verif-bit-not-forward): no rock is
    removed, the profile is constant, and only the wear flats rub, against the rotation, with at most their
    full friction."""
    loads = [{"at": 1.0, "force": [0, 0, 30e3]}]
    model = drilling({"bit_law": DRAG}, {"kind": "top_drive", "rotation": turning, "force": 0.0}, loads=loads)
    rows = figures(model, 0.5, ts_rtol=1e-3)
    late = rows[rows[:, 0] > 0.2]
    chips = unknowns(model, "bit.chips")
    assert (rows[:, 3:] == 0.0).all() and np.ptp(chips) == 0.0 and abs(chips).max() < 1e-15  # rounding [m]
    assert late[:, 1].mean() == pytest.approx(30e3, rel=0.1)
    if turning:
        assert (late[:, 2] < -0.1 * RUB).all() and (late[:, 2] > -1.001 * RUB).all()
    else:
        assert (late[:, 2] == 0.0).all()


@pytest.mark.parametrize("rotation", [0.0, -TURNING, {"time": [0.0, 0.2, 0.8], "value": [10.0, 10.0, -10.0]}])
def test_newton_converges_at_standstill_and_in_reverse(rotation):
    """Fewer than 15 iterations per step of 5 ms and no failed step, at standstill, in reverse rotation and
    through zero (manual: verif-bit-not-forward)."""
    model = drilling(
        {"bit_law": DRAG}, {"kind": "top_drive", "rotation": rotation, "lowering": 8e-3}, axial=1e7
    )
    counts, rejected, failures = iterations(model, 1.0, 5e-3)
    assert max(counts) < 15
    assert rejected == failures == 0


# ---------------------------------------------------------------------- lift-off
LIFT_TIMES, LIFT = [0, 0.5, 0.52, 0.72, 0.74, 0.95, 0.97, 1.19, 1.21, 3], 0.5


def lifted(h: float = 1.0) -> tuple[DrillingModel, np.ndarray]:
    """Steady cutting, 11 cm off bottom and back at 0.5 m/s (manual: verif-lift-off). Rows (t, weight, rate,
    depth of the face, drilled, profile ...)."""
    v = feed(4e-3)
    lowering = {"time": LIFT_TIMES, "value": [v, v, -LIFT, -LIFT, 0, 0, LIFT, LIFT, v, v]}
    model = drilling({"bit_law": DRAG}, {"kind": "top_drive", "rotation": TURNING, "lowering": lowering})
    bit = bit_of(model)

    def sample(system):
        f = bit.element_results(system.assembly)
        return [
            f[0], f[2], system.field("string.position")[-1, 2] - 1.0, *unknowns(model, "hole.drilled"),
            *unknowns(model, "bit.chips"),
        ]  # fmt: skip

    return model, sampled(model.system, 2.2, sample, model.breaks, ts_rtol=1e-4)


def test_lift_off_keeps_the_uncut_rock():
    """The hole never becomes shorter, nothing is cut off bottom, and the removed rock equals the drilled
    length (manual: verif-lift-off).

    The rock below the bit lies at the mean of the blades' profile B. Each turn removes blades * chip, so the
    drilled length is the change of that mean. In steady cutting B decreases linearly over one chip from the
    face, so the hole ends half a chip above the face.
    """
    _, rows = lifted()
    t, weight, rate, face, drilled, profile = (
        rows[:, 0], rows[:, 1], rows[:, 2], rows[:, 3], rows[:, 4], rows[:, 5:],
    )  # fmt: skip
    off = (t > 0.53) & (t < 1.15)
    assert off.sum() > 20
    assert np.diff(drilled).min() >= -1e-15 and weight.min() >= 0.0 and rate.min() >= 0.0
    assert (weight[off] == 0.0).all() and (rate[off] == 0.0).all() and np.ptp(drilled[off]) < 1e-15
    assert drilled[off][0] > 3e-3  # it had cut before
    chip = 1e-3
    # uncut rock stays
    assert (
        profile[off].min() > face[t < 0.5].max() - 1.5 * chip
        and profile[off].max() < face[t < 0.52].max() + 0.2 * chip
    )
    assert weight[-1] == pytest.approx(CUT * 4e-3 + CONTACT, rel=1e-3)
    assert drilled[-1] == pytest.approx(face[-1] - 0.5 * chip, abs=1e-3 * chip)


def test_a_profile_that_rotates_off_bottom_does_not_grow():
    """Off bottom the inflow is what the preceding blade leaves, B(2 pi/n) = B(0): B_t = omega B_xi on a ring,
    whose solutions rotate without growth.

    A discrete profile may lose short waves, but no component may grow; otherwise hours of rotation off bottom
    would create rock.
    """
    D = profile_derivative(CHIPS, 0.5 * np.pi)
    ring = D[:, :CHIPS].copy()
    ring[:, 0] += D[:, CHIPS]
    assert np.linalg.eigvals(ring).real.max() < 1e-9  # growth per radian turned


# ---------------------------------------------------------------------- small vibrations
LENGTH, MASS = 10.0, 5e3


def vibration(
    damping: float, stiffness: float, turning: float, chip: float, wear_flat: float, end: float, step: float
) -> np.ndarray:
    """Displacement [m] from steady cutting of a mass on a spring above a drag bit, after a push of 0.1 mm/s;
    one value every ``step`` [s].

    The spring with its parallel damper is a massless, damped beam. The bit starts in the profile of steady
    cutting, under its weight.
    """
    pipe = beam(
        LENGTH,
        1,
        stiffness * LENGTH,
        1e9,
        1e10,
        1e-6,
        1e-3,
        od=2 * RADIUS,
        damping={"stiffness": damping / stiffness},
    )
    item = {
        "kind": "bit",
        "length": 0.1,
        "od": 2 * RADIUS,
        "mass": MASS,
        "inertia": {"axial": 10.0, "transverse": 100.0},
    }
    depth, speed = LENGTH + 0.1, feed(4 * chip, turning)
    well = simple_well(depth, 2 * RADIUS, friction=0.0)
    model = straight(
        string=[pipe, item],
        well=well,
        contact=None,
        top=lowered(speed, turning),
        gravity=0.0,
        initial={"from": "straight"},
        bottom={"kind": "bit", "stiffness": 1e8, "friction": 0.0},
        formation={"bit_law": DRAG | {"wear_flat": wear_flat}},
    )
    system, bit = model.system, bit_of(model)
    weight = 4 * chip * CUT + CONTACT * wear_flat / 1.2e-3
    pressed, sunk = (
        weight / stiffness,
        weight / 1e8,
    )  # the profile of steady cutting follows from the weight at rest
    assert isinstance(model.top, TopDrive)
    model.top.shift(pressed + sunk)
    system.set_field("string.position", np.outer([pressed + sunk, LENGTH + sunk], [0, 0, 1]))
    system.set_field("string.tangent", np.tile([0, 0, 1 - pressed / LENGTH], (2, 1)))
    system.set_field("string.position", np.outer([speed, speed + 1e-4], [0, 0, 1]), "y")
    bit.first_cut(system.assembly)
    rows = sampled(system, end, lambda m: m.field("string.position")[-1, 2], **fixed(step, q_snes_stol=1e-9))
    return rows[:, 1] - LENGTH - sunk - speed * rows[:, 0]


@pytest.mark.parametrize(
    ("damping", "stiffness", "turning", "wear_flat", "growing", "end", "step"),
    [
        (1e4, 2e7, TURNING, 0.0, True, 0.6, 5e-4),
        (1e5, 2e7, 15.0, 1.2e-3, True, 1.0, 4e-4),
        (2e5, 2e7, 20.0, 0.0, False, 1.0, 5e-4),
    ],
    ids=["unstable", "near_neutral", "stable"],
)
def test_small_vibrations_grow_as_in_the_delay_equation(
    damping, stiffness, turning, wear_flat, growing, end, step
):
    """Growth rate and frequency within 2 % of the rightmost root of m u'' + c u' + k u = -4 zeta eps a (u(t)
    - u(t - tau)), tau a quarter turn (manual: verif-regenerative-stability).

    The roots are computed in delay_roots.py, where the argument principle confirms that none lies further
    right. Those of the run are fitted by sums of exponentials. A wear flat in contact with a descending bit
    adds a constant force only.
    """
    equation = Regenerative(MASS, damping, stiffness, 4 * CUT, 0.5 * np.pi / turning)
    root = equation.roots(1)[0]
    assert (root.real > 0) == growing
    right, top = equation.bound(0.0), equation.bound(root.real - 0.1) + 1
    assert equation.zeros_within(root.real - 0.05, right, top) == pytest.approx(2, abs=1e-6)
    assert equation.zeros_within(root.real + 0.05, right, top) == pytest.approx(0, abs=1e-6)
    u = vibration(damping, stiffness, turning, 1e-3, wear_flat, end, step)
    assert np.abs(u).max() < 1e-4  # a tenth of a chip: nothing leaves the groove
    found = fitted_exponents(u[len(u) // 4 :], step, 12)
    nearest = found[np.argmin(np.abs(found - root))]
    assert nearest.real == pytest.approx(root.real, rel=0.02)
    assert nearest.imag == pytest.approx(root.imag, rel=0.02)
