"""`roadmap --model stiff` and flowing mud in a roadmap (manual: verif-roadmap-stiff, verif-roadmap-flow)."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from drillpetsc import calibrate, load_case, roadmap, statics
from drillpetsc.analysis.loads.torque_drag.roadmap import run_roadmap
from drillpetsc.case.case import Case
from drillpetsc.errors import CaseError
from drillpetsc.output import read_table
from drillpetsc.output.job import Job
from tests.helpers.wells import newtonian, simple_well
from tests.verification.test_roadmap_command import INCLINE, PIPE, case, rows

EAGLE = Path(__file__).parents[2] / "cases" / "field" / "eagle.yaml"


def test_incline(tmp_path):
    """Straight 60 deg incline: w L (cos I + a mu sin I), torque mu w sin I R L; the beam's first and last metres do not lie on the
    wall as the soft string's do, which is worth less than 0.2 %."""
    made = case([0, 1000], [60, 60], roadmap=INCLINE | {"friction_factor": {"open_hole": [0.0, 0.3]}})
    found = rows(made, tmp_path, model="stiff")
    weight, along = 242e3, 121e3
    for mu in (0.0, 0.3):
        drag = mu * weight * np.sin(np.radians(60))
        expected = {
            "trip_out": along + drag,
            "trip_in": along - drag,
            "rotate_off_bottom": along,
            "drilling": along - 20e3,
            "sliding": along - drag - 20e3,
        }
        for operation, load in expected.items():
            row = found[operation, mu, 1000.0]
            assert row["status"] == "ok" and row["hook_load"] == pytest.approx(load, rel=2e-3), operation
        turning = found["rotate_off_bottom", mu, 1000.0]
        assert turning["surface_torque"] == pytest.approx(drag * 0.0635, rel=2e-3, abs=1e-2)
        assert turning["max_side_force_per_joint"] == pytest.approx(
            242 * np.sin(np.radians(60)) * 31 * 0.3048, rel=0.05
        )
        pushed = found["sliding", mu, 1000.0]
        assert pushed["min_effective_tension"] == pytest.approx(-20e3, rel=1e-2)


@pytest.mark.parametrize(
    "mud", [{}, {"fluid": {"density": 1200, "rheology": {"model": "newtonian", "viscosity": "20 cP"}}}]
)
def test_vertical_well(mud, tmp_path):
    """All operations and factors give the buoyed weight where nothing presses on the wall, at several bit depths; the stretch of
    a hanging pipe is w L^2/2EA."""
    plan = {"bit_depth": [300, 1000], "drilling": {"wob": 0, "tob": "1 kN m"}, "sliding": {"wob": 0}}
    made = case([0, 1500], [0, 0], roadmap=plan, **mud)
    found = rows(made, tmp_path, model="stiff")
    area = np.pi / 4 * (0.127**2 - 0.1086**2)
    weight = 242.0 - mud["fluid"]["density"] * 9.81 * area if mud else 242.0
    assert {row["status"] for row in found.values()} == {"ok"}
    for (_, _, depth), row in found.items():
        assert row["hook_load"] == pytest.approx(weight * depth, rel=1e-6)
        assert row["stretch"] == pytest.approx(weight * depth**2 / (2 * 206e9 * area), rel=1e-3)
    drilling = found["drilling", 0.3, 1000.0]
    polar = np.pi / 32 * (0.127**4 - 0.1086**4)
    assert drilling["surface_torque"] == pytest.approx(1e3, rel=1e-6)
    assert drilling["twist"] == pytest.approx(1e3 * 1000 * 2.6 / (206e9 * polar), rel=1e-2)


