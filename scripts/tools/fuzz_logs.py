"""Fuzz test of the reader of logs: every mutant gives the true values, or a CaseError that says where and what is allowed.

Half of the mutants are changed in a way whose true reading is known (units, names, clocks, separators, order, cells): a log that is
read otherwise is a silent guess. The others are corrupted as text, in CSV, LAS 2 and 3 and WITSML: no traceback, no warning of
numpy, no hang. Each mutant follows from --seed and its number alone.
"""

from __future__ import annotations

import argparse
import random
import sys
import tempfile
import time
from collections import Counter
from dataclasses import dataclass, field
from datetime import datetime, timedelta
from pathlib import Path
from typing import Any

import numpy as np
from fuzz_judge import Failure, guarded
from fuzz_mutations import mutate_text

from drillpetsc.analysis.commands.import_log import Choices, read_and_divide
from drillpetsc.errors import CaseError
from drillpetsc.logs.log import Log, read_log

ROWS = 24
START = datetime(2020, 3, 25, 23, 59, 30)
#: unit -> size in SI, typed from the tables of units and not read from the program
FORCES = {
    "kN": 1e3,
    "t": 9806.65,
    "klbf": 4448.2216152605,
    "kkgf": 9806.65,
    "daN": 10.0,
    "N": 1.0,
    "kips": 4448.2216152605,
}
LENGTHS = {"m": 1.0, "ft": 0.3048}
FLOWS = {"l/min": 1e-3 / 60, "lpm": 1e-3 / 60, "gpm": 3.785411784e-3 / 60, "m3/min": 1 / 60}
TORQUES = {"kN m": 1e3, "kNm": 1e3, "kft-lbf": 1355.8179483314, "N.m": 1.0}
TURNS = {"rpm": np.pi / 30, "1/min": np.pi / 30, "rad/s": 1.0}
NAMES: dict[str, tuple[tuple[str, ...], dict[str, float]]] = {
    "bit_depth": (("bit depth", "DBTM", "Bit_MD", "depth bit"), LENGTHS),
    "hook_load": (("hook load", "HKLD", "hookload", "HKLA"), FORCES),
    "torque": (("torque", "surface torque", "TQA"), TORQUES),
    "rpm": (("rpm", "RPMA", "rotary speed"), TURNS),
    "flow_rate": (("flow in", "MFIA", "flow rate"), FLOWS),
}
UNKNOWN = ("V", "xyz")
JUNK = ("abc", "1e999", "--", "1,2,3,4x", "inf", "0x10", "1_000", "１２", "1 2", "#REF!", "12:30")
NOTHING = ("", "NaN", "-999.25", "null", "-9999")


@dataclass
class Table:
    """A log that is known: channel -> values as written; units and titles; what must come out."""

    title: dict[str, str]
    unit: dict[str, str]
    cells: dict[str, list[str]]
    times: list[datetime]
    clock: str = "%Y-%m-%dT%H:%M:%S"
    separator: str = ","
    style: str = "brackets"
    truth: dict[str, np.ndarray] = field(default_factory=dict)
    may_read: bool = True  # False: only a refusal is right

    def heading(self, channel: str) -> str:
        title, unit = self.title[channel], self.unit[channel]
        if not unit:
            return title
        return {"brackets": f"{title} [{unit}]", "round": f"{title} ({unit})", "under": f"{title}_{unit}"}[
            self.style
        ]

    def text(self) -> str:
        order = list(self.cells)
        rows = [["time", *map(self.heading, order)]]
        rows += [
            [t.strftime(self.clock), *(self.cells[c][i] for c in order)] for i, t in enumerate(self.times)
        ]
        return "\n".join(self.separator.join(row) for row in rows) + "\n"


def table(rng: random.Random) -> Table:
    """A valid log of 24 rows."""
    title = {c: rng.choice(names) for c, (names, _) in NAMES.items()}
    unit = {c: rng.choice(list(units)) for c, (_, units) in NAMES.items()}
    number = {
        "bit_depth": (1000.0, 3000.0),
        "hook_load": (80.0, 900.0),
        "torque": (1.0, 30.0),
        "rpm": (0.0, 180.0),
    }
    cells, truth = {}, {}
    for channel, (_, units) in NAMES.items():
        low, high = number.get(channel, (0.0, 3500.0))
        cells[channel] = [f"{rng.uniform(low, high):.2f}" for _ in range(ROWS)]
        truth[channel] = np.array([float(q) for q in cells[channel]]) * units[unit[channel]]
    times = [START + timedelta(seconds=10 * i) for i in range(ROWS)]
    made = Table(title, unit, cells, times, truth=truth, style=rng.choice(["brackets", "round"]))
    made.separator = rng.choice([",", ";", "\t", "|"])
    return made


