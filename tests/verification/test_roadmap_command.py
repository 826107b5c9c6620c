"""`roadmap`: closed forms of the soft string through a case (manual: sec-verif-statics-torque-drag)."""

from __future__ import annotations

import json
import time

import numpy as np
import pytest

from drillpetsc.analysis.loads.torque_drag.roadmap import run_roadmap
from drillpetsc.case.case import Case
from drillpetsc.errors import CaseError
from drillpetsc.output import read_table
from drillpetsc.output.job import Job
from tests.helpers.tables import each_row

# 127 x 108.6 mm pipe whose density gives 242 N/m
PIPE = {"kind": "pipe", "od": "127 mm", "id": "108.6 mm", "material": {"density": "7245.416608 kg/m3"}}


def case(md, inclination, friction=0.3, length=None, item=PIPE, above=(), sections=None, **keys):
    """A case in a hole of 215.9 mm; angles in degrees."""
    sections = sections or [{"kind": "open_hole", "diameter": "215.9 mm", "friction": friction}]
    survey = {"md": md, "inclination": [f"{a} deg" for a in inclination], "azimuth": ["0 deg"] * len(md)}
    well = {"survey": survey, "sections": sections}
    return Case(
        title="closed form",
        well=well,
        string=[*above, {**item, "length": length or md[-1]}],
        top="clamped",
        gravity="9.81 m/s2",
        **keys,
    )


def rows(c, folder, **options):
    """{(operation, ff_open_hole, bit depth): row} of a roadmap."""
    result = run_roadmap(Job(c, folder / "out", overwrite=True), **options)
    table = read_table(result.folder / "roadmap.csv")
    names = {title: title.split(" [")[0] for title in table}
    out = {}
    for i in range(len(table["bit_depth [m]"])):
        row = {names[t]: table[t][i] for t in table}
        out[row["operation"], round(float(row["ff_open_hole"]), 6), float(row["bit_depth"])] = row
    return out


INCLINE = {
    "bit_depth": [1000],
    "friction_factor": {"open_hole": [0.2, 0.3, 0.4]},
    "drilling": {"wob": "20 kN", "tob": 0, "rop": 0},
    "sliding": {"wob": "20 kN", "tob": 0},
}


def test_incline(tmp_path):
    """w L (cos I + a mu sin I), less the weight on bit; torque mu w sin I R L, at I = 60 deg."""
    found = rows(case([0, 1000], [60, 60], roadmap=INCLINE), tmp_path)
    hook = {key[:2]: row["hook_load"] for key, row in found.items()}
    expected = {
        ("trip_out", 0.3): 183.873e3,
        ("trip_in", 0.3): 58.127e3,
        ("rotate_off_bottom", 0.3): 121e3,
        ("trip_out", 0.2): 162.916e3,
        ("trip_in", 0.2): 79.084e3,
        ("trip_out", 0.4): 204.831e3,
        ("trip_in", 0.4): 37.169e3,
        ("drilling", 0.3): 101e3,
        ("sliding", 0.3): 38.127e3,
    }
    assert {key: hook[key] for key in expected} == pytest.approx(expected, rel=2e-5)
    assert found["rotate_off_bottom", 0.3, 1000]["surface_torque"] == pytest.approx(3992.5, rel=2e-5)
    assert found["drilling", 0.3, 1000]["surface_torque"] == pytest.approx(3992.5, rel=2e-5)
    assert found["trip_out", 0.3, 1000]["surface_torque"] == 0
    assert found["trip_out", 0.3, 1000]["stretch"] == pytest.approx(
        183.873e3 * 1000 / 2 / 7.0137489e8, rel=2e-5
    )
    assert found["rotate_off_bottom", 0.3, 1000]["twist"] == pytest.approx(
        3992.5 * 1000 / 2 / 9.4156072e5, rel=1e-4
    )
    side = 242 * np.sin(np.pi / 3) * 31 * 0.3048
    assert found["trip_in", 0.3, 1000]["max_side_force_per_joint"] == pytest.approx(side, rel=1e-5)
    assert {row["status"] for row in found.values()} == {"ok"}


