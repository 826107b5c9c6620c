"""Derivatives of a run by numbers of its case: a torsional pendulum in closed form, and stick-slip against runs with the same steps."""

from __future__ import annotations

import json
from collections.abc import Callable

import numpy as np
import pytest
from petsc4py import PETSc
from scipy.optimize import brentq

from drillpetsc.analysis.sensitivities.command import Question, run_sensitivities
from drillpetsc.analysis.sensitivities.keys import key_of
from drillpetsc.analysis.sensitivities.motion.outputs import parsed_outputs
from drillpetsc.analysis.sensitivities.motion.run_of_case import RunOfCase, RunSeries
from drillpetsc.arrays import FloatArray
from drillpetsc.case import Case
from drillpetsc.errors import CaseError
from drillpetsc.output import read_table
from drillpetsc.output.catalogue import outputs_by_file
from drillpetsc.output.job import Job
from drillpetsc.parallel import initialise_petsc
from drillpetsc.solvers import petsc_options as options
from tests.helpers.wells import simple_well

Watch = Callable[[RunOfCase], None] | None
INERTIA, STIFFNESS, LENGTH, SPEED, RAMP = 374.0, 473.0, 100.0, 5.0, 0.1


@pytest.fixture(scope="module", autouse=True)
def _petsc() -> None:
    initialise_petsc()


def pendulum(integrator: str, **changes: object) -> Case:
    """A bit on a shaft without mass to speak of, whose top is turned at 5 rad/s from 0.1 s on."""
    shaft = {
        "kind": "beam", "length": LENGTH, "axial_stiffness": 7e8, "bending_stiffness": 1e9, "torsional_stiffness": STIFFNESS * LENGTH,
        "mass": 100.0, "polar_inertia": 1e-3, "od": 0.127, "id": 0.1086, "element_length": 25.0,
    }  # fmt: skip
    bit = {
        "kind": "bit",
        "length": 0.5,
        "od": 0.2159,
        "mass": 60.0,
        "inertia": {"axial": INERTIA, "transverse": 400.0},
    }
    case = {
        "well": simple_well(LENGTH + 0.5, 0.2159),
        "string": [shaft, bit],
        "top": {"kind": "top_drive", "rotation": {"time": [0.0, RAMP], "value": [0.0, SPEED]}},
        "bottom": "free",
        "contact": "none",
        "initial": {"from": "rest", "imperfection": 0},
        "time": {"end": 8.0, "integrator": integrator},
        "output": {"history_every": 0.1},
        "petsc": {"ts_rtol": "1e-4"},
    }
    return Case(**(case | changes))


def rock_bit(integrator: str) -> Case:
    """The same with a bit whose torque falls with its speed: it sticks, breaks loose, and sticks again."""
    law = {"kind": "velocity_weakening", "static": 6e3, "dynamic": 3e3, "speed": 1.0}
    changes = {
        "bottom": {"kind": "bit"},
        "formation": {"drillability": 0.0, "bit_law": law},
        "initial": {"from": "statics", "wob": 50e3, "imperfection": 0},
        "petsc": {"ts_rtol": "1e-4"},
        "time": {"end": 8.0, "integrator": integrator},
    }
    return pendulum(integrator, **changes)


def on_the_wall(integrator: str, end: float, lean: float, collar: dict[str, object], **top: object) -> Case:
    """80 m of pipe and an unbalanced collar on the wall of a hole that leans by ``lean`` [rad]."""
    pipe = {"kind": "pipe", "length": 60.0, "od": 0.127, "id": 0.1086, "element_length": 10.0}
    case = {
        "well": simple_well(100.0, 0.2159, lean, friction=0.25),
        "string": [pipe, {"kind": "pipe", "length": 20.0, "od": 0.1715, "id": 0.0714, "element_length": 10.0, **collar}],
        "top": {"kind": "top_drive"} | {k: {"time": [0.0, 0.5], "value": [0.0, v]} for k, v in top.items()},
        "bottom": "free",
        "gravity": 9.81,
        "initial": {"from": "statics"},
        "time": {"end": end, "integrator": integrator},
        "output": {"history_every": 0.01},
    }  # fmt: skip
    return Case(**case)


