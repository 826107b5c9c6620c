"""`top.hoist` and `top.autodriller`: what they may hold, and that a case is written and read back unchanged."""

from __future__ import annotations

from typing import Any

import pytest

from drillpetsc.case import Case, load_case
from drillpetsc.errors import CaseError
from tests.helpers.tables import each_row

PIPE = {"kind": "pipe", "length": "90 m", "od": "5 in", "id": "4.276 in"}
LINE = {"axial_stiffness": 5e7}
HOIST: dict[str, Any] = {"block_mass": "25 t", "line": LINE}
BIT = {
    "bottom": "bit",
    "well": {
        "survey": {"md": [0, 100], "inclination": [0, 0], "azimuth": [0, 0]},
        "sections": [{"to": 100, "kind": "open_hole", "diameter": "8.5 in"}],
    },
}
DRILL: dict[str, Any] = {"wob": "100 kN"}
MUD = {
    "density": 1200.0,
    "rheology": {"model": "newtonian", "viscosity": 1e-3},
    "flow_rate": 0.03,
    "annulus": False,
}


def made(hoist: Any = HOIST, autodriller: Any = None, top: dict[str, Any] | None = None, **keys: Any) -> Case:
    parts = {"hoist": hoist, "autodriller": autodriller, **(top or {})}
    given = {key: value for key, value in parts.items() if value is not None}
    return Case(**{"string": [PIPE], "top": {"kind": "top_drive", **given}, **BIT, **keys})


