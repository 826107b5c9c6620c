"""Results that describe themselves: fields, blocks, absent keys, and what a command must give."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import pytest

from drillpetsc.output.summaries.summary import MISSING, Missing, Summary, SummaryKey


@dataclass(frozen=True, kw_only=True)
class Soft(Summary):
    """A block."""

    hook_load: Annotated[float, "N", "Hook load by the soft string."]
    twist: Annotated[float | None, "-", "Turns.", "rotation"] = None


@dataclass(frozen=True, kw_only=True)
class Result(Summary):
    """A result with a block."""

    title: Annotated[str, "", "Title of the case."]
    soft: Annotated[Soft | Missing, "a wall"] = MISSING
    total: Annotated[float | Missing, "N", "With the block.", "rig"] = MISSING


def test_the_fields_are_the_keys() -> None:
    assert Result.described() == (
        SummaryKey("title", "", "Title of the case."),
        SummaryKey("soft.hook_load", "N", "Hook load by the soft string.", "a wall"),
        SummaryKey("soft.twist", "-", "Turns.", "rotation"),
        SummaryKey("total", "N", "With the block.", "rig"),
    )


def test_null_is_a_value_and_missing_is_not() -> None:
    assert Result(title="a").as_dict() == {"title": "a"}
    whole = Result(title="a", soft=Soft(hook_load=1.0), total=2.0).as_dict()
    assert whole == {"title": "a", "soft": {"hook_load": 1.0, "twist": None}, "total": 2.0}


def test_a_key_cannot_be_forgotten_or_invented() -> None:
    with pytest.raises(TypeError, match="title"):
        Result()  # type: ignore[call-arg]
    with pytest.raises(TypeError, match="hook"):
        Result(title="a", hook=1.0)  # type: ignore[call-arg]
