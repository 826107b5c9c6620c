"""Problems and scores of the yardstick: errors of answers against the bands of cases/yardstick.

Needs numpy only, so that any program can be scored without drillpetsc.
"""

from __future__ import annotations

import csv
import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

PROBLEMS = Path(__file__).parents[2] / "cases" / "yardstick"
NOT_QUANTITIES = ("seconds", "note")
ORDER = (
    "lubinski", "mitchell", "dawson-paslay", "madsim", "aarsnes-shor", "api-13d", "paidoussis", "fritz",
    "volve-f5", "volve-f4", "forge-16b", "laboratory-rig",
)  # fmt: skip


@dataclass(frozen=True)
class Problem:
    """A problem: its folder and the content of problem.json."""

    folder: Path
    data: dict[str, Any]

    @property
    def given(self) -> dict[str, Any]:
        """Numbers of the problem in SI, by name with unit."""
        return dict(self.data["given"])

    def table(self, file: str) -> dict[str, list[str]]:
        """Columns of a CSV file of the problem as text, by heading."""
        with (self.folder / file).open(newline="", encoding="utf-8") as lines:
            head, *rows = csv.reader(lines)
        return {name: [row[k] for row in rows] for k, name in enumerate(head)}

    def column(self, file: str, name: str) -> np.ndarray:
        """A column (n,) of numbers; empty cells are NaN."""
        return np.array([float(cell) if cell else np.nan for cell in self.table(file)[name]])

    def expected(self, quantity: str) -> np.ndarray:
        """Expected value (1,) or series (n,) of a quantity in its unit."""
        value = self.data["expected"][quantity]["value"]
        if isinstance(value, str):
            file, name = value.split(": ", 1)
            return self.column(file, name)
        return np.atleast_1d(np.asarray(value, dtype=float))


def load(name: str, problems: Path = PROBLEMS) -> Problem:
    """Read a problem. An unknown name raises ValueError with the names there are."""
    path = problems / name / "problem.json"
    if not path.is_file():
        raise ValueError(f"no problem '{name}'; there are: {', '.join(ORDER)}")
    return Problem(path.parent, json.loads(path.read_text(encoding="utf-8")))


@dataclass(frozen=True)
class Score:
    """Verdict on a quantity: in the band, not, or None (not answered); error and band in words."""

    inside: bool | None
    error: str = ""

    @property
    def word(self) -> str:
        """The verdict in a table."""
        return "not answered" if self.inside is None else f"{self.error}, {'in' if self.inside else 'OUT'}"


def band_words(band: dict[str, float]) -> str:
    """A band in words."""
    words = {"relative": "{:g} %", "absolute": "± {:g}", "rms": "rms {:g} %", "largest": "largest {:g} %"}
    words["mean_size"] = "mean size {:g} %"
    return ", ".join(words[k].format(v if k == "absolute" else round(100 * v, 6)) for k, v in band.items())


def score(problem: Problem, quantity: str, answer: object) -> Score:
    """Compare an answer with the band of a quantity; an answer of wrong length or without a finite number is out."""
    if answer is None:
        return Score(None)
    expected, band = problem.expected(quantity), problem.data["expected"][quantity]["band"]
    try:
        given = np.atleast_1d(np.asarray(answer, dtype=float))
    except (TypeError, ValueError):
        return Score(False, "no number")
    if given.shape != expected.shape:
        return Score(False, f"{given.size} values instead of {expected.size}")
    if not np.isfinite(given).all():
        return Score(False, "not finite")
    if "absolute" in band:
        off = float(given[0] - expected[0])
        return Score(abs(off) <= band["absolute"], f"{off:+.3g}")
    off = given / expected - 1
    figures = {
        "relative": float(np.abs(off).max()),
        "largest": float(np.abs(off).max()),
        "rms": float(np.sqrt((off**2).mean())),
        "mean_size": float(np.abs(off).mean()),
    }
    inside = all(figures[kind] <= limit for kind, limit in band.items())
    if len(off) == 1:
        return Score(inside, f"{100 * off[0]:+.2g} %")
    return Score(inside, ", ".join(f"{kind.replace('_', ' ')} {100 * figures[kind]:.2g} %" for kind in band))


def read_answers(path: Path) -> dict[str, dict[str, Any]]:
    """Read an answer file. Unknown problems and quantities raise ValueError: a misspelt name is not an answer."""
    try:
        answers = json.loads(path.read_text(encoding="utf-8"))
    except ValueError as error:
        raise ValueError(f"{path.name} is not JSON: {error}") from None
    if not isinstance(answers, dict) or not all(isinstance(q, dict) for q in answers.values()):
        raise ValueError(f"{path.name} is not an answer file: a problem has {{quantity: value}}")
    for name, found in answers.items():
        known = load(name).data["expected"]
        for quantity in found:
            if quantity not in known and quantity not in NOT_QUANTITIES:
                raise ValueError(
                    f"{path.name}: {name} does not ask for '{quantity}'; it asks for: {', '.join(known)}"
                )
    return dict(answers)


def rows(files: Sequence[Path]) -> tuple[list[str], list[list[str]]]:
    """Heading and cells of the table of scores: a row a quantity, then the seconds and notes of the problem, and totals."""
    found = [read_answers(path) for path in files]
    table, inside, asked = [], [0] * len(files), 0
    for name in ORDER:
        problem = load(name)
        for quantity, about in problem.data["expected"].items():
            scores = [score(problem, quantity, a.get(name, {}).get(quantity)) for a in found]
            asked += 1
            inside = [n + (s.inside is True) for n, s in zip(inside, scores, strict=True)]
            table.append([name, quantity, band_words(about["band"]), *(s.word for s in scores)])
        seconds = [a.get(name, {}).get("seconds") for a in found]
        table.append([name, "seconds", "", *("" if s is None else f"{s:.3g}" for s in seconds)])
    table.append(["all", "in the band", f"of {asked}", *map(str, inside)])
    return ["problem", "quantity", "band", *(path.stem for path in files)], table


def notes(files: Sequence[Path]) -> list[str]:
    """What the answer files say about problems: mesh, or why there is no answer."""
    lines = []
    for path in files:
        for name, found in read_answers(path).items():
            if "note" in found:
                lines.append(f"{path.stem}, {name}: {found['note']}")
    return lines


def plain(head: list[str], table: list[list[str]]) -> str:
    """The table as aligned text."""
    width = [max(len(row[k]) for row in [head, *table]) for k in range(len(head))]
    return "\n".join(
        "  ".join(c.ljust(w) for c, w in zip(row, width, strict=True)).rstrip() for row in [head, *table]
    )


def markdown(head: list[str], table: list[list[str]]) -> str:
    """The table in Markdown."""
    lines = [head, ["---"] * len(head), *table]
    return "\n".join("| " + " | ".join(row) + " |" for row in lines)