def test_block_weight_adds_to_the_total_alone(tmp_path):
    plain = rows(case([0, 1000], [60, 60], roadmap=INCLINE), tmp_path)
    with_block = rows(case([0, 1000], [60, 60], roadmap=INCLINE, rig={"block_weight": "100 kN"}), tmp_path)
    for key, row in with_block.items():
        assert row["hook_load"] == plain[key]["hook_load"]
        assert row["hook_load_total"] == row["hook_load"] + 100e3
    assert "hook_load_total" not in plain["trip_in", 0.3, 1000]


def test_hoisting_with_rotation(tmp_path):
    """0.3 m/s and 60 rpm: shares 0.600978 and 0.799265 of the friction, 158.786 kN and 3191.0 N m."""
    roadmap = {
        "operations": ["backreaming"],
        "bit_depth": 1000,
        "friction_factor": {"open_hole": 0.3},
        "backreaming": {"speed": "0.3 m/s", "rpm": "60 rpm", "tob": 0},
    }
    row = rows(case([0, 1000], [60, 60], roadmap=roadmap), tmp_path)["backreaming", 0.3, 1000]
    assert row["hook_load"] == pytest.approx(158.786e3, rel=1e-5)
    assert row["surface_torque"] == pytest.approx(3191.0, rel=2e-5)


def test_vertical_well(tmp_path):
    """No wall force: every operation and factor has the buoyed weight, here 242 N/m less mud of 1200 kg/m3."""
    roadmap = {"friction_factor": {"open_hole": [0.1, 0.5]}, "drilling": {"wob": 0}, "sliding": {"wob": 0}}
    mud = {"density": 1200, "rheology": {"model": "newtonian", "viscosity": "20 cP"}}
    found = rows(case([0, 2000], [0, 0], roadmap=roadmap, fluid=mud), tmp_path)
    metal = np.pi / 4 * (0.127**2 - 0.1086**2)
    for (_, _, depth), row in found.items():
        assert row["hook_load"] == pytest.approx((7245.416608 - 1200) * metal * 9.81 * depth, rel=1e-9)
        assert row["buckling_state"] == "none" and row["max_side_force_per_joint"] == 0
        assert row["neutral_point"] == pytest.approx(depth)


def test_neutral_point_of_a_vertical_string(tmp_path):
    """The weight below the neutral point is the weight on bit: 10 kN at 242 N/m are 41.322 m."""
    roadmap = {"operations": ["drilling"], "bit_depth": [500, 2000], "drilling": {"wob": "10 kN"}}
    found = rows(case([0, 2000], [0, 0], roadmap=roadmap), tmp_path)
    for (_, _, depth), row in found.items():
        assert row["neutral_point"] == pytest.approx(depth - 10e3 / 242, abs=1e-6)
        assert row["min_effective_tension"] == pytest.approx(-10e3) and row["md_of_min"] == depth


def test_j_well(tmp_path):
    """1000 m vertical, 60 deg at 1360 m, 2860 m: integration of the soft string's equation (manual: verif-j-well)."""
    roadmap = {
        "operations": ["pickup", "slackoff", "rob"],
        "bit_depth": [2860],
        "friction_factor": {"open_hole": 0.25},
    }
    found = rows(case([0, 1000, 1360, 2860], [0, 0, 60, 60], roadmap=roadmap), tmp_path)
    hook = {key[0]: row["hook_load"] for key, row in found.items()}
    expected = {"trip_out": 648.808e3, "trip_in": 394.217e3, "rotate_off_bottom": 495.548e3}
    assert hook == pytest.approx(expected, rel=1e-5)
    assert found["rotate_off_bottom", 0.25, 2860]["surface_torque"] == pytest.approx(7884.9, rel=2e-5)


# Wicks, Wardle and Pafitis (SPE 116194) as in the limits of the project's reference data: od 140, id 116, hole 222 mm
WICKS = {
    "kind": "beam",
    "axial_stiffness": "1e9 N",
    "bending_stiffness": f"{207e9 * 9.97e-6} N m^2",
    "torsional_stiffness": "1e6 N m^2",
    "mass": f"{315 / 9.81} kg/m",
    "polar_inertia": 0.1,
    "od": "140 mm",
    "id": "116 mm",
}


