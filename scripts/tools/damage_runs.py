"""Damage the files of a run at random, then continue, plot and report it: no loss without a message.

A run of 20 ms is continued to 30 ms after one change of a table or of the checkpoint. The restart must refuse with a message, or end with
every byte as without the change (which then concerned what a restart writes again). `plot` and `report` of the damaged
folder must work or give a message. Each change follows from --seed and its number.
"""

from __future__ import annotations

import argparse
import random
import shutil
import tempfile
from collections import Counter
from pathlib import Path

from kill_test import differences

from drillpetsc import Case
from drillpetsc.analysis.motion.transient import run
from drillpetsc.errors import DrillError
from drillpetsc.plotting.run.plot import plot
from drillpetsc.reporting import report

CASE = {
    "string": [{"kind": "pipe", "length": 30, "od": 0.127, "id": 0.1086, "element_length": 10}],
    "top": {"kind": "top_drive", "rotation": 6.0},
    "time": {"end": 0.02},
    "output": {"history_every": 1e-3, "field_every": 5e-3, "probes": [10]},
}
TABLES = ("history.csv", "probes.csv")
FILES = (*TABLES, "checkpoint.h5", "string.pvd", "string/000002.vtu")
LOOKS_EVERY = 10  # changes; pictures take much longer than a restart


def changed_row(rows: list[str], rng: random.Random) -> str:
    """Change rows of a table, without its header, in place; returns what was done."""
    k, j = rng.sample(range(len(rows)), 2)
    kind = rng.choice(("dropped", "doubled", "swapped", "digit", "cell"))
    if kind == "dropped":
        del rows[k]
    elif kind == "doubled":
        rows.insert(k, rows[k])
    elif kind == "swapped":
        rows[k], rows[j] = rows[j], rows[k]
    elif kind == "digit":
        place = rng.choice([i for i, letter in enumerate(rows[k]) if letter.isdigit()])
        digit = rng.choice([d for d in "0123456789" if d != rows[k][place]])
        rows[k] = rows[k][:place] + digit + rows[k][place + 1 :]
    else:
        cells = rows[k].split(",")
        cells[rng.randrange(len(cells))] = rng.choice(("", "nan", "x", "1e999"))
        rows[k] = ",".join(cells).rstrip("\n") + "\n"
    return f"row {k} {kind}"


def damage(folder: Path, rng: random.Random) -> str:
    """Change one file of a run; returns which and how."""
    name = rng.choice((*TABLES, *FILES))
    file = folder / name
    data = file.read_bytes()
    if name in TABLES and rng.random() < 0.8:
        first, *rows = data.decode().splitlines(keepends=True)
        done = changed_row(rows, rng)
        file.write_text(first + "".join(rows))
        return f"{name}: {done}"
    at = rng.randrange(len(data))
    if rng.random() < 0.5:
        file.write_bytes(data[:at])
        return f"{name}: cut after {at} bytes"
    file.write_bytes(data[:at] + bytes([data[at] ^ (1 << rng.randrange(8))]) + data[at + 1 :])
    return f"{name}: a bit of byte {at}"


def restarted(folder: Path) -> None:
    run(Case(**CASE | {"time": {"end": 0.03}}), folder, restart=True, progress="silent")


def judged(folder: Path, whole: Path, looks: bool) -> str:
    """What continuing a damaged run gave: `refused`, `same`, or what is wrong."""
    for look in (plot, report) if looks else ():
        try:
            look(folder)
        except DrillError:
            pass
        except Exception as error:
            return f"WRONG: {look.__name__} raised {type(error).__name__}: {error}"
    try:
        restarted(folder)
    except DrillError:
        return "refused"
    except Exception as error:
        return f"WRONG: restart raised {type(error).__name__}: {error}"
    shutil.rmtree(folder / "plots", ignore_errors=True)
    (folder / "report.html").unlink(missing_ok=True)
    differ = differences(whole, folder)
    return f"WRONG: continued to other files: {', '.join(differ[:3])}" if differ else "same"


def main(words: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--changes", type=int, default=500)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args(words)
    found: Counter[str] = Counter()
    with tempfile.TemporaryDirectory() as name:
        base, whole, damaged = (Path(name) / part for part in ("base", "whole", "damaged"))
        run(Case(**CASE), base, progress="silent")
        shutil.copytree(base, whole)
        restarted(whole)
        for k in range(arguments.changes):
            shutil.rmtree(damaged, ignore_errors=True)
            shutil.copytree(base, damaged)
            done = damage(damaged, random.Random(f"{arguments.seed}/{k}"))
            verdict = judged(damaged, whole, k % LOOKS_EVERY == 0)
            found[verdict.split(":")[0]] += 1
            if verdict.startswith("WRONG"):
                print(f"{k}: {done}: {verdict}", flush=True)
    print(", ".join(f"{count} {word}" for word, count in sorted(found.items())))
    return 1 if found["WRONG"] else 0


if __name__ == "__main__":
    raise SystemExit(main())