#: of a string on the wall: movement of the top, lean of the hole [deg], end [s], column, changes of contacts at least
WALL = {
    "lowered": ({"lowering": 0.1}, 60.0, 1.0, {}, "hook_load", 0),
    "turned": ({"rotation": 6.0}, 60.0, 0.7, {}, "surface_torque", 0),
    "off the wall and back": ({"rotation": 15.0}, 5.0, 0.35, {"eccentricity": 0.02}, "surface_torque", 4),
}


def series_of(
    case: Case, names: list[str], columns: list[str], steps: FloatArray | None = None, watch: Watch = None
) -> RunSeries:
    """Columns of a run and their derivatives.  steps: that it takes [s]; watch: called with the run after each step."""
    with options.applied({"q_snes_stol": "1e-12"} | case.petsc):
        run = RunOfCase(case, PETSc.COMM_SELF)
        if steps is not None:
            run.freeze(steps)
        if watch is not None:
            run.integrator.after_step.append(lambda t, dt: watch(run))
        return run.series([key_of(case, n) for n in names], columns)


def flags_of(run: RunOfCase) -> FloatArray:
    """Whether each contact of a run is closed."""
    flags = [f.values.ravel() for f in run.model.system.contact_flags]
    return np.concatenate(flags).astype(float)


@pytest.mark.parametrize("integrator", ["bdf", "generalized_alpha"])
def test_torsional_pendulum(integrator):
    """Speed after a ramp of length T: W (1 - (sin wt - sin w(t - T))/(wT)), with w = sqrt(k/I); its derivatives by k and by I.

    The tolerance is the integrator's: at 1e-5 a step it has order 2, and phases are right to 1e-3 after 1.4 periods.
    """
    names = ["string[0].torsional_stiffness", "string[1].inertia.axial"]
    found = series_of(pendulum(integrator), names, ["bit_speed"])
    t, w = found.times[found.times > RAMP], np.sqrt(STIFFNESS / INERTIA)
    slopes = found.slopes[found.times > RAMP, 0]
    a = np.sin(w * t) - np.sin(w * (t - RAMP))
    by_w = t * np.cos(w * t) - (t - RAMP) * np.cos(w * (t - RAMP))
    exact = -SPEED / RAMP * (by_w / w - a / w**2) * w / 2
    largest = np.abs(exact).max()
    assert slopes[:, 0] * STIFFNESS * LENGTH == pytest.approx(exact, abs=2e-3 * largest)
    assert slopes[:, 1] * INERTIA == pytest.approx(-exact, abs=2e-3 * largest)


@pytest.mark.parametrize("integrator", ["bdf", "generalized_alpha"])
def test_stick_slip_with_frozen_steps(integrator, tmp_path):
    """Five outputs by four keys, against differences of runs that take the same steps: 1e-4 of each derivative.

    The maximum is that before 4 s: with BDF two steps later on are equal to 2e-7, and the larger of two has a kink.
    """
    keys = "formation.bit_law.static,formation.bit_law.dynamic,string[0].torsional_stiffness,string[1].inertia.axial"
    of = "surface_torque.mean[2:8],surface_torque.rms,bit_speed.mean,bit_speed.rms[1:7],bit_speed.max[0:4]"
    question = Question("run", of.split(","), keys.split(","), check=4)
    run_sensitivities(Job(rock_bit(integrator), tmp_path / "r"), question)
    summary = json.loads((tmp_path / "r/summary.json").read_text())
    assert len(summary["checked"]) == 20
    assert max(c["error"] for c in summary["checked"]) < 1e-4
    assert min(abs(c["difference"]) for c in summary["checked"]) > 0
    assert summary["cost"].keys() == {"steps", "with_derivatives", "alone", "ratio"}


