"""A jar: waves after the shot, metering, triggers, re-cocking, time of the event (manual: sec-verif-jar)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from drillpetsc import Case, Jar, run
from drillpetsc.errors import CaseError
from drillpetsc.fem.string_mesh import JarLaw
from drillpetsc.model.drilling_model import build_model
from drillpetsc.output import read_table
from drillpetsc.physics.joints import Joints
from drillpetsc.physics.tools.jar import FREE, LATCHED, METERING
from drillpetsc.physics.tools.jar import Jar as Latch
from tests.helpers.tables import each_row

PIPE, COLLAR = {"od": 0.127, "id": 0.1086}, {"od": 0.1778, "id": 0.0714}
WAVE = np.sqrt(206e9 / 7850)
Z_PIPE, Z_COLLAR = (np.pi / 4 * (q["od"] ** 2 - q["id"] ** 2) * np.sqrt(206e9 * 7850) for q in (PIPE, COLLAR))


def jar(**keys: Any) -> dict:
    item = {key: keys.pop(key) for key in ("length", "element_length") if key in keys}
    law = {"stroke": 0.18, "threshold": 6e4} | keys
    return Jar(**({"length": 2.0, "joint_at": 0.5, **COLLAR} | item), jar=law)


def results(case: Case, folder: Path) -> tuple[dict[str, np.ndarray], dict]:
    """Columns of history.csv by name without unit, and the summary."""
    summary = run(case, folder / "run", progress="silent").summary
    table = read_table(folder / "run" / "history.csv")
    return {name.split(" [")[0]: values for name, values in table.items()}, summary


@pytest.mark.parametrize(
    ("pull", "stroke", "collars", "kind"),
    [(4e5, 0.18, 120.0, "bdf"), (2.5e5, 0.045, 80.0, "bdf"), (4e5, 0.18, 120.0, "alpha2")],
)
def test_waves_after_the_shot(pull, stroke, collars, kind, tmp_path: Path):
    """Drill pipe of 1500 m that is held, over collars, the part below the slider held by its mass; no gravity, no mud.

    The end of the collars steps by F/Z_c, and at each return of the wave by the reflection at the pipe towards F/Z_p:
    0.47765, 1.16448, 1.65828, 2.01330 m/s every 46.85 ms for 400 kN and 120 m. It hits when the integral of the speed is
    the stroke (153.155 ms), with a force that the collars take up: speed times Z_c (1685.995 kN). 3 %.
    """
    length = collars + 0.5
    data = {
        "string": [
            {"kind": "pipe", "length": 1500, "element_length": 2.0, **PIPE},
            {"kind": "pipe", "length": collars, "element_length": 2.0, **COLLAR},
            jar(stroke=stroke, element_length=0.5),
            {"kind": "body", "length": 0.1, "mass": 1e8, "inertia": {"axial": 1e6, "transverse": 1e6}},
        ],
        "top": "clamped",
        "bottom": {"kind": "force", "force": [0, 0, pull]},
        "gravity": 0.0,
        "initial": {"imperfection": 0.0},
        "time": {"end": 0.186 if stroke == 0.18 else 0.12},
        "output": {"history_every": 2.5e-4},
        "petsc": {"ts_type": kind, "ts_adapt_type": "none", "ts_dt": 2e-4},
    }
    found, summary = results(Case(**data), tmp_path)
    period, r = 2 * length / WAVE, (Z_COLLAR - Z_PIPE) / (Z_COLLAR + Z_PIPE)
    speeds = pull / Z_COLLAR + (pull / Z_PIPE - pull / Z_COLLAR) * (1 - r ** np.arange(7))
    if (pull, collars) == (4e5, 120.0):
        assert speeds[:4] == pytest.approx([0.47765, 1.16448, 1.65828, 2.01330], rel=2e-3)
    travelled = np.concatenate([[0.0], np.cumsum(speeds) * period])
    k = int(np.searchsorted(travelled, stroke)) - 1
    hit = k * period + (stroke - travelled[k]) / speeds[k]
    t, x = found["time"], found["jar_stroke"]
    for n in range(k + 1):
        begin, end = n * period + 4e-3, min((n + 1) * period, hit) - 4e-3
        if end - begin > 4e-3:
            at = np.interp([begin, end], t, x)
            assert (at[1] - at[0]) / (end - begin) == pytest.approx(speeds[n], rel=0.03)
    force = found["jar_impact_force"]
    after = t[np.argmax(force > 0.1 * speeds[k] * Z_COLLAR)]
    assert after == pytest.approx(hit, abs=6e-4)
    plateau = (t > hit + 2e-3) & (t < min((k + 1) * period, hit + 30e-3) - 3e-3)
    assert force[plateau].mean() == pytest.approx(speeds[k] * Z_COLLAR, rel=0.03)
    assert (found["jar_state"][0], found["jar_state"][-1]) == (0, 2)
    assert (found["jar_fired"][0], found["jar_fired"][-1]) == (0, 1)
    text = f"string[2] jar: at time 0 the load {pull / 1e3:g} kN lies beyond its latch: it fires at once"
    assert text in summary["warnings"]
    assert summary["energy"]["gained_share"] < 1e-3


def test_error_of_the_speeds_falls_with_mesh_and_step(tmp_path: Path):
    """C18 with elements of 16, 8 and 4 m and steps of 1.6, 0.8 and 0.4 ms: the largest error of the speeds between the waves falls at
    least 2.5-fold by halving both, order 2 but for the fronts, to less than 0.3 %."""
    pull, length, errors = 4e5, 120.5, []
    period, r = 2 * length / WAVE, (Z_COLLAR - Z_PIPE) / (Z_COLLAR + Z_PIPE)
    speeds = pull / Z_COLLAR + (pull / Z_PIPE - pull / Z_COLLAR) * (1 - r ** np.arange(3))
    for size in (16.0, 8.0, 4.0):
        data = {
            "string": [
                {"kind": "pipe", "length": 1500, "element_length": size, **PIPE},
                {"kind": "pipe", "length": 120.0, "element_length": size, **COLLAR},
                jar(stroke=0.18, element_length=0.5),
                {"kind": "body", "length": 0.1, "mass": 1e8, "inertia": {"axial": 1e6, "transverse": 1e6}},
            ],
            "top": "clamped",
            "bottom": {"kind": "force", "force": [0, 0, pull]},
            "gravity": 0.0,
            "initial": {"imperfection": 0.0},
            "time": {"end": 0.145},
            "output": {"history_every": 1e-3},
            "petsc": {"ts_adapt_type": "none", "ts_dt": size * 1e-4},
        }
        found, _ = results(Case(**data), tmp_path / f"{size:g}")
        spans = [(n * period + 8e-3, (n + 1) * period - 8e-3) for n in range(3)]
        at = [np.interp(span, found["time"], found["jar_stroke"]) for span in spans]
        mean = [(x[1] - x[0]) / (end - begin) for x, (begin, end) in zip(at, spans, strict=True)]
        errors.append(np.abs(np.array(mean) / speeds - 1).max())
    assert errors[0] > 2.5 * errors[1] > 2.5**2 * errors[2]
    assert errors[2] < 3e-3


def hanging(*items: dict, **keys: Any) -> Case:
    """A stiff short string with a body of 2 t below the jars."""
    pipe = {"kind": "pipe", "element_length": 5, **COLLAR}
    data = {
        "string": [
            {**pipe, "length": 5},
            *items,
            {**pipe, "length": 5},
            {"kind": "body", "length": 0.5, "mass": 2000},
        ],
        "top": "clamped",
        "time": {"end": 0.6},
        "output": {"history_every": 1e-3},
    }
    return Case(**(data | keys))


STEEL = 7850 * np.pi / 4 * (0.1778**2 - 0.0714**2)
WEIGHT = (2000 + STEEL * 6.5) * 9.80665


@pytest.mark.parametrize(
    ("threshold", "resistance", "metering", "kind"),
    [(1.5e4, 2e5, 0.02, "bdf"), (2e4, 1e5, 0.015, "bdf"), (1.5e4, 2e5, 0.02, "alpha2")],
)
def test_metering_takes_its_time(threshold, resistance, metering, kind, tmp_path: Path):
    """v = (F - threshold)/resistance under a weight; then the body falls freely by the rest of the stroke and hits."""
    found, summary = results(
        hanging(
            jar(threshold=threshold, metering_resistance=resistance, metering_stroke=metering, stroke=0.1),
            material={"damping": {"stiffness": 1e-5}},
            petsc={"ts_type": kind, "ts_rtol": 1e-5},
        ),
        tmp_path,
    )
    t, mode = found["time"], found["jar_state"]
    speed = (WEIGHT - threshold) / resistance
    free = t[np.argmax(mode == 2)]
    # the body takes mass/resistance to reach the speed
    assert free == pytest.approx(metering / speed + WEIGHT / 9.80665 / resistance, abs=1.5e-3)
    lag = WEIGHT / 9.80665 / resistance
    middle = (t > 0.3 * free) & (t < 0.9 * free)
    expected = speed * (t[middle] - lag * (1 - np.exp(-t[middle] / lag)))
    assert found["jar_stroke"][middle] == pytest.approx(expected, rel=0.02)
    g, rest = 9.80665, 0.1 - metering
    fall = (-speed + np.sqrt(speed**2 + 2 * g * rest)) / g
    assert t[np.argmax(found["jar_impact_force"] > 1e4)] == pytest.approx(free + fall, abs=4e-3)
    assert set(mode) == {0, 1, 2} and found["jar_fired"][-1] == 1
    before = t < free + fall - 5e-3  # the hit sends waves into the string that the time steps damp
    assert np.abs(found["energy_error"][before]).max() < 1e-3 * WEIGHT * 0.1
    assert summary["energy"]["gained_share"] < 2e-3
    assert "it meters at once" in " ".join(summary["warnings"])


def test_a_load_below_the_latch_does_nothing(tmp_path: Path):
    found, summary = results(hanging(jar(threshold=4e4), time={"end": 0.05}), tmp_path)
    assert set(found["jar_state"]) == {0} and found["jar_fired"][-1] == 0
    assert np.abs(found["jar_stroke"] - WEIGHT / 1e9).max() < 1e-6
    assert not any("jar" in line for line in summary["warnings"])


class Seen:
    """Figures of the joints when a law changes."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.numbers: list[np.ndarray] = []
        change = Joints.change_law

        def note(joints: Joints, numbers: np.ndarray) -> None:
            self.numbers.append(numbers)
            change(joints, numbers)

        monkeypatch.setattr(Joints, "change_law", note)


