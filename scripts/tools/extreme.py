"""Run the robustness suite and print one table: case, criterion, measured, allowed, pass.

    scripts/extreme                     all cases; writes cases/extreme/REPORT.md
    scripts/extreme X02 X05 --jobs 2    these two cases, two computations at a time
    scripts/extreme --judge             evaluates existing runs, computes nothing

Each computation is a separate process on one core. CPU times are compared with cases/extreme/cpu_seconds.json,
those of the first version that passed; a new run is added to the file. The exit status is 1 if a criterion is
not met.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from datetime import date
from pathlib import Path

ROOT = Path(__file__).parents[2]
CASES = ROOT / "cases" / "extreme"
BUDGETS, REPORT = CASES / "cpu_seconds.json", CASES / "REPORT.md"
LIMIT = 3600  # longest wall time of a computation [s]


def words(argv: Sequence[str] | None = None) -> argparse.Namespace:
    p = argparse.ArgumentParser(
        prog="scripts/extreme", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    p.add_argument("cases", nargs="*", metavar="CASE", help="X01, X02, ... (default: all)")
    p.add_argument("--jobs", type=int, default=1, help="computations at a time (default: 1)")
    p.add_argument(
        "--out",
        type=Path,
        default=ROOT / "results" / "extreme",
        help="folder of the run folders (default: results/extreme)",
    )
    p.add_argument("--judge", action="store_true", help="only evaluate existing runs")
    p.add_argument("--part", help=argparse.SUPPRESS)
    return p.parse_args(argv)


# ---------------------------------------------------------------------- one computation in a process
def compute(part, out: Path) -> None:
    """Compute one part of a case into its run folder."""
    import petsc4py

    petsc4py.init(["drillpetsc"])
    from petsc4py import PETSc

    PETSc.Log.begin()
    from tests.robustness import run as robustness_run

    robustness_run.compute(part, CASES, out)


def start(part, out: Path) -> str:
    """Run one part in a new process; returns an error message, or an empty text."""
    (out / part.name / "summary.json").unlink(missing_ok=True)
    command = [sys.executable, "-P", str(Path(__file__)), "--part", part.name, "--out", str(out)]
    try:
        done = subprocess.run(
            command,
            capture_output=True,
            text=True,
            timeout=LIMIT,
            cwd=ROOT,
            env={**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])},
        )
    except subprocess.TimeoutExpired:
        return f"{part.name}: stopped after {LIMIT} s"
    return (
        ""
        if done.returncode == 0
        else f"{part.name}: {(done.stderr.strip().splitlines() or ['no message'])[-1]}"
    )


# ---------------------------------------------------------------------- evaluation
def evaluated(case, out: Path, budgets: dict[str, float]) -> list:
    """Rows of a case; a missing or failed run gives a row that does not pass."""
    from tests.robustness.criteria import Run, holds, in_time

    runs = {part.name: Run(out / part.name) for part in case.parts}
    missing = [name for name, run in runs.items() if not (run.folder / "summary.json").is_file()]
    if missing:
        return [holds(case.number, f"{name}: run", "missing", "done", False) for name in missing]
    failed = [
        (name, str(q.summary["status"]))
        for name, q in runs.items()
        if q.summary.get("status", "done") != "done"
    ]
    if failed:
        return [
            holds(case.number, f"{name}: run", status.splitlines()[0], "done", False)
            for name, status in failed
        ]
    rows = case.check(runs)
    for part in case.parts:
        if part.kind != "statics":
            rows += in_time(case.number, runs[part.name], budgets.get(part.name))
    if all(row.passed for row in rows):
        for part in case.parts:
            if part.kind != "statics":
                budgets.setdefault(part.name, round(runs[part.name].summary["cpu_seconds"], 2))
    return rows


def lines(rows: list) -> list[str]:
    """The table as text in columns."""
    cells = [("case", "criterion", "measured", "allowed", "pass")]
    cells += [
        (
            r.case,
            r.criterion,
            r.measured if isinstance(r.measured, str) else f"{r.measured:.4g}",
            r.allowed,
            "yes" if r.passed else "NO",
        )
        for r in rows
    ]
    width = [max(len(row[k]) for row in cells) for k in range(5)]
    return ["  ".join(cell.ljust(w) for cell, w in zip(row, width, strict=True)).rstrip() for row in cells]


def report(rows: list, cases) -> str:
    """REPORT.md."""
    titles = {s.number: s.title for s in cases}
    out = [
        "# Robustness suite",
        "",
        f"Written by `scripts/extreme` on {date.today().isoformat()}. The case files are beside this file, "
        "the criteria and their derivations in tests/robustness.",
        f"{sum(r.passed for r in rows)} of {len(rows)} criteria met in {len(titles)} cases. CPU times are those of one core.",
        "",
    ]
    for number, title in titles.items():
        out += [
            f"## {number}: {title}",
            "",
            "| criterion | measured | allowed | pass |",
            "| --- | --- | --- | --- |",
        ]
        for r in rows:
            if r.case == number:
                measured = r.measured if isinstance(r.measured, str) else f"{r.measured:.4g}"
                out.append(
                    f"| {r.criterion} | {measured} | {r.allowed} | {'yes' if r.passed else '**NO**'} |".replace(
                        "|speed|", "speed"
                    )
                )
        out.append("")
    return "\n".join(out)


def main() -> int:
    asked = words()
    from tests.robustness.cases import CASES as SUITE
    from tests.robustness.cases import chosen

    asked.out = asked.out.resolve()
    if asked.part:
        compute(next(p for case in SUITE for p in case.parts if p.name == asked.part), asked.out)
        return 0
    try:
        cases = chosen(asked.cases)
    except ValueError as error:
        print(f"scripts/extreme: {error}", file=sys.stderr)
        return 2
    asked.out.mkdir(parents=True, exist_ok=True)
    if not asked.judge:
        parts = [part for case in cases for part in case.parts]
        with ThreadPoolExecutor(max(1, asked.jobs)) as pool:
            for message in pool.map(lambda part: start(part, asked.out), parts):
                if message:
                    print(message, file=sys.stderr)
    budgets = json.loads(BUDGETS.read_text()) if BUDGETS.is_file() else {}
    known = dict(budgets)
    rows = [row for case in cases for row in evaluated(case, asked.out, budgets)]
    print("\n".join(lines(rows)))
    failed = [r for r in rows if not r.passed]
    print(f"{len(rows) - len(failed)} of {len(rows)} criteria met in {len(cases)} cases")
    if budgets != known:
        BUDGETS.write_text(json.dumps(dict(sorted(budgets.items())), indent=1) + "\n")
    if len(cases) == len(SUITE):
        REPORT.write_text(report(rows, cases))
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