@pytest.mark.parametrize("integrator", ["bdf", "generalized_alpha"])
@pytest.mark.parametrize("name", WALL)
def test_wall_contact_with_frozen_steps(name, integrator):
    """Contact that slides, and contact that opens and closes: the history to 1e-4 of differences of runs with the same steps.

    The static start has its top on the wall, whose place moves with the diameter.  The step of the differences at which they are
    best depends on how near contacts are to opening: further ones are tried, and two of them extrapolated, while none is near enough.
    """
    top, degrees, end, collar, column, least = WALL[name]
    case = on_the_wall(integrator, end, np.radians(degrees), collar, **top)
    names, closed = ["well.sections[0].friction", "string[0].od", "gravity[2]"], []
    run = series_of(case, names, [column], watch=lambda r: closed.append(flags_of(r)))
    assert np.abs(np.diff(np.array(closed), axis=0)).sum() >= least
    assert np.sum(closed, axis=1).min() > 4
    for k, key in enumerate(key_of(case, n) for n in names):
        own, full = run.slopes[:, 0, k] * key.size, {}
        for step in (1e-5, 1e-4, 1e-6):
            sides = [
                series_of(key.changed(case, key.value + sign * step * key.size), [], [column], run.steps)
                for sign in (-1, 1)
            ]
            full[step] = (sides[1].values - sides[0].values)[:, 0] / (2 * step)
            among = [*full.values()]
            among += [
                (100 * full[small] - full[large]) / 99
                for large, small in ((1e-4, 1e-5), (1e-5, 1e-6))
                if {large, small} <= full.keys()
            ]
            gap = min(np.linalg.norm(own - q) / np.linalg.norm(q) for q in among)
            if gap < 1e-4:
                break
        assert gap < 1e-4


@pytest.mark.parametrize("integrator", ["bdf", "generalized_alpha"])
def test_wall_that_the_survey_moves(integrator):
    """A turned string on the wall of a bend: an inclination moves the hole by far more than the wall yields, and the string with it."""
    case = on_the_wall(integrator, 0.2, 1.0, {}, rotation=6.0, lowering=0.1)
    bend = {"md": [0, 30, 100], "inclination": [0, 0.1, 0.6], "azimuth": [0, 0, 0.2]}
    case = Case(**(case._given.keys | {"well": case._given.keys["well"] | {"survey": bend}}))
    columns, name = ["hook_load", "surface_torque"], "well.survey.inclination[2]"
    run, key, full = series_of(case, [name], columns), key_of(case, name), []
    for step in (3e-5, 1e-5, 3e-6):
        sides = [
            series_of(key.changed(case, key.value + sign * step), [], columns, run.steps).values
            for sign in (-1, 1)
        ]
        full.append((sides[1] - sides[0]) / (2 * step))
    best = np.min([np.abs(run.slopes[:, :, 0] - q).max(axis=0) for q in full], axis=0)
    assert run.flags == [""]
    assert (best < 1e-4 * np.abs(full[0]).max(axis=0)).all(), best


@pytest.mark.parametrize("integrator", ["bdf", "generalized_alpha"])
def test_a_key_does_not_know_of_the_others(integrator):
    """Derivatives to the last bit, whatever other keys there are and in whatever order."""
    top, degrees, end, collar, column, _ = WALL["turned"]
    case = on_the_wall(integrator, 0.5 * end, np.radians(degrees), collar, **top)
    names = ["well.sections[0].friction", "string[0].od", "top.rotation.value[1]"]
    every = series_of(case, names, [column])
    some = series_of(case, [names[2], names[1]], [column])
    assert np.array_equal(every.slopes[:, :, [2, 1]], some.slopes)