def level(wob, friction=0.3, length=2000):
    """A level hole of 222 mm with a string that is pushed along it with ``wob``."""
    roadmap = {
        "operations": ["sliding"],
        "bit_depth": [length],
        "friction_factor": {"open_hole": friction},
        "sliding": {"wob": wob, "tob": 0},
    }
    c = case([0, length], [90, 90], item=WICKS, roadmap=roadmap)
    return c.model_copy(
        update={
            "well": c.well.model_copy(
                update={"sections": (c.well.sections[0].model_copy(update={"diameter": 0.222}),)}
            )
        }
    )


def test_buckling_loads_in_a_level_hole(tmp_path):
    """P_s 251.84 kN and P_h 356.16 kN, from Dawson and Paslay and from Chen, Lin and Cheatham."""
    states = {}
    for wob in (251.7e3, 252.0e3, 356.0e3, 356.3e3):
        # without friction the force is the weight on bit everywhere
        states[wob] = rows(level(wob, 0.0), tmp_path)["sliding", 0.0, 2000]["buckling_state"]
    assert list(states.values()) == ["none", "sinusoidal", "sinusoidal", "helical"]


def test_force_along_a_helix(tmp_path):
    """dF/ds = mu (w + r F^2/4EI): F = sqrt(4 w EI/r) tan(atan(F0/sqrt(4 w EI/r)) + mu s sqrt(w r/4EI)).

    From 400 kN at the bit, helical from there, over 500 m.
    """
    ei, r, w, mu, length = 207e9 * 9.97e-6, 0.041, 315.0, 0.3, 500.0
    size = np.sqrt(4 * w * ei / r)
    exact = size * np.tan(np.arctan(400e3 / size) + mu * length * np.sqrt(w * r / 4 / ei))
    row = rows(level(400e3, mu, length), tmp_path)["sliding", mu, length]
    assert row["hook_load"] == pytest.approx(-exact, rel=1e-6)
    assert row["buckling_state"] == "helical" and row["status"].startswith("must be pushed")


def test_lock_up(tmp_path):
    """A change of the force at the top reaches the bit by the factor (1 + (F0/c)^2)/(1 + (F/c)^2).

    Less than 1 % of it arrives where the tangent is close to its pole; a longer string bears no weight at all.
    """
    ei, r, w, mu, f0 = 207e9 * 9.97e-6, 0.041, 315.0, 0.3, 400e3
    size, rate = np.sqrt(4 * w * ei / r), mu * np.sqrt(w * r / 4 / ei)
    largest = np.sqrt(100 * (1 + (f0 / size) ** 2) - 1) * size
    length = (np.arctan(largest / size) - np.arctan(f0 / size)) / rate
    free = rows(level(f0, mu, round(length - 10)), tmp_path)["sliding", mu, round(length - 10)]
    locked = rows(level(f0, mu, round(length + 10)), tmp_path)["sliding", mu, round(length + 10)]
    assert free["buckling_state"] == "helical"
    assert locked["buckling_state"] == "lock_up" and "no weight passes MD" in locked["status"]
    pole = (np.pi / 2 - np.arctan(f0 / size)) / rate
    beyond = rows(level(f0, mu, round(pole + 200)), tmp_path)["sliding", mu, round(pole + 200)]
    assert beyond["buckling_state"] == "lock_up" and np.isnan(beyond["hook_load"])
    where = float(beyond["status"].split("MD ")[1].split(" m")[0])
    # the force passes 50 MN, that of no string, 13 m below the pole
    assert round(pole + 200) - where == pytest.approx(
        (np.arctan(5e7 / size) - np.arctan(f0 / size)) / rate, abs=6
    )


def test_safety_factor_and_overpull(tmp_path):
    """5in 19.50 S-135 premium hanging vertically: 560,764 lbf at yield (API RP 7G), 58,114 ft-lbf in torsion.

    The tube of the premium class has 4.6691 in2: 0.9 x 560,764 lbf less the weight is the margin.
    """
    pipe = {"kind": "drill_pipe", "pipe": "5in 19.50 S-135 NC50 premium"}
    roadmap = {
        "operations": ["trip_out", "drilling"],
        "bit_depth": [2000],
        "friction_factor": {"open_hole": 0.3},
        "drilling": {"wob": 0, "tob": "20 kft-lbf"},
    }
    found = rows(case([0, 2000], [0, 0], item=pipe, roadmap=roadmap), tmp_path)
    row = found["trip_out", 0.3, 2000]
    yields = 560_764 * 4.4482216
    assert row["overpull_margin"] == pytest.approx(0.9 * yields - row["hook_load"], rel=1e-4)
    assert row["min_safety_factor"] == pytest.approx(yields / row["hook_load"], rel=1e-4)
    turned = found["drilling", 0.3, 2000]
    exact = 1 / np.hypot(turned["hook_load"] / yields, 20_000 / 58_114)
    # the torsional limit of RP 7G has 0.577 in place of 1/sqrt(3)
    assert turned["min_safety_factor"] == pytest.approx(exact, rel=1e-3)


