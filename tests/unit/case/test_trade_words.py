"""Words of the trade in place of keys and kinds are answered with what to write."""

from __future__ import annotations

from typing import Any

import pytest

from drillpetsc.case import Case
from drillpetsc.case.trade_words import KEYS, KINDS
from drillpetsc.errors import CaseError
from tests.helpers.tables import each_row

PIPE = {"kind": "pipe", "length": 9.0, "od": 0.127, "id": 0.1}
BIT = {"kind": "bit", "length": 0.3, "od": 0.2159}
WELL = {
    "survey": {"md": [0, 20], "inclination": [0, 0], "azimuth": [0, 0]},
    "sections": [{"to": "end", "kind": "open_hole", "diameter": 0.2159}],
}
FLUID = {"density": 1200, "rheology": {"model": "newtonian", "viscosity": 1e-3}}


def hint(**keys: Any) -> str:
    """All hints on a case with these keys."""
    with pytest.raises(CaseError) as caught:
        Case(**({"string": [PIPE, BIT], "top": "clamped", "well": WELL} | keys))
    return " | ".join(error.hint for error in (caught.value, *caught.value.also))


@each_row(
    ("keys", "wanted"),
    [
        ({"mud": FLUID}, "'fluid'"),
        ({"bha": []}, "'string'"),
        ({"wob": 25}, "initial: {wob"),
        ({"rpm": 120}, "top: {kind: top_drive"),
        ({"survey": "a.csv"}, "well: {survey"),
        ({"pore": 1}, ""),
        ({"fluid": FLUID | {"flow": 10}}, "'flow_rate'"),
        ({"fluid": FLUID | {"pv": 10}}, "rheology: {pv"),
        ({"string": [BIT | {"type": "PDC"}]}, "'bit_type'"),
        ({"string": [BIT | {"jets": [12]}]}, "'nozzles'"),
        ({"string": [PIPE | {"kind": "DP"}]}, "'drill_pipe'"),
        ({"string": [PIPE | {"kind": "nmdc"}]}, "nonmagnetic: true"),
        ({"string": [PIPE | {"kind": "stabiliser"}]}, "'stabilizer'"),
        ({"string": [PIPE | {"kind": "MWD"}]}, "tool, with its od"),
        ({"string": [PIPE | {"kind": 5}]}, ""),
        ({"string": [PIPE | {"kind": "drill_pipe", "connection": "NC50"}]}, "tool_joint: {connection"),
        (
            {"string": [{"kind": "drill_pipe", "length": 9, "od": 0.127, "weight": 29}]},
            "nominal_weight finds the row",
        ),
        (
            {"well": WELL | {"sections": [{"to": "end", "kind": "casing", "od": 0.24}]}},
            "in casing, its inner diameter",
        ),
        ({"top": {"kind": "top_drive", "rpm": 120}}, "'rotation'"),
        ({"top": None}, "top_drive"),
        ({"initial": {"wob": 1e3}}, "bottom: bit"),
    ],
)
def test_the_hint_says_what_to_write(keys: dict[str, Any], wanted: str) -> None:
    assert wanted in hint(**keys)


def test_no_word_is_a_key_or_a_kind_itself() -> None:
    """Words that become valid one day must leave this table."""
    kinds = {
        "pipe", "tool", "beam", "drill_pipe", "hwdp", "drill_collar", "casing", "coiled_tubing", "stabilizer", "body",
        "bit",
    }  # fmt: skip
    assert not kinds & KINDS.keys()
    assert all(meant.partition(",")[0] in kinds for meant in KINDS.values())
    assert all(word not in keys for word, keys in KEYS.items())
