"""`calibrate`: friction factors come back from synthetic points of a J-well, with honest intervals."""

from __future__ import annotations

import functools
import json

import numpy as np
import pytest

from drillpetsc.analysis.loads.torque_drag.circulation import circulation
from drillpetsc.analysis.loads.torque_drag.readings.by_depth import drift_by_windows
from drillpetsc.analysis.loads.torque_drag.readings.calibrate import Choices, run_calibrate
from drillpetsc.analysis.loads.torque_drag.readings.calibration import Calibration
from drillpetsc.analysis.loads.torque_drag.readings.flow_table import flow_table
from drillpetsc.analysis.loads.torque_drag.readings.reading import corrected_points
from drillpetsc.analysis.loads.torque_drag.readings.sensor import weight_over_line
from drillpetsc.analysis.statics.start.soft_string import torque_drag
from drillpetsc.case.blocks.roadmap import MeasuredPoint
from drillpetsc.case.case import Case
from drillpetsc.errors import CaseError
from drillpetsc.geometry.well import Well
from drillpetsc.output import read_table
from drillpetsc.output.job import Job

TRUTH = {"cased": 0.18, "open_hole": 0.27}
SHOE, END, BLOCK = 1500.0, 2860.0, 100e3
MD, INCLINATION = [0.0, 1000.0, 1360.0, END], [0.0, 0.0, 60.0, 60.0]


def case(**keys):
    """A J-well cased to 1500 m, pipe of 242 N/m; its own friction is not that of the points."""
    return Case(
        well={
            "survey": {"md": MD, "inclination": [f"{a} deg" for a in INCLINATION], "azimuth": ["0 deg"] * 4},
            "sections": [
                {"to": SHOE, "kind": "casing", "diameter": "224 mm", "friction": 0.3},
                {"kind": "open_hole", "diameter": "215.9 mm", "friction": 0.4},
            ],
        },
        string=[
            {
                "kind": "pipe",
                "od": "127 mm",
                "id": "108.6 mm",
                "length": END,
                "material": {"density": "7245.416608 kg/m3"},
            }
        ],
        top="clamped",
        gravity="9.81 m/s2",
        **keys,
    )


def synthetic(depths=(800, 1400, 1900, 2400, 2860), weight=242.0, block=0.0, noise=0.0, seed=0):
    """Points from the soft string of `drillpetsc statics`, an integration of its own, in the same hole."""
    rng = np.random.default_rng(seed)
    well = Well.from_survey(
        MD,
        np.radians(INCLINATION),
        np.zeros(4),
        [SHOE, END],
        [0.112, 0.10795],
        [TRUTH["cased"], TRUTH["open_hole"]],
    )
    motions = {
        "trip_in": {"axial_velocity": -0.3},
        "trip_out": {"axial_velocity": 0.3},
        "rotate_off_bottom": {"rotation": 10.0},
    }
    points = []
    for depth in depths:
        edges = np.linspace(0, depth, 143)
        for operation, motion in motions.items():
            found = torque_drag(well, edges, weight, 0.0635, 7.0137489e8, 9.4156072e5, **motion)
            torque = found.surface_torque if operation == "rotate_off_bottom" else None
            points.append(
                MeasuredPoint(
                    bit_depth=depth,
                    operation=operation,
                    hook_load=found.hook_load + block + noise * rng.standard_normal(),
                    torque=torque,
                )
            )
    return tuple(points)


def test_factors_come_back():
    """Noise-free points return the factors within 1e-3."""
    fit = Calibration(case(), synthetic()).fit(("cased", "open_hole"))
    assert dict(zip(fit.parameters, fit.value, strict=True)) == pytest.approx(TRUTH, abs=1e-3)
    assert not fit.reasons and fit.chi2 < 1e-3
    assert fit.correlation[0, 1] < 0 and np.diag(fit.correlation) == pytest.approx(1.0)


