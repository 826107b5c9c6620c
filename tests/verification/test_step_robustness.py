"""Time steps: failed Newton solves, impacts and breaks are resolved, and energy gain is reported (manual:
verif-failed-steps, verif-step-limits, verif-energy-gain)."""

from __future__ import annotations

import json

import numpy as np
import pytest
import yaml
from petsc4py import PETSc

from drillpetsc.analysis.motion.transient import run
from drillpetsc.case.reader import load_case
from drillpetsc.errors import CaseError, SolveError
from drillpetsc.fem.component import Powers
from drillpetsc.output import read_table
from drillpetsc.physics.beam import AncfBeam
from drillpetsc.solvers.time.newton import CondensedNewton
from tests.helpers.wells import simple_well

WELL = simple_well(60, "215.9 mm", "60 deg", kind="casing", friction=0.2)
LYING = {
    "well": WELL,
    "string": [{"kind": "pipe", "length": "50 m", "od": "127 mm", "id": "108.6 mm"}],
    "top": {"kind": "top_drive", "rotation": "60 rpm"},
    "bottom": "free",
    "time": {"end": "60 ms"},
    "output": {"history_every": "1 ms", "field_every": "1 s"},
}
IMPACT = np.pi * np.sqrt(7850 * np.pi / 4 * (0.127**2 - 0.1086**2) / 1e8)  # t_c = pi sqrt(m'/k')


def computed(tmp_path, case: dict, name: str = "run"):
    """History and summary of a run."""
    (tmp_path / "case.yaml").write_text(yaml.safe_dump(case))
    folder = run(load_case(tmp_path / "case.yaml"), tmp_path / name, progress="silent").folder
    return read_table(folder / "history.csv"), json.loads((folder / "summary.json").read_text())


def test_energy_strict_caps_steps_at_half_an_impact(tmp_path, options):
    """By the case and by the option; without it steps are longer (manual: verif-step-limits)."""
    free, _ = computed(tmp_path, LYING)
    assert free["step [s]"].max() > 0.6 * IMPACT
    capped, summary = computed(tmp_path, LYING | {"contact": {"energy_strict": True}}, "capped")
    assert 0.3 * IMPACT < capped["step [s]"].max() <= 0.5 * IMPACT * (1 + 1e-9)
    assert summary["petsc_options"]["ts_adapt_dt_max"]
    options(drillpetsc_energy_strict=True)
    by_option, _ = computed(tmp_path, LYING, "option")
    assert np.array_equal(by_option["hook_load [N]"], capped["hook_load [N]"])
    options(ts_adapt_type="none", ts_dt=0.6 * IMPACT)
    with pytest.raises(CaseError, match="half the shortest impact"):
        computed(tmp_path, LYING, "refused")


def test_fixed_steps_too_long_for_impacts_are_reported(tmp_path, options):
    options(ts_adapt_type="none", ts_dt=0.5 * IMPACT)
    _, summary = computed(tmp_path, LYING)
    assert len(summary["warnings"]) == 1 and "do not resolve impacts" in summary["warnings"][0]
    options(ts_dt=0.25 * IMPACT)
    _, summary = computed(tmp_path, LYING, "short")
    assert summary["warnings"] == []


@pytest.mark.parametrize("fixed", [True, False])
def test_a_failed_newton_is_never_accepted(fixed, tmp_path, options, monkeypatch):
    """Newton's method fails for every step longer than 0.4 ms: all accepted steps are shorter, and the run is
    completed (manual: verif-failed-steps)."""
    solve, failed = CondensedNewton.solve, []

    def stubborn(self, t, shift):
        reason = solve(self, t, shift)
        if shift < 1.0 / 4e-4:  # 1/dt at least, for any order and any step before
            failed.append(shift)
            self.discard_factor()
            return PETSc.SNES.ConvergedReason.DIVERGED_MAX_IT
        return reason

    monkeypatch.setattr(CondensedNewton, "solve", stubborn)
    if fixed:
        options(ts_adapt_type="none", ts_dt=2e-3)
    history, summary = computed(tmp_path, LYING | {"time": {"end": "20 ms", "integrator": "bdf"}})
    assert failed and summary["status"] == "done"
    assert history["step [s]"].max() <= 1.5 * 4e-4  # BDF2: shift is 1.5/dt at equal steps
    assert summary["rejected_steps"] >= len(failed) > 0


