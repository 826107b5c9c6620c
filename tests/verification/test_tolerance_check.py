"""Classes of motion, and the check of a run against a finer tolerance (manual: verif-tolerance-check)."""

from __future__ import annotations

import json

import numpy as np
import pytest

from drillpetsc import Case, run
from drillpetsc.errors import CaseError
from drillpetsc.model.drilling_model import build_model
from drillpetsc.output.measured.motion_classes import MotionClasses, changed_classes
from drillpetsc.studies.convergence.fine_tolerance import (
    FOLDER,
    LIMIT,
    add_tolerance_check,
    compared,
    tolerance_lines,
)

HOLE, GAUGE, SPIN, STEP = 0.2159, 0.2, 10.0, 1e-3
TOUCHING = 0.5 * (HOLE - GAUGE) + 1e-5  # offset of the axis of a stabilizer at the wall [m]


def stabilized(survey=None) -> Case:
    return Case(
        well={
            "survey": survey or {"md": [0, 21], "inclination": [0, 0], "azimuth": [0, 0]},
            "sections": [{"to": 21, "kind": "open_hole", "diameter": HOLE, "friction": 0.3}],
        },
        string=[
            {"kind": "pipe", "length": 10, "od": 0.127, "id": 0.0714, "element_length": 5},
            {"kind": "stabilizer", "name": "blades", "length": 1, "od": GAUGE, "id": 0.0714, "mass": 100},
            {"kind": "pipe", "length": 9, "od": 0.127, "id": 0.0714, "element_length": 4.5},
        ],
        top={"kind": "top_drive", "rotation": SPIN},
        time={"end": 1},
    )


#: offset [m], whirl rate [rad/s], spin rate [rad/s] -> classes
MOTIONS = {
    "synchronous": (TOUCHING, SPIN, SPIN, "at the wall", "sliding", "forward whirl"),
    "pure rolling": (
        TOUCHING, -SPIN * 0.5 * GAUGE / TOUCHING, SPIN, "at the wall", "rolling", "backward whirl",
    ),
    "turning in place": (TOUCHING, 0.0, SPIN, "at the wall", "sliding", "no whirl"),
    "at rest": (TOUCHING, 0.0, 0.0, "at the wall", "sticking", "no whirl"),
    "counter-clockwise": (TOUCHING, -SPIN, -SPIN, "at the wall", "sliding", "forward whirl"),
    "in mid-hole": (0.3 * TOUCHING, -2 * SPIN, SPIN, "off the wall", None, "backward whirl"),
}  # fmt: skip


@pytest.mark.parametrize("inclination", [0.0, 1.0])
@pytest.mark.parametrize("name", MOTIONS)
def test_classes_of_motions_with_known_kinematics(name, inclination):
    """A stabilizer is led on a circle in a vertical and in an inclined hole: pure rolling is a whirl of -w R/e
    (R its radius, e its offset), which has no slip at the wall."""
    offset, whirl, spin, contact, sliding, word = MOTIONS[name]
    survey = {"md": [0, 21], "inclination": [inclination] * 2, "azimuth": [0.5, 0.5]}
    model = build_model(stabilized(survey))
    system, well = model.system, model.well
    centres, tangents, _ = well.at(np.asarray(model.mesh.node_depth))
    first = np.cross(tangents[0], [0.3, 0.5, 0.1])
    first /= np.linalg.norm(first)
    second = np.cross(tangents[0], first)  # clockwise from the first one, looking down
    classes = MotionClasses(model, 0.0)
    system.set_field("string.tangent", tangents)
    system.set_field("string.spin", np.full((model.mesh.nodes, 1), spin), "y")
    for k in range(int(2 * 2 * np.pi / SPIN / STEP)):
        angle = whirl * k * STEP
        direction = np.cos(angle) * first + np.sin(angle) * second
        system.set_field("string.position", centres + offset * direction)
        classes.step(k * STEP, STEP)
    part = next(p for p in classes.summary() if p["name"] == "blades")
    assert part["contact"] == contact
    assert part.get("sliding") == sliding
    assert part["whirl"] == word
    if spin:
        assert part["whirl_ratio"] == pytest.approx(whirl / spin, rel=1e-3, abs=1e-9)


@pytest.mark.parametrize(
    ("rates", "word"),
    [
        (lambda t: SPIN + 0 * t, "turns"),
        (lambda t: SPIN * np.maximum(0.0, np.sin(10 * t)), "sticks at times"),
        (lambda t: SPIN * (0.3 + np.sin(10 * t)), "turns backward at times"),
        (lambda t: 0 * t, "does not turn"),
    ],
)
def test_classes_of_rotation(rates, word):
    """The lower end at given spin rates."""
    model = build_model(stabilized())
    classes = MotionClasses(model, 0.0)
    for t in np.arange(0.0, 2.0, 0.005):
        model.system.set_field("string.spin", np.full((model.mesh.nodes, 1), float(rates(t))), "y")
        classes.step(t, 0.005)
    assert classes.summary()[-1]["rotation"] == word


