"""`calibrate --model dynamic`: numbers of runs come back from logs with noise, with honest intervals, and what a log cannot tell is said."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from petsc4py import PETSc

import drillpetsc
from drillpetsc.analysis.calibration.command import run_calibrate_log
from drillpetsc.analysis.calibration.estimator import Fit
from drillpetsc.analysis.calibration.log_series import log_series
from drillpetsc.analysis.calibration.of_runs import (
    RunCalibration,
    fit_run,
    moved_by_steps,
    next_column,
    readings_alike,
    run_of,
)
from drillpetsc.case import Case
from drillpetsc.errors import CaseError
from drillpetsc.output import read_table
from drillpetsc.output.job import Job
from drillpetsc.parallel import initialise_petsc
from tests.helpers.run_twins import RunTwin
from tests.verification.test_sensitivities_run import INERTIA, LENGTH, STIFFNESS, pendulum, rock_bit

#: seeds of a fit with the run itself, and of all: intervals of 95 % hold the truth in fewer with probabilities of 3e-3 and 3e-4
WHOLE, FEWEST_WHOLE, SEEDS, FEWEST = 2, 1, 20, 16
LOOSE = {"petsc.ts_rtol": "1e-3"}
SHAFT, INERTIA_KEY = "string[0].torsional_stiffness", "string[1].inertia.axial"
FREE = {SHAFT: 1.1 * STIFFNESS * LENGTH, INERTIA_KEY: 0.93 * INERTIA}
LAW = {"formation.bit_law.static": 6.4e3, "formation.bit_law.dynamic": 2.8e3, INERTIA_KEY: 0.97 * INERTIA}
TIMES = np.arange(0.05, 6.0 + 1e-9, 0.05)


@pytest.fixture(scope="module", autouse=True)
def _petsc() -> None:
    initialise_petsc()


def twin(case: Case, truth: dict[str, float], *columns: str) -> RunTwin:
    return RunTwin(case.replace(LOOSE), truth, columns or ("surface_torque", "bit_speed"), TIMES)


def held(pair: RunTwin, fits: list[Fit]) -> None:
    assert min(pair.held(fits[:WHOLE])) >= FEWEST_WHOLE
    assert min(pair.held(fits)) >= FEWEST


def test_pendulum_with_independent_noise():
    """Stiffness and inertia of a torsional pendulum."""
    held(pair := twin(pendulum("bdf"), FREE), pair.fits(WHOLE, range(SEEDS), 0.02))


def test_bit_law_with_noise_that_lasts():
    """A bit that breaks loose; noise of a memory of 0.8 a row. Intervals of independent errors are then too narrow by a factor of two."""
    pair = twin(rock_bit("bdf"), LAW)
    fits = pair.fits(WHOLE, range(SEEDS), 0.02, memory=0.8)
    held(pair, fits)
    assert sum(pair.held(fits, independent=True)) < 0.75 * SEEDS * len(LAW)


@pytest.mark.parametrize("memory", [0.0, 0.5, 0.8])
def test_readings_that_count_as_one(memory):
    """(1 + rho)/(1 - rho) of an autoregression."""
    draw = np.random.default_rng(1)
    noise = draw.standard_normal(20000)
    for i in range(1, len(noise)):
        noise[i] = memory * noise[i - 1] + np.sqrt(1 - memory**2) * noise[i]
    assert readings_alike(noise) == pytest.approx((1 + memory) / (1 - memory), rel=0.06)
    assert readings_alike(np.ones(50)) == 1.0


def test_bit_speed_alone_tells_one_ratio():
    """The speed of the pendulum depends on stiffness over inertia alone, which is found with the case's value of one; the torque would tell both."""
    pair = twin(pendulum("bdf"), FREE, "bit_speed")
    work = RunCalibration(run_of(pair.case, PETSc.COMM_SELF), pair.log(pair.clean(), 0.02, 0))
    fit = fit_run(work, tuple(FREE), True, {})
    (missing,) = fit.reasons
    assert "do not distinguish" in fit.reasons[missing]
    found = {name: work.default(name) for name in FREE} | fit.best
    assert found[SHAFT] / found[INERTIA_KEY] == pytest.approx(FREE[SHAFT] / FREE[INERTIA_KEY], rel=0.01)
    further = next_column(work, fit)
    assert further is not None and further.column == "surface_torque"
    assert further.widths[missing] < work.allowed(missing)
    known = fit_run(work, tuple(FREE), True, {INERTIA_KEY: (FREE[INERTIA_KEY], 1.0)})
    assert known.best[SHAFT] == pytest.approx(FREE[SHAFT], rel=0.03)


