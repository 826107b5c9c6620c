"""Stability of steady drilling over rotary speed and weight on bit (manual: verif-stability-map)."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import yaml

import drillpetsc
from drillpetsc import Case
from drillpetsc.analysis.linear.frequency.stability_runs import classify
from drillpetsc.errors import CaseError
from drillpetsc.output import read_table
from tests.helpers import top_drive_models as m
from tests.helpers.command import main_succeeds
from tests.helpers.delay_roots import Regenerative
from tests.helpers.motion import beam
from tests.helpers.tables import each_row
from tests.helpers.wells import simple_well
from tests.verification.test_top_drive_modes import characteristic, impedance, root

STIFFNESS, MASS, DAMPING, BLADES = 3e7, 2e4, 6e4, 4
RADIUS, RATIO = 0.108, 0.6


def spring_and_bit(cutting: float = 4e6, weight: float = 20e3) -> dict:
    """A bit of 20 t on a damped spring of 30 MN/m; ``cutting`` is the stiffness of all blades [N/m]."""
    length = 10.0
    pipe = beam(
        length,
        1,
        STIFFNESS * length,
        1e12,
        1e12,
        1e-6,
        1e-3,
        od=2 * RADIUS,
        damping={"stiffness": DAMPING / STIFFNESS},
    )
    item = {
        "kind": "bit",
        "length": 0.1,
        "od": 2 * RADIUS,
        "mass": MASS,
        "inertia": {"axial": 10.0, "transverse": 100.0},
    }
    law = {"kind": "drag_bit", "blades": BLADES, "inclination_ratio": RATIO, "wear_flat": 0.0}
    law["specific_energy"] = cutting / BLADES / (RATIO * RADIUS)
    depth = length + 0.1
    return {
        "string": [pipe, item],
        "well": simple_well(depth, 2 * RADIUS, friction=0.0),
        "contact": "none",
        "top": {"kind": "top_drive", "rotation": 12.0},
        "gravity": 0.0,
        "initial": {"wob": weight, "imperfection": 0.0},
        "bottom": {"kind": "bit", "stiffness": 1e8, "friction": 0.0},
        "formation": {"bit_law": law},
    }


def rows(folder: Path, file: str) -> dict[str, np.ndarray]:
    return {name.split(" [")[0]: values for name, values in read_table(folder / file).items()}


def stability(case: dict, folder: Path, **options) -> dict[str, np.ndarray]:
    """stability_map.csv."""
    drillpetsc.stability(Case(**case), folder, overwrite=True, **options)
    return rows(folder, "stability_map.csv")


def test_regenerative_map(tmp_path):
    """Cutting stiffness 4 MN/m: boundaries at 39.345, 49.283, 63.757, 104.048, 167.986 rpm within 0.5 % (C24).  Growth at 130,
    171, 106, 102 rpm within 1 % of 0.7305, -0.0986, 0.1251, -0.1502 1/s, and of the rightmost root of the delay equation.
    Through a case file and the command line."""

    file = tmp_path / "bit.yaml"
    file.write_text(yaml.safe_dump(spring_and_bit()))
    words = ["stability", str(file), "--speeds", "36:186:6 rpm", "--wob", "20 kN", "--count", "6"]
    main_succeeds(*words, "--out", tmp_path / "run")
    edges = rows(tmp_path / "run", "stability_boundary.csv")
    expected = [39.345, 49.283, 63.757, 104.048, 167.986]
    assert edges["boundary_speed"] == pytest.approx(expected, rel=5e-3)
    assert list(edges["stable_side"]) == ["above", "below", "above", "below", "above"]
    assert (tmp_path / "run" / "plots" / "stability_map.png").exists()
    found = stability(
        spring_and_bit(), tmp_path / "points", speeds="102,106,130,171 rpm", wob="20 kN", count=6
    )
    assert found["largest_growth"] == pytest.approx([-0.1502, 0.1251, 0.7305, -0.0986], rel=1e-2)
    for rpm, growth in zip((102, 106, 130, 171), found["largest_growth"], strict=True):
        delay = 60.0 / (rpm * BLADES)
        exact = Regenerative(MASS, DAMPING, STIFFNESS, 4e6, delay).roots(1)[0]
        assert growth == pytest.approx(exact.real, rel=2e-3)
    assert found["state_imbalance"].max() < 1.0  # the rate of penetration follows the weight and the speed


def test_below_the_classical_bound(tmp_path):
    """A cutting stiffness below 2 K z (1 + z) = 2.41379 MN/m is stable at every speed, with any weight; 1 % above it is not."""
    z = DAMPING / (2 * np.sqrt(STIFFNESS * MASS))
    bound = 2 * STIFFNESS * z * (1 + z)
    assert bound == pytest.approx(2.41379e6, rel=1e-5)
    # the worst speed of the first lobe: w = w_n sqrt(1 + 2 z), phase 3 pi/2 and a bit more
    w = np.sqrt(STIFFNESS / MASS * (1 + 2 * z))
    lag = 2 * np.pi - 2 * np.arctan2(DAMPING * w, MASS * w**2 - STIFFNESS)  # of a chatter mark
    rpm = 60 * w / (BLADES * (2 * np.pi - (2 * np.pi - lag)))
    for share, grows in ((0.99, False), (1.01, True)):
        found = stability(
            spring_and_bit(share * bound),
            tmp_path,
            speeds=[rpm * m.RPM * q for q in (0.98, 1.0, 1.02)],
            wob=[1e4, 3e4],
            count=6,
        )
        assert (found["largest_growth"].max() > 0) == grows


def torsional_growth(name: str, rpm: float, weight: float) -> float:
    """Largest growth [1/s] below 1.2 Hz from the wave equation, with the torque 0.06 W falling to 0.04 W over 6 rad/s."""
    Z, w = impedance(name), rpm * m.RPM
    slope = -0.02 * weight * 2 * w / 36 * np.exp(-((w / 6) ** 2))
    starts = [complex(0.01, 2 * np.pi * f) for f in np.arange(0.06, 1.2, 0.04)]
    found = [q for q in (root(s, Z, slope) for s in starts) if np.isfinite(q) and 0.3 < q.imag < 12]
    return float(max(q.real for q in found if abs(characteristic(q, Z, slope)) < 1e-6 * m.GJ))


@pytest.mark.parametrize(
    ("name", "rpm", "expected"),
    [
        ("stiff", "110:140:10 rpm", {50: 118.40, 100: 128.72, 150: 134.31}),
        ("soft 0.75", "40:100:20 rpm", {50: None, 100: 77.63, 150: 88.18}),
    ],
)
def test_critical_speeds_by_weight(name, rpm, expected, tmp_path):
    """Stick-slip ends at 118.40, 128.72, 134.31 rpm under stiff control, at 77.63 and 88.18 rpm under soft torque (C25), within
    0.5 rpm.  At 50 kN soft torque is stable at every speed by the wave equation: growth -0.0021 1/s at the steepest torque."""
    control = {"stiff": m.STIFF, "soft 0.75": m.COMPENSATED}[name]
    law = {
        "kind": "velocity_weakening",
        "static_friction": 0.06 / (2 / 3 * 0.108),
        "dynamic_friction": 0.04 / (2 / 3 * 0.108),
        "speed": 6.0,
    }
    case = m.on_bottom(control, 10.0, bit_law=law, loads=[])
    found = stability(case, tmp_path, speeds=rpm, wob="50,100,150 kN", count=3, kind="torsional")
    edges = rows(tmp_path, "stability_boundary.csv")
    for weight, critical in expected.items():
        at = edges["weight_on_bit"] == weight * 1e3
        if critical is None:
            assert not at.any()
            growth = found["largest_growth"][
                (found["weight_on_bit"] == weight * 1e3) & (found["rotary_speed"] == 40)
            ]
            assert growth == pytest.approx(torsional_growth(name, 40.0, weight * 1e3), rel=2e-2)
            assert torsional_growth(name, 46.01, weight * 1e3) < 0
            continue
        assert edges["boundary_speed"][at] == pytest.approx([critical], abs=0.5)
        assert (
            torsional_growth(name, critical - 0.1, weight * 1e3)
            > 0
            > torsional_growth(name, critical + 0.1, weight * 1e3)
        )


@each_row(
    ("changes", "options", "words"),
    [
        ({"bottom": "free", "formation": None, "initial": {}}, {}, ("bottom", "a bit on bottom")),
        ({}, {"speeds": "0:60:30 rpm"}, ("--speeds", "above 0")),
        ({}, {"speeds": "60:60:30 rpm"}, ("--speeds", "smaller")),
        ({}, {"wob": "0 kN"}, ("--wob", "above 0")),
        ({}, {"wob": "50,20 kN"}, ("--wob", "ascending")),
        ({}, {"wob": "5 m"}, ("--wob", "N")),
        ({}, {"count": 0}, ("--count", "at least 1")),
        ({}, {"method": "runs"}, ("--method", "eigen or time")),
        ({}, {"method": "time", "duration": "0 s"}, ("--duration", "s")),
    ],
)
def test_bad_input_is_refused(changes, options, words, tmp_path):
    case = Case(**(spring_and_bit() | changes))
    with pytest.raises(CaseError) as error:
        drillpetsc.stability(case, tmp_path / "run", **({"speeds": "60 rpm", "wob": "20 kN"} | options))
    assert all(word in str(error.value) for word in words), str(error.value)


def test_a_state_that_is_not_steady_is_told(tmp_path):
    """A weight that presses the bit in by less than the onset of its contact: the state is out of balance, and a note says so."""
    case = spring_and_bit()
    case["bottom"] = {"kind": "bit", "stiffness": 1e10, "friction": 0.0}
    stability(case, tmp_path, speeds="130 rpm", wob="20 kN", count=4)
    warnings = json.loads((tmp_path / "summary.json").read_text())["warnings"]
    assert any("not steady" in w for w in warnings)


@pytest.mark.parametrize(
    ("control", "speeds"),
    [(m.STIFF, {110: ("grows", "stick_slip"), 150: ("decays", "steady")}), (m.COMPENSATED, {66: ("grows", "stick_slip"), 90: ("decays", "steady")})],
    ids=["stiff", "soft"],
)  # fmt: skip
def test_runs_in_time_beside_the_eigenvalues(control, speeds, tmp_path):
    """Below the critical 128.72 rpm (stiff; 77.63 rpm soft) of 100 kN a run swings up, above it calms down; both methods agree."""
    law = {"kind": "velocity_weakening", "speed": 6.0}
    law |= {"static_friction": 0.06 / (2 / 3 * 0.108), "dynamic_friction": 0.04 / (2 / 3 * 0.108)}
    case = m.on_bottom(control, 10.0, 20, bit_law=law, loads=[], contact="none")
    result = drillpetsc.stability(
        Case(**case), tmp_path, speeds=",".join(map(str, speeds)) + " rpm", wob="100 kN", count=3, kind="torsional",
        method="time", duration="45 s", overwrite=True,
    )  # fmt: skip
    runs = rows(tmp_path, "stability_runs.csv")
    for rpm, behaviour, allowed in zip(
        runs["rotary_speed"], runs["run_behaviour"], speeds.values(), strict=True
    ):
        assert behaviour in allowed, rpm
    assert result.summary["runs"]["differ"] == 0
    assert (rows(tmp_path, "stability_map.csv")["largest_growth"] > 0).tolist() == [True, False]


def test_behaviour_of_a_run():
    """Sines whose amplitude grows, decays or stays, and a bit that stands for a part of each period."""
    t = np.linspace(0, 60, 1501)
    wave = np.sin(2 * np.pi * t / 4)
    for spin, expected in (
        (10 + 0.1 * wave, "steady"),
        (10 + 0.5 * np.exp(0.03 * t) * wave, "grows"),
        (10 + 5 * np.exp(-0.02 * t) * wave, "decays"),
        (10 + 9 * wave, "stick_slip"),
        (np.maximum(10 + 14 * wave, 0.0), "stick_slip"),
        (0.0 * t, "stick_slip"),
    ):
        assert classify(t, spin)[3] == expected
    index, _, rest, _ = classify(t, 10 + 8 * wave)
    assert index == pytest.approx(0.8, rel=5e-3) and rest == 0


def test_a_growth_far_below_the_frequency_is_marginal():
    """3e-5 1/s at 0.2 Hz takes 4600 periods to double: neither stable nor unstable; 1e-2 1/s, and any growth without period, is."""
    from drillpetsc.analysis.linear.frequency.stability_map import Point, _lines, _summary, boundaries

    def point(growth: float, frequency: float, speed: float = 10.0) -> Point:
        return Point(speed, 1e5, growth, frequency, "torsional", 0.0)

    small = [point(3e-5, 0.2, s) for s in (8.0, 10.0, 12.0)]
    assert all(p.marginal and not p.unstable for p in small)
    assert point(1e-2, 0.2).unstable and point(3e-5, 0.0).unstable and not point(-1e-2, 0.2).unstable
    case = Case(**spring_and_bit())
    summary = _summary(case, small, 0, None)
    assert (summary["unstable"], summary["marginal"]) == (0, 3)
    lines = _lines(case, small, [], summary)
    assert "unstable at 0 of 3 points, marginal at 3" in lines[0] and "marginal at all speeds" in lines[1]

    class Growth:
        weight = 1e5

        def at(self, speed: float) -> Point:
            return point(3e-5 * (1 if speed > 10 else -1), 0.2, speed)

    assert boundaries(Growth(), (8.0, 12.0)) == []  # no boundary between two growths that are none