def test_interval_holds_the_truth():
    """5 kN of noise, 100 seeds: the 95 % interval holds each factor 90 to 99 times."""
    hits = dict.fromkeys(TRUTH, 0)
    clean = Calibration(case(), synthetic())
    for seed in range(100):
        points = synthetic_with_noise(clean.points, 5e3, seed)
        work = Calibration.__new__(Calibration)
        work.__dict__.update(clean.__dict__)
        work.points = points
        work.data = work._data()
        fit = work.fit(("cased", "open_hole"))
        for name, value, width in zip(fit.parameters, fit.value, fit.interval, strict=True):
            hits[name] += abs(value - TRUTH[name]) <= width
    assert all(90 <= count <= 99 for count in hits.values()), hits


def synthetic_with_noise(points, size, seed):
    """The same hook loads with normal noise; torques are left out."""
    rng = np.random.default_rng(seed)
    return tuple(
        p.model_copy(update={"hook_load": p.hook_load + size * rng.standard_normal(), "torque": None})
        for p in points
    )


def test_block_weight_and_weight_factor_come_back():
    points = synthetic(weight=1.03 * 242.0, block=BLOCK)
    fit = Calibration(case(rig={"block_weight": "60 kN"}), points).fit(
        ("cased", "open_hole", "block_weight", "weight_factor")
    )
    found = dict(zip(fit.parameters, fit.value, strict=True))
    assert found["block_weight"] == pytest.approx(BLOCK, rel=2e-3)
    assert found["weight_factor"] == pytest.approx(1.03, abs=1e-3)
    assert {k: found[k] for k in TRUTH} == pytest.approx(TRUTH, abs=2e-3)


def test_weight_error_is_told_and_not_absorbed(tmp_path):
    """Hook loads with an unknown block: it follows from rotating off bottom."""
    result = run_calibrate(Job(case(), tmp_path / "c"), synthetic(block=BLOCK))
    (warning,) = [w for w in result.summary["warnings"] if "error of the weight" in w]
    assert "below the measured" in warning


def test_weight_error_over_the_reading(tmp_path):
    """The difference over what was read, and over the string without the block; the three numbers stand in the sentence.

    242 N/m of string: 2860 m along the J-well weigh 242 x TVD; the readings are 50 kN too low."""
    points = tuple(
        p.model_copy(update={"hook_load": p.hook_load - 50e3})
        for p in synthetic(depths=(1900, 2860), block=BLOCK)
    )
    rig = {"block_weight": "100 kN"}
    result = run_calibrate(Job(case(rig=rig), tmp_path / "c"), points)
    (warning,) = [w for w in result.summary["warnings"] if "error of the weight" in w]
    read = next(p.hook_load for p in points if p.operation == "rotate_off_bottom")
    assert f"{50e3 / read:.1%} above the measured one" in warning
    assert f"{50e3 / (read - BLOCK):.1%} of the string's weight" in warning
    assert f"{read / 1e3:.4g} kN" in warning and "hookload_excludes_block" not in warning
    without = tuple(p.model_copy(update={"hook_load": p.hook_load - BLOCK}) for p in points)
    result = run_calibrate(Job(case(rig=rig), tmp_path / "d"), without)
    (warning,) = [w for w in result.summary["warnings"] if "error of the weight" in w]
    assert "hookload_excludes_block: true" in warning


def _noisy_points_of_one_depth():
    noise = (12e3, -16e3, 12e3)
    return tuple(
        p.model_copy(update={"hook_load": p.hook_load + d, "torque": None})
        for p, d in zip(synthetic(depths=(2100,)), noise, strict=True)
    )


def test_two_that_act_alike_are_both_not_determined(tmp_path):
    """Readings of one depth with 20 kN of noise: pick-up and slack-off say the sum of both frictions only, so neither is a result."""
    fit = Calibration(case(), _noisy_points_of_one_depth()).fit(("cased", "open_hole"))
    assert set(fit.reasons) == {"cased", "open_hole"} and np.isnan(fit.value).all()
    assert "the points do not tell cased from open_hole (correlation -0.9" in fit.reasons["cased"]
    result = run_calibrate(Job(case(), tmp_path / "c"), _noisy_points_of_one_depth())
    assert sum("is not determined" in w for w in result.summary["warnings"]) == 2