def test_fixed_steps_end_at_breaks(tmp_path, options):
    """Steps of 7 ms and a rotation that changes its slope at 10 ms: the speed of the top is exact in every
    row around it, which it is not if a step passes over the break (manual: verif-step-limits)."""
    options(ts_adapt_type="none", ts_dt=7e-3)
    rotation = {"time": ["0 s", "10 ms", "1 s"], "value": ["60 rpm", "90 rpm", "90 rpm"]}
    case = {
        "string": [{"kind": "pipe", "length": "30 m", "od": "127 mm", "id": "108.6 mm"}],
        "top": {"kind": "top_drive", "rotation": rotation},
        "bottom": "free",
        "time": {"end": "31 ms"},
        "output": {"history_every": "1 ms", "field_every": "1 s"},
    }
    (tmp_path / "case.yaml").write_text(yaml.safe_dump(case))
    steps = []
    from drillpetsc.solvers.time import time_integrator as integrator

    original = integrator.TimeIntegrator._post_step

    def noted(self, ts):
        steps.append(ts.getTime())
        original(self, ts)

    integrator.TimeIntegrator._post_step = noted  # type: ignore[method-assign]
    try:
        run(load_case(tmp_path / "case.yaml"), tmp_path / "run", progress="silent")
    finally:
        integrator.TimeIntegrator._post_step = original  # type: ignore[method-assign]
    assert np.allclose(steps, [0.007, 0.010, 0.017, 0.024, 0.031], atol=1e-12), steps


def test_spurious_energy_gain_is_reported_and_can_stop_the_run(tmp_path, options):
    """BDF of order 3 is unstable for some undamped waves (its stability region excludes part of the imaginary
    axis: Hairer and Wanner, Solving ODEs II, V.1): a string that oscillates in its axial waves gains energy.
    BDF of order 1 only loses energy (manual: verif-energy-gain)."""
    case = {
        "string": [{"kind": "pipe", "length": "100 m", "od": "127 mm", "id": "108.6 mm"}],
        "top": "clamped",
        "bottom": {"kind": "force", "force": [0, 0, 1e5]},
        "initial": {"from": "rest"},
        "time": {"end": "0.3 s"},
        "output": {"history_every": "5 ms", "field_every": "1 s"},
    }
    options(ts_adapt_type="none", ts_dt=3e-3, ts_bdf_order=1)
    _, summary = computed(tmp_path, case)
    assert (
        not summary["energy"]["flag"]
        and summary["energy"]["gained_share"] < 1e-6
        and summary["warnings"] == []
    )
    options(ts_bdf_order=3)
    history, summary = computed(tmp_path, case, "order3")
    assert (
        summary["energy"]["flag"]
        and summary["energy"]["gained_share"] > 0.01
        and "generated" in summary["warnings"][0]
    )
    assert summary["energy"]["gained"] == pytest.approx(history["energy_error [J]"].max())
    options(drillpetsc_stop_on_gain=True)
    with pytest.raises(SolveError, match="generated"):
        computed(tmp_path, case, "stopped")
    stopped = json.loads((tmp_path / "stopped" / "summary.json").read_text())
    assert 0 < stopped["time"] < 0.3 and stopped["status"].startswith("failed") and stopped["energy"]["flag"]


def test_negative_damping_is_reported_as_gained_energy(tmp_path, monkeypatch):
    """Axial waves of a string whose mass damping is -0.5 1/s, a defect that the balance does not contain.  The waves of a
    force that is applied at once have half of their energy E in motion: 0.5 E are gained in a second, of 4 E that are
    exchanged, less 1 % that the steps remove (manual: verif-energy-gain)."""
    case = {
        "string": [{"kind": "pipe", "length": "100 m", "od": "127 mm", "id": "108.6 mm"}],
        "top": "clamped",
        "bottom": {"kind": "force", "force": [0, 0, 1e5]},
        "initial": {"from": "rest"},
        "time": {"end": "1 s"},
        "output": {"history_every": "5 ms", "field_every": "1 s"},
        "petsc": {"ts_rtol": 1e-6},
    }
    _, summary = computed(tmp_path, case)
    assert not summary["energy"]["flag"]
    kept = AncfBeam.__init__

    def negative(self, mesh, *arguments, **named):
        kept(self, mesh, *arguments, **named)
        mesh.mass_damping[:] = -0.5

    monkeypatch.setattr(AncfBeam, "__init__", negative)
    monkeypatch.setattr(AncfBeam, "powers", lambda self, t, state: Powers())
    monkeypatch.setattr(AncfBeam, "powers_of", lambda self, steps: (0.0, 0.0))
    _, summary = computed(tmp_path, case, "negative")
    assert summary["energy"]["flag"] and summary["energy"]["gained_share"] == pytest.approx(0.115, abs=0.015)