@pytest.mark.parametrize(
    ("direction", "sign", "kind"),
    [("up", 1.0, "bdf"), ("down", -1.0, "bdf"), ("both", -1.0, "bdf"), ("up", 1.0, "alpha2")],
)
def test_mechanical_jar_fires_at_its_trigger_and_cocks_again(
    direction, sign, kind, tmp_path: Path, monkeypatch
):
    """The load at the lower end grows, turns round, and grows again. The shot is located within 1e-6 s: the load is beyond the
    trigger by no more than its rate allows, with waves in the string ten times that of the input."""
    seen = Seen(monkeypatch)
    pipe = {"kind": "pipe", "element_length": 5, "length": 10, **COLLAR}
    load = {"time": [0, 0.2, 0.4, 0.6, 0.9], "value": [0.5, 1.5, -1.5, -0.2, 1.5]}
    case = Case(
        string=[
            pipe,
            jar(action="mechanical", threshold=None, trigger=1e5, stroke=0.02, direction=direction),
            pipe,
        ],
        top="clamped",
        gravity=0.0,
        loads=[{"at": 22.0, "force": [0, 0, sign * 1e5], "value_over": load}],
        initial={"imperfection": 0.0},
        material={"damping": {"stiffness": 1e-3}},
        time={"end": 0.9},
        output={"history_every": 1e-3},
        petsc={"ts_type": kind},
    )
    found, _ = results(case, tmp_path)
    first = seen.numbers[0]
    assert sign * first[2] == pytest.approx(1e5, abs=1e7 * 1e-6)
    assert found["jar_fired"].max() >= 2
    shot = found["time"][np.argmax(found["jar_fired"] > 0)]
    assert shot == pytest.approx(0.1, abs=4e-3)


