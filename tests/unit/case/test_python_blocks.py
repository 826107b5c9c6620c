"""Blocks of a case for Python: the same case as from the keys of a file; quantities of pint; what a notebook shows."""

from __future__ import annotations

import copy
import inspect
import pickle
from typing import Any, get_args

import pytest

import drillpetsc as dp
from drillpetsc.case import case_json_schema
from drillpetsc.case.python_blocks import CASE_BLOCKS, PUBLIC_NAMES, PYTHON_BLOCKS
from drillpetsc.errors import CaseError
from tests.helpers.tables import each_row

WELL = {
    "survey": {"md": [0, 9000], "inclination": [0, 0], "azimuth": [0, 0]},
    "sections": [{"to": "9000 ft", "kind": "open_hole", "diameter": 8.5, "friction": 0.3}],
}
REST: dict[str, Any] = {"units": "field", "well": WELL, "top": "clamped", "bottom": "free"}


@each_row("name", sorted(CASE_BLOCKS))
def test_classes_have_exactly_the_keys_of_their_blocks(name: str) -> None:
    block, written = CASE_BLOCKS[name], PYTHON_BLOCKS[PUBLIC_NAMES.get(name, name)]
    fields = {
        key: field
        for key, field in block.model_fields.items()
        if key not in ("kind", "model") or len(get_args(field.annotation)) > 1
    }
    signature = inspect.signature(written)
    assert set(signature.parameters) == set(fields)
    required = {key for key, field in fields.items() if field.is_required()}
    assert {n for n, p in signature.parameters.items() if p.default is inspect.Parameter.empty} == required
    assert getattr(dp, written.__name__) is written


def test_every_block_of_a_case_has_a_class() -> None:
    """Every block that the schema of case files knows, which is all that a case may hold."""
    assert set(case_json_schema()["$defs"]) == set(CASE_BLOCKS) and len(PYTHON_BLOCKS) == len(CASE_BLOCKS)


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
        eval(repr(pipe), dict(PYTHON_BLOCKS)),
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


def test_all_blocks_of_a_well_by_their_classes() -> None:
    """The same case as from mappings, with a word that differs between blocks (kind, model) given by the class."""
    blocks = dp.Case(
        string=[dp.DrillCollar(length=9.0, od=0.17, id=0.07), dp.Bit(length=0.3, od=0.2159)],
        well=dp.Well(
            survey=dp.Survey(md=[0, 10], inclination=[0, 0], azimuth=[0, 0]),
            sections=[dp.Section(to=10.0, kind="open_hole", diameter=0.2159)],
        ),
        top=dp.TopDrive(rotation="120 rpm", motor=dp.TopMotor(inertia=2000.0), control=dp.StiffController()),
        fluid=dp.Fluid(
            density="1.2 sg", rheology=dp.PowerLaw(consistency=0.5, index=0.7), flow_rate="30 l/s"
        ),
    )
    mappings = dp.Case(
        string=[
            {"kind": "drill_collar", "length": 9.0, "od": 0.17, "id": 0.07},
            {"kind": "bit", "length": 0.3, "od": 0.2159},
        ],
        well={
            "survey": {"md": [0, 10], "inclination": [0, 0], "azimuth": [0, 0]},
            "sections": [{"to": 10.0, "kind": "open_hole", "diameter": 0.2159}],
        },
        top={
            "kind": "top_drive",
            "rotation": "120 rpm",
            "motor": {"inertia": 2000.0},
            "control": {"kind": "stiff"},
        },
        fluid={
            "density": "1.2 sg",
            "rheology": {"model": "power_law", "consistency": 0.5, "index": 0.7},
            "flow_rate": "30 l/s",
        },
    )
    assert blocks == mappings


def test_quantities_of_pint() -> None:
    """Lengths by definition: 1 in = 25.4 mm, 1 ft = 0.3048 m; whatever the units of the case are."""
    pint = pytest.importorskip("pint")
    unit = pint.UnitRegistry()
    case = dp.Case(
        units="field",
        string=[dp.Pipe(length=300 * unit.foot, od=127 * unit.mm, id=4.0)],
        top="clamped",
        well={
            "survey": {"md": [0, 100] * unit.m, "inclination": [0, 90] * unit.degree, "azimuth": [0, 0]},
            "sections": [dp.Section(to=100 * unit.m, kind="open_hole", diameter=8.5 * unit.inch)],
        },
    )
    assert case.string[0].length == pytest.approx(91.44, rel=1e-14)
    assert case.string[0].od == pytest.approx(0.127, rel=1e-14)
    assert case.string[0].id == pytest.approx(0.1016, rel=1e-14)
    assert case.well is not None
    assert case.well.survey.md == (0.0, 100.0)
    assert case.well.survey.inclination[1] == pytest.approx(1.5707963267948966, rel=1e-15)
    assert case.well.sections[0].diameter == pytest.approx(0.2159, rel=1e-14)
    longer = case.replace({"string[0].length": 90 * unit.m})
    assert longer.string[0].length == pytest.approx(90.0, rel=1e-14)
    with pytest.raises(CaseError) as caught:
        dp.Pipe(length=3 * unit.s, od=0.1) and dp.Case(
            string=[dp.Pipe(length=3 * unit.s, od=0.1)], top="clamped"
        )
    assert caught.value.at == "string[0].length" and caught.value.got == "3 s"


def test_reprs_and_names_for_a_notebook() -> None:
    """A case is a line, a block shows what was given, a long survey its ends; names of the reading library stay away."""
    depths = [10.0 * i for i in range(1000)]
    case = dp.Case(
        title="Long",
        string=[dp.Pipe(length=90.0, od=0.127, id=0.1)],
        top="clamped",
        well={
            "survey": {"md": depths, "inclination": [0.0] * 1000, "azimuth": [0.0] * 1000},
            "sections": [dp.Section(to=9990.0, kind="open_hole", diameter=0.2159)],
        },
    )
    assert str(case) == repr(case) == "<Case 'Long': 1 item, 90 m, well, contact>"
    assert (
        repr(case.well.survey).startswith("Survey(md=(0.0, ..., 9990.0: 1000), ")
        and len(repr(case.well)) < 300
    )
    assert "eccentricity" not in repr(case.string[0]) and "od=0.127" in repr(case.string[0])
    names = [name for name in dir(case.string[0]) if not name.startswith("_")]
    assert {"length", "od", "material", "outer_section"} <= set(names)
    assert not {"model_dump", "parse_obj", "construct", "unsupported_keys", "fill_defaults"} & set(names)
    assert {"well", "replace", "to_yaml"} <= set(dir(case)) and "model_fields" not in dir(case)