def test_defaults(tmp_path):
    """30 depths and the shoe, six operations, three times the sections' own friction; what was assumed is reported."""
    sections = [
        {"to": 1400, "kind": "casing", "diameter": "224 mm", "friction": 0.2},
        {"kind": "open_hole", "diameter": "215.9 mm", "friction": 0.3},
    ]
    c = case([0, 1000, 1360, 2860], [0, 0, 60, 60], sections=sections)
    result = run_roadmap(Job(c, tmp_path / "r"))
    table = read_table(tmp_path / "r" / "roadmap.csv")
    assert len(set(table["bit_depth [m]"])) == 31 and 1400 in table["bit_depth [m]"]
    assert len(table["bit_depth [m]"]) == 31 * 6 * 3
    assert np.allclose(sorted(set(table["ff_cased [-]"])), [0.15, 0.2, 0.25])
    assert np.allclose(sorted(set(table["ff_open_hole [-]"])), [0.225, 0.3, 0.375])
    inputs = json.loads((tmp_path / "r" / "roadmap.json").read_text())
    assert inputs["casing_shoes [m]"] == [1400]
    assert any("drilling.wob 111.2 kN assumed" in note for note in result.summary["notes"])


def test_time(tmp_path):
    """30 depths x 6 operations x 3 pairs on a well of 5 km take at most 10 s."""
    depths = [float(d) for d in np.linspace(500, 5000, 30)]
    c = case([0, 1000, 1600, 2600, 3200, 5000], [0, 0, 30, 30, 88, 88], roadmap={"bit_depth": depths})
    start = time.process_time()
    run_roadmap(Job(c, tmp_path / "r"))
    assert time.process_time() - start < 10


@each_row(
    ("roadmap", "at", "want"),
    [
        ({"operations": ["fishing"]}, "roadmap.operations[0]", "one of trip_in"),
        ({"bit_depth": [0]}, "roadmap.bit_depth[0]", "above 0"),
        ({"bit_depth": [5000]}, "roadmap.bit_depth[0]", "end of the hole"),
        ({"bit_depth": {"from": "shoe", "step": 100}}, "roadmap.bit_depth.from", "no casing"),
        ({"bit_depth": {"from": 900, "to": 300, "step": 100}}, "roadmap.bit_depth", "rising"),
        ({"friction_factor": {}}, "roadmap.friction_factor.cased", "cased"),
        ({"friction_factor": {"cased": [0.1, 0.2], "open_hole": [0.1, 0.2, 0.3]}}, "open_hole", "as many"),
        ({"friction_factor": {"open_hole": [-0.1]}}, "open_hole[0]", "at least 0"),
        ({"rpm": 100}, "roadmap.rpm", "at most 50"),
        ({"drilling": {"flow_rate": "600 gpm"}}, "roadmap.drilling.flow_rate", "a fluid in the bore"),
        ({"operations": []}, "roadmap.operations", ""),
    ],
)
def test_refused(roadmap, at, want, tmp_path):
    with pytest.raises(CaseError) as error:
        run_roadmap(Job(case([0, 1000], [60, 60], roadmap=roadmap), tmp_path / "r"))
    assert at in error.value.at and want in str(error.value)
    assert not (tmp_path / "r").exists()


def test_string_that_cannot_be_lengthened(tmp_path):
    collars = {"kind": "body", "length": 50, "od": "170 mm", "mass": 5000}
    c = case([0, 1000], [0, 0], length=100, above=[collars], roadmap={"bit_depth": [900]})
    with pytest.raises(CaseError, match="topmost item is not a pipe"):
        run_roadmap(Job(c, tmp_path / "r"))


def test_no_well(tmp_path):
    c = Case(string=[{**PIPE, "length": 100}], top="clamped")
    with pytest.raises(CaseError, match="a well for roadmap"):
        run_roadmap(Job(c, tmp_path / "r"))
