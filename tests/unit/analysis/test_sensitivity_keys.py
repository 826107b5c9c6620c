"""Which numbers of a case are keys: paths, names of items, units, and what is refused with which reason."""

from __future__ import annotations

from pathlib import Path

import pytest

from drillpetsc.analysis.sensitivities.keys import every_key, key_of
from drillpetsc.case import Case, load_case
from drillpetsc.errors import CaseError

ROOT = Path(__file__).resolve().parents[3]


@pytest.fixture(scope="module")
def case():
    return load_case(ROOT / "cases/measured/volve-f5/case.yaml")


def test_values_in_si_and_stated_changes(case):
    """As given (N/m of a weight is kg/m), as a default of the resolved case, and of an item by its name."""
    friction = key_of(case, "well.sections[1].friction")
    assert (friction.value, friction.unit, friction.per) == (0.22, "", 0.05)
    jar = key_of(case, "string[jar].weight")
    assert jar.name == "string[3].weight" and jar.unit == "kg/m"
    assert jar.value == pytest.approx(1824.04 / 9.80665)
    assert jar.per == pytest.approx(0.01 * jar.value)
    assert key_of(case, "bottom.stiffness").value == 1e8
    assert key_of(case, "fluid.rheology.yield_point").value == 8.6


@pytest.mark.parametrize(
    "name", ["string[jar].weight", "bottom.stiffness", "fluid.rheology.yield_point", "gravity[2]"]
)
def test_the_case_with_another_value(case, name):
    """A key takes another value, and its own again, wherever the file has it."""
    key = key_of(case, name)
    other = key.changed(case, 1.25 * key.value)
    assert key_of(other, name).value == pytest.approx(1.25 * key.value)
    assert key.changed(case, key.value) == case


REFUSED = {
    "string[0].element_length": "the mesh is held",
    "mesh.refinement": "the mesh is held",
    "contact.points_per_element": "whole number",
    "contact.energy_strict": "switch",
    "beam.formulation": "a word",
    "fluid": "it is a block: name one of its keys (density",
    "gravity": "[0], [1], [2]",
    "formation.drillability": "the case has no such number",
    "string[99].od": "the case has no such number",
    "string[motor].od": "no item is called 'motor'; the string has drill pipe",
    "petsc.ts_rtol": "a tolerance",
}


@pytest.mark.parametrize("name", REFUSED)
def test_refused_with_the_reason(case, name):
    with pytest.raises(CaseError) as error:
        key_of(case, name)
    assert REFUSED[name] in error.value.want
    assert error.value.at == "--to" and error.value.got == name


def test_every_key_is_a_continuous_number(case):
    names = [key.name for key in every_key(case)]
    assert {"fluid.density", "string[3].weight", "well.sections[0].friction", "initial.wob"} <= set(names)
    assert len(names) == len(set(names))
    assert not [name for name in names if "element_length" in name or "survey" in name or "mesh" in name]


def test_hole_that_goes_on_below_the_bit():
    """The hole ends at bit_depth, above the end of the survey and of its sections: other keys can still change."""
    case = Case(
        well={
            "survey": {"md": [0, 500, 2200], "inclination": [0, 0, 0.7], "azimuth": [0, 0, 0]},
            "sections": [
                {"to": 900, "kind": "casing", "diameter": 0.32, "friction": 0.2},
                {"to": 2000, "kind": "open_hole", "diameter": 0.31, "friction": 0.3},
                {"to": 2200, "kind": "open_hole", "diameter": 0.22, "friction": 0.4},
            ],
        },
        string=[{"kind": "pipe", "length": "fill", "od": 0.127, "id": 0.1086}],
        bit_depth=1800,
        top={"kind": "top_drive"},
    )
    changed = key_of(case, "well.sections[1].friction").changed(case, 0.31)
    assert [(s.to, s.friction) for s in changed.well.sections] == [(900, 0.2), (1800, 0.31)]
    assert changed.well.survey.md == case.well.survey.md