def test_number_without_effect():
    pair = twin(pendulum("bdf"), FREE)
    work = RunCalibration(run_of(pair.case, PETSc.COMM_SELF), pair.log(pair.clean(), 0.02, 0))
    fit = fit_run(work, (*FREE, "string[0].od"), True, {})
    assert "less than their scatter" in fit.reasons["string[0].od"]
    assert fit.best[SHAFT] == pytest.approx(FREE[SHAFT], rel=0.05)


def test_error_of_the_steps_is_told():
    """A log without noise of a run with fine steps, fitted with coarse ones: the change that is told is the fit's own error to a third."""
    fine, coarse = (pendulum("bdf").replace({"petsc.ts_rtol": r}) for r in ("1e-6", "1e-3"))
    clean = RunTwin(fine, FREE, ("surface_torque", "bit_speed"), TIMES).clean()
    pair = RunTwin(coarse, FREE, ("surface_torque", "bit_speed"), TIMES)
    work = RunCalibration(run_of(coarse, PETSc.COMM_SELF), pair.log(clean, 0.0, 0))
    fit = fit_run(work, tuple(FREE), True, {})
    for name, change in moved_by_steps(work, fit).items():
        assert change == pytest.approx(FREE[name] - fit.best[name], rel=0.35)


def test_chaotic_motion_is_refused():
    """Derivatives that grow exponentially from the start, e-fold in 0.2 s."""
    pair = twin(pendulum("bdf"), FREE)
    work = RunCalibration(run_of(pair.case, PETSc.COMM_SELF), pair.log(pair.clean(), 0.02, 0))
    series = work.followed({}, tuple(FREE))
    grown = series.slopes * np.exp(series.times / 0.2)[:, None, None]
    work._kept = dict.fromkeys(work._kept, replace(series, slopes=grown))
    with pytest.raises(CaseError, match="chaotic") as found:
        fit_run(work, tuple(FREE), True, {})
    assert found.value.at == "--log"


def test_numbers_that_chaos_has_lost_are_named_as_such():
    """Where a second search begins, the derivatives are lost after a second: nothing is said of the scatter."""
    pair = twin(pendulum("bdf"), FREE)
    work = RunCalibration(run_of(pair.case, PETSc.COMM_SELF), pair.log(pair.clean(), 0.02, 0))
    work.start = dict(FREE)
    series = work.followed(work.start, tuple(FREE))
    lost = np.where(series.times[:, None, None] > 1.0, np.nan, series.slopes)
    work._kept = dict.fromkeys(work._kept, replace(series, slopes=lost))
    reasons = work.fit(tuple(FREE), True, {}).reasons
    assert set(reasons) == set(FREE) and all("chaotic: from 1.0" in why for why in reasons.values())


# ---------------------------------------------------------------------- logs
def written(tmp_path: Path, text: str) -> str:
    path = tmp_path / "log.csv"
    path.write_text(text)
    return str(path)


def rows(heading: str, *cells: str, first: float = 0.0) -> str:
    """A log with a row each 0.1 s; cells: of the columns after the time."""
    return "\n".join([heading, *(f"{first + 0.1 * i:.1f}," + ",".join(cells) for i in range(20))])


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (rows("time [s],flow [l/min]", "900"), "surface|torque"),
        (rows("time [s],torque [kN m]", "5", first=7.0), "times from 0 to 8 s"),
        (rows("time [s],torque [kN m]", "nan"), "at least 10 numbers"),
        ("time [s],torque [kN m]\n0,1\n1,2\n", "at least 10 numbers"),
        (rows("depth [m],torque [kN m]", "5"), "log by time"),
    ],
)
def test_logs_that_tell_nothing_are_refused(tmp_path, text, words):
    case = pendulum("bdf")
    with pytest.raises(CaseError) as found:
        log_series(written(tmp_path, text), case, run_of(case, PETSc.COMM_SELF).names)
    assert any(word in str(found.value) for word in words.split("|"))
    assert "log.csv" in str(found.value)


