"""summary.json: JSON's own types only, whole or not at all; and what importing the output layer costs."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from drillpetsc.errors import CaseError
from drillpetsc.output import read_summary, write_summary
from drillpetsc.output.files import json_file as module
from tests.helpers.tables import each_row


@dataclass(frozen=True)
class Balance:
    error: float
    steps: np.int64


def test_numpy_and_odd_values_become_json(tmp_path: Path) -> None:
    path = write_summary(
        tmp_path / "summary.json",
        {
            "factor": np.float32(2.5),
            "steps": np.int32(7),
            "ok": np.bool_(True),
            "nan": np.float64("nan"),
            "inf": -np.inf,
            "array": np.array([[1.0, np.nan]]),
            "complex": 1 + 2j,
            "balance": Balance(1e-9, np.int64(3)),
            "path": Path("a/b"),
            "none": None,
            5: (1, 2),
            "words": "θ",
        },
    )

    def strict(word: str) -> float:
        raise AssertionError(f"{word} is not JSON")

    assert json.loads(path.read_text(encoding="utf-8"), parse_constant=strict) == {
        "factor": 2.5,
        "steps": 7,
        "ok": True,
        "nan": None,
        "inf": None,
        "array": [[1.0, None]],
        "complex": [1.0, 2.0],
        "balance": {"error": 1e-9, "steps": 3},
        "path": "a/b",
        "none": None,
        "5": [1, 2],
        "words": "θ",
    }


def test_a_failing_write_keeps_the_old_summary(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = write_summary(tmp_path / "summary.json", {"steps": 1})

    def fails(*_: object) -> None:
        raise OSError("disk full")

    monkeypatch.setattr("os.replace", fails)
    with pytest.raises(OSError, match="disk full"):
        module.write_summary(path, {"steps": 2})
    assert read_summary(path) == {"steps": 1}
    assert [file.name for file in tmp_path.iterdir()] == ["summary.json"]


@each_row("text", ["{", "", "[1]", "\x00\x01"])
def test_a_damaged_summary_is_named(tmp_path: Path, text: str) -> None:
    (tmp_path / "summary.json").write_text(text)
    with pytest.raises(CaseError) as caught:
        read_summary(tmp_path / "summary.json")
    assert "summary.json" in str(caught.value) and "no JSON" in str(caught.value)
