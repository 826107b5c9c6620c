"""`calibrate` with the beam, with numbers of the case, and the readings that it proposes; synthetic points of known parameters."""

from __future__ import annotations

import sys
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from petsc4py import PETSc

from drillpetsc.analysis.loads.torque_drag.readings.calibrate import Choices, run_calibrate
from drillpetsc.analysis.loads.torque_drag.readings.calibration import Calibration
from drillpetsc.analysis.loads.torque_drag.readings.forward_stiff import StiffForward
from drillpetsc.analysis.loads.torque_drag.readings.next_reading import next_readings
from drillpetsc.case.blocks.roadmap import MeasuredPoint
from drillpetsc.case.options.measured_option import fit_option, prior_option
from drillpetsc.errors import CaseError
from drillpetsc.output.job import Job
from tests.verification.test_calibrate_command import (
    BLOCK,
    TRUTH,
    case,
    synthetic,
)

sys.path.insert(0, str(Path(__file__).parents[2] / "scripts" / "tools"))
import twin_calibration as twin  # noqa: E402

MUD = {"fluid": {"density": "1200 kg/m3", "rheology": {"model": "newtonian", "viscosity": "20 cP"}}}
BEAM = partial(StiffForward, comm=PETSc.COMM_SELF)
SOME = (800, 1900, 2860)


def coarse(**keys):
    """The J-well with elements of 20 m."""
    return case(**keys).replace({"string[0].element_length": "20 m"})


def test_density_of_the_mud_comes_back():
    """A density of 1300 kg/m3 where the case says 1200: pipe that weighs 242 N/m in air weighs rho g A less in mud."""
    area = np.pi / 4 * (0.127**2 - 0.1086**2)
    points = synthetic(weight=242.0 - 1300 * 9.81 * area, block=BLOCK)
    names = ("cased", "open_hole", "block_weight", "fluid.density")
    fit = Calibration(case(**MUD), points).fit(names)
    assert not fit.reasons
    assert fit.value == pytest.approx([*TRUTH.values(), BLOCK, 1300.0], rel=5e-3)


def test_beam_in_place_of_the_soft_string():
    """Points of a soft string, an integration of its own, in a smooth hole: the beam's factors differ by its ends and clearance only.

    Its tangents are the differences of full solutions."""
    work = Calibration(coarse(), synthetic(depths=SOME), forward=BEAM)
    fit = work.fit(("cased", "open_hole"))
    assert dict(zip(fit.parameters, fit.value, strict=True)) == pytest.approx(TRUTH, abs=5e-3)
    h = 1e-3
    for k, name in enumerate(TRUTH):
        sides = [{**fit.best, name: fit.best[name] + q} for q in (h, -h)]
        full = np.subtract(*work.computed(sides)) / (2 * h)
        slope = work.slopes(fit.best, tuple(TRUTH))[k]
        assert np.abs(slope - full).max() < 1e-3 * np.abs(full).max()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("model", "seeds", "depths"), [("soft", 20, twin.DEPTHS), ("stiff", 1, (500.0, 1500.0, 2390.0))]
)
def test_twin(model, seeds, depths):
    """Five parameters: nearly all intervals hold the truth; nearly none would if errors were twice as large as the intervals say.

    Of independent intervals 95 % hold; of 100, fewer than 88 do with a probability of 0.4 %, of 5 fewer than 3 with 0.1 %."""
    ratio = twin.Twin(model, depths).errors(range(seeds))
    held = (np.abs(ratio) <= 1).mean()
    assert held >= (0.88 if model == "soft" else 0.6)
    assert np.abs(ratio).mean() == pytest.approx(0.40, abs=0.1 if model == "soft" else 0.3)


OPEN = ("cased", "open_hole"), (1200, 1400, 1520)  # 20 m of open hole
WEIGHTS = ("block_weight", "weight_factor", "open_hole"), (2860,)  # a block is as good as heavier pipe


@pytest.mark.parametrize(("names", "depths"), [OPEN, WEIGHTS])
def test_proposed_readings_determine(names, depths):
    """Points that leave a parameter open, with 3 kN of noise. The readings that are proposed, added, determine it.

    The interval is at least as narrow as expected: the noise is less than the errors that are assumed."""
    known = case(rig={"block_weight": "90 kN"}).replace({"well.sections[0].friction": TRUTH["cased"]})
    points = synthetic(depths=depths, block=BLOCK, noise=3e3)
    names = (*names, "block_weight") if "block_weight" not in names else names
    work = Calibration(known, points)
    fit = work.fit(names)
    assert fit.reasons and set(fit.reasons) < set(names) | {"block_weight"}
    found = next_readings(work, fit)
    assert 1 <= len(found) <= 6
    off_bottom = {"trip_in", "trip_out", "rotate_off_bottom"}  # without an unknown load on the bit
    assert {q.operation for q in found} <= off_bottom
    new = sorted({int(q.bit_depth) for q in found} | set(depths))
    every = {(p.operation, p.bit_depth): p for p in synthetic(depths=new, block=BLOCK)}
    more = tuple(
        every[q.operation, q.bit_depth].model_copy(
            update={"torque": None} if q.key == "hook_load" else {"hook_load": None}
        )
        for q in found
    )
    again = Calibration(known, (*points, *more)).fit(names)
    assert not again.reasons
    width = dict(zip(again.parameters, again.interval, strict=True))
    for name, expected in found[-1].widths.items():
        assert width[name] < 1.2 * expected


