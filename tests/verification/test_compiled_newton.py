"""Newton's iteration gives the same state whether its parts are compiled or in Python, as on several ranks, to the last bit."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from drillpetsc import load_case
from drillpetsc.analysis.motion.session.session import Session
from drillpetsc.solvers.time.newton import CondensedNewton

CASES = Path(__file__).parents[2] / "cases"
#: case, changes of it, time to reach [s], counters of the solves that must not be zero
RUNS = {
    "whirl": (
        "vertical-2000m-dry", ["petsc.ts_adapt_type=none", "petsc.ts_dt=0.005"], 0.4, "contact_updates",
    ),
    "impacts": ("benchmark/hanging-string-contact", ["top.rotation=80 rpm"], 0.3, "jacobians"),
    "mud": ("benchmark/coupled-2000m", [], 0.15, "jacobians"),
    "leaning top": ("benchmark/pendulum", [], 0.2, "jacobians"),
    "curved hole": ("benchmark/deep-spin-up", ["string[0].element_length=100 m"], 0.1, "jacobians"),
    "failures": (
        "benchmark/hanging-string-contact",
        ["top.rotation=80 rpm", "petsc.q_snes_max_it=4", "petsc.ts_rtol=1e-2"],
        0.3,
        "failures",
    ),
}  # fmt: skip
COUNTERS = ("iterations", "jacobians", "linear_iterations", "failures", "contact_updates")


def end_of(name: str, compiled: bool) -> tuple[np.ndarray, list[int], int]:
    """State and residual at the end of a run, counters of Newton's method, number of residuals."""
    case, changes, end, _ = RUNS[name]
    with Session(load_case(CASES / f"{case}.yaml", changes)) as s:
        newton: CondensedNewton = s._integrator.newton
        newton.iteration.compiled = compiled
        s.step(end)
        asm = newton.system.assembly
        state = np.concatenate([asm.x, asm.y, asm.a, newton.arrays[1]])
        assert (newton.iteration.seconds["ChainSolve"] > 0) == compiled
        return state, [getattr(newton, name) for name in COUNTERS], asm.evaluations


@pytest.mark.parametrize("name", RUNS)
def test_the_same_to_the_last_bit(name):
    """Whirl renews contacts apart, impacts shorten steps, a path first needs the state, and solves that fail leave the same state."""
    state, counts, residuals = end_of(name, True)
    expected, expected_counts, expected_residuals = end_of(name, False)
    assert counts == expected_counts and residuals == expected_residuals
    assert np.array_equal(state, expected)
    assert counts[COUNTERS.index(RUNS[name][-1])] > 0


def test_a_singular_matrix_ends_the_solve_on_both_ways():
    """A pivot that is missing is a failed solve, and the next solve starts with a Jacobian of its own."""
    from drillpetsc.solvers.chain.chain_lu import ChainFactor

    ends = []
    for compiled in (True, False):
        with Session(load_case(CASES / "benchmark" / "pendulum.yaml")) as s:
            s.step(0.01)
            newton = s._integrator.newton
            newton.iteration.compiled = compiled
            factor: ChainFactor = newton.factor
            kept = factor.pivot_tolerance
            newton.discard_factor()
            # no pivot is larger than its column
            factor.pivot_tolerance = newton.iteration._chain.tolerance = 2.0
            before = newton.failures
            assert (
                newton.solve(newton.t, newton.shift) < 0
                and newton.failures == before + 1
                and not newton.iteration.record.good
            )
            factor.pivot_tolerance = newton.iteration._chain.tolerance = kept
            jacobians = newton.jacobians
            assert newton.solve(newton.t, newton.shift) > 0 and newton.jacobians > jacobians
            ends.append(newton.system.assembly.x.copy())
    assert np.array_equal(*ends)