def test_a_start_with_a_kink_is_flagged(tmp_path):
    """Of two pipes of one diameter on the wall one gets thicker by more than the wall yields, as in statics.

    The effects of both sides are of runs with the same steps; the check leaves the key out.
    """
    pipe = {"kind": "pipe", "length": 30.0, "od": 0.127, "id": 0.1086, "element_length": 10.0}
    case = on_the_wall("bdf", 0.1, np.radians(60.0), {}, rotation=6.0)
    case = Case(**(case._given.keys | {"string": [pipe, pipe]}))
    keys = ["string[0].od", "well.sections[0].friction"]
    run_sensitivities(Job(case, tmp_path / "r"), Question("run", ["hook_load.mean"], keys, check=2))
    summary = json.loads((tmp_path / "r/summary.json").read_text())
    by_od, by_friction = summary["sensitivities"]
    assert by_od["flag"] == "one-sided" and by_friction["flag"] == ""
    assert by_od["effect_below"] is not None and by_od["effect_above"] is not None
    assert by_friction["effect_above"] is None
    assert [c["key"] for c in summary["checked"]] == ["well.sections[0].friction"]
    assert any("one-sided" in note for note in summary["notes"])
    words = [q.name for q in outputs_by_file()["sensitivities_history.csv"]]
    assert words == ["time", "OUTPUT", "OUTPUT by KEY"]
    titles = ["hook_load", *(f"hook_load by {key}" for key in keys)]
    table = read_table(tmp_path / "r/sensitivities_history.csv")
    assert list(table) == ["time [s]", *(f"{title} [N]" for title in titles)]


def test_all_keys_leave_out_what_cannot_be_followed(tmp_path):
    """The bore of a solid bit cannot change; named alone, it is refused."""
    case = Case(**(rock_bit("bdf")._given.keys | {"time": {"end": 0.2, "integrator": "bdf"}}))
    run_sensitivities(Job(case, tmp_path / "r"), Question("run", ["surface_torque.mean"], [], every=True))
    summary = json.loads((tmp_path / "r/summary.json").read_text())
    assert "can change a little" in summary["skipped"]["string[1].id"]
    found = {row["key"]: row for row in summary["sensitivities"]}
    assert len(found) > 30 and not set(found) & set(summary["skipped"])
    assert found["top.rotation.value[1]"]["relative"] == pytest.approx(1.0, abs=1e-3)
    assert found["formation.drillability"]["flag"] == "limit"
    with pytest.raises(CaseError) as error:
        run_sensitivities(Job(case, tmp_path / "s"), Question("run", [], ["string[1].id"]))
    assert error.value.got == "string[1].id" and "can change a little" in error.value.want


def test_chaos_has_no_number_and_a_warning(tmp_path):
    """A collar with an eccentricity of 20 mm that strikes the wall for 2 s: derivatives by its friction exceed any sense."""
    case = on_the_wall("bdf", 2.0, np.radians(5.0), {"eccentricity": 0.02}, rotation=15.0)
    of = ["surface_torque.mean", "surface_torque.mean[0:0.3]"]
    run_sensitivities(Job(case, tmp_path / "r"), Question("run", of, ["well.sections[0].friction"]))
    summary = json.loads((tmp_path / "r/summary.json").read_text())
    late, early = summary["sensitivities"]
    assert late["flag"] == "not determined" and late["derivative"] is None
    assert early["flag"] == "" and 0 < early["relative"] < 1
    assert len(summary["warnings"]) == 1 and "chaotic" in summary["warnings"][0]


