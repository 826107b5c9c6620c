"""Steps keep the energy of a stabilizer that would roll along the wall, or the run says so (manual: sec-time-whirl-steps), and the
orbits of a string that is not balanced."""

from __future__ import annotations

import re
from types import SimpleNamespace

import numpy as np
import pytest

from drillpetsc.analysis.motion.transient import run
from drillpetsc.analysis.motion.whirl_steps import PRODUCT_BDF, WhirlSteps, product_of_alpha
from drillpetsc.analysis.statics.placement import move_rigidly, place_along_hole, release
from drillpetsc.case import Case
from drillpetsc.doubts.motion import whirl_damped
from drillpetsc.model.drilling_model import build_model
from drillpetsc.output import read_table
from drillpetsc.solvers.time.alpha_formula import AlphaFormula
from tests.helpers import frequency_models as m
from tests.helpers.wells import simple_well

HOLE, BLADES, RPM = 0.2159, 0.209, 95.0
ROLLING = RPM / 60 * BLADES / (HOLE - BLADES)  # turns of the hole a second, by Jansen (1991)


def case(blades: float = BLADES, rpm: float = RPM, **keys) -> Case:
    return Case(
        **{
            "well": simple_well(60, HOLE, 0.2, friction=0.2),
            "string": [
                {"kind": "pipe", "length": 40.0, "od": 0.165, "id": 0.07, "element_length": 10.0},
                {"kind": "stabilizer", "name": "lower", "length": 2.0, "od": blades, "id": 0.07},
                {"kind": "pipe", "length": 10.0, "od": 0.165, "id": 0.07, "element_length": 10.0},
                {"kind": "bit", "length": 0.3, "od": HOLE, "mass": 50.0},
            ],
            "top": {"kind": "top_drive", "rotation": f"{rpm} rpm"},
            "bottom": "free",
            **keys,
        }
    )


def said(step: float, rpm: float = RPM, **keys) -> list[str]:
    """Warnings of a string that turns, for steps of this length [s] of BDF 2."""
    model = build_model(case(rpm=rpm, **keys))
    place_along_hole(model)
    release(model)
    move_rigidly(model)
    found = WhirlSteps(model, PRODUCT_BDF).damped(step, abs(rpm) * np.pi / 30)
    return whirl_damped.sentences(SimpleNamespace(whirl=found, units=model.case.shown_units))


def energy_lost(radii: np.ndarray, angles: np.ndarray) -> np.ndarray:
    """Share of the energy that a formula takes in a period, from modulus and angle of its principal root."""
    return 1 - radii ** (4 * np.pi / angles)


def test_steps_keep_the_energy_of_a_whirl():
    """At the products that limit the steps both formulas take at most 0.1 % of the energy in a period: principal roots of BDF 2,
    (3 + 2 i w h) z^2 - 4 z + 1 = 0 for y' = -i w y, and of generalised-alpha (AlphaFormula.amplification)."""
    z = np.roots([3 + 2j * PRODUCT_BDF, -4, 1])
    z = z[np.abs(z).argmax()]
    assert energy_lost(np.abs(z), np.abs(np.angle(z))) == pytest.approx(1e-3, rel=0.02)
    for radius, most in ((0.8, 2.28e-4), (0.5, 1e-3), (0.0, 1e-3)):
        root = AlphaFormula(radius).amplification(product_of_alpha(radius))
        assert energy_lost(np.abs(root), np.abs(np.angle(root))) == pytest.approx(most, rel=0.03)
    assert product_of_alpha(1.0) == 0.3  # nothing is lost: the frequency decides


@pytest.mark.parametrize("rpm", [40.0, 95.0, -140.0])
def test_frequency_and_step_of_rolling_whirl(rpm):
    """The frequency is the rotation times radius over clearance, whichever way the string turns; the step named keeps its energy."""
    (line,) = said(0.02, rpm=rpm)
    whirl = abs(rpm) / RPM * ROLLING
    assert "lower at MD" in line
    found = float(re.search(r"at ([\d.]+) Hz \(", line)[1])  # type: ignore[index]
    assert found == pytest.approx(whirl, rel=0.05)
    step = float(re.search(r"-ts_adapt_dt_max ([\d.e-]+),", line)[1])  # type: ignore[index]
    assert 2 * np.pi * whirl * step == pytest.approx(PRODUCT_BDF, rel=0.05)  # two digits
    assert said(0.9 * step, rpm=rpm) == []