def test_only_clear_changes_of_class_count():
    """Another word is a change where its number has moved, not where it lies at the limit in both runs."""
    part = {
        "name": "blades",
        "md [m]": 5.0,
        "contact": "at the wall",
        "contact_share": 0.901,
        "whirl": "no whirl",
    }
    part |= {"whirl_ratio": 0.0}
    near = part | {"contact": "bouncing", "contact_share": 0.899}
    far = part | {"contact": "bouncing", "contact_share": 0.5, "whirl": "backward whirl", "whirl_ratio": -3.0}
    assert changed_classes([part], [part]) == []
    assert changed_classes([part], [near]) == []
    assert [c["what"] for c in changed_classes([part], [far])] == ["contact", "whirl"]
    assert changed_classes([part], [far])[1] == {
        "name": "blades",
        "md [m]": 5.0,
        "what": "whirl",
        "was": "no whirl",
        "is": "backward whirl",
    }


def test_columns_are_compared_by_mean_and_range():
    """A wave of twice the amplitude and another mean; a load that hardly moves is measured by its size."""
    t = np.linspace(0, 2, 201)
    wave = np.sin(2 * np.pi * t)
    fine = {"time [s]": t, "bit_speed [rad/s]": wave, "hook_load [N]": 1e6 + wave}
    run_ = {"time [s]": t, "bit_speed [rad/s]": 0.1 + 2 * wave, "hook_load [N]": 1e6 + 2 * wave + 1}
    columns = compared(run_, fine)
    assert columns["bit_speed [rad/s]"]["mean"] == pytest.approx(0.05)
    assert columns["bit_speed [rad/s]"]["range_change"] == pytest.approx(1.0)
    assert columns["hook_load [N]"]["mean"] == pytest.approx(1e-3, rel=1e-4)
    assert columns["hook_load [N]"]["range_change"] == pytest.approx(2e-3, rel=1e-4)


def disc(**petsc) -> Case:
    """A disc on a shaft whose top starts to turn: vibration at 31.6 rad/s about the mean rotation."""
    return Case(
        string=[
            {
                "kind": "beam",
                "length": 1,
                "axial_stiffness": 1e6,
                "bending_stiffness": 1e4,
                "torsional_stiffness": 2000,
                "mass": 1,
                "polar_inertia": 1e-9,
                "element_length": 1,
            },
            {"kind": "body", "length": 0.1, "mass": 10, "inertia": {"axial": 2, "transverse": 1}},
        ],
        top={"kind": "top_drive", "rotation": {"ramp": 0.1, "value": 5.0}},
        bottom="free",
        gravity=0,
        time={"end": 1.5},
        output={"history_every": 0.02},
        petsc=petsc,
    )


@pytest.mark.parametrize(("tolerance", "fine_enough"), [(5e-2, False), (1e-5, True)])
def test_a_run_is_repeated_at_a_tenth_of_its_tolerance(tmp_path, tolerance, fine_enough):
    """Warned of at 5e-2, where the vibration is damped; not at 1e-5.  Summary, warnings and lines agree, and the
    range of the speed is nearer to that of the closed form in the fine run."""
    case, out = disc(ts_rtol=tolerance), tmp_path / "out"
    coarse = run(case, out, progress="silent", watch_motion=True)
    summary = add_tolerance_check(case, out, coarse.summary, "disc")
    written = json.loads((out / "summary.json").read_text(encoding="utf-8"))
    check = written["error_estimate"]["tolerance"]
    fine = json.loads((out / FOLDER / "summary.json").read_text(encoding="utf-8"))
    assert float(fine["petsc_options"]["ts_rtol"]) == pytest.approx(tolerance / 10)
    assert fine["steps"] == check["steps"] > coarse.summary["steps"]
    assert check["columns"]["bit_speed [rad/s]"]["range"] > 0
    assert bool(check["warnings"]) != fine_enough
    assert written["warnings"] == summary["warnings"] == [*coarse.summary["warnings"], *check["warnings"]]
    text = "\n".join(tolerance_lines(summary))
    assert ("not fine enough" in text) != fine_enough
    if not fine_enough:
        speed = check["columns"]["bit_speed [rad/s]"]
        assert max(speed["mean"], speed["range_change"]) > LIMIT


def test_fixed_steps_are_refined_so_that_the_local_error_is_a_tenth(tmp_path):
    """Steps of 1/10^(1/3), also where options of the command line would override the case."""
    from petsc4py import PETSc

    case, out = disc(), tmp_path / "out"
    options = PETSc.Options()
    options.setValue("ts_adapt_type", "none")
    options.setValue("ts_dt", "0.01")
    try:
        coarse = run(case, out, progress="silent", watch_motion=True)
        add_tolerance_check(case, out, coarse.summary, "disc")
        assert float(options.getReal("ts_dt")) == 0.01
        assert not options.hasName("ts_rtol")
    finally:
        options.delValue("ts_adapt_type")
        options.delValue("ts_dt")
    fine = json.loads((out / FOLDER / "summary.json").read_text(encoding="utf-8"))
    assert fine["steps"] / coarse.summary["steps"] == pytest.approx(10 ** (1 / 3), rel=0.05)


def test_restart_is_refused(tmp_path):
    """The classes of a continued run would be those of its last part."""
    with pytest.raises(CaseError, match="--check-tolerance"):
        run(disc(), tmp_path / "out", restart=True, watch_motion=True)