LAW = JarLaw(threshold=6e4, metering=0.05, resistance=2e5, latch=1e8, up=True, down=True, item=0)


@each_row(("side", "beyond"), [(1.0, 0.0), (-1.0, 0.0), (1.0, 2e-5), (-1.0, -3e-5)])
def test_a_latch_that_holds_again_is_a_spring_about_its_place(side, beyond):
    """Where the pull fell to the threshold the slider has that force and no energy, beyond it a latch's."""
    place, load = side * 0.03, side * LAW.threshold
    latch = Latch(LAW, LATCHED, side, place, load)
    law, x = latch.slider(), place + beyond
    assert law["spring"] * x - law["preload"] == pytest.approx(load + LAW.latch * beyond, rel=1e-9)
    energy = (0.5 * law["spring"] * x - law["preload"]) * x + latch.at_latch
    assert energy == pytest.approx(load * beyond + 0.5 * LAW.latch * beyond**2, abs=1e-6)


@each_row("side", [1.0, -1.0])
def test_a_jar_meters_its_stroke_in_either_direction(side):
    latch, pull = Latch(LAW, METERING, side), side * 8e4
    assert not latch.passed(0.98 * side * LAW.metering, side * 0.1, pull)
    assert latch.passed(1.02 * side * LAW.metering, side * 0.1, pull)
    latch.switch(1.02 * side * LAW.metering, side * 0.1, pull)
    assert (latch.mode, latch.fired) == (FREE, 1)