def test_soft_against_stiff_on_a_real_well(tmp_path):
    """Eagle with the bit at the shoe and at the end of the hole: where nothing buckles the soft string is within 2 % of the
    beam's hook load, and within 3 % of its torque (which it misses where the beam's stiffness lifts it off the wall)."""
    made = load_case(EAGLE)
    plan = {"bit_depth": ["4500 ft", "10317 ft"], "friction_factor": {"cased": [0.2], "open_hole": [0.3]}}
    result = roadmap(made.replace({"roadmap": plan}), tmp_path / "r", model="stiff")
    table = read_table(result.folder / "roadmap.csv")
    assert set(table["status [-]"]) == {"ok"} and len(table["status [-]"]) == 12
    found = result.summary["soft_against_stiff"]
    assert found["rows"] == 12 and found["hook_load"] < 0.02 and found["surface_torque"] < 0.03
    assert result.summary["model"] == "stiff" and result.summary["stiff_seconds"] > 0


def test_doglegs_smaller_than_the_clearance(tmp_path):
    """What parts soft string and beam: the soft string turns by every dogleg of the survey, the beam cuts those that fit into its
    clearance. A build to 40 deg whose inclinations err by 0.3 deg to either side at every second station (a swing of about 4 cm):
    the drag of trip_out is that of the soft string in a hole 1 mm wider than the pipe, and that of the well without errors in
    a hole of 44 mm clearance. Without errors both agree in either hole."""
    plan = {"bit_depth": [3000], "operations": ["trip_out"], "friction_factor": {"open_hole": [0.3]}}
    depths = np.arange(0.0, 3001.0, 30.0)
    smooth = np.interp(depths, [0, 500, 1700, 3000], [0, 0, 40, 40])
    errors = np.where(depths > 500, 0.3 * (-1.0) ** np.arange(depths.size), 0.0)

    def drag(inclination, diameter, model):
        sections = [{"kind": "open_hole", "diameter": diameter, "friction": 0.3}]
        made = case(depths.tolist(), inclination.tolist(), sections=sections, roadmap=plan)
        row = rows(made, tmp_path, model=model)["trip_out", 0.3, 3000.0]
        assert row["status"] == "ok"
        free = made.replace({"roadmap": plan | {"friction_factor": {"open_hole": [0.0]}}})
        return row["hook_load"] - rows(free, tmp_path)["trip_out", 0.0, 3000.0]["hook_load"]

    soft, soft_rough = drag(smooth, "216 mm", "soft"), drag(smooth + errors, "216 mm", "soft")
    wide, wide_rough = drag(smooth, "216 mm", "stiff"), drag(smooth + errors, "216 mm", "stiff")
    tight, tight_rough = drag(smooth, "129 mm", "stiff"), drag(smooth + errors, "129 mm", "stiff")
    assert wide == pytest.approx(soft, rel=1e-2) and tight == pytest.approx(soft, rel=1e-2)
    assert soft_rough > 1.05 * soft
    assert tight_rough == pytest.approx(soft_rough, rel=2e-2)
    assert wide_rough == pytest.approx(wide, rel=2e-2)


def test_rows_that_fail_are_marked(tmp_path):
    """A level hole of 2 km, mu 0.4: a string slid with 200 kN on the bit locks up; that row has no number and a reason, the
    others are there."""
    plan = {
        "operations": ["rotate_off_bottom", "sliding"],
        "bit_depth": [2000],
        "friction_factor": {"open_hole": [0.4]},
        "sliding": {"wob": "400 kN"},
    }
    made = case([0, 2000], [90, 90], roadmap=plan)
    result = run_roadmap(Job(made, tmp_path / "r"), model="stiff")
    table = read_table(result.folder / "roadmap.csv")
    ok = table["operation [-]"] == "rotate_off_bottom"
    assert (
        not table["status [-]"][ok][0].startswith("failed")
        and np.isfinite(table["surface_torque [N m]"][ok]).all()
    )
    assert table["status [-]"][~ok][0].startswith("failed: ")
    for name in ("hook_load [N]", "stretch [m]", "min_safety_factor [-]", "neutral_point [m]"):
        assert np.isnan(table[name][~ok]).all()
    assert any("sliding: failed" in line for line in result.summary["warnings"])


