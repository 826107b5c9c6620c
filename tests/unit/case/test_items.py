"""String items for Python: the same case as from the keys of a file."""

from __future__ import annotations

import copy
import inspect
import pickle
from typing import Any

import pytest

import drillpetsc as dp
from drillpetsc.case.block import kinds_of
from drillpetsc.case.blocks.items import agitator, motor, string, tools, tubulars
from drillpetsc.case.items import ITEMS
from drillpetsc.errors import CaseError
from tests.helpers.tables import each_row

BLOCKS = (
    tubulars.Pipe, string.Tool, tubulars.Beam, tubulars.DrillPipe, tubulars.HeavyPipe, tubulars.DrillCollar,
    tubulars.Casing, tubulars.CoiledTubing, tools.ShockSub, tools.BumperSub, motor.PositiveDisplacementMotor,
    tools.Jar, agitator.AgitatorTool, string.Stabilizer, string.Body, string.Bit, tubulars.RotarySteerable,
    tubulars.PositiveDisplacementMotor, tubulars.Reamer,
)  # fmt: skip
WELL = {
    "survey": {"md": [0, 9000], "inclination": [0, 0], "azimuth": [0, 0]},
    "sections": [{"to": "9000 ft", "kind": "open_hole", "diameter": 8.5, "friction": 0.3}],
}
ITEMS_BY_NAME = {item.__name__: item for item in ITEMS.values()}
REST: dict[str, Any] = {"units": "field", "well": WELL, "top": "clamped", "bottom": "free"}


@each_row("block", BLOCKS, ids=lambda block: block.__name__)
def test_items_have_exactly_the_keys_of_their_blocks(block: Any) -> None:
    item = ITEMS[kinds_of(block)[0]]
    fields = {name: field for name, field in block.model_fields.items() if name != "kind"}
    signature = inspect.signature(item)
    assert set(signature.parameters) == set(fields)
    required = {name for name, field in fields.items() if field.is_required()}
    assert {n for n, p in signature.parameters.items() if p.default is inspect.Parameter.empty} == required


def test_every_kind_has_a_class() -> None:
    assert set(ITEMS) == {kinds_of(block)[0] for block in BLOCKS}
    assert all(getattr(dp, item.__name__) is item for item in ITEMS.values())


def test_a_string_of_items_is_that_of_mappings() -> None:
    """Bare numbers take the units of the case (field.md of the contract: feet for lengths, inches for diameters)."""
    items = dp.Case(
        string=[
            dp.DrillPipe("5in 19.50 S-135 NC50 premium", length=8000),
            dp.DrillCollar(length="180 ft", od="6 3/4 in", id=2.8125, spiral=True),
            dp.Bit(length=1, od=8.5, nozzles=[12, 12, 12]),
        ],
        **REST,
    )
    mappings = dp.Case(
        string=[
            {"kind": "drill_pipe", "pipe": "5in 19.50 S-135 NC50 premium", "length": 8000},
            {"kind": "drill_collar", "length": "180 ft", "od": "6 3/4 in", "id": 2.8125, "spiral": True},
            {"kind": "bit", "length": 1, "od": 8.5, "nozzles": [12, 12, 12]},
        ],
        **REST,
    )
    assert items == mappings
    assert items.string[0].length == pytest.approx(8000 * 0.3048)


def test_a_varied_item() -> None:
    pipe = dp.DrillPipe("5in 19.50 S-135 NC50", length="9 m", class_="new")
    assert pipe == {"kind": "drill_pipe", "pipe": "5in 19.50 S-135 NC50", "length": "9 m", "class": "new"}
    assert repr(pipe) == "DrillPipe(pipe='5in 19.50 S-135 NC50', length='9 m', class_='new')"
    for again in (
        copy.deepcopy(pipe),
        pickle.loads(pickle.dumps(pipe)),
        eval(repr(pipe), dict(ITEMS_BY_NAME)),
    ):
        assert again == pipe and type(again) is dp.DrillPipe


@each_row(
    ("make", "at", "hint"),
    [
        (lambda: dp.DrillPipe(lenght=9.0, length=1.0), "lenght", "length"),
        (lambda: dp.Bit(length=1.0, od=0.2, tfa="0.3 in2"), "tfa", "nozzle_area"),
        (lambda: dp.DrillCollar(od=0.2), "DrillCollar: length", ""),
        (lambda: dp.Pipe(length=None, od=0.1), "Pipe: length", ""),
        (lambda: dp.HWDP(length=9.0, kind="pipe"), "kind", ""),
        (lambda: dp.Body(nozzles=[12]), "nozzles", ""),
    ],
)
def test_wrong_keys_are_refused_at_once(make: Any, at: str, hint: str) -> None:
    with pytest.raises(CaseError) as caught:
        make()
    assert caught.value.at == at and hint in caught.value.hint


def test_a_wrong_value_is_told_with_its_place_in_the_case() -> None:
    with pytest.raises(CaseError) as caught:
        dp.Case(string=[dp.DrillPipe("5in 19.50 S-135 NC50", length="9 kg")], **REST)
    assert caught.value.at == "string[0].length"
