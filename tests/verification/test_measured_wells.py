"""Measured wells: cases/measured against their bands, which stand beside the cases (contract A3). Nothing is tuned but what is fitted."""

from __future__ import annotations

import csv
import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.optimize import least_squares

from drillpetsc.analysis.commands.check import describe
from drillpetsc.analysis.hydraulics.flow_model import FlowModel, whole_string
from drillpetsc.analysis.hydraulics.losses import balance
from drillpetsc.analysis.loads.torque_drag.readings.calibration import Calibration
from drillpetsc.analysis.loads.torque_drag.readings.held_out import hold_out_depth, predict
from drillpetsc.analysis.loads.torque_drag.string_rows import rows_at
from drillpetsc.case import load_case
from drillpetsc.case.blocks.roadmap import MeasuredPoint
from drillpetsc.case.case import Case
from drillpetsc.errors import CaseError
from drillpetsc.model.hole import build_well
from drillpetsc.parallel import initialise_petsc
from drillpetsc.units import to_si
from tests.helpers.records import record

sys.path.insert(0, str(Path(__file__).parents[2] / "scripts" / "tools"))
import measured_rig  # noqa: E402

WELLS = Path(__file__).parents[2] / "cases" / "measured"


def bands(well: str) -> dict[str, Any]:
    return dict(json.loads((WELLS / well / "bands.json").read_text()))


def case(well: str, *changes: str) -> Case:
    return load_case(WELLS / well / "case.yaml", list(changes))


def points(c: Case) -> tuple[MeasuredPoint, ...]:
    assert c.roadmap is not None and c.roadmap.measured is not None
    return c.roadmap.measured


def errors(work: Calibration, values: dict[str, float]) -> dict[str, np.ndarray]:
    """Relative residuals by kind of reading."""
    d = work.data
    relative = work.computed([values])[0] / d.value - 1
    return {"hook_load": relative[d.hook], "torque": relative[~d.hook]}


def rms(residual: np.ndarray) -> float:
    return float(np.sqrt((residual**2).mean()))


@pytest.mark.parametrize("well", sorted(p.name for p in WELLS.iterdir()))
def test_every_well_has_its_files(well: str) -> None:
    files = {p.name for p in (WELLS / well).iterdir()}
    assert {
        "case.yaml",
        "SOURCE.md",
        "bands.json",
        "windows.csv" if well == "ufrj-rig" else "survey.csv",
    } <= files
    words = (WELLS / well / "SOURCE.md").read_text()
    assert "**Records.**" in words and "**Assumptions.**" in words


# ---------------------------------------------------------------------- Volve F-5
FITTED = ("open_hole", "block_weight")


def test_f5_fitted_to_its_points() -> None:
    c = case("volve-f5")
    assert len(points(c)) == 20
    assert c.string[0].length == pytest.approx(2265.49, abs=1e-6)  # fill, contract A1
    work = Calibration(c, points(c))
    fit = work.fit(FITTED)
    found, band = errors(work, dict(zip(FITTED, fit.value, strict=True))), bands("volve-f5")
    band = band["all points, open_hole and block_weight fitted"]
    for key, residual in found.items():
        assert rms(residual) <= band[f"{key}_rms"], key
        assert np.abs(residual).max() <= band[f"{key}_max"], key
    for value, key in zip(fit.value, ("open_hole", "block_weight [N]"), strict=True):
        assert band[key][0] <= value <= band[key][1]