def test_wide_interval_determines_nothing(tmp_path):
    """One factor of its own at the casing shoe, with an interval as wide as friction factors differ: not a result, and this is said."""
    noise = (60e3, -70e3, 60e3)
    points = tuple(
        p.model_copy(update={"hook_load": p.hook_load + d, "torque": None})
        for p, d in zip(synthetic(depths=(2860,)), noise, strict=True)
    )
    fit = Calibration(case(), points).fit(("open_hole",))
    assert np.isnan(fit.value[0]) and (
        "95 % interval" in fit.reasons["open_hole"] or "bound" in fit.reasons["open_hole"]
    )


def test_prior_of_one_of_two_that_act_alike():
    """With what is known of the cased hole the sum of both gives the other one; the prior itself is not improved."""
    priors = {"cased": (TRUTH["cased"], 0.02)}
    fit = Calibration(case(), _noisy_points_of_one_depth()).fit(("cased", "open_hole"), priors=priors)
    assert not fit.reasons and fit.priors == ("cased",)
    assert fit.value[0] == pytest.approx(TRUTH["cased"], abs=0.02)
    assert abs(fit.value[1] - TRUTH["open_hole"]) < max(fit.interval[1], 0.1)


def _drilling(seed, noise=8e3, correlated=30.0):
    """Torques every 2 m from 1900 to 2400 m, with noise that is alike over some metres (an autoregressive walk)."""
    rng = np.random.default_rng(seed)
    keep = np.exp(-2.0 / correlated)
    value, out = rng.standard_normal(), []
    for point in _clean():
        out.append(point.model_copy(update={"torque": point.torque + 0.05 * noise * value}))
        value = keep * value + np.sqrt(1 - keep**2) * rng.standard_normal()
    return tuple(out)


@functools.cache
def _clean():
    """Torques of the case itself with the true factors: the noise alone is on trial here."""
    true = case().replace(
        {"well.sections[0].friction": TRUTH["cased"], "well.sections[1].friction": TRUTH["open_hole"]}
    )
    points = tuple(
        MeasuredPoint(bit_depth=float(d), operation="rotate_off_bottom", torque=1e3, rpm=10.0)
        for d in np.arange(1900.0, 2400.0, 2.0)
    )
    work = Calibration(true, points)
    return tuple(
        p.model_copy(update={"torque": float(t)}) for p, t in zip(points, work.computed([{}])[0], strict=True)
    )


@pytest.mark.slow
def test_block_interval_holds_where_the_independent_one_fails():
    """Noise that is alike over 30 m: the interval by blocks holds the truth in 88 to 99 of 100 seeds, the independent one does not."""
    hits = {"blocks": 0, "independent": 0}
    work = Calibration(case(), _drilling(0))
    work.own[0] = TRUTH["cased"]
    for seed in range(100):
        work.points = _drilling(seed)
        work.data = work._data()
        fit = work.fit(("open_hole",), correlated=True)
        away = abs(fit.value[0] - TRUTH["open_hole"])
        hits["blocks"] += bool(away <= fit.interval[0])
        hits["independent"] += bool(away <= fit.independent[0])
    assert 88 <= hits["blocks"] <= 99, hits
    assert hits["independent"] < 70, hits


def test_drift_is_named_and_noise_is_not():
    """A friction of the open hole that grows by 0.1 over 500 m drifts; noise that is alike over 30 m does not."""
    work = Calibration(case(), _drilling(0))
    work.own[0] = TRUTH["cased"]
    share = np.linspace(0.0, 1.0, len(work.points))
    ends = [work.computed([{"open_hole": TRUTH["open_hole"] + q}])[0] for q in (0.0, 0.1)]
    torque = (1 - share) * ends[0] + share * ends[1]
    work.points = tuple(
        p.model_copy(update={"torque": float(t)}) for p, t in zip(work.points, torque, strict=True)
    )
    work.data = work._data()
    drift = drift_by_windows(work, work.fit(("open_hole",), correlated=True))
    assert drift.drifts and drift.slope == pytest.approx(0.1 / 500, rel=0.15)
    assert drift.value == pytest.approx(TRUTH["open_hole"] + 0.1 * (drift.middle - 1900) / 500, abs=0.005)
    work.points = _clean()
    work.data = work._data()
    clean = drift_by_windows(work, work.fit(("open_hole",), correlated=True))
    assert np.ptp(clean.value) < 1e-4


