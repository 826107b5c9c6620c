"""Generalised-alpha on strings: order of the scheme, starts and jumps, error control, restart, case keys."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from drillpetsc import Case, run
from drillpetsc.errors import CaseError, SolveError
from drillpetsc.output import read_summary
from drillpetsc.solvers.time.alpha_formula import AlphaFormula
from drillpetsc.solvers.time.generalized_alpha import GeneralizedAlpha
from tests.helpers.motion import beam, fixed, integrate, straight
from tests.helpers.tables import each_row

TIGHT = {"ts_type": "alpha2", "q_snes_stol": 1e-10, "drillpetsc_newton_work": 0}


def observed_order(values: list[np.ndarray]) -> float:
    """Order from the differences of three results, each with half the step of the one before."""
    first, second = (np.linalg.norm(a - b) for a, b in zip(values[:-1], values[1:], strict=True))
    return float(np.log2(first / second))


# ---------------------------------------------------------------------- order
def swinging():
    """A soft inclined string that swings and is spun up: large rotations, transport of spins, prescribed rows."""
    return straight(
        string=[beam(0.5, 3, 4.0, 2e-4, 1e-3, 0.02, 1.7e-6)],
        top={"kind": "top_drive", "rotation": {"ramp": 0.2, "value": 10.0}},
        gravity=[3.0, 0, 9.81],
        initial={"inclination": 1.0},
    )


@pytest.mark.parametrize("radius", [0.8, 0.5])
def test_order_two_of_positions_spins_and_rates(radius):
    """Differences of runs with steps that resolve the highest mode of the mesh."""
    found: dict[str, list[np.ndarray]] = {}
    for h in (2e-4, 1e-4, 5e-5):
        model = swinging()
        integrate(model.system, 0.05, fixed(h, ts_alpha_radius=radius, **TIGHT), breaks=model.breaks)
        for field in ("string.position", "string.spin"):
            for what in "xy":
                found.setdefault(field + what, []).append(model.system.field(field, what).copy())
    for name, values in found.items():
        assert observed_order(values) == pytest.approx(2.0, abs=0.1), name


def test_start_has_the_accelerations_of_the_equations():
    """A rod without ends falls: every node has the acceleration of gravity."""
    model = straight(string=[beam(2.0, 2, 1e5, 10.0, 10.0, 3.0, 1e-3)], top="free", gravity=[0.0, 0.0, 9.81])
    system = model.system
    integrator = integrate(system, 1e-3, fixed(1e-3, **TIGHT))
    position = system.layout.dofs["string.position"]
    assert isinstance(integrator, GeneralizedAlpha)
    integrator.begin.accelerations(0.0)
    assert system.assembly.a[position] == pytest.approx(np.tile([0.0, 0.0, 9.81], (3, 1)), abs=1e-6)


# ---------------------------------------------------------------------- jumps of prescribed velocities
def test_jump_of_a_prescribed_velocity_acts_as_the_impulse_of_the_mass_matrix():
    """Right after a jump of the top's rotation: the free spin rates fulfil M change = 0.

    Two elements have the mean of consistent and lumped inertia, J L/12 [10 1; 1 5] at the two free nodes and
    J L/12 [1 0] towards the top (docs: eq-beam-spin-inertia).  A jump of 10 rad/s there gives -50/49 and 10/49.
    """
    model = straight(
        string=[beam(1.0, 2, 100.0, 1.0, 1.0, 1.0, 0.1)],
        top={
            "kind": "top_drive",
            "rotation": {"time": [0.0, 0.01, 0.01, 1.0], "value": [0.0, 0.0, 10.0, 10.0]},
        },
        gravity=0.0,
    )
    integrate(model.system, 0.01 + 1e-6, fixed(1e-6, **TIGHT), breaks=model.breaks, start=0.009999)
    spin = model.system.field("string.spin", "y")[:, 0]
    assert spin == pytest.approx([10.0, -50.0 / 49, 10.0 / 49], abs=1e-3)


# ---------------------------------------------------------------------- energy
def tumbling(mass: float = 2.0, stiffness: float = 1e6, nodes: int = 5):
    """A free rod that tumbles at 1 turn a second, with the strain that its tension asks for.

    N(s) = m w^2 (L^2/4 - s^2)/2 from the middle, so the displacement is cubic: exact in these elements.
    """
    model = straight(string=[beam(1.0, nodes - 1, stiffness, 1e3, 1e3, mass, 0.01)], top="free", gravity=0.0)
    system, turn = model.system, 2 * np.pi
    s = system.field("string.position")[:, 2] - 0.5
    share = 0.5 * mass * turn**2 / stiffness
    position, slope, rate, turning = (np.zeros((nodes, 3)) for _ in range(4))
    position[:, 2], slope[:, 2] = s + share * (0.25 * s - s**3 / 3), 1 + share * (0.25 - s**2)
    rate[:, 0], turning[:, 0] = turn * position[:, 2], turn * slope[:, 2]
    for name, value, speed in (("position", position, rate), ("tangent", slope, turning)):
        system.set_field(f"string.{name}", value)
        system.set_field(f"string.{name}", speed, "y")
    return system


def test_tumbling_rod_keeps_its_energy():
    """Ten revolutions at 100 steps each: never gaining; the loss is that of the turning spring at radius 0.8.

    -4.26e-5 is the figure of a mass on a stiff turning spring (tests/unit/solvers/test_alpha_formula.py): a
    stiff rod turns as its masses do.  BDF2 loses a tenth here.
    """
    system = tumbling()
    before, energies = sum(system.energies(0.0)), []
    integrator = integrate(
        system, 10.0, fixed(0.01, ts_type="alpha2"), lambda t, dt: energies.append(sum(system.energies(t)))
    )
    change = np.array(energies) / before - 1
    assert change.max() < 1e-6
    assert change[-1] == pytest.approx(-4.26e-5, rel=0.05)
    assert integrator.damped_above() == pytest.approx(integrator.damped_product() / 0.01, rel=1e-9)


def test_a_rejected_step_is_repeated_by_the_order_of_its_error(monkeypatch):
    """The local error goes with h^3: one of 8 halves the step, times the safety factor 0.9."""
    steps, errors = [], iter([8.0])
    error, solve = GeneralizedAlpha._error, GeneralizedAlpha._solve_step
    monkeypatch.setattr(GeneralizedAlpha, "_error", lambda self: next(errors, error(self)))

    def counted(self, end, h):
        steps.append(h)
        return solve(self, end, h)

    monkeypatch.setattr(GeneralizedAlpha, "_solve_step", counted)
    integrate(tumbling(), 0.05, {"ts_type": "alpha2", "ts_rtol": 1e-2, "ts_adapt_safety": 0.9})
    assert steps[1] == steps[0]  # the first step is a trial of its own
    assert steps[2] == pytest.approx(0.9 * 0.5 * steps[1], rel=1e-9)


@pytest.mark.parametrize("tolerance", [1e-2, 1e-3])
def test_error_control_of_a_tumbling_rod(tolerance):
    """Adaptive steps lose less energy than the tolerance, and gain none."""
    system = tumbling()
    before, energies = sum(system.energies(0.0)), []
    integrator = integrate(
        system,
        1.0,
        {"ts_type": "alpha2", "ts_rtol": tolerance},
        lambda t, dt: energies.append(sum(system.energies(t))),
    )
    change = np.array(energies) / before - 1
    assert change.max() < 1e-6 and change[-1] > -0.01 * tolerance
    assert integrator.counters.steps < 200


def test_undamped_axial_ring_keeps_its_amplitude():
    """Mode 1 of 20 elements at w h = 0.05: energy lost in 50 periods, -(w h)^3 2 pi 50 times the factor of the formula.

    The exact loss of one oscillator at that step (``AlphaFormula.amplification``) is the reference; the
    coefficient of the modes above is only their rounding.
    """
    model = straight(string=[beam(10.0, 20, 1e4, 1e3, 1e3, 1.0, 0.01)], top="clamped", gravity=0.0)
    system = model.system
    s, w = system.field("string.position")[:, 2].copy(), 0.5 * np.pi / 10.0 * 100.0
    for name, shape in (
        ("position", np.sin(0.05 * np.pi * s)),
        ("tangent", 0.05 * np.pi * np.cos(0.05 * np.pi * s)),
    ):
        rates = np.zeros((21, 3))
        rates[:, 2] = 1e-3 * w * shape
        system.set_field(f"string.{name}", rates, "y")
    before, h, periods = sum(system.energies(0.0)), 0.05 / w, 50
    steps = round(periods * 2 * np.pi / 0.05)
    options = fixed(h, ts_type="alpha2", drillpetsc_newton_work=0, q_snes_stol=1e-9)
    integrate(system, steps * h, options)
    lost = sum(system.energies(0.0)) / before - 1
    factor = abs(AlphaFormula(0.8).amplification(0.05)) ** (2 * steps) - 1
    assert -1e-4 < factor < 0
    assert lost == pytest.approx(factor, rel=0.05)


# ---------------------------------------------------------------------- runs
CASE = {
    "string": [beam(5.0, 4, 1e5, 20.0, 30.0, 2.0, 0.02)],
    "top": {
        "kind": "top_drive",
        "rotation": {"time": [0.0, 0.1, 0.25, 0.4], "value": [0.0, 20.0, 20.0, 0.0]},
    },
    "gravity": [1.0, 0.0, 9.81],
}


def case(end: float, **more) -> Case:
    time = {"end": end, "integrator": "generalized_alpha"}
    return Case(**{**CASE, "time": time, "output": {"history_every": 0.01, "checkpoint_every": 0.05}, **more})


def test_restart_is_the_same_to_the_last_bit(tmp_path):
    """A run stopped by -ts_max_steps between two kinks of the input and continued, against one that never stopped."""
    run(case(0.4), out=tmp_path / "whole", progress="silent")
    with pytest.raises(SolveError, match="ts_max_steps"):
        run(case(0.4, petsc={"ts_max_steps": 60}), out=tmp_path / "parts", progress="silent")
    continued = run(case(0.4), out=tmp_path / "parts", progress="silent", restart=True, accept_changes=True)
    assert 0 < read_summary(continued.folder / "summary.json")["steps"]
    whole, parts = (rows(tmp_path / name) for name in ("whole", "parts"))
    assert whole == parts


def rows(folder: Path) -> list[str]:
    """Lines of the history without counts of iterations, which a restart begins anew."""
    return [line.rsplit(",", 1)[0] for line in (folder / "history.csv").read_text().splitlines()]


def test_summary_has_the_energy_that_damping_removed(tmp_path):
    summary = read_summary(run(case(0.2), out=tmp_path / "a", progress="silent").folder / "summary.json")
    assert abs(summary["energy"]["error_share"]) < 1e-3
    assert {"damped", "newton"} <= set(summary["energy"])
    assert summary["error_estimate"]["damped_above"] > 0


@each_row(
    ("time", "petsc", "message"),
    [
        ({"integrator": "generalized_alpha", "mode": "quasi_static"}, {}, "quasi_static"),
        ({"spectral_radius": 0.5}, {}, "generalized_alpha"),
        ({"integrator": "generalized_alpha", "spectral_radius": 1.5}, {}, "spectral_radius"),
        ({}, {"ts_type": "alpha2", "ts_alpha_radius": -0.1}, "ts_alpha_radius"),
        ({}, {"ts_type": "alpha2", "ts_adapt_type": "dsp"}, "ts_adapt_type"),
        ({}, {"ts_type": "alpha2", "ts_bdf_order": 3}, "ts_bdf_order"),
        ({}, {"ts_type": "alpha2", "snes_type": "newtonls"}, "snes_type"),
        ({}, {"ts_type": "alpha2", "ts_alpha_alpha_m": 0.9, "ts_alpha_alpha_f": 0.5}, "alpha_m"),
        ({"integrator": "generalized_alpha"}, {"ts_type": "bdf"}, "ts_type"),
    ],
)
def test_what_has_no_meaning_is_refused(time, petsc, message, tmp_path):
    with pytest.raises(CaseError, match=message):
        run(
            Case(**{**CASE, "time": {"end": 0.1, **time}, "petsc": petsc}),
            out=tmp_path / "a",
            progress="silent",
        )
    assert not (tmp_path / "a").exists()
