"""A row of the parallel matrix, and what rows share."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from tests.helpers.ranks import run_here

Columns = dict[str, np.ndarray]


def steps(length: str) -> tuple[str, ...]:
    """PETSc's options of fixed steps of ``length`` [s], with Newton's method to rounding."""
    return ("-ts_adapt_type", "none", "-ts_dt", length, "-q_snes_stol", "1e-12")


@dataclass(frozen=True)
class Row:
    """A case, what may differ between numbers of ranks, and the checkpoints from which it is restarted.

    case: text or keys of a case file.
    ranks: PETSc's options of the runs on 1, 2 and 3 ranks; None: no such runs.
    share, least, without: of `same_histories`.
    restarts: which of the checkpoints are continued; None: none.
    shows: asserts of run folders and the history of the first that the run does what its name says; called for both.
    begun: the runs go on from the state of one that is made first.
    """

    case: str | dict[str, Any]
    ranks: tuple[str, ...] | None = None
    share: float = 1e-7
    least: float = 0.0
    without: tuple[str, ...] = ()
    restarts: slice | None = None
    checkpoints: int = 3
    shows: Callable[[list[Path], Columns], object] = lambda folders, history: None
    begun: bool = False

    def written(self, folder: Path, name: str = "case") -> Path:
        """The case in a file."""
        path = folder / f"{name}.yaml"
        path.write_text(self.case if isinstance(self.case, str) else yaml.safe_dump(self.case))
        if self.begun and self.ranks is not None and not isinstance(self.case, str):
            run_here(path, folder / f"{name}-start", self.ranks)
            path.write_text(yaml.safe_dump(self.case | {"initial": {"from": str(folder / f"{name}-start")}}))
        return path


def summaries(folders: list[Path]) -> list[dict]:
    return [json.loads((folder / "summary.json").read_text()) for folder in folders]


def equal_steps(folders: list[Path]) -> None:
    """As many steps, and no start that is only found by relaxation on some ranks: such a one has many times the iterations."""
    found = summaries(folders)
    assert len({summary["steps"] for summary in found}) == 1
    starts = [summary["statics"]["iterations"] for summary in found if "statics" in summary]
    assert not starts or max(starts) <= 2 * min(starts)
