"""How far the swirl of the mud is that of a viscous flow (manual: sec-mud-swirl, verif-swirl-accuracy)."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq

from drillpetsc.physics.fluid.added_mass import chi_confined, stokes_coefficients, stokes_force
from drillpetsc.physics.fluid.swirl import steady_share
from tests.helpers.couette_whirl import stiffness

SPIN = 80 * np.pi / 30
HOLE = 0.2159


def test_flow_about_a_cylinder_that_hardly_turns():
    """The independent solution without spin is the closed form of Chen, Wambsganss and Jendrzejczyk (1976)."""
    inner, nu, rate, spin = 0.5 * 0.1778, 1e-4, 6.0, 1e-6
    found = stiffness(inner, 0.5 * HOLE, nu, spin, rate) * spin**2
    expected = stokes_force(1j * rate, inner, nu, HOLE / 0.1778) * (1j * rate) ** 2
    assert found == pytest.approx(complex(expected), rel=1e-5)


@pytest.mark.parametrize("ratio", [0.5, 0.588, 0.8235, 0.98])
def test_whirl_without_a_tangential_force_is_that_of_the_swirl(ratio):
    """In viscous flow the force across the whirl changes its sign at the rate share x spin exactly."""
    nu = (0.5 - 0.5 * ratio) ** 2
    found = brentq(lambda w: stiffness(0.5 * ratio, 0.5, nu, 1.0, w).imag, 0.05, 0.95)
    assert found == pytest.approx(float(steady_share(np.array(ratio), np.array(1.0))), rel=1e-4)


@pytest.mark.parametrize(
    ("diameter", "viscosity", "whirl", "across", "radial"),
    [
        (0.1778, 0.153, 0.0, 0.01, -0.08), (0.1778, 0.153, 1.0, 0.05, 1.30), (0.1778, 0.05, 0.0, 0.08, 0.02),
        (0.127, 0.189, 0.0, 0.05, -0.12), (0.127, 0.189, 1.0, 0.22, 1.32),
    ],
)  # fmt: skip
def test_force_against_viscous_flow(diameter, viscosity, whirl, across, radial):
    """Collars and drill pipe at 80 rpm in mud of 1200 kg/m3: at rest off the axis, and whirling with the spin.

    The force across the whirl, which carries the power, is within the share ``across``.  What the radial force lacks, over the
    displaced mass times spin^2, is known: it centres a whirl that is as fast as the spin, and decentres a string that stays aside.
    """
    nu = viscosity / 1200.0
    exact = stiffness(0.5 * diameter, 0.5 * HOLE, nu, SPIN, whirl * SPIN)
    share = float(steady_share(np.array(diameter), np.array(HOLE)))
    _, damping = stokes_coefficients(SPIN * (0.5 * diameter) ** 2 / nu, HOLE / diameter)
    relative = 1j * (whirl - share)  # over the spin
    model = float(chi_confined(diameter, HOLE)) * relative**2 + float(damping) * relative
    assert model.imag == pytest.approx(exact.imag, rel=across)
    assert exact.real - model.real == pytest.approx(radial, abs=0.03)
