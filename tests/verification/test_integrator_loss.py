"""Energy that BDF2 and generalised-alpha lose in a period of a mass on a rod, through a case (manual: verif-integrator-loss)."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc import Case, run
from drillpetsc.output import read_table
from tests.helpers.motion import beam

MASS, STIFFNESS = 1000.0, 4e6  # [kg], [N/m]
RATE = np.sqrt(STIFFNESS / MASS)


def amplitudes(product: float, integrator: dict, folder) -> tuple[np.ndarray, np.ndarray]:
    """Times [s] and energies [J] of the oscillation of a mass that is let go, in steps of ``product`` over its rate.

    The energy is that about the place of rest; gravity starts the motion.
    """
    step = product / RATE
    case = Case(
        string=[
            beam(1.0, 1, STIFFNESS, 1e6, 1e6, 1e-6, 1e-3),
            {"kind": "body", "length": 0.01, "mass": MASS, "inertia": {"axial": 1.0, "transverse": 1.0}},
        ],
        top="clamped",
        initial={"from": "rest", "imperfection": 0.0},
        time={"end": 8 * 2 * np.pi / RATE, **integrator},
        output={"history_every": step},
        petsc={"ts_adapt_type": "none", "ts_dt": step, "q_snes_stol": 1e-13},
    )
    found = read_table(run(case, folder, progress="silent").folder / "history.csv")
    whole = 0.5 * (MASS * 9.80665) ** 2 / STIFFNESS
    return found["time [s]"], whole + found["energy_error [J]"]


@pytest.mark.parametrize(
    ("product", "integrator", "loss", "period"),
    [
        (0.1, {}, 3.0704e-3, 3.30e-3),
        (0.5, {}, 2.2834e-1, 6.94e-2),
        (0.1, {"integrator": "generalized_alpha", "spectral_radius": 0.5}, 2.31e-4, 1.248e-3),
        (0.5, {"integrator": "generalized_alpha", "spectral_radius": 0.8}, 1.02e-3, 2.16e-2),
        (0.5, {"integrator": "generalized_alpha", "spectral_radius": 0.0}, 3.52e-1, 8.58e-2),
    ],
    ids=["bdf 0.1", "bdf 0.5", "alpha 0.5", "alpha 0.8", "alpha 0"],
)
def test_loss_in_a_period(product, integrator, loss, period, tmp_path):
    """The exact amplification of the formula in one of its periods, which are longer by ``period``; 1 % of the loss (C32)."""
    time, energy = amplitudes(product, integrator, tmp_path / "run")
    later = time > 2 * 2 * np.pi / RATE
    slope = np.polyfit(time[later], np.log(energy[later]), 1)[0]
    assert 1 - np.exp(slope * 2 * np.pi / RATE * (1 + period)) == pytest.approx(loss, rel=1e-2)