# ---------------------------------------------------------------------- changes whose reading is known
def _no_unit(rng: random.Random, made: Table) -> None:
    channel = rng.choice([c for c in made.truth if c != "rpm"])  # whose name is its unit
    made.unit[channel], made.may_read = "", False


def _other_dimension(rng: random.Random, made: Table) -> None:
    channel = rng.choice(list(made.truth))
    made.unit[channel] = rng.choice(("psi", "kg", "degC", "s", "Hz", "bar", *UNKNOWN))
    made.truth.pop(channel, None)
    made.may_read = (
        made.may_read and channel not in ("bit_depth", "hook_load") and made.unit[channel] not in UNKNOWN
    )


def _twice(rng: random.Random, made: Table) -> None:
    channel = rng.choice(list(made.truth))
    other = rng.choice([q for q in NAMES[channel][0] if q != made.title[channel]])
    made.title["twin"], made.unit["twin"], made.cells["twin"] = (
        other,
        made.unit[channel],
        list(made.cells[channel]),
    )
    made.may_read = False


def _junk(rng: random.Random, made: Table) -> None:
    cells = made.cells[rng.choice(list(made.truth))]
    cells[rng.randrange(ROWS)], made.may_read = rng.choice(JUNK), False


def _nothing(rng: random.Random, made: Table) -> None:
    channel, row = rng.choice(list(made.truth)), rng.randrange(ROWS)
    made.cells[channel][row], made.truth[channel][row] = rng.choice(NOTHING), np.nan


def _unknown_name(rng: random.Random, made: Table) -> None:
    channel = rng.choice(["hook_load", "torque", "rpm", "flow_rate"])
    made.title[channel] = rng.choice(["hookload max", "gamma", "hook load expected", "MSE", "x"])
    made.truth.pop(channel, None)


def _order(rng: random.Random, made: Table) -> None:
    order = list(range(ROWS))
    rng.choice([order.reverse, lambda: rng.shuffle(order)])()
    made.times = [made.times[i] for i in order]
    made.cells = {c: [cells[i] for i in order] for c, cells in made.cells.items()}


def _clock(rng: random.Random, made: Table) -> None:
    made.clock = rng.choice(
        [
            "%Y-%m-%d %H:%M:%S",
            "%d/%m/%Y %H:%M:%S",
            "%m/%d/%Y %H:%M:%S",
            "%d.%m.%Y %H:%M:%S",
            "%m/%d/%Y %I:%M:%S %p",
        ]
    )
    if rng.random() < 0.3:  # a day that may be a month
        made.times = [t.replace(day=2) for t in made.times if t.day == 25] + [
            t.replace(day=3) for t in made.times if t.day == 26
        ]
        made.may_read = made.may_read and made.clock.startswith("%Y")


def _comma(rng: random.Random, made: Table) -> None:
    made.separator = rng.choice([";", "\t"])
    made.cells = {c: [q.replace(".", ",") for q in cells] for c, cells in made.cells.items()}


def _under(rng: random.Random, made: Table) -> None:
    made.style = "under"
    made.unit = {
        c: u.replace("/", "_per_").replace(" ", "").replace("N.m", "Nm").replace("1_per_min", "rpm")
        for c, u in made.unit.items()
    }


def _wide_row(rng: random.Random, made: Table) -> None:
    channel = list(made.cells)[-1]
    made.cells[channel][rng.randrange(ROWS)] += made.separator + "1"
    made.may_read = False


#: in the order in which they are made: rows are moved last
KNOWN = (
    _unknown_name,
    _other_dimension,
    _no_unit,
    _nothing,
    _twice,
    _junk,
    _clock,
    _comma,
    _under,
    _wide_row,
    _order,
)


def known_mutant(rng: random.Random) -> Table:
    """A log with up to three changes."""
    made = table(rng)
    for change in sorted(set(rng.choices(KNOWN, k=rng.choice([1, 1, 2, 3]))), key=KNOWN.index):
        if change is _under and ("twin" in made.cells or set(UNKNOWN) & set(made.unit.values())):
            continue  # behind an underscore an unknown unit is a part of an unknown name
        change(rng, made)
    return made