def test_derivatives_that_the_steps_do_not_resolve_are_flagged(tmp_path):
    """A bit breaks loose and sticks in steps that are too long: flagged with both numbers.  Before it does, nothing is.

    Rows of the history have no part in an output.
    """
    keys = ["formation.bit_law.static"]
    of = ["bit_speed.max", "bit_speed.mean", "surface_torque.mean[0:1]", "hook_load.mean"]
    found = []
    for name, every in (("a", 0.1), ("b", 2.0)):
        case = Case(
            **(
                rock_bit("bdf")._given.keys
                | {"petsc": {"ts_rtol": "1e-2"}, "output": {"history_every": every}}
            )
        )
        run_sensitivities(Job(case, tmp_path / name), Question("run", of, keys))
        found.append(json.loads((tmp_path / name / "summary.json").read_text()))
    summary = found[0]
    flags = {row["output"]: row["flag"] for row in summary["sensitivities"]}
    assert "steps" in flags["bit_speed.mean"] and flags["surface_torque.mean[0:1]"] == ""
    assert not any("hook_load" in w for w in summary["warnings"])  # rounding of a torque has no effect on it
    assert any("bit_speed.mean" in w and "ts_rtol" in w for w in summary["warnings"])
    assert found[1]["sensitivities"] == summary["sensitivities"] and found[1]["outputs"] == summary["outputs"]


def test_smooth_motion_is_resolved(tmp_path):
    keys = ["string[0].torsional_stiffness", "string[1].inertia.axial"]
    of = ["bit_speed.mean[0.1:8]", "bit_speed.rms", "surface_torque.max"]
    run_sensitivities(Job(pendulum("generalized_alpha"), tmp_path / "r"), Question("run", of, keys))
    summary = json.loads((tmp_path / "r/summary.json").read_text())
    assert not summary["warnings"] and {row["flag"] for row in summary["sensitivities"]} == {""}


def test_a_key_without_effect_has_zero_and_a_word():
    case = pendulum("bdf", time={"end": 0.5})
    found = series_of(case, ["string[1].mass"], ["bit_speed"])
    assert np.abs(found.slopes).max() == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"time": None}, "end"),
    ],
)
def test_refusals(changes, said):
    """A run whose derivatives are not computed is refused by name."""
    with pytest.raises(CaseError) as error:
        RunOfCase(pendulum("bdf", **changes), PETSc.COMM_SELF)
    assert said in str(error.value)


def test_words_of_outputs():
    """Mean of a parabola by the trapezoidal rule of its rows; the largest value where it is; windows outside are refused."""
    t = np.linspace(0.0, 4.0, 401)
    values, slopes = t**2, np.stack([t, 2 * t], axis=1)
    (mean, largest) = parsed_outputs(["wob.mean[2:4]", "wob.max"], ["wob"], 4.0)
    value, slope = mean.of(t, values, slopes)
    assert value == pytest.approx(28 / 3, rel=1e-5)
    assert slope == pytest.approx([3.0, 6.0])
    assert largest.of(t, values, slopes)[1] == pytest.approx([4.0, 8.0])
    for word, said in (("wib", "wob"), ("wob.mean[2:9]", "0 to 4 s"), ("wob.median", "mean")):
        with pytest.raises(CaseError) as error:
            parsed_outputs([word], ["wob"], 4.0)
        assert said in str(error.value)


# ---------------------------------------------------------------------- joints and events
def test_joint_with_frozen_steps():
    """A body of 2 t that falls on the spring of a shock sub: hook load by spring and mass, 2e-5 of the largest."""
    pipe = {"kind": "pipe", "length": 5, "element_length": 5, "od": 0.1778, "id": 0.0714}
    sub = {
        "kind": "shock_sub",
        "od": 0.1778,
        "id": 0.0714,
        "length": 2.0,
        "joint_at": 0.5,
        "stiffness": 6e5,
        "damping": 5e3,
    }
    case = Case(
        string=[pipe, sub, pipe, {"kind": "body", "length": 0.5, "mass": 2000}],
        top="clamped",
        initial={"from": "rest", "imperfection": 0},
        time={"end": 0.4, "integrator": "bdf"},
        petsc={"ts_rtol": "1e-5"},
    )  # fmt: skip
    names = ["string[1].stiffness", "string[3].mass"]
    run = series_of(case, names, ["hook_load"])
    for k, key in enumerate(key_of(case, n) for n in names):
        low, high = (
            series_of(key.changed(case, key.value * (1 + sign * 1e-4)), [], ["hook_load"], run.steps).values
            for sign in (-1, 1)
        )
        own, full = run.slopes[:, 0, k] * key.size, (high - low)[:, 0] / 2e-4
        assert np.abs(own).max() > 5e4
        assert np.abs(own - full).max() < 2e-5 * np.abs(own).max()
    data = case._given.keys | {"time": {"end": 0.4, "integrator": "generalized_alpha"}}
    with pytest.raises(CaseError) as error:
        RunOfCase(Case(**data), PETSc.COMM_SELF)
    assert "time.integrator: bdf" in error.value.want