def test_no_reading_is_proposed_in_vain():
    """Where all is determined nothing is missing; no reading finds the friction of a section that the well does not have."""
    work = Calibration(case(), synthetic(depths=SOME))
    assert next_readings(work, work.fit(("cased", "open_hole"))) == []
    bare = case().replace({"well.sections": [{"kind": "open_hole", "diameter": "215.9 mm"}]})
    work = Calibration(bare, synthetic(depths=SOME))
    fit = work.fit(("cased", "open_hole"))
    assert "no such section" in fit.reasons["cased"] and next_readings(work, fit) == []


def test_files_of_the_beam(tmp_path):
    """Model, friction of each reading alone by the tangent, points held out, and the proposed readings in the files."""
    from drillpetsc.output import read_table

    choices = Choices(("cased", "open_hole"), hold_out="2000 m", model="stiff")
    result = run_calibrate(Job(coarse(), tmp_path / "c"), synthetic(depths=(800, 1900, 2200)), choices)
    assert result.summary["model"] == "stiff" and result.summary["next_readings"] == []
    assert result.summary["hold_out"]["hook_load"]["rms"] < 5e-3
    table = read_table(tmp_path / "c" / "calibration.csv")
    deep = (table["part [-]"] == "fitted") & (table["bit_depth [m]"] == 1900)
    alone = table["ff_open_hole_alone [-]"][deep]
    assert alone[np.isfinite(alone)] == pytest.approx(TRUTH["open_hole"], abs=0.02)
    assert any("beam in static equilibrium" in line for line in result.lines)


BAD = [
    ("fluid.densty", {}, "--fit"),
    ("string[0].kind", {}, "--fit"),
    ("mesh.element_length", {}, "--fit"),
    ("cased", {"fluid.density": (1200.0, 10.0)}, "--prior"),
]


@pytest.mark.parametrize(("name", "priors", "at"), BAD)
def test_bad_parameters_are_named(name, priors, at, tmp_path):
    with pytest.raises(CaseError, match=at):
        run_calibrate(Job(case(**MUD), tmp_path / "c"), synthetic(), Choices((name,), priors=priors))


def test_beam_refuses_by_name(tmp_path):
    """A level of mud in the string, for which the beam has no answer."""
    fluid = MUD["fluid"] | {"level_in_string": "100 m"}
    plugged = {"bottom": {"kind": "free", "plugged": True}}
    with pytest.raises(CaseError, match="--model"):
        run_calibrate(Job(case(fluid=fluid, **plugged), tmp_path / "c"), synthetic(), Choices(model="stiff"))


def test_point_without_a_state_is_named(tmp_path):
    """Pipe of 1100 kg/m3 floats in its mud: the soft string pulls it down, the beam has no state."""
    floating = case(**MUD).replace({"string[0].material.density": "1100 kg/m3"})
    with pytest.raises(CaseError, match=r"measured\[0\]"):
        run_calibrate(Job(floating, tmp_path / "c"), synthetic(), Choices(model="stiff"))


def test_options():
    """Paths are parameters, with priors in their units; words that are neither are refused."""
    made = case(**MUD)
    assert fit_option("cased, fluid.density", made) == ("cased", "fluid.density")
    assert prior_option(["fluid.density=1.3 g/cm3+-20 kg/m3"]) == {
        "fluid.density": (pytest.approx(1300.0), pytest.approx(20.0))
    }
    with pytest.raises(CaseError, match="--fit"):
        fit_option("cased,density", made)


def test_number_without_effect():
    """The roadmap's weight on bit changes no reading of a trip."""
    made = case(roadmap={"drilling": {"wob": "50 kN"}})
    fit = Calibration(made, synthetic(depths=SOME)).fit(("cased", "roadmap.drilling.wob"))
    assert "change no reading" in fit.reasons["roadmap.drilling.wob"]
    point = MeasuredPoint(bit_depth=2000, operation="drilling", hook_load=4e5)
    assert not Calibration(made, (*synthetic(depths=SOME), point))._numbers_without_effect(
        ("roadmap.drilling.wob",)
    )