def test_a_string_on_a_latch_that_holds_again_has_no_energy_in_it():
    """The strain energy of the joints with the slider at the place of the latch: the energy books begin there anew."""
    model = build_model(hanging(jar(threshold=1e4, metering_resistance=2e5, metering_stroke=0.05)))
    joints, asm = model.part(Joints), model.system.assembly
    assert joints is not None
    (latch,), place = joints.jars, 0.02
    latch.mode, latch.place, latch.load = LATCHED, place, latch.law.threshold
    joints.set_state(joints.get_state())
    model.beam.place(model.system, model.position, model.tangent)
    below = model.system.layout.dofs["string.position"][joints.joints[0].cell + 1 :]
    asm.x[below] += place * model.tangent[joints.joints[0].cell + 1 :]
    assert joints.element_results(asm)[0, joints.RESULTS.index("travel")] == pytest.approx(place)
    assert abs(joints.energies(0.0, asm).strain) < 1e-5 * latch.law.latch * place**2


@each_row(
    ("keys", "words"),
    [
        ({"threshold": None}, "a hydraulic jar needs it"),
        ({"action": "mechanical", "threshold": None}, "a mechanical jar needs it"),
        ({"action": "mechanical", "trigger": 1e5}, "no threshold for a mechanical jar"),
        ({"metering_stroke": 0.05}, "a resistance together with a metering_stroke"),
        ({"metering_stroke": 0.2, "metering_resistance": 1e6}, "below the stroke"),
    ],
)
def test_bad_jars_are_refused(keys, words):
    with pytest.raises(CaseError, match=words):
        hanging(jar(**keys))


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"time": {"end": 1.0, "mode": "quasi_static"}}, "dynamic with a jar"),
        ({"petsc": {"ts_type": "arkimex"}}, "genalpha with a jar"),
    ],
)
def test_runs_that_do_not_locate_the_shot_are_refused(keys, words):
    with pytest.raises(CaseError, match=words):
        hanging(jar(), **keys)