@pytest.mark.parametrize(
    "keys", [{"rpm": 0.0}, {"blades": HOLE}, {"blades": 0.16}, {"contact": "none"}], ids=str
)
def test_nothing_is_said_where_nothing_would_roll_fast(keys):
    """Without rotation, for blades of full gauge, for thin ones (4.5 Hz), and without contact."""
    assert said(0.002, **keys) == []


def test_default_steps_keep_what_may_whirl(tmp_path):
    """The default integrator of a turning string limits its steps by the stabilizer that lies on the wall, and says so; BDF with
    its own steps says that they do not determine the result."""
    keys = {"time": {"end": 0.15}, "initial": {"from": "statics"}}
    result = run(case(**keys), out=tmp_path / "auto").summary
    assert result["petsc_options"]["ts_type"] == "alpha2"
    assert not [w for w in result["warnings"] if "roll along" in w]
    limit = result["steps_limited_by"]
    assert limit["name"] == "lower" and limit["share"] > 0.5
    assert limit["shortest [s]"] == pytest.approx(0.3 / (2 * np.pi * ROLLING), rel=0.3)
    bdf = case(**keys, petsc={"ts_type": "bdf", "ts_dt": 2e-3, "ts_adapt_type": "none"})
    (line,) = [w for w in run(bdf, out=tmp_path / "bdf").summary["warnings"] if "roll along" in w]
    assert "lower at MD" in line and "time.integrator: auto" in line


def test_only_steps_that_it_shortens_count_as_limited(monkeypatch):
    """A part that whirls at 100 rad/s, product 0.3: a step of 1 ms stays and does not count, one of 4 ms becomes 3 ms."""
    steps = WhirlSteps(build_model(case()), 0.3)
    monkeypatch.setattr(WhirlSteps, "_rates", lambda self: [100.0] * len(self.parts))
    assert steps(1e-3) == 1e-3
    assert steps.summary(1) is None
    assert steps(4e-3) == pytest.approx(3e-3)
    said = steps.summary(2)
    assert said is not None
    assert said["share"] == 0.5
    assert said["shortest [s]"] == pytest.approx(3e-3)


@pytest.mark.parametrize("integrator", ["auto", "bdf"])
@pytest.mark.parametrize("rpm", [30.0, 60.0])
@pytest.mark.parametrize("length", [14.0, 40.0])
def test_orbits_of_an_eccentric_collar(length, rpm, integrator, tmp_path):
    """At the default tolerance every row of the orbit of a hinged collar is within 1 %, below its critical speed (118 rpm) and
    above it (14 rpm).  Its mass is off by e = 0.2 mm, and a force c m per length and velocity damps it, so that it comes to its
    orbit: from EI w'''' + m (i c Omega - Omega^2) w = m Omega^2 e, in the middle, with q = L/2 (m (Omega^2 - i c Omega)/EI)^(1/4),

    |w| = |e Omega^2/(Omega^2 - i c Omega) (1 - 1/(2 cos q) - 1/(2 cosh q))| (manual: verif-orbit-of-a-run)."""
    e, c, speed, end = 2e-4, 2.8, rpm * m.RPM, 7.8  # exp(-c t/2) of its start is left: 3e-4 after end - 2
    mass, stiffness = m.DENSITY * m.COLLAR_AREA, m.YOUNG * np.pi / 64 * (0.1778**4 - 0.0714**4)
    pull = speed**2 - 1j * c * speed
    q = 0.5 * length * (mass * pull / stiffness) ** 0.25
    orbit = abs(e * speed**2 / pull * (1 - 0.5 / np.cos(q) - 0.5 / np.cosh(q)))
    collar = m.collars(length, 10) | {"eccentricity": e}
    collar["material"] |= {"damping": {"stiffness": 0.0, "mass": c}}
    turning = Case(
        well=simple_well(60, 0.3, friction=0.2),
        string=[collar],
        top={"kind": "top_drive", "rotation": f"{rpm} rpm", "hinged": True},
        bottom="pinned",
        gravity=0.0,
        initial={"from": "straight"},
        time={"end": end, "integrator": integrator},
        output={"history_every": 0.02, "probes": [length / 2]},
    )
    p = read_table(run(turning, out=tmp_path / "run", progress="silent").folder / "probes.csv")
    radius = np.hypot(p[f"x_{length / 2:g} [m]"], p[f"y_{length / 2:g} [m]"])[p["time [s]"] > end - 2]
    assert radius == pytest.approx(orbit, rel=0.01)
