"""Old keys and values are refused with the new word; `cases/broken/old-word.yaml` shows the message."""

from typing import Any

import pytest

from drillpetsc.case import Case
from drillpetsc.case.blocks.formation import Formation
from drillpetsc.case.blocks.settings import BeamTheory
from drillpetsc.case.old_words import EACH, RENAMED_KEYS, RENAMED_VALUES, check_old_words
from drillpetsc.errors import CaseError


def data(**keys: Any) -> dict[str, Any]:
    return {"string": [{"kind": "pipe", "length": 9, "od": 0.127, "id": 0.1}], "top": "clamped", **keys}


def test_an_old_value_is_answered_with_the_new_one() -> None:
    with pytest.raises(CaseError) as caught:
        Case(**data(beam={"formulation": "gauge"}))
    assert (caught.value.at, caught.value.got) == ("beam.formulation", "gauge")
    assert caught.value.hint == "gauge is now called ancf"
    assert Case(**data(beam={"formulation": "ancf"})).beam == BeamTheory()


def test_an_old_key_is_answered_with_the_new_one(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(RENAMED_KEYS, ("string", EACH, "outer"), "od")
    check_old_words(data())
    with pytest.raises(CaseError) as caught:
        Case(**data(string=[{"kind": "pipe", "length": 9, "outer": "5 in"}]))
    assert (caught.value.at, caught.value.got) == ("string[0].outer", "5 in")
    assert caught.value.hint == "outer is now called od"


def test_the_new_words_exist() -> None:
    """No entry of the table sends a user to a word that is refused in turn."""
    for path, new_of in RENAMED_VALUES.items():
        for old, new in new_of.items():
            block: Any = new
            for step in reversed(path):
                block = [block] if step == EACH else {step: block}
            assert old != new and Case(**data(**block)).to_yaml()


def test_the_hole_s_node_spacing_has_one_name() -> None:
    with pytest.raises(CaseError) as caught:
        Case(**data(formation={"freeze_interval": 0.5}))
    assert caught.value.hint == "freeze_interval is now called node_spacing"
    assert "node_spacing" in Formation.model_fields
