"""`Case`: a complete, valid description of what is simulated."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from pydantic import ValidationError, model_validator

from drillpetsc.case.blocks.case_blocks import CaseBlocks
from drillpetsc.case.checks.case import check_case
from drillpetsc.case.defaults import fill_case_defaults, fill_presence_defaults
from drillpetsc.case.key_paths import check_plain
from drillpetsc.case.messages import case_error
from drillpetsc.case.old_words import check_old_words
from drillpetsc.case.writer import case_yaml


class Case(CaseBlocks):
    """A case: the string, the hole, the drive, the fluid, the rock and the simulated time. A block that is
    absent is absent physics.

    Built from the keys of a case file: `Case(string=[{"kind": "pipe", "length": "9 m", "od": "5 in"}],
    top="clamped")`. Numbers are SI, text carries a unit; after construction everything is SI and every
    default is filled in. Wrong input is a `CaseError`.
    """

    def __init__(self, /, **keys: Any) -> None:
        check_plain(keys)
        check_old_words(keys)
        try:
            super().__init__(**keys)
        except ValidationError as error:
            raise case_error(error, keys) from None

    @model_validator(mode="after")
    def _check_and_fill(self) -> Case:
        fill_presence_defaults(self)
        check_case(self)
        fill_case_defaults(self)
        return self

    def to_yaml(self) -> str:
        """The case as YAML, in SI numbers and with every default written out; `load_case` reads it back
        unchanged."""
        return case_yaml(self)

    def dump(self, path: str | Path) -> None:
        """Write `to_yaml()` to a file."""
        Path(path).write_text(self.to_yaml(), encoding="utf-8")
