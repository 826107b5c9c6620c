"""Measured records of public wells: not in the project, beside it in `../shared/data`, or where DRILLPETSC_DATA points."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

FOLDER = Path(os.environ.get("DRILLPETSC_DATA") or Path(__file__).parents[2].parent / "shared" / "data")


def record(name: str) -> Path:
    """A file of the records; skips the test without them."""
    path = FOLDER / name
    if not path.is_file():
        pytest.skip(f"no record {name} in {FOLDER}: set DRILLPETSC_DATA")
    return path
