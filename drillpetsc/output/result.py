"""Result of a command: its run folder, its summary and its report for the screen."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any


@dataclass
class RunResult:
    """Results of a command; the same on all ranks.

    folder: run folder
    summary: contents of its summary.json
    lines: report for the screen
    """

    folder: Path
    summary: dict[str, Any] = field(default_factory=dict)
    lines: list[str] = field(default_factory=list)
