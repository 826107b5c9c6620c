"""Fuzz test of tables: tallies in CSV and xlsx, surveys and logs in xlsx. Read as written, or refused with what is allowed.

Half of the mutants have changes whose true reading is known: another reading is a silent guess. The others are corrupted, as text or
in the bytes of the workbook: no traceback, no warning of numpy, no hang. Each mutant follows from --seed and its number alone.
"""

from __future__ import annotations

import argparse
import io
import math
import random
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from datetime import date, datetime
from pathlib import Path
from typing import Any

import fuzz_files
import fuzz_logs
import openpyxl
import yaml
from fuzz_judge import Failure, guarded
from fuzz_mutations import mutate_text

from drillpetsc.case.files.survey_file import read_survey
from drillpetsc.case.importers.fragment import fragment
from drillpetsc.case.importers.stations import Rules
from drillpetsc.errors import CaseError
from drillpetsc.logs.log import read_log
from drillpetsc.units import to_si

#: unit -> size in SI, typed from the tables of units and not read from the program
LENGTHS = {"m": 1.0, "ft": 0.3048}
SIZES = {"in": 0.0254, "mm": 1e-3, "m": 1.0}
WEIGHTS = {"kg/m": 1.0, "lb/ft": 0.45359237 / 0.3048, "N/m": 1 / 9.80665}
COLUMNS: dict[str, tuple[tuple[str, ...], dict[str, float]]] = {
    "length": (("Length", "Len", "total length"), LENGTHS),
    "od": (("OD", "Outer Diameter"), SIZES),
    "bore": (("ID", "Bore", "inside diameter"), SIZES),
    "weight": (("Weight", "Linear Weight", "wt"), WEIGHTS),
}
ITEMS = (
    ("Drill pipe", 0.127, 0.1086),
    ("HWDP", 0.127, 0.0762),
    ("Drill collar", 0.1715, 0.0714),
    ("MWD", 0.1715, 0.0714),
)
STEEL = 7850.0
JUNK = ("abc", "1e999", "--", "inf", "0x10", "1_000", "１２", "#REF!", "12:30", "-3", "3 in", "½")
CELLS: tuple[Any, ...] = (None, True, False, date(2020, 3, 1), datetime(2020, 3, 1, 12), math.pi, -1, 10**300, 1e308, "=1+1", "=A1", " 7 ", "7,5")  # fmt: skip


@dataclass
class Sheet:
    """A tally that is known: rows of cells from the rig down, titles, and what must come out [SI]."""

    titles: dict[str, str]
    unit: dict[str, str]
    rows: list[dict[str, str]]
    truth: list[dict[str, float]]
    order: list[str] = field(default_factory=list)
    separator: str = ","
    style: str = "{} [{}]"
    may_read: bool = True  # False: only a refusal is right

    def cells(self) -> list[list[str]]:
        """Rows with the header first."""
        heads = [
            self.style.format(self.titles[q], self.unit[q]) if self.unit.get(q) else self.titles[q]
            for q in self.order
        ]
        return [heads, *([row[q] for q in self.order] for row in self.rows)]


def sheet(rng: random.Random) -> Sheet:
    """A valid tally of three to six items with a bit."""
    titles = {q: rng.choice(names) for q, (names, _) in COLUMNS.items()} | {
        "name": rng.choice(("Description", "Component", "Item"))
    }
    unit = {q: rng.choice(list(units)) for q, (_, units) in COLUMNS.items()}
    rows: list[dict[str, str]] = []
    truth = []
    digits = rng.choice([3, 4, 6])
    some = [*rng.choices(ITEMS, k=rng.randint(2, 5)), ("PDC bit", 0.2159, 0.0)]
    for i, (name, od, bore) in enumerate(some):
        weight = STEEL * math.pi / 4 * (od**2 - bore**2) * rng.uniform(0.9, 1.2)
        values = {"length": rng.uniform(1, 100) if bore else 0.3, "od": od, "bore": bore, "weight": weight}
        text = {q: f"{v / COLUMNS[q][1][unit[q]]:.{digits}f}" for q, v in values.items()}
        truth.append({q: float(text[q]) * COLUMNS[q][1][unit[q]] for q in values})
        rows.append(text | {"name": f"{name} {i}" if "bit" not in name else name})
    order = [*COLUMNS, "name"]
    rng.shuffle(order)
    made = Sheet(titles, unit, rows, truth, order, rng.choice([",", ";", "\t"]))
    made.style = rng.choice(["{} [{}]", "{} ({})"])
    return made