@each_row(
    ("keys", "place", "words"),
    [
        ({"hoist": {}}, "top.hoist.block_mass", ""),
        ({"hoist": {**HOIST, "line": {}}}, "axial_stiffness", "an axial_stiffness or a diameter"),
        ({"hoist": {**HOIST, "line": {**LINE, "diameter": "35 mm"}}}, "axial_stiffness", "not both"),
        ({"hoist": {**HOIST, "line": {**LINE, "modulus": 1e11}}}, "modulus", "without a diameter"),
        ({"hoist": {**HOIST, "line": {"diameter": "35 m"}}}, "diameter", "0.1"),
        ({"hoist": {**HOIST, "lines": 10.5}}, "lines", ""),
        ({"hoist": {**HOIST, "lines": 0}}, "lines", ""),
        ({"hoist": {"block_mass": "25 t", "damping": 1e5}}, "damping", "without a line"),
        (
            {"hoist": {**HOIST, "height": 30, "crown_height": 30}},
            "crown_height",
            "above the height of the block",
        ),
        ({"hoist": {**HOIST, "sheave_efficiency": 1.1}}, "sheave_efficiency", "1"),
        ({"hoist": {**HOIST, "blockmass": 1}}, "blockmass", "one of these keys"),
        ({"hoist": {**HOIST, "heave": {"amplitude": 1}}}, "heave.period", ""),
        ({"top": {"force": 1e5}}, "top.force", "a hoist or a force"),
        ({"top": {"hinged": True}}, "top.hinged", "no hinge with a hoist"),
        ({"top": {"lowering": 2.0}}, "top.lowering", "at most hoist.max_speed, 1.5 m/s"),
        ({"top": {"lowering": {"time": [0, 1], "value": [0, -2]}}}, "top.lowering", "1.5 m/s"),
        ({"hoist": None, "autodriller": DRILL}, "top.autodriller", "a hoist with a line"),
        ({"hoist": {"block_mass": 1e4}, "autodriller": DRILL}, "top.autodriller", "a line of the hoist"),
        ({"autodriller": DRILL, "top": {"lowering": 0.0}}, "top.lowering", "from time 0"),
        ({"autodriller": {}}, "wob", "which mode wob needs"),
        ({"autodriller": {**DRILL, "rop": 1e-3}}, "rop", "no rop without mode rop"),
        ({"autodriller": {**DRILL, "mode": []}}, "mode", "one or several of"),
        ({"autodriller": {**DRILL, "mode": ["wob", "wob"]}}, "mode", "each mode once"),
        ({"autodriller": {**DRILL, "mode": ["wobb"]}}, "mode", ""),
        ({"autodriller": {"mode": "rop", "rop": 1e-3, "p": 1e-8}}, "autodriller.p", "without mode wob"),
        (
            {"autodriller": {"mode": "torque", "torque": 1e3, "p": 1e-8}},
            "autodriller.p",
            "mode torque has torque_p",
        ),
        ({"autodriller": {"wob": "-100 kN"}}, "autodriller.wob", "0 or more"),
        (
            {"autodriller": {"mode": "rop", "rop": {"time": [0, 5], "value": [1e-3, -1e-3]}}},
            "autodriller.rop",
            "reverse: true",
        ),
        ({"autodriller": {**DRILL, "p": 0}}, "autodriller.p", "above 0"),
        ({"autodriller": {**DRILL, "max_speed": 3.0}}, "max_speed", "at most hoist.max_speed"),
        ({"autodriller": {**DRILL, "measur": "bit"}}, "measur", "one of these keys"),
        ({"autodriller": DRILL, "bottom": "free"}, "autodriller.mode", "unless bottom is a bit"),
        (
            {"autodriller": {"mode": "differential_pressure", "differential_pressure": 1e6}},
            "autodriller.mode",
            "without mud",
        ),
        (
            {"autodriller": {**DRILL, "sample": 0.01}, "petsc": {"ts_adapt_type": "none", "ts_dt": 0.05}},
            "autodriller.sample",
            "at least the fixed step",
        ),
        (
            {"autodriller": DRILL, "time": {"end": 1, "mode": "quasi_static"}},
            "top.autodriller",
            "quasi-static",
        ),
        (
            {
                "hoist": {**HOIST, "heave": {"amplitude": 1, "period": 10}},
                "time": {"end": 1, "mode": "quasi_static"},
            },
            "top.hoist.heave",
            "quasi-static",
        ),
        ({"beam": {"formulation": "quaternion"}}, "top.hoist", "not with quaternion"),
        ({"hold_string": True, "fluid": MUD, "bottom": "free"}, "top.hoist", "no hoist of a held string"),
    ],
)
def test_refused(keys: dict[str, Any], place: str, words: str) -> None:
    """One message with the key's path and what is allowed."""
    with pytest.raises(CaseError) as caught:
        made(**keys)
    text = str(caught.value)
    assert place in text and words in text


@each_row(
    "keys",
    [
        {},
        {"hoist": {"block_mass": 25e3, "sheave_efficiency": 0.98, "tare": True}},
        {"hoist": {**HOIST, "line": {"diameter": "35 mm"}, "heave": {"amplitude": "1 m", "period": "10 s"}}},
        {"autodriller": DRILL},
        {
            "autodriller": {
                "mode": ["wob", "rop", "torque"],
                **DRILL,
                "rop": "20 m/h",
                "torque": "8 kN m",
                "from": 3,
            },
            "top": {"lowering": "5 m/h"},
        },
        {
            "autodriller": {
                "mode": ["differential_pressure"],
                "differential_pressure": "10 bar",
                "filter": 1,
            },
            "fluid": MUD,
        },
    ],
)
def test_written_and_read_back(keys: dict[str, Any], tmp_path) -> None:
    case = made(**keys)
    case.dump(tmp_path / "case.yaml")
    assert load_case(tmp_path / "case.yaml") == case


def test_stiffness_of_the_rope_by_its_diameter() -> None:
    """100 GPa times 0.4 d^2 with d = 35 mm: 49 MN."""
    case = made({**HOIST, "line": {"diameter": "35 mm"}})
    assert case.top.hoist is not None and case.top.hoist.line is not None
    assert case.top.hoist.line.stiffness == pytest.approx(1e11 * 0.4 * 0.035**2)
    assert case.top.hoist.crown == 60.0