def test_weight_that_drifts_determines_no_friction():
    """Pipe of 257 N/m in a hole whose program has 242 N/m, beside a block weight that is right at one depth: no friction factor."""
    points = synthetic(weight=262.0)
    fit = Calibration(case(), points).fit(("cased", "open_hole"))
    assert all("weight wrong" in fit.reasons[name] for name in ("cased", "open_hole"))
    assert not Calibration(case(), points).fit(("cased", "open_hole", "weight_factor")).reasons


def test_running_drag_comes_back():
    """Hook loads of trips with 80 kN per m/s: up adds, down takes away; without trips it is not determined."""
    points = tuple(
        p.model_copy(
            update={
                "speed": speed,
                "torque": None,
                "hook_load": p.hook_load + {"trip_in": -80e3, "trip_out": 80e3}.get(p.operation, 0.0) * speed,
            }
        )
        for p in synthetic()
        for speed in (0.2, 0.9)
    )
    fit = Calibration(case(), points).fit(("cased", "open_hole", "running_drag"))
    assert fit.value == pytest.approx([*TRUTH.values(), 80e3], rel=0.01)
    still = tuple(p for p in points if p.operation == "rotate_off_bottom")
    assert "tripping" in Calibration(case(), still).fit(("running_drag",)).reasons["running_drag"]


@pytest.mark.parametrize("excludes", [False, True])
def test_sheave_efficiency_comes_back(excludes):
    """12 lines with 0.97 a sheave, of which the case knows 0.99: readings are weights times n F/W of the closed form."""
    rig = {"block_weight": "100 kN"}
    weights = synthetic(block=BLOCK)
    hoisting, lowering = weight_over_line(12, 0.97, "still")
    over = {"trip_out": 12 / hoisting, "trip_in": 12 / lowering, "rotate_off_bottom": 1.0}
    points = tuple(
        p.model_copy(update={"hook_load": p.hook_load * over[p.operation] - BLOCK * excludes})
        for p in weights
    )
    sensor = {"at": "dead_line", "lines": 12, "sheave_efficiency": 0.99}
    given = case(rig=rig | {"hookload_sensor": sensor})
    names = ("cased", "open_hole", "sheave_efficiency")
    fit = Calibration(given, corrected_points(given, points, excludes), excludes).fit(names)
    assert fit.value == pytest.approx([*TRUTH.values(), 0.97], abs=1e-3)
    at_hook = case(rig=rig)
    assert "dead line" in Calibration(at_hook, points).fit(names).reasons["sheave_efficiency"]
    still = tuple(p for p in points if p.operation == "rotate_off_bottom")
    assert "block moved" in Calibration(given, still).fit(names).reasons["sheave_efficiency"]


def test_held_out_points_are_predicted(tmp_path):
    choices = Choices(hold_out="0.4")
    result = run_calibrate(
        Job(case(rig={"block_weight": "100 kN"}), tmp_path / "c"), synthetic(block=BLOCK), choices
    )
    table = read_table(tmp_path / "c" / "calibration.csv")
    held = table["part [-]"] == "held_out"
    assert set(table["bit_depth [m]"][held]) == {2400.0, 2860.0}
    found = result.summary["hold_out"]["hook_load"]
    assert found["readings"] == 6 and found["rms"] < 1e-3 and found["largest"] < 2e-3
    for text in ("1.5", "5 m", "9000 m", "half", "2 kg"):
        with pytest.raises(CaseError, match="--hold-out"):
            run_calibrate(Job(case(), tmp_path / "d"), synthetic(), Choices(hold_out=text))


def test_bound_is_exact():
    """Slack-off loads above those without friction ask for a factor below 0: the answer is 0, not 5e-20."""
    points = tuple(
        p.model_copy(update={"hook_load": p.hook_load + 40e3 * (p.operation == "trip_in"), "torque": None})
        for p in synthetic()
        if p.operation == "trip_in"
    )
    fit = Calibration(case(), points).fit(("open_hole",))
    assert fit.value[0] == 0.0 or np.isnan(fit.value[0])


def test_open_hole_that_no_bit_reached():
    fit = Calibration(case(), synthetic(depths=(800, 1200, 1450))).fit(("cased", "open_hole"))
    assert np.isnan(fit.value[1]) and "no point has the bit" in fit.reasons["open_hole"]
    assert fit.value[0] == pytest.approx(TRUTH["cased"], abs=1e-3)


