"""Local errors of generalised-alpha by unknown, `error_estimate.time` of the summary (manual: eq-time-alpha-phase)."""

from __future__ import annotations

import pytest

import drillpetsc
from drillpetsc import load_case
from drillpetsc.solvers.time.alpha_formula import AlphaFormula

PENDULUM = "cases/verification/study-pendulum.yaml"


def test_sums_of_a_pendulum(tmp_path):
    """At equal fixed steps the sums are those of BDF 2 times phase error over 2/9, the constants of h^3 x'''; order 2 in the step."""
    sums = {}
    for integrator in ("generalized_alpha", "bdf"):
        for step in (1e-3, 5e-4):
            keys = [
                "petsc.ts_adapt_type=none",
                f"petsc.ts_dt={step}",
                "petsc.ts_rtol=1e-6",  # what Newton's method leaves is then small beside the formula's error
                "time.end=0.3",
                f"time.integrator={integrator}",
            ]
            folder = tmp_path / f"{integrator}{step}"
            estimate = drillpetsc.run(load_case(PENDULUM, keys), folder, progress="silent").summary[
                "error_estimate"
            ]["time"]
            assert estimate["steps"] > 0.9 * 0.3 / step
            sums[integrator, step] = estimate["unknowns"]["string.position"]["sum"]
    assert sums["generalized_alpha", 1e-3] / sums["generalized_alpha", 5e-4] == pytest.approx(4.0, rel=3e-2)
    ratio = sums["generalized_alpha", 5e-4] / sums["bdf", 5e-4]
    assert ratio == pytest.approx(AlphaFormula(0.8).phase_error / (2 / 9), rel=1e-2)