def judge(made: Table, log: Log) -> None:
    """Failure for a log that is not what was written."""
    if not made.may_read:
        raise Failure("a log was read that can only be guessed")
    seconds = np.array([(t - min(made.times)).total_seconds() for t in sorted(made.times)])
    if len(log) != ROWS or not np.allclose(log.values["time"], seconds):
        raise Failure("other times than written")
    for channel in made.truth:
        if channel not in log.values:
            raise Failure(f"{channel} was not found")
    for channel in NAMES:
        if channel in log.values:
            if channel not in made.truth:
                raise Failure(f"{channel} has a column of another name or unit")
            if not np.allclose(log.values[channel], made.truth[channel], rtol=1e-9, equal_nan=True):
                raise Failure(f"{channel}: other values than written")


# ---------------------------------------------------------------------- corrupted texts
def plain_texts(rng: random.Random) -> tuple[str, str]:
    """(text of a valid log, ending of its name)."""
    made = table(rng)
    kind = rng.choice(["csv", "las", "las3", "xml"])
    order = list(NAMES)
    if kind == "csv":
        return made.text(), "csv"
    names = {"bit_depth": "DBTM", "hook_load": "HKLA", "torque": "TQA", "rpm": "RPMA", "flow_rate": "MFIA"}
    units = {c: made.unit[c].replace(" ", ".") for c in order}
    rows = [[t.isoformat(), *(made.cells[c][i] for c in order)] for i, t in enumerate(made.times)]
    if kind == "xml":
        curves = "".join(
            f"<logCurveInfo><mnemonic>{names[c]}</mnemonic><unit>{units[c]}</unit></logCurveInfo>"
            for c in order
        )
        data = "".join(f"<data>{','.join(row)}</data>\n" for row in rows)
        lists = f"<mnemonicList>TIME,{','.join(names[c] for c in order)}</mnemonicList><unitList>s,{','.join(units[c] for c in order)}</unitList>"
        head = '<logs xmlns="http://www.witsml.org/schemas/1series" version="1.4.1.1"><log uid="1">'
        return f"{head}{curves}<logData>{lists}\n{data}</logData></log></logs>", "xml"
    three = kind == "las3"
    lines = [
        "~Version",
        f"VERS. {'3.0' if three else '2.0'} : v",
        "WRAP. NO : one line",
        *(["DLM. COMMA : comma"] if three else []),
    ]
    lines += ["~Well", "STRT.S 0 : first", "STOP.S 1 : last", "STEP.S 0 : step", "NULL. -999.25 : null"]
    lines += [
        "~Log_Definition" if three else "~Curve",
        "TIME. : time",
        *(f"{names[c]}.{units[c]} : {c}" for c in order),
    ]
    lines += ["~Log_Data | Log_Definition" if three else "~ASCII"]
    return "\n".join([*lines, *((("," if three else " ").join(row)) for row in rows)]) + "\n", "las"


# ---------------------------------------------------------------------- run
def try_one(number: int, seed: int, folder: Path) -> str:
    """Outcome of a mutant: read or refused; raises Failure."""
    rng = random.Random(f"{seed}-{number}")
    made: Any = None
    if number % 2:
        made = known_mutant(rng)
        raw, ending = made.text().encode(), "csv"
    else:
        text, ending = plain_texts(rng)
        raw = mutate_text(rng, text)
    path = folder / f"log.{ending}"
    path.write_bytes(raw)
    try:
        log = guarded(lambda: read_log([path]), 20.0)
        if made is not None:
            judge(made, log)
        if number % 10 == 1:
            guarded(lambda: read_and_divide([str(path)], None, Choices()), 20.0)
    except CaseError as error:
        for each in (error, *error.also):
            if not each.want:
                raise Failure("message without what is allowed") from None
        return "refused"
    return "read"


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--count", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=1e9)
    parser.add_argument("--only", type=int, help="one mutant by its number, which is printed")
    given = parser.parse_args()
    outcomes: Counter[str] = Counter()
    failures: dict[str, list[int]] = {}
    start = time.monotonic()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for number in [given.only] if given.only is not None else range(given.count):
            if time.monotonic() - start > given.seconds:
                break
            try:
                outcomes[try_one(number, given.seed, folder)] += 1
            except Failure as failure:
                outcomes["failed"] += 1
                failures.setdefault(str(failure), []).append(number)
            if given.only is not None:
                print(next(folder.iterdir()).read_bytes().decode("utf-8", "replace"))
    print(
        ", ".join(f"{what} {count}" for what, count in sorted(outcomes.items())),
        f"in {time.monotonic() - start:.0f} s",
    )
    for text, numbers in sorted(failures.items(), key=lambda item: -len(item[1])):
        print(f"FAILED {len(numbers)} times, such as number {numbers[0]}: {text}")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