def test_log_begins_where_its_seconds_say(tmp_path):
    """Seconds are those of the run. A speed that the run does not compute, and rows without a number, are told."""
    text = rows("time [s],torque [kN m],rpm,bit rpm", "5", "60", "120", first=2.0) + "\n4.0,nan,60,120\n"
    case = pendulum("bdf")
    log = log_series(written(tmp_path, text), case, run_of(case, PETSc.COMM_SELF).names)
    assert log.columns == ("surface_torque", "bit_speed")
    assert log.time.min() == pytest.approx(2.0) and log.end == pytest.approx(4.0)
    assert (log.column == 0).sum() == 20 and (log.column == 1).sum() == 21
    assert log.value[log.column == 1] == pytest.approx(4 * np.pi)
    assert any("no top_speed" in note for note in log.notes) and any("1 rows" in note for note in log.notes)


def test_hook_load_is_that_of_the_string(tmp_path):
    """The block is on the hook unless the case says that the reading leaves it out."""
    text = rows("time [s],hook load [kN]", "600")
    case = pendulum("bdf", rig={"block_weight": "100 kN"})
    names = run_of(case, PETSc.COMM_SELF).names
    assert log_series(written(tmp_path, text), case, names).value == pytest.approx(500e3)
    without = case.replace({"roadmap.hookload_excludes_block": True})
    assert log_series(written(tmp_path, text), without, names).value == pytest.approx(600e3)


def test_files_and_lines(tmp_path):
    pair = twin(pendulum("bdf"), FREE)
    torque, speed = pair.clean()
    lines = [
        f"{t!r},{a / 1e3!r},{b!r}"
        for t, a, b in zip(TIMES.tolist(), torque.tolist(), speed.tolist(), strict=True)
    ]
    file = written(tmp_path, "\n".join(["time [s],torque [kN m],bit speed [rad/s]", *lines]))
    job = Job(pair.case, tmp_path / "out", communicator=PETSc.COMM_SELF)
    found = run_calibrate_log(job, file, tuple(FREE), True, {})
    assert found.summary["model"] == "dynamic" and set(found.summary["fit"]) == set(FREE)
    for name, value in FREE.items():
        assert found.summary["fit"][name]["value"] == pytest.approx(value, rel=1e-3)
    table = read_table(tmp_path / "out" / "calibration_series.csv")
    assert table["surface_torque computed [N m]"] == pytest.approx(
        table["surface_torque read [N m]"], abs=10.0
    )
    assert any("calibration of the run with 240 readings" in line for line in found.lines)


@pytest.mark.parametrize(
    ("options", "at", "word"),
    [
        ({"fit": SHAFT}, "--log", "log by time"),
        ({"log": "log.csv"}, "--fit", "numbers of the case"),
        ({"log": "log.csv", "fit": SHAFT, "hold_out": "0.5"}, "--hold-out", "soft or stiff"),
        ({"measured": "log.csv", "fit": SHAFT}, "--measured", "row by row"),
        ({"log": "log.csv", "fit": "open_hole"}, "--fit", "numbers of the case"),
        ({"log": "log.csv", "fit": "string[0].lenght"}, "--fit", "no such number"),
        ({"log": "log.csv", "fit": "mesh.refinement"}, "--fit", "mesh"),
        ({"log": "log.csv", "fit": SHAFT, "prior": ("fluid.density=1+-1",)}, "--prior", "is fitted"),
    ],
)
def test_options_that_do_not_fit(tmp_path, monkeypatch, options, at, word):
    monkeypatch.chdir(tmp_path)
    written(tmp_path, rows("time [s],torque [kN m]", "5"))
    with pytest.raises(CaseError) as found:
        drillpetsc.calibrate(pendulum("bdf"), model="dynamic", **options)
    assert found.value.at == at and word in str(found.value)
    assert [path.name for path in tmp_path.iterdir()] == ["log.csv"]
