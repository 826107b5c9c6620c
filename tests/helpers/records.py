"""Public records of rigs, which stay beside the project: tests that need them skip with that reason elsewhere."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


def record(name: str) -> Path:
    """A file of the records, `volve-f5/measured-12in.csv`; skips the test where they are not at hand."""
    given = os.environ.get("DRILLPETSC_DATA")
    path = (Path(given) if given else ROOT.parent / "shared" / "data") / name
    if not path.exists():
        pytest.skip(f"needs the public record {name}: ../shared/data or DRILLPETSC_DATA")
    return path