def test_refused(tmp_path):
    made = case([0, 1000], [0, 0], roadmap={"bit_depth": [500]})
    with pytest.raises(CaseError, match="soft or stiff"):
        roadmap(made, tmp_path / "r", model="rope")
    with pytest.raises(CaseError, match="ancf"):
        run_roadmap(
            Job(
                made.model_copy(
                    update={
                        "beam": Case(
                            string=[{**PIPE, "length": 1}], top="clamped", beam={"formulation": "quaternion"}
                        ).beam
                    }
                ),
                tmp_path / "r",
            ),
            model="stiff",
        )


def test_no_wall_and_a_string_that_floats(tmp_path):
    """Without contact the wall drags nothing: refused.  A pipe that floats has no row, and the reason."""
    plan = {"bit_depth": [200], "operations": ["trip_in"]}
    with pytest.raises(CaseError, match="contact"):
        run_roadmap(Job(case([0, 300], [0, 30], roadmap=plan, contact="none"), tmp_path / "r"), model="stiff")
    mud = {"density": 9000, "rheology": {"model": "newtonian", "viscosity": "20 cP"}}
    result = run_roadmap(Job(case([0, 300], [0, 30], roadmap=plan, fluid=mud), tmp_path / "f"), model="stiff")
    assert all("float" in s for s in read_table(result.folder / "roadmap.csv")["status [-]"])


FLOW, VISCOSITY, DENSITY = 0.02, 0.2, 1200.0
BIT = {"kind": "bit", "length": 0.3, "od": "215 mm", "id": "50 mm", "mass": 1.0, "nozzle_area": "6 cm^2"}


def flowing(**plan) -> Case:
    return Case(
        well=simple_well(1000, "215.9 mm", friction=0.3),
        string=[{**PIPE, "length": 999.7}, BIT],
        top={"kind": "top_drive"},
        gravity="9.81 m/s2",
        fluid=newtonian(DENSITY, VISCOSITY, bulk_modulus=1e14),
        roadmap={"bit_depth": [1000.0], "friction_factor": {"open_hole": [0.0]}, **plan},
    )


@pytest.mark.parametrize("model", ["soft", "stiff"])
def test_flow_in_a_vertical_well(model, tmp_path):
    """Laminar flow of a Newtonian mud in the annulus as a slot of height h: wall shear tau = 6 mu v/h (White, Fluid Mechanics, section
    4.10), pressure gradient 2 tau/h.  It lifts the pipe by tau pi D + A_o 2 tau/h per length, and the jets by rho Q^2/A_n.  Friction in
    the bore changes nothing."""
    still = rows(flowing(operations=["backreaming"]), tmp_path, model=model)
    flow = {"operations": ["backreaming"], "backreaming": {"flow_rate": FLOW}}
    pumped = rows(flowing(**flow), tmp_path, model=model)
    outer, hole = 0.127, 0.2159
    height = 0.5 * (hole - outer)
    section = np.pi / 4 * outer**2
    tau = 6 * VISCOSITY * FLOW / (np.pi / 4 * (hole**2 - outer**2)) / height
    lift = 999.7 * tau * (np.pi * outer + 2 * section / height) + DENSITY * FLOW**2 / 6e-4
    key = ("backreaming", 0.0, 1000.0)
    change = still[key]["hook_load"] - pumped[key]["hook_load"]
    assert change == pytest.approx(lift, rel=1e-2)
    margin = still[key]["overpull_margin"], pumped[key]["overpull_margin"]
    assert np.isnan(margin).all() or margin[0] != margin[1]