# ---------------------------------------------------------------------- changes whose reading is known
def _no_unit(rng: random.Random, made: Sheet) -> None:
    made.unit[rng.choice(list(COLUMNS))], made.may_read = "", False


def _other_dimension(rng: random.Random, made: Sheet) -> None:
    column = rng.choice([q for q in COLUMNS if made.unit[q]])
    made.unit[column] = rng.choice(("psi", "degC", "s", "bar"))
    made.may_read = made.may_read and column in ("bore", "weight")  # a column that is not read, and said
    for row in made.truth:
        row.pop(column, None)


def _junk(rng: random.Random, made: Sheet) -> None:
    read = [q for q in COLUMNS if any(q in row for row in made.truth)]
    made.rows[rng.randrange(len(made.rows))][rng.choice(read)] = rng.choice(JUNK)
    made.may_read = False


def _no_name(rng: random.Random, made: Sheet) -> None:
    made.rows[rng.randrange(len(made.rows))]["name"], made.may_read = "", False


def _no_weight(rng: random.Random, made: Sheet) -> None:
    k = rng.choice([i for i, row in enumerate(made.rows) if row["weight"] not in JUNK])  # junk stays
    made.rows[k]["weight"] = ""
    made.truth[k].pop("weight", None)


def _upward(rng: random.Random, made: Sheet) -> None:
    made.rows.reverse()


def _bit_inside(rng: random.Random, made: Sheet) -> None:
    k = rng.randrange(1, len(made.rows) - 1)
    made.rows[k], made.rows[-1] = made.rows[-1], made.rows[k]
    made.may_read = False


def _comma(rng: random.Random, made: Sheet) -> None:
    made.separator = rng.choice([";", "\t"])
    for row in made.rows:
        row.update({q: row[q].replace(".", ",") for q in COLUMNS})


def _more(rng: random.Random, made: Sheet) -> None:
    made.titles["more"] = rng.choice(("Remark", "Grade", "Serial", "Connection"))
    made.order.insert(rng.randint(0, len(made.order)), "more")
    for row in made.rows:
        row["more"] = rng.choice(("", "x1", "S-135"))


#: in the order in which they are made
KNOWN = (_no_unit, _other_dimension, _junk, _no_name, _no_weight, _comma, _more, _bit_inside, _upward)


def known_sheet(rng: random.Random) -> Sheet:
    """A tally with up to two changes."""
    made = sheet(rng)
    for change in sorted(set(rng.choices(KNOWN, k=rng.choice([0, 1, 1, 2]))), key=KNOWN.index):
        change(rng, made)
    return made


def judge_tally(made: Sheet, text: str) -> None:
    """Failure for a string that is not the one that was written."""
    if not made.may_read:
        raise Failure("a tally was read that can only be guessed")
    items = yaml.safe_load(text)["string"]
    if len(items) != len(made.truth):
        raise Failure("other items than written")
    for item, row in zip(items, made.truth, strict=True):
        for key, column, unit in (
            ("length", "length", "m"),
            ("od", "od", "m"),
            ("id", "bore", "m"),
            ("weight", "weight", "kg/m"),
        ):
            if key not in item or column not in row:
                continue
            read = to_si(str(item[key]), unit)
            if not math.isclose(read, row[column], rel_tol=2e-5, abs_tol=1e-9):
                raise Failure(f"{key}: other values than written")


# ---------------------------------------------------------------------- workbooks
def workbook(rows: Sequence[Sequence[Any]], rng: random.Random) -> bytes:
    """A workbook with the rows; texts that are numbers become numbers in half of the books."""
    book, numbers = openpyxl.Workbook(), rng.random() < 0.5
    for row in rows:
        book.active.append([_number(cell) if numbers else cell for cell in row])
    out = io.BytesIO()
    book.save(out)
    return out.getvalue()


def _number(cell: Any) -> Any:
    try:
        return (
            float(cell)
            if isinstance(cell, str) and cell.isascii() and "_" not in cell and math.isfinite(float(cell))
            else cell
        )
    except ValueError:
        return cell


def spoilt(rng: random.Random, raw: bytes) -> bytes:
    """A workbook with some bytes changed, cut out or repeated."""
    for _ in range(rng.choice([1, 1, 3, 20])):
        k, n = rng.randrange(len(raw) + 1), rng.choice([1, 1, 8, 200])
        raw = raw[:k] + rng.choice([bytes([rng.randrange(256)]), b"", raw[k : k + n] * 2]) + raw[k + n :]
    return raw


