"""Two jars, two agitators, two reamers, a reamer with a steerable tool in one string (manual: verif-two-of-a-kind)."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from drillpetsc import Case, run
from drillpetsc.errors import CaseError
from drillpetsc.output import catalogue, read_table
from tests.verification import test_agitator as agitators
from tests.verification import test_jar as jars
from tests.verification.test_reamer import LENGTH, PILOT_LENGTH, expected, reaming

AREA = math.pi / 4 * (0.127**2 - 0.1086**2)


# ---------------------------------------------------------------------- agitators
def tool(**changes) -> dict:
    section = agitators.SECTION | changes
    size = {"length": 2.0, **agitators.PIPE, "element_length": 1.0, "mass": 2.0}
    return {"kind": "agitator", **size, "agitator": section}


@pytest.mark.parametrize(
    ("upper", "lower", "masses"),
    [
        ({}, {"rev_per_volume": "0.8 rev/l", "piston_area": "40 cm2", "spring": "3 MN/m"}, (800.0, 500.0)),
        ({"flow_rate": "12 l/s"}, {"pressure_amplitude": "120 psi", "spring": "1 MN/m"}, (300.0, 900.0)),
    ],
)
def test_two_agitators_shake_two_masses(upper, lower, masses, tmp_path):
    """Held top, agitator, mass, agitator, free mass: two masses on two springs, each with its own force across its spring."""
    case = agitators.case()
    case["string"] = [
        tool(**upper),
        {"kind": "body", "length": 0.5, "mass": masses[0]},
        tool(**lower),
        {"kind": "body", "length": 0.5, "mass": masses[1]},
    ]
    case["petsc"] = {"ts_rtol": 1e-7}
    got = agitators.history(case, tmp_path / "run")

    def pulse(section):
        flow, turns, area, pressure = (
            float(str(section[key]).split()[0])
            for key in ("flow_rate", "rev_per_volume", "piston_area", "pressure_amplitude")
        )
        return area * 1e-4 * pressure * 6894.757, 2 * math.pi * flow * turns

    forces = [pulse(agitators.SECTION | q) for q in (upper, lower)]
    t = got["time"]
    for name, (force, w) in zip(("agitator_force", "agitator_2_force"), forces, strict=True):
        assert np.abs(got[name] - force * np.sin(w * t)).max() < 1e-3 * force
    # spring and the pipe of the tool in series; half of its 2 kg on either side
    pipe = 206e9 * AREA / 2.0
    springs = [float((agitators.SECTION | q)["spring"].split()[0]) * 1e6 for q in (upper, lower)]
    series = [1 / (1 / k + 1 / pipe) for k in springs]
    m1, m2 = masses[0] + 2.0, masses[1] + 1.0

    def rates(time, y):
        pulls = []  # tension between the ends: spring and pipe in series, the pulse across the spring only
        for stretch, k, full, (force, w) in zip((y[0], y[1] - y[0]), springs, series, forces, strict=True):
            pulls.append(full * stretch - force * math.sin(w * time) * full / k)
        return [y[2], y[3], (pulls[1] - pulls[0]) / m1, -pulls[1] / m2]

    exact = solve_ivp(rates, (0, t[-1]), np.zeros(4), t_eval=t, rtol=1e-10, atol=1e-13)
    stretches = exact.y[0], exact.y[1] - exact.y[0]
    travels = [q for name, q in got.items() if name.startswith("joint_") and name.endswith("_travel")]
    assert len(travels) == 2
    for found, x, k, full, (force, w) in zip(travels, stretches, springs, series, forces, strict=True):
        wave = force * np.sin(w * t)
        travel = (full * x - wave * full / k + wave) / k  # of the slider without that of the pipe
        assert np.abs(found - travel).max() < 0.02 * np.abs(travel).max()


# ---------------------------------------------------------------------- jars
def test_two_jars_meter_together_and_the_first_to_end_its_stroke_fires(tmp_path: Path):
    """Two hydraulic jars under one weight give way at (W - T_i)/R_i each; one fires, the other meters again after its hit.

    The weight's mass m takes 1/m sum of 1/R to reach that speed: with both braking, F = W - m a with F - T_i = R_i v_i and
    a = v_1' + v_2', so F goes from W to its steady value within m (1/R_1 + 1/R_2).
    """
    laws = [
        {"threshold": 1.5e4, "metering_resistance": 2.0e5, "metering_stroke": 0.02, "stroke": 0.1},
        {"threshold": 1.8e4, "metering_resistance": 1.5e5, "metering_stroke": 0.03, "stroke": 0.1},
    ]
    case = jars.hanging(
        *(jars.jar(**law) for law in laws),
        material={"damping": {"stiffness": 1e-5}},
        petsc={"ts_rtol": 1e-5},
        time={"end": 0.45},
    )
    found, summary = jars.results(case, tmp_path)
    steel = 7850 * math.pi / 4 * (0.1778**2 - 0.0714**2)
    below = [
        (2000 + steel * (5 + 1.5 + 2 * k)) * 9.80665 for k in (1, 0)
    ]  # under the upper and the lower slider
    t = found["time"]
    modes = found["jar_state"], found["jar_2_state"]
    assert all((mode[t < 0.01] <= 1).all() and 1 in mode for mode in modes)
    speeds = [(w - law["threshold"]) / law["metering_resistance"] for w, law in zip(below, laws, strict=True)]
    ends = [law["metering_stroke"] / v for v, law in zip(speeds, laws, strict=True)]
    first = int(np.argmin(ends))
    names = ("jar", "jar_2")
    shot = t[np.argmax(found[f"{names[first]}_state"] == 2)]
    lag = below[0] / 9.80665 * sum(1 / law["metering_resistance"] for law in laws)
    middle = (t > 0.4 * shot) & (t < 0.9 * shot)
    for name, speed in zip(names, speeds, strict=True):
        slope = np.polyfit(t[middle], found[f"{name}_stroke"][middle], 1)[0]
        assert slope == pytest.approx(speed, rel=0.02)
    assert shot == pytest.approx(ends[first] + lag, abs=0.5 * lag)
    other = names[1 - first]
    hit = t[np.argmax(found[f"{names[first]}_impact_force"] > 1e4)]
    falls = (t > shot + 0.002) & (t < hit)  # the weight falls: the other jar has no load, and does not open
    assert 1 not in found[f"{other}_state"][falls]
    assert np.diff(found[f"{other}_stroke"][falls]).max() < 1e-6
    assert not found[f"{other}_fired"][t < hit].any()
    again = (t > hit) & (
        found[f"{other}_state"] == 1
    )  # under the load of the hit: the rest of its metering stroke
    assert again.any()
    second = np.argmax(found[f"{other}_fired"] == 1)
    assert found[f"{other}_stroke"][second] == pytest.approx(laws[1 - first]["metering_stroke"], rel=0.02)
    assert found[f"{names[first]}_fired"][-1] == 1
    assert summary["energy"]["gained_share"] < 2e-3


# ---------------------------------------------------------------------- reamers
def two_reamers(sizes, energy, ratio, rpm, lowering, wob, mode="dynamic", **more) -> dict:
    """Bit and two reamers above it; ``sizes``: their diameters from the bit up [m]."""
    bit, lower, upper = sizes
    case = reaming(bit, lower, energy, ratio, rpm, lowering, wob, mode, **more)
    pipe, reamer, pilot, cutter = case["string"]
    between = {**pilot, "length": 5.0}
    case["string"] = [
        {**pipe, "length": pipe["length"] - 6.0}, {**reamer, "od": upper}, between, reamer, pilot, cutter,
    ]  # fmt: skip
    rows = case["well"]["sections"]
    case["well"]["sections"] = [{**rows[0], "to": LENGTH - PILOT_LENGTH - 6.0, "diameter": upper}, *rows]
    return case


SIZES = [(0.2159, 0.2667, 0.3112), (0.3112, 0.4064, 0.4445)]


@pytest.mark.parametrize(("sizes", "mode"), [(SIZES[0], "dynamic"), (SIZES[1], "quasi_static")])
def test_weights_and_torques_of_two_reamers_add(sizes, mode, tmp_path):
    """Each ring has its share (a_i - a_(i-1))/a_n of the weight, all advance alike, and the hook takes their sum."""
    energy, ratio, rpm, both = 40e6, 0.6, 100.0, 60e3
    depth = both / (ratio * energy * 0.5 * sizes[-1])
    rate = depth * rpm / 60
    radii = [0.0, *(0.5 * q for q in sizes)]
    weights = [ratio * energy * (b - a) * depth for a, b in zip(radii, radii[1:], strict=False)]
    torques = [0.5 * energy * (b**2 - a**2) * depth for a, b in zip(radii, radii[1:], strict=False)]
    assert expected(sizes[0], sizes[1], energy, ratio, depth)[:2] == pytest.approx(weights[:2])
    case = two_reamers(sizes, energy, ratio, rpm, rate, weights[0], mode, petsc={"ts_rtol": 1e-5})
    history = read_table(run(Case(**case), tmp_path / "run", progress="silent").folder / "history.csv")
    late = history["time [s]"] > 2.0
    # from the top down: the upper reamer is the first
    names = ("wob [N]", "wob_reamer_2 [N]", "wob_reamer [N]")
    assert [history[q][late].mean() for q in names] == pytest.approx(weights, rel=1e-3)
    names = ("bit_torque [N m]", "torque_reamer_2 [N m]", "torque_reamer [N m]")
    assert [history[q][late].mean() for q in names] == pytest.approx(torques, rel=1e-3)
    for name in (
        "hole_depth",
        "hole_depth_reamer",
        "hole_depth_reamer_2",
    ):  # the pipe between the cutters is compressed
        # more than at rest: the first blades take different depths
        assert np.ptp(history[f"{name} [m]"][late]) == pytest.approx(
            rate * np.ptp(history["time [s]"][late]), rel=1e-3
        )
    assert -history["hook_load [N]"][late].mean() == pytest.approx(both, rel=1e-3)
    if mode == "dynamic":
        work = both * 3.0 * rate + sum(torques) * rpm * np.pi / 30 * 3.0
        assert np.abs(history["energy_error [J]"]).max() < 0.01 * work


@pytest.mark.parametrize(
    ("upper", "words"),
    [({"od": 0.2667}, "more than the diameter of the reamer below"), ({"pilot": 0.2159}, "reamer below")],
)
def test_reamers_that_do_not_widen_one_another_are_refused(upper, words):
    case = two_reamers(SIZES[0], 40e6, 0.6, 100.0, 0.0, 40e3)
    case["string"][1] |= upper
    with pytest.raises(CaseError, match=words):
        Case(**case)


def test_names_of_columns_of_the_second_tool_are_known():
    """A second tool's columns have words, units and numbers of their own."""
    for name, words in (
        ("jar_2_state", "State of the jar 2"),
        ("agitator_3_force", "Agitator force 3"),
        ("wob_reamer_2", "Weight on reamer 2"),
        ("wob_reamer", "Weight on reamer"),
    ):
        assert catalogue.label(name) == words
    assert catalogue.label("wob_reamer_x") is None