def test_f5_lower_half_predicted() -> None:
    """Groups of 10 m of the record, as `import log` makes them: fitted from 1900 to 2150 m, predicted to 2400 m."""
    with record("volve-f5/measured-12in.csv").open(newline="") as lines:
        rows = [{key: float(value or "nan") for key, value in row.items()} for row in csv.DictReader(lines)]
    groups: dict[int, list[dict[str, float]]] = {}
    for row in rows:
        if 147 <= row["rpm"] <= 153 and 1900 <= row["bit_md_m"] < 2400:
            groups.setdefault(int(row["bit_md_m"] // 10), []).append(row)
    made = []
    for some in groups.values():
        middle = {key: float(np.nanmedian([row[key] for row in some])) for key in some[0]}
        made.append(
            MeasuredPoint(
                bit_depth=middle["bit_md_m"],
                operation="drilling",
                hook_load=to_si(f"{middle['hookload_t']} t", "kg") * 9.80665,
                torque=middle["torque_surface_kNm"] * 1e3,
                wob=max(middle["wob_downhole_t"], 0.0) * 9806.65,
                tob=max(middle["torque_downhole_kNm"], 0.0) * 1e3,
                rpm=middle["rpm"] * np.pi / 30,
                flow_rate=middle["flow_in_lpm"] / 6e4,
            )
        )
    c = case("volve-f5")
    upper, lower = (tuple(p for p in made if (p.bit_depth < 2150) is above) for above in (True, False))
    assert len(upper) == 25 and len(lower) == 25
    fit = Calibration(c, upper).fit(FITTED)
    found = errors(Calibration(c, lower), dict(zip(FITTED, fit.value, strict=True)))["hook_load"]
    band = bands("volve-f5")["record in 10 m groups, fitted above 2150 m, predicted below"]
    assert rms(found) <= band["hook_load_rms"] and np.abs(found).max() <= band["hook_load_max"]


def predicted(well: str, below: str, fitted: tuple[str, ...]) -> dict[str, dict[str, Any]]:
    """Errors of the deeper points of a case, predicted with a fit to the others."""
    c = case(well)
    depth = hold_out_depth(below, points(c))
    upper, lower = (tuple(p for p in points(c) if (p.bit_depth > depth) == deep) for deep in (False, True))
    work = Calibration(c, upper)
    return predict(work, work.fit(fitted), Calibration(c, lower)).errors()


def test_f5_drift_is_carried_on() -> None:
    """The ten upper points fitted, torque of the ten lower ones within 5 % and in the band; hook load within 1 %."""
    found = predicted("volve-f5", "2150 m", FITTED)
    band = bands("volve-f5")["points, fitted above 2150 m, predicted below"]
    assert found["hook_load"]["rms"] <= band["hook_load_rms"]
    assert abs(found["surface_torque"]["bias"]) <= band["torque_bias"]
    assert found["surface_torque"]["rms"] <= band["torque_rms"] and found["surface_torque"]["in_band"] >= 0.85


def test_f4_deeper_half_is_predicted() -> None:
    found = predicted("volve-f4", "0.5", ("cased", "weight_factor", "running_drag"))
    assert found["hook_load"]["readings"] == 18
    assert found["hook_load"]["rms"] <= bands("volve-f4")["deeper half predicted"]["hook_load_rms"]


def test_f5_weight_of_the_planner() -> None:
    """The planner's rotating weight off bottom without block: 143.9 klbf at 1900 m, 171.8 at 2400 m."""
    c, band = case("volve-f5"), bands("volve-f5")["weight without friction, without block [N]"]
    well = build_well(c)
    assert well is not None
    for depth in (1900.0, 2400.0):
        rows = rows_at(c, depth)
        down = np.asarray(well.at(rows.edges)[0])[:, 2]
        weight = float(rows.weight @ np.diff(down)) + rows.end_weight
        assert weight == pytest.approx(band[f"{depth:g} m"], rel=band["relative"])


# ---------------------------------------------------------------------- Volve F-4
def test_f4_trips_with_running_drag() -> None:
    """Friction, weight factor and a drag proportional to the speed, by least squares on the soft string."""
    c = case("volve-f4")
    some = points(c)
    assert [sum(p.operation == q for p in some) for q in ("trip_in", "trip_out")] == [20, 19]
    work = Calibration(c, some)
    speed = np.array([(p.speed or 0.0) * (1 if p.operation == "trip_out" else -1) for p in some])

    def residual(x: np.ndarray) -> np.ndarray:
        computed = work.computed([{"cased": x[0], "weight_factor": x[1]}])[0] + 1e5 * x[2] * speed
        return np.asarray(computed / work.data.value - 1)

    found = residual(least_squares(residual, [0.3, 1.0, 0.5]).x)
    band = bands("volve-f4")["friction, weight factor and running drag fitted"]
    assert rms(found) <= band["hook_load_rms"] and np.abs(found).max() <= band["hook_load_max"]


def test_f4_riser_is_cased_hole() -> None:
    """The riser has the friction group of the casing, and the same hook loads."""
    c = case("volve-f4")
    sections = [{"to": "20 m", "kind": "casing", "diameter": "508 mm", "friction": 0.25}]
    assert c.well is not None and c.well.sections[0].kind == "riser" and c.well.sections[0].group == "cased"
    other = c.replace({"well.sections[0]": sections[0]})
    some = points(c)[::8]
    assert Calibration(c, some).computed([{}]) == pytest.approx(Calibration(other, some).computed([{}]))


def test_f4_without_bit_depth_says_where_the_bit_is() -> None:
    """562 and 2054 m of pipe in a hole of 3510 m: one line; none with the bit depth, nor in a hole as long as the string."""
    line = "the lower end is at MD 2616 m, the length of the string; the hole goes on to 3510 m (bit_depth)"
    assert line in describe(case("volve-f4"))
    assert "the hole goes on" not in describe(case("volve-f4", "bit_depth=2616 m"))
    assert "the hole goes on" not in describe(case("volve-f5"))


def stages(well: str) -> list[list[float]]:
    with (WELLS / well / "stages.csv").open(newline="") as lines:
        return [[float(cell) for cell in row] for row in list(csv.reader(lines))[1:]]


def pressures(c: Case, flows: list[float]) -> list[dict[str, float]]:
    model, out = FlowModel(c, whole_string(c), "pumping"), []
    for flow in flows:
        model.solve(flow)
        out.append(balance(model))
    return out


def test_f4_pump_pressure_of_sea_water() -> None:
    rows = [row for row in stages("volve-f4") if row[1] >= 886]
    sums = pressures(case("volve-f4", "bit_depth=2616 m"), [row[1] / 6e4 for row in rows])
    band = bands("volve-f4")["pump pressure, nothing fitted, from 886 l/min"]
    assert len(rows) == 7
    for (_, flow, read), found in zip(rows, sums, strict=True):
        off = (found["pump_pressure"] - found["outlet"]) / (read * 1e5) - 1
        assert band["below"] <= off <= band["above"], flow
        if 1770 <= flow <= 2200:
            assert abs(off) <= band["1770 to 2200 l/min"], flow


# ---------------------------------------------------------------------- FORGE 16B
def test_forge_pump_pressure() -> None:
    gpm, psi = to_si("1 gpm", "m^3/s"), to_si("1 psi", "Pa")
    rows = stages("forge-16b")
    c = case("forge-16b")
    sums = pressures(c, [row[1] * gpm for row in rows])
    computed = [(q["pump_pressure"] - q["outlet"]) / psi for q in sums]
    flow, read = np.array(rows)[:, 1], np.array(rows)[:, 2]
    largest = int(np.argmax(flow))
    tools = (read[largest] - computed[largest]) * (flow / flow[largest]) ** 2
    off = np.delete((computed + tools) / read - 1, largest)
    band = bands("forge-16b")["pump pressure, one tool loss K Q^2 from the largest flow rate"]
    assert len(off) == 4 and np.abs(off).max() <= band["each"] and np.abs(off).mean() <= band["mean"]
    band = bands("forge-16b")["bit loss at 700 gpm [psi]"]
    (found,) = pressures(c, [700 * gpm])
    assert found["bit_loss"] / psi == pytest.approx(band["rig"], rel=band["relative"])


def test_forge_bit_depth_cuts_the_hole() -> None:
    """The survey to 10,947 ft with the bit at 8585 ft, or a survey that ends there: the same pump pressure to 1 psi."""
    psi, flow = to_si("1 psi", "Pa"), 600 * to_si("1 gpm", "m^3/s")
    c = case("forge-16b")
    survey = read = str(record("forge-16b/survey-8585.csv"))
    shorter = case("forge-16b", f"well.survey={read}", "string[0].length=7331.73 ft").replace(
        {"bit_depth": "8585 ft"}
    )
    assert survey and shorter.string_length == pytest.approx(c.string_length, abs=1e-6)
    one, other = (pressures(q, [flow])[0]["pump_pressure"] for q in (c, shorter))
    assert one == pytest.approx(other, abs=psi)


# ---------------------------------------------------------------------- the laboratory rig
@pytest.fixture(scope="module")
def rig_motion(tmp_path_factory: pytest.TempPathFactory) -> measured_rig.Figures:
    return measured_rig.figures(*measured_rig.computed(tmp_path_factory.mktemp("rig") / "run"))


@pytest.mark.parametrize(
    ("start", "band"),
    [(37.0, "37 to 41 s, parameters from the balances of torque"), (41.0, "41 to 45 s, predicted")],
)
def test_rig_stick_slip(rig_motion: measured_rig.Figures, start: float, band: str) -> None:
    read, allowed = measured_rig.read_windows()[start], bands("ufrj-rig")[band]
    for key in ("mean", "frequency", "peak"):
        assert getattr(rig_motion, key) == pytest.approx(getattr(read, key), rel=allowed[key]), key
    assert rig_motion.stuck == pytest.approx(read.stuck, abs=allowed["stuck share"])


def test_rig_windows_are_those_of_the_record() -> None:
    """windows.csv is rounded to 0.1 rpm, 1 mHz and 0.1 % of the time."""
    found = {
        start: q for start, _, q in measured_rig.windows(measured_rig.read_record(record(measured_rig.NAME)))
    }
    written = measured_rig.read_windows()
    assert len(written) == 10 and written.keys() == found.keys()
    for start, q in found.items():
        read = written[start]
        assert [q.mean, q.peak] == pytest.approx([read.mean, read.peak], abs=0.051 * measured_rig.RPM)
        assert [q.frequency, q.stuck] == pytest.approx([read.frequency, read.stuck], abs=5.1e-4)


def test_rig_parameters_are_fitted() -> None:
    """The fit to the record gives the parameters of the case."""
    found = list(measured_rig.fit(measured_rig.read_record(record(measured_rig.NAME))).values())
    c = case("ufrj-rig")
    shaft, bit = c.string
    stiffness = shaft.torsional_stiffness / shaft.length
    control, law = c.top.control[0], c.formation.bit_law
    given = [
        bit.inertia.axial,
        stiffness,
        stiffness * shaft.damping.stiffness,
        c.top.motor.inertia,
        c.top.motor.time_constant,
        control.p,
        control.p * c.top.rotation.constant,
        law.static,
        law.dynamic,
        law.speed,
    ]
    rel = bands("ufrj-rig")["fitted again from the record, relative"]
    assert found[:10] == pytest.approx(given, rel=rel, abs=1e-6)


def test_rig_law_by_the_run_itself() -> None:
    """0.7 s do not tell the stiffness; what they tell are the values that the balances of torque found without a run.

    It looks like the inertia or like the speed of the bit law: correlations of 0.98 to 0.995, of which the larger one is named.
    """
    initialise_petsc()
    work, found = measured_rig.fit_by_run(measured_rig.read_record(record(measured_rig.NAME)))
    assert "string[0].torsional_stiffness" in found.reasons and len(found.reasons) == 2
    told = [name for name in measured_rig.RUN_PARAMETERS if name not in found.reasons]
    assert "formation.bit_law.static" in told
    for name in told:
        i = found.parameters.index(name)
        assert abs(found.value[i] - work.default(name)) <= found.interval[i]


def test_rig_with_the_default_slip_velocity_is_doubtful() -> None:
    """10 mm/s over 2/3 of the bit's radius of 50 mm are 0.3 rad/s or 2.86 rpm; the case has 0.5 mm/s."""
    said = describe(case("ufrj-rig", "contact.slip_velocity=10 mm/s"))
    assert "contact.slip_velocity (10 mm/s) lets a bit that sticks creep at up to 2.86 rpm" in said
    assert "slip_velocity" not in describe(case("ufrj-rig"))


def test_rig_figures_of_a_known_motion() -> None:
    """A raised cosine of 2.5 Hz from 0 to 160 rpm: stuck below 10 rpm for arccos(1 - 2/16) / pi of the time."""
    t = np.arange(0.05, 4.05, measured_rig.STEP)
    found = measured_rig.figures(t, 80 * measured_rig.RPM * (1 - np.cos(2 * np.pi * 2.5 * t)))
    assert [found.mean, found.peak] == pytest.approx(
        [80 * measured_rig.RPM, 160 * measured_rig.RPM], rel=1e-3
    )
    assert found.frequency == pytest.approx(2.5, rel=1e-6)
    assert found.stuck == pytest.approx(np.arccos(1 - 2 / 16) / np.pi, abs=2.5e-3)  # a sample a cycle


# ---------------------------------------------------------------------- the doubtful string
def test_dogleg_string_is_refused_by_its_collar() -> None:
    with pytest.raises(CaseError) as caught:
        case("field-dogleg")
    text = str(caught.value)
    assert "string[2].weight" in text and "1267 lb/ft" in text
    assert f"{bands('field-dogleg')['steel collar [lb/ft]']} lb/ft" in text


def test_dogleg_weight_is_wrong_with_a_steel_collar_too() -> None:
    c = case("field-dogleg", "string[2].weight=147 lb/ft")
    foot, klbf = to_si("1 ft", "m"), to_si("1 klbf", "N")
    found = Calibration(c, points(c)).weight_misfit()
    off = np.array([[p.bit_depth / foot, ((p.hook_load or 0.0) - computed) / klbf] for p, computed in found])
    band = bands("field-dogleg")["rotating weight as read less computed, collar of 147 lb/ft [klbf]"]
    for depth, value in (off[0], off[-1]):
        low, high = band[f"{depth:.0f} ft"]
        assert low <= value <= high
    low, high = band["per 1000 ft"]
    assert low <= np.polyfit(off[:, 0] / 1000, off[:, 1], 1)[0] <= high