# ---------------------------------------------------------------------- one mutant
def _tally(rng: random.Random, folder: Path) -> None:
    made = known_sheet(rng)
    if rng.random() < 0.5:
        path = folder / "tally.csv"
        path.write_text("\n".join(made.separator.join(row) for row in made.cells()) + "\n", encoding="utf-8")
    else:
        path = folder / "tally.xlsx"
        path.write_bytes(workbook(made.cells(), rng))
    text, _ = guarded(lambda: fragment([str(path)], folder), 20.0)
    judge_tally(made, text)


def _spoilt_tally(rng: random.Random, folder: Path) -> None:
    made = known_sheet(rng)
    if rng.random() < 0.6:
        path = folder / "tally.csv"
        path.write_bytes(mutate_text(rng, "\n".join(made.separator.join(row) for row in made.cells()) + "\n"))
    else:
        path = folder / "tally.xlsx"
        path.write_bytes(spoilt(rng, workbook(made.cells(), rng)))
    guarded(lambda: fragment([str(path)], folder), 20.0)


def _survey(rng: random.Random, folder: Path) -> None:
    """A survey in a workbook with one odd cell: all other stations stay."""
    path, stations = folder / "survey.xlsx", fuzz_files.stations(rng)
    rows: list[list[Any]] = [["MD [m]", "Inc [deg]", "Azi [deg]"], *([*station] for station in stations)]
    k, column = rng.randint(1, len(stations)), rng.randrange(3)
    rows[k][column] = rng.choice(CELLS)
    path.write_bytes(workbook(rows, rng))
    found = guarded(lambda: read_survey(str(path), Rules()), 20.0)
    got = fuzz_files.degrees_of(found)
    for i, station in enumerate(stations, 1):
        if i != k and not any(fuzz_files.near(station, one) for one in got):
            raise Failure(f"stations beside a changed cell are lost: {rows[k][column]!r}")


def _log(rng: random.Random, folder: Path) -> None:
    """A log with known changes in a workbook, where a cell to the right of the titles moves no other."""
    path, rows = folder / "log.xlsx", [[""], ["", ""]]
    while len(rows[0]) < max(map(len, rows)):
        made = fuzz_logs.known_mutant(rng)
        rows = [line.split(made.separator) for line in made.text().splitlines()]
    path.write_bytes(workbook(rows, rng))
    fuzz_logs.judge(made, guarded(lambda: read_log([path]), 20.0))


def _spoilt_workbook(rng: random.Random, folder: Path) -> None:
    path = folder / "log.xlsx"
    made = fuzz_logs.known_mutant(rng)
    path.write_bytes(
        spoilt(rng, workbook([line.split(made.separator) for line in made.text().splitlines()], rng))
    )
    guarded(lambda: read_log([path]), 20.0)


KINDS = (_tally, _tally, _spoilt_tally, _survey, _log, _spoilt_workbook)


def try_one(number: int, seed: int, folder: Path) -> str:
    """Outcome of a mutant: read or refused; raises Failure."""
    try:
        KINDS[number % len(KINDS)](random.Random(f"{seed}-{number}"), folder)
    except CaseError as error:
        if not all(each.want for each in (error, *error.also)):
            raise Failure("message without what is allowed") from None
        return "refused"
    return "read"


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--count", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", type=int, help="one mutant by its number, which is printed")
    given = parser.parse_args()
    outcomes: Counter[str] = Counter()
    failures: dict[str, list[int]] = {}
    start = time.monotonic()
    with tempfile.TemporaryDirectory() as name:
        for number in [given.only] if given.only is not None else range(given.count):
            try:
                outcomes[
                    f"{KINDS[number % len(KINDS)].__name__.strip('_')} {try_one(number, given.seed, Path(name))}"
                ] += 1
            except Failure as failure:
                outcomes["failed"] += 1
                failures.setdefault(
                    f"{KINDS[number % len(KINDS)].__name__.strip('_')}: {failure}", []
                ).append(number)
    print(
        ", ".join(f"{what} {count}" for what, count in sorted(outcomes.items())),
        f"in {time.monotonic() - start:.0f} s",
    )
    for text, numbers in sorted(failures.items(), key=lambda item: -len(item[1])):
        print(f"FAILED {len(numbers)} times, such as number {numbers[0]}: {text}")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