def test_vertical_readings_determine_nothing():
    fit = Calibration(case(), synthetic(depths=(300, 600, 900))).fit(("cased",))
    assert np.isnan(fit.value[0]) and "3 standard errors" in fit.reasons["cased"]


def test_one_point_does_not_determine_two_factors():
    point = [p for p in synthetic(depths=(2860,)) if p.operation == "trip_out"]
    fit = Calibration(case(), tuple(point)).fit(("cased", "open_hole"))
    assert len(fit.reasons) == 1 and np.isnan(fit.value).sum() == 1
    assert np.isnan(fit.interval).all()  # one unknown, one reading: no interval


def test_torques_without_rotation_are_no_readings(tmp_path):
    """Rigs write a torque of 0 beside pick-up and slack-off: the fit and its interval are those without these torques."""
    own = synthetic()
    filled = tuple(p if p.torque is not None else p.model_copy(update={"torque": 0.0}) for p in own)
    assert [sum(p.torque is not None for p in some) for some in (own, filled)] == [5, 15]
    found, expected = (run_calibrate(Job(case(), tmp_path / str(i)), p) for i, p in enumerate((filled, own)))
    assert found.summary["fit"] == expected.summary["fit"]
    assert found.summary["readings"] == expected.summary["readings"] == 20
    assert any("10 torques without rotation (trip_in, trip_out)" in note for note in found.summary["notes"])
    still = MeasuredPoint(bit_depth=800, operation="trip_in", torque=0.0)
    with pytest.raises(CaseError, match="measured"):
        Calibration(case(), (still,))


def test_files(tmp_path):
    points = synthetic()
    result = run_calibrate(Job(case(rig={"block_weight": "100 kN"}), tmp_path / "c"), synthetic(block=BLOCK))
    table = read_table(tmp_path / "c" / "calibration.csv")
    assert len(table["residual [N or N m]"]) == 20
    assert np.abs(table["residual [N or N m]"]).max() < 100
    alone = table["ff_open_hole_alone [-]"]
    deep = (table["bit_depth [m]"] > 2000) & (table["operation [-]"] != "rotate_off_bottom")
    assert alone[deep] == pytest.approx(TRUTH["open_hole"], abs=2e-3)
    assert np.isnan(alone[table["bit_depth [m]"] < SHOE]).all()
    summary = json.loads((tmp_path / "c" / "summary.json").read_text())
    assert summary["fit"]["cased"]["status"] == "determined"
    a, b = summary["fit"]["cased"]["interval"]
    assert a < TRUTH["cased"] < b and summary == result.summary
    assert points


def test_refused(tmp_path):
    with pytest.raises(CaseError, match="measured points"):
        run_calibrate(Job(case(), tmp_path / "c"), None)
    with pytest.raises(CaseError, match="end of the hole"):
        run_calibrate(
            Job(case(), tmp_path / "c"), (MeasuredPoint(bit_depth=5000, operation="trip_in", hook_load=1e5),)
        )
    assert not (tmp_path / "c").exists()


def test_flow_between_depths_and_rates_is_that_of_a_solve():
    """Lift and thrust of mud that are interpolated between bit depths and rates differ by less than 0.5 % from a solve at the place."""
    mud = {
        "density": "1300 kg/m3",
        "rheology": {"model": "bingham", "plastic_viscosity": "25 mPa s", "yield_stress": "7 Pa"},
    }
    made = case(fluid=mud)
    table = flow_table(made, np.array([1400.0, 2800.0]), np.array([0.02, 0.035]), 20.0, "flow")
    wrong = []
    for depth, rate in ((1411.0, 0.02), (1493.0, 0.028), (1507.0, 0.033), (2333.0, 0.024), (2799.0, 0.035)):
        edges = np.linspace(0.0, depth, 300)
        exact = circulation(made, depth, rate, "flow")
        lift, thrust = table.forces(depth, rate, edges)
        total = [float(q @ np.diff(edges)) for q in (lift, exact.lift(edges))]
        if total[0] != pytest.approx(total[1], rel=0.005) or thrust != pytest.approx(exact.thrust, rel=0.001):
            wrong.append((depth, rate, total, thrust, exact.thrust))
    assert not wrong
