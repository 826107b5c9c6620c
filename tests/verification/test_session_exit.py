"""A script that ends by the error of a session: its message and exit status 1, no crash of the interpreter."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest

from drillpetsc import Session, load_case
from drillpetsc.errors import SolveError
from drillpetsc.solvers.time.newton import CondensedNewton

CASE = "cases/lying-string.yaml"
SCRIPT = f"""
import drillpetsc
from drillpetsc.solvers.time.newton import CondensedNewton
session = drillpetsc.Session(drillpetsc.load_case({CASE!r}, OPTIONS))
session.step(0.02)
CondensedNewton.solve = lambda self, *rest: -3  # Newton's method fails from now on
"""
ENDS = {
    "with block": "with session:\n    session.step(0.5)",
    "left open": "session.step(0.5)",
    "closed": "try:\n    session.step(0.5)\nfinally:\n    session.close()",
    "own error in a callback": (
        "def stop(t, dt):\n    raise drillpetsc.SolveError('enough')\n"
        "session._integrator.after_step.append(stop)\nCondensedNewton.solve = solve\nwith session:\n    session.step(0.5)"
    ),
}


@pytest.mark.parametrize(
    ("end", "options"), [*((end, []) for end in ENDS), ("with block", ["petsc.ts_max_reject=2"])]
)
def test_script_that_ends_by_an_error(end, options):
    before = "from drillpetsc.solvers.time.newton import CondensedNewton\nsolve = CondensedNewton.solve\n"
    script = before + SCRIPT.replace("OPTIONS", repr(options)) + ENDS[end]
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=120)
    assert done.returncode == 1, done.stderr
    assert "SolveError" in done.stderr.splitlines()[-3] or "SolveError" in done.stderr.splitlines()[-1]


def test_state_after_a_step_that_failed_for_good(monkeypatch):
    """PETSc's post-step call after a failed step counts no step, and the state is that before it, to the last bit."""
    with Session(load_case(CASE, ["petsc.ts_max_reject=2", "petsc.ts_type=bdf"])) as s:
        s.step(0.02)
        integrator = s._integrator
        asm, seen = integrator.system.assembly, []
        before, steps = (asm.x.copy(), asm.y.copy()), integrator.counters.steps
        integrator.after_step.append(lambda t, dt: seen.append(t))
        monkeypatch.setattr(CondensedNewton, "solve", lambda self, *rest: -3)
        with pytest.raises(SolveError, match="DIVERGED_STEP_REJECTED"):
            s.step(0.5)
        assert (seen, integrator.counters.steps) == ([], steps)
        n = integrator.system.layout.size
        assert np.array_equal(asm.x[:n], before[0][:n])
        assert np.array_equal(asm.y[:n], before[1][:n])
