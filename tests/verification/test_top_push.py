"""A top that pushes the string is told (manual: sec-statics-top-push)."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc import Case, run, statics
from drillpetsc.errors import CaseError

LENGTH, OD, BORE = 100.0, 0.1715, 0.0714
WEIGHT = 7850 * 9.80665 * np.pi / 4 * (OD**2 - BORE**2) * LENGTH  # [N] of the collars; the bit adds 0.6 kN


def collars(wob: float, stabilizer: float = 0.21, casing: float = 0.22, bit: float = 0.2159, **more) -> Case:
    """Collars on a bit in a vertical hole without friction."""
    return Case(
        well={
            "survey": {"md": [0, LENGTH + 1.3], "inclination": [0, 0], "azimuth": [0, 0]},
            "sections": [
                {"to": 50, "kind": "casing", "diameter": casing, "friction": 0.0},
                {"to": LENGTH + 1.3, "kind": "open_hole", "diameter": 0.2159, "friction": 0.0},
            ],
        },
        string=[
            {"kind": "pipe", "length": LENGTH, "od": OD, "id": BORE},
            {"kind": "stabilizer", "length": 1.0, "od": stabilizer, "id": BORE, "mass": 100},
            {"kind": "bit", "length": 0.3, "od": bit, "mass": 60},
        ],
        top={"kind": "top_drive"},
        bottom={"kind": "bit", "friction": 0.0},
        initial={"from": "statics", "wob": wob},
        **more,
    )


def said(warnings: list[str]) -> list[str]:
    return [w for w in warnings if "top pushes the string" in w]


def test_a_weight_on_the_bit_beyond_that_of_the_string(tmp_path):
    """160 kg below the collars: hook load (weight of all) - wob; pushed by 20 kN with 20 kN more than the weight, in statics and
    at the start of a run; nothing is said where the string hangs."""
    weight = WEIGHT + 160 * 9.80665
    pushed = statics(collars(weight + 20e3), tmp_path / "pushed").summary
    assert pushed["hook_load"] == pytest.approx(-20e3, rel=1e-3)
    assert "with 20 kN" in said(pushed["warnings"])[0]
    hangs = statics(collars(weight - 20e3), tmp_path / "hangs").summary
    assert hangs["hook_load"] == pytest.approx(20e3, rel=1e-3)
    assert not said(hangs["warnings"])
    moved = run(collars(weight + 20e3, time={"end": 0.01}), tmp_path / "run", progress="silent").summary
    assert said(moved["warnings"]) == said(pushed["warnings"])


@pytest.mark.parametrize(
    ("stabilizer", "casing", "at"), [(0.23, 0.24, "open hole"), (0.215, 0.2, "casing"), (0.2172, 0.24, "")]
)
def test_a_stabilizer_larger_than_the_hole(stabilizer, casing, at):
    """Refused where it stands and where it has passed; blades within 1/16 in of the hole are not."""
    if not at:
        collars(1e4, stabilizer, casing, min(casing, 0.2159))
        return
    with pytest.raises(CaseError, match=f"1/16 in above the diameter of the {at}"):
        collars(1e4, stabilizer, casing, min(casing, 0.2159))