def test_flow_against_the_coupled_solution(tmp_path):
    """Eagle while it drills with 550 gpm, mud and beam solved together by `statics`: the soft string with the flow is within 0.7 % of
    that hook load; without it, 8 % above."""
    made = load_case(EAGLE)
    exact = statics(made, tmp_path / "s").summary["hook_load"]
    plan = {
        "operations": ["drilling"],
        "bit_depth": ["10317 ft"],
        "friction_factor": {"cased": [0.2], "open_hole": [0.3]},
        "drilling": {"wob": "25 klbf", "tob": "1770 ft-lbf", "rop": "0 ft/h", "flow_rate": "550 gpm"},
    }
    pumped = roadmap(made.replace({"roadmap": plan}), tmp_path / "r")
    load = float(read_table(pumped.folder / "roadmap.csv")["hook_load [N]"][0])
    assert load == pytest.approx(exact, rel=7e-3)
    plan["drilling"]["flow_rate"] = "0 gpm"
    still = roadmap(made.replace({"roadmap": plan}), tmp_path / "q")
    assert float(read_table(still.folder / "roadmap.csv")["hook_load [N]"][0]) > 1.06 * exact
    assert any("the mud stands still in drilling" in note for note in still.summary["notes"])
    plan["drilling"].pop("flow_rate")  # then it is that of the case, 550 gpm
    own = roadmap(made.replace({"roadmap": plan}), tmp_path / "o")
    assert float(read_table(own.folder / "roadmap.csv")["hook_load [N]"][0]) == load


def test_flow_that_cannot_be(tmp_path):
    """No mud: refused, with the key."""
    made = case([0, 1000], [0, 0], roadmap={"bit_depth": [500], "sliding": {"flow_rate": "600 gpm"}})
    with pytest.raises(CaseError, match="roadmap.sliding.flow_rate"):
        run_roadmap(Job(made, tmp_path / "r"))


def test_calibration_with_flowing_mud(tmp_path):
    """A reading at 20 l/s that a roadmap with that flow rate gives: the factor comes back; without the flow it does not."""
    made = load_case(EAGLE)
    plan = {
        "operations": ["sliding", "trip_out"],
        "bit_depth": ["8000 ft", "10317 ft"],
        "friction_factor": {"cased": [0.2], "open_hole": [0.27]},
        "sliding": {"wob": "10 klbf", "flow_rate": "550 gpm"},
    }
    folder = roadmap(made.replace({"roadmap": plan}), tmp_path / "r").folder
    table = read_table(folder / "roadmap.csv")
    lines = ["bit depth [m], operation, hook load [N], flow [l/s], wob [klbf]"]
    for i, operation in enumerate(table["operation [-]"]):
        flow = 34.69878 if operation == "sliding" else 0.0
        load = table["hook_load_total [N]"][i]
        lines.append(f"{table['bit_depth [m]'][i]}, {operation}, {load}, {flow}, 10")
    fitted = {}
    for name, text in (("with", lines), ("without", [line.replace("34.69878", "0") for line in lines])):
        (tmp_path / f"{name}.csv").write_text("\n".join(text))
        result = calibrate(made, tmp_path / name, measured=str(tmp_path / f"{name}.csv"), fit="open_hole")
        fitted[name] = result.summary["fit"]["open_hole"]["value"]
    assert fitted["with"] == pytest.approx(0.27, abs=2e-3)
    assert abs(fitted["without"] - 0.27) > 0.02


def test_a_stabilizer_in_the_build_is_no_load(tmp_path):
    """Eagle with its stabilizer in the build and a friction of 0.25: the string goes in by its weight, as the soft string's does.
    The chord of the rigid item had bent the short element below it with meganewtons, and the start of statics had locked up."""
    plan = {
        "operations": ["trip_in"],
        "bit_depth": ["802.42 m", "900.01 m"],
        "friction_factor": {"cased": [0.25], "open_hole": [0.375]},
    }
    result = roadmap(load_case(EAGLE).replace({"roadmap": plan}), tmp_path / "r", model="stiff")
    table = read_table(result.folder / "roadmap.csv")
    assert set(table["status [-]"]) == {"ok"}
    assert result.summary["soft_against_stiff"]["hook_load"] < 0.02