def test_jar_that_fires(tmp_path):
    """A body below a jar, m v' = W - h - c v from the latch's give W/k on; after the metering stroke s, at t*, it falls freely.

    Travel and mean force (W t - m v) by h, c and s before and after t*, differentiated by differences of the closed form; 1e-3 of the
    largest effect, which the formula's start after the event has at steps of 1e-4 s.
    """
    pipe = {"kind": "pipe", "length": 5, "element_length": 5, "od": 0.1778, "id": 0.0714}
    law = {"stroke": 0.1, "threshold": 1.5e4, "metering_resistance": 2e5, "metering_stroke": 0.02}
    jar = {"kind": "jar", "length": 2.0, "joint_at": 0.5, "od": 0.1778, "id": 0.0714, "jar": law}
    case = Case(
        string=[pipe, jar, pipe, {"kind": "body", "length": 0.5, "mass": 2000}],
        top="clamped",
        material={"young": 1e14, "density": 7850, "damping": {"stiffness": 1e-5}},
        time={"end": 0.38, "integrator": "bdf"},
        petsc={"ts_rtol": "1e-6"},
    )
    names = [f"string[1].jar.{name}" for name in ("threshold", "metering_resistance", "metering_stroke")]
    columns, end = ["jar_stroke", "joint_5.5_force"], 0.38
    run = series_of(case, names, columns)
    mass = 2000 + 7850 * np.pi / 4 * (0.1778**2 - 0.0714**2) * 6.5
    weight = mass * 9.80665

    def motion(p: FloatArray, t: FloatArray) -> tuple[FloatArray, float, float]:
        """Travel (m,) at t, time of the event and impulse of the force until then."""
        speed, lag = (weight - p[0]) / p[1], mass / p[1]
        travel = lambda s: weight / 1e9 + speed * (s - lag * (1 - np.exp(-s / lag)))  # noqa: E731
        event = brentq(lambda s: travel(s) - p[2], 0.01, 1.0)
        then = speed * (1 - np.exp(-event / lag))
        free = p[2] + then * (t - event) + 0.5 * 9.80665 * (t - event) ** 2
        return np.where(t < event, travel(t), free), event, weight * event - mass * then

    p = np.array([1.5e4, 2e5, 0.02])
    apart = np.abs(run.times - run.events[-1][0]) > 2e-4
    for k in range(3):
        step = 1e-4 * p[k] * np.eye(3)[k]
        sides = [motion(p + sign * step, run.times) for sign in (-1, 1)]
        travel, event, impulse = ((high - low) / 2e-4 for low, high in zip(*sides, strict=True))
        own = run.slopes[:, 0, k] * p[k]
        assert np.abs(own - travel)[apart].max() < 1e-3 * np.abs(travel).max()
        assert run.events[-1][1][k] * p[k] == pytest.approx(event, rel=1e-3)
        (mean,) = parsed_outputs(["joint_5.5_force.mean"], columns, end)
        _, slopes = mean.of(run.times, run.values[:, 1], run.slopes[:, 1], run.events)
        assert slopes[k] * p[k] == pytest.approx(impulse / end, rel=2e-3)
    with pytest.raises(CaseError) as error:
        run_sensitivities(Job(case, tmp_path / "r"), Question("run", ["jar_stroke.mean"], names, check=1))
    assert error.value.at == "--check"
