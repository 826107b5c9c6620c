"""Ends of a string: a top that moves across with a force, joints at depth 0, a weight on bit with a top force
(manual: verif-ends)."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from drillpetsc import Case, modes, run, statics
from drillpetsc.errors import CaseError
from drillpetsc.output import read_table
from tests.helpers.wells import simple_well

LENGTH = 20.0
PIPE = {"kind": "pipe", "length": LENGTH, "od": 0.127, "id": 0.1086, "element_length": 0.5}
EI, MASS = 206e9 * np.pi / 64 * (0.127**4 - 0.1086**4), 7850 * np.pi / 4 * (0.127**2 - 0.1086**2)
UNIVERSAL, REVOLUTE = ({"kind": kind, "at": 0.0} for kind in ("universal", "revolute"))


def frequencies(folder, **more: Any) -> np.ndarray:
    """Natural frequencies [Hz] of 20 m of pipe without weight."""
    case = Case(string=[PIPE], gravity=[0, 0, 0], **more)
    return np.array(read_table(modes(case, folder).folder / "modes.csv")["frequency [Hz]"])


@pytest.mark.parametrize("hinged, root, share", [(False, 2.365020, 1.0), (True, 1.875104, 0.25)])
def test_a_top_that_moves_across_under_a_force(tmp_path, hinged, root, share):
    """Beam clamped at its lower end, above free across and held in direction, or free.

    Frequency root^2 sqrt(EI/m L^4)/2 pi (Blevins, Formulas for Natural Frequency and Mode Shape, 1979, table
    8-1); Euler's load share pi^2 EI/L^2 (Timoshenko and Gere, Theory of Elastic Stability, 1961, chapter 2), at which it
    becomes zero.
    """
    critical = share * np.pi**2 * EI / LENGTH**2

    def first(force: float, name: str) -> float:
        top = {"kind": "top_drive", "force": force, "guided": False, "hinged": hinged}
        return float(frequencies(tmp_path / name, top=top, bottom="clamped")[0])

    alone = first(0.0, "alone")
    assert alone == pytest.approx(root**2 * np.sqrt(EI / MASS / LENGTH**4) / (2 * np.pi), rel=1e-5)
    # close to the critical load the square of the frequency is linear in the load
    one, two = first(-0.98 * critical, "one") ** 2, first(-0.99 * critical, "two") ** 2
    assert 0.99 + 0.01 * two / (one - two) == pytest.approx(1.0, abs=1e-4)
    assert first(-1.01 * critical, "over") == 0.0  # it grows without oscillation


def test_a_guided_top_without_force_is_needed():
    with pytest.raises(CaseError, match="a force: a top whose axial position is prescribed is guided"):
        Case(string=[PIPE], top={"kind": "top_drive", "guided": False})


def test_joints_at_depth_zero(tmp_path):
    """Under a clamped top a universal joint makes a pinned top, and a revolute joint does so about one axis only."""
    pinned, clamped = (
        frequencies(tmp_path / top, top=top, bottom="clamped")[:4] for top in ("pinned", "clamped")
    )
    universal, revolute = (
        frequencies(tmp_path / joint["kind"], top="clamped", bottom="clamped", joints=[joint])[:4]
        for joint in (UNIVERSAL, REVOLUTE)
    )
    assert universal == pytest.approx(pinned, rel=1e-7)
    assert revolute == pytest.approx(np.sort(np.concatenate([pinned[::2], clamped[::2]])), rel=1e-7)


@pytest.mark.parametrize("element", ["ancf", "quaternion"])
def test_a_universal_joint_at_depth_zero_turns_a_bent_string(tmp_path, element):
    """A string pulled aside at its end turns on the joint: energy balance, weight, and an angle without a moment."""
    case = Case(
        string=[PIPE],
        top={"kind": "top_drive", "rotation": 5.0},
        bottom="free",
        joints=[UNIVERSAL],
        loads=[{"at": LENGTH, "force": [500.0, 300.0, 0.0]}],
        beam={"formulation": element},
        time={"end": 0.3},
        output={"history_every": 0.1, "probes": [0.5]},
    )
    result = run(case, tmp_path / element, progress="silent")
    history = read_table(result.folder / "history.csv")
    weight = MASS * LENGTH * 9.80665
    assert history["hook_load [N]"] == pytest.approx(weight, rel=3e-5)
    # the bending moment is zero at the joint, so the first half metre is straight
    probes = read_table(result.folder / "probes.csv")
    angle = np.arcsin(np.hypot(probes["x_0.5 [m]"], probes["y_0.5 [m]"]) / 0.5)
    assert angle[0] > 0.1
    assert history["joint_0_angle [rad]"] == pytest.approx(angle, rel=2e-3)
    assert abs(result.summary["energy"]["error"]) < 0.1


@pytest.mark.parametrize("top", ["pinned", "free", {"kind": "top_drive", "hinged": True}])
def test_a_joint_at_depth_zero_needs_a_top_that_holds_it(top):
    with pytest.raises(CaseError, match="a top that holds its section"):
        Case(string=[PIPE], top=top, joints=[UNIVERSAL])


WELL = simple_well([0, 300, 600], 0.2159, [0.1, 0.3, 0.6], kind="casing", friction=0.2)


def bit_on_bottom(length: float, **top: Any) -> Case:
    string = [
        {"kind": "pipe", "length": length, "od": 0.127, "id": 0.1086},
        {"kind": "pipe", "length": 99.5, "od": 0.1715, "id": 0.0714},
        {"kind": "bit", "length": 0.5, "od": 0.2159, "mass": 60},
    ]
    return Case(
        string=string,
        well=WELL,
        bottom="bit",
        top={"kind": "top_drive", "rotation": 5.0} | top,
        initial={"from": "statics", "wob": 30e3},
        time={"end": 0.3},
        output={"history_every": 0.05},
    )


@pytest.mark.parametrize("length", [500.0, 480.0])
def test_a_weight_on_bit_with_a_top_force(tmp_path, length):
    """The pull with which statics meets the weight holds the string where it is, also in a hole deeper than the string;
    with another pull it starts to move, and a warning says so."""
    held = statics(bit_on_bottom(length), tmp_path / "held").summary
    pulled = statics(bit_on_bottom(length, force=1e5), tmp_path / "pulled").summary
    assert pulled["hook_load"] == pytest.approx(held["hook_load"], rel=1e-9)
    result = run(bit_on_bottom(length, force=held["hook_load"]), tmp_path / "run", progress="silent")
    fixed = run(bit_on_bottom(length), tmp_path / "fixed", progress="silent")
    one, two = (read_table(r.folder / "history.csv") for r in (result, fixed))
    assert one["wob [N]"] == pytest.approx(30e3, rel=3e-3)
    assert np.ptp(one["top_travel [m]"]) < 1e-4
    for column in ("surface_torque [N m]", "bit_speed [rad/s]"):
        assert one[column][0] == pytest.approx(two[column][0], rel=1e-3), column
    assert not result.summary["statics"]["warnings"]
    other = run(bit_on_bottom(length, force=1.2 * held["hook_load"]), tmp_path / "other", progress="silent")
    assert "it starts to move" in other.summary["statics"]["warnings"][0]
    assert read_table(other.folder / "history.csv")["wob [N]"].min() < 25e3
