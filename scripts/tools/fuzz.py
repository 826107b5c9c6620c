"""Fuzz test of the case reader: every mutated case file gives a validated case or a helpful CaseError.

Each mutant follows from --seed and its number alone. Most are changed as data (what the YAML reader makes of
a file), the others as the text or as a survey beside it; some of those that stay valid are written and read
back, built into a model, or given to `drillpetsc check`.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import random
import resource
import sys
import tempfile
import time
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import fuzz_files
from fuzz_cases import valid_case
from fuzz_judge import Failure, check_message, check_round_trip, check_visible, guarded
from fuzz_mutations import mutate_data, mutate_survey, mutate_text, places, replaced, value_at, without
from ruamel.yaml import YAML

from drillpetsc.case import Case, case_from_data, load_case, read_case_file
from drillpetsc.case.blocks.items.string import Flexible
from drillpetsc.case.checks.limits import element_count
from drillpetsc.errors import CaseError

ROOT = Path(__file__).parents[2]
MEMORY = 6 << 30  # address space [bytes]; a larger request is a failure
LARGEST_BUILT = 700  # elements: building takes milliseconds
#: one in so many accepted mutants is built, written and read, given to `drillpetsc check`
BUILT_PART, WRITTEN_PART, COMMAND_PART = 10, 10, 200


@dataclass(frozen=True)
class Seed:
    """A valid case to mutate: its file, text, data."""

    file: Path
    text: str
    data: dict[str, Any]


@dataclass
class Mutant:
    """Changed data or text; path and given: of the new value, if there is one."""

    how: str
    file: Path
    data: dict[str, Any] | None = None
    text: bytes = b""
    survey: bytes = b""
    path: tuple[str | int, ...] = ()


@dataclass
class Found:
    """A distinct failure: its count, and number and text of the smallest mutant."""

    count: int
    number: int
    text: bytes
    also: Path | None = None


@dataclass
class Tally:
    outcomes: Counter[tuple[str, str]] = field(default_factory=Counter)
    stages: Counter[str] = field(default_factory=Counter)
    failures: dict[str, Found] = field(default_factory=dict)


def case_files() -> list[Path]:
    """All valid files of cases/."""
    return [file for file in sorted((ROOT / "cases").rglob("*.yaml")) if "broken" not in file.parts]


def seeds() -> list[Seed]:
    return [Seed(file, file.read_text(encoding="utf-8"), read_case_file(file)[0]) for file in case_files()]


def written(data: Any) -> str:
    """YAML text of the data that reads as the same data, as far as YAML can express them."""
    yaml, stream = YAML(typ="safe", pure=True), io.StringIO()
    yaml.default_flow_style = None  # type: ignore[assignment]
    yaml.width = 4096  # type: ignore[assignment]
    yaml.dump(data, stream)
    return stream.getvalue()


def mutant(number: int, seed: int, known: list[Seed], folder: Path) -> Mutant:
    """The mutant of this number; its files are in the folder."""
    r = random.Random(f"{seed} {number}")
    file = folder / "case.yaml"
    kind = r.random()
    if kind < 0.9:
        base = r.choice(known).data if r.random() < 0.4 else valid_case(r)
        data, path = mutate_data(r, base)
        if r.random() < 0.2:
            data, path = mutate_data(r, data)
        return Mutant("data", file, data=data, path=path)
    if kind < 0.98:
        text = r.choice(known).text if r.random() < 0.5 else written(valid_case(r))
        return Mutant("text", file, text=mutate_text(r, text))
    data = valid_case(r)
    while "well" not in data:
        data = valid_case(r)
    survey = data["well"]["survey"]
    rows = zip(survey["md"], survey["inclination"], survey["azimuth"], strict=True)
    table = "\n".join(
        ["md,inclination,azimuth", *(f"{md!r},{3 * k},10" for k, (md, _, _) in enumerate(rows))]
    )
    data["well"]["survey"] = "survey.csv"
    return Mutant("survey", file, data=data, survey=mutate_survey(r, table))


# ---------------------------------------------------------------------- one mutant
def judge(m: Mutant, r: Any, tally: Tally | None) -> str:
    """`valid` or `refused`; raises Failure."""
    lines = None
    if m.how == "text":
        m.file.write_bytes(m.text)
        lines = (
            m.text.count(b"\n") + m.text.count(b"\r") + m.text.decode("utf-8", "replace").count("\x85") + 2
        )
    if m.survey:
        (m.file.parent / "survey.csv").write_bytes(m.survey)
    try:
        case = guarded(lambda: load_case(m.file) if m.data is None else case_from_data(m.data, m.file, {}))
    except CaseError as error:
        refusal = error
        guarded(lambda: check_message(refusal, (m.file, m.file.parent / "survey.csv"), lines))
        return "refused"
    if m.data is not None and m.path:
        given = value_at(m.data, m.path)
        guarded(lambda: check_visible(case, m.path, given))
    elements = sum(element_count(item) for item in case.string if isinstance(item, Flexible))
    for name, part, stage in (
        ("written and read", WRITTEN_PART, _write_and_read),
        ("built", BUILT_PART, _build),
        ("command", COMMAND_PART, _command),
    ):
        if r.randint(1, part) == 1 and (name == "written and read" or elements <= LARGEST_BUILT):
            end = stage(case, m)
            if tally is not None:
                tally.stages[f"{name}: {end}"] += 1
    return "valid"


def _write_and_read(case: Case, m: Mutant) -> str:
    again = m.file.with_name("again.yaml")

    def load(text: str) -> Case:
        again.write_text(text, encoding="utf-8")
        return load_case(again)

    guarded(lambda: check_round_trip(case, load), 20.0)
    return "the same"


def _build(case: Case, m: Mutant) -> str:
    from drillpetsc.model.drilling_model import build_model

    try:
        guarded(lambda: build_model(case), 20.0)
    except CaseError as error:
        if not (error.want and error.at):
            raise Failure(f"building refused without key or what is allowed: {str(error)[:60]}") from error
        return "refused"
    return "a model"


def _command(case: Case, m: Mutant) -> str:
    from drillpetsc.cli import main

    if m.how != "text":
        m.file.write_text(case.to_yaml(), encoding="utf-8")
    with (
        contextlib.redirect_stdout(io.StringIO()) as printed,
        contextlib.redirect_stderr(io.StringIO()) as refused,
    ):
        status = guarded(lambda: main(["check", str(m.file)]), 20.0)
    if (
        status not in (0, 2)
        or bool(printed.getvalue()) != (status == 0)
        or bool(refused.getvalue()) != (status == 2)
    ):
        raise Failure(f"drillpetsc check ended with {status}")
    return f"status {status}"


def verdict(m: Mutant, number: int, tally: Tally | None = None, every_stage: bool = False) -> str:
    """The outcome, or the name of the failure."""
    r: Any = random.Random(number)
    if every_stage:
        r.randint = lambda a, b: 1
    try:
        return judge(m, r, tally)
    except Failure as failure:
        return str(failure)


# ---------------------------------------------------------------------- smallest
def smallest(m: Mutant, number: int, name: str, seconds: float = 20.0) -> Mutant:
    """Remove from a mutant all parts that its failure does not need."""
    end, again = time.monotonic() + seconds, True
    while again and time.monotonic() < end:
        again = False
        for less in _smaller(m):
            if time.monotonic() > end:
                break
            if verdict(less, number, every_stage=True) == name:
                m, again = less, True
                break
    return m


def _smaller(m: Mutant):
    if m.data is not None:
        for path in list(places(m.data)):
            if m.path[: len(path)] != path:
                moved = m.path and path[:-1] == m.path[: len(path) - 1] and isinstance(path[-1], int)
                if not moved:
                    yield Mutant(m.how, m.file, without(m.data, path), survey=m.survey, path=m.path)
        for path in places(m.data):
            value = value_at(m.data, path)
            if isinstance(value, str) and len(value) > 30:
                yield Mutant(
                    m.how,
                    m.file,
                    replaced(m.data, path, value[: len(value) // 2]),
                    survey=m.survey,
                    path=m.path,
                )
        return
    lines = m.text.split(b"\n")
    size = len(lines)
    while size:
        for k in range(0, len(lines), size):
            yield Mutant(m.how, m.file, text=b"\n".join([*lines[:k], *lines[k + size :]]))
        size //= 2
    size = len(m.text) // 2
    while size > 2:
        for k in range(0, len(m.text), size):
            yield Mutant(m.how, m.file, text=m.text[:k] + m.text[k + size :])
        size //= 2


def as_text(m: Mutant) -> bytes:
    if m.data is None:
        return m.text
    try:
        return written(m.data).encode("utf-8", "surrogatepass")
    except Exception:  # too deep, or a number that YAML cannot write
        return ascii(m.data)[:5000].encode()


# ---------------------------------------------------------------------- all
def run(
    count: int, seed: int, seconds: float, start: int, keep: Path, say: Any, thorough: bool = False
) -> Tally:
    """Test mutants from number `start` on; the files of failures go to the folder `keep`.

    thorough: all stages of all valid mutants.
    """
    known, tally, began = seeds(), Tally(), time.monotonic()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for number in range(start, start + count):
            if seconds and time.monotonic() - began > seconds:
                break
            m = mutant(number, seed, known, folder)
            end = verdict(m, number, tally, thorough)
            failed = end not in ("valid", "refused")
            tally.outcomes[m.how, "FAILED" if failed else end] += 1
            if failed:
                _keep(tally, m, number, end, keep, say)
            done = number - start + 1
            if done % 10000 == 0:
                say(
                    f"{done} mutants, {done / (time.monotonic() - began):.0f} a second, {len(tally.failures)} distinct failures"
                )
    return tally


def _keep(tally: Tally, m: Mutant, number: int, name: str, keep: Path, say: Any) -> None:
    if name in tally.failures:
        tally.failures[name].count += 1
        return
    say(f"mutant {number} ({m.how}): {name}")
    least = smallest(m, number, name)
    keep.mkdir(parents=True, exist_ok=True)
    file = keep / f"failure-{len(tally.failures) + 1:03d}.yaml"
    file.write_bytes(as_text(least))
    if least.survey:
        file.with_suffix(".csv").write_bytes(least.survey)
    tally.failures[name] = Found(1, number, as_text(least), file)


def table(tally: Tally) -> list[str]:
    """The outcomes, and each distinct failure with its smallest mutant."""
    kinds, ends = ("data", "text", "survey"), ("valid", "refused", "FAILED")
    rows = [f"{'mutated as':<12}" + "".join(f"{end:>10}" for end in (*ends, "all"))]
    for kind in (*kinds, "all"):
        counts = [
            sum(n for (k, e), n in tally.outcomes.items() if e == end and kind in (k, "all")) for end in ends
        ]
        rows.append(f"{kind:<12}" + "".join(f"{n:>10}" for n in (*counts, sum(counts))))
    rows += ["", "of the valid ones"]
    rows += [f"  {name:<28}{count:>10}" for name, count in sorted(tally.stages.items())]
    for name, found in tally.failures.items():
        rows += [
            "",
            f"FAILED {found.count} times, first with number {found.number}: {name}",
            f"  {found.also}",
        ]
        rows += [f"  | {line[:160]}" for line in found.text.decode("utf-8", "replace").splitlines()[:30]]
    return rows


def main() -> int:
    p = argparse.ArgumentParser(prog="scripts/fuzz", description=__doc__.splitlines()[0])
    p.add_argument("--count", type=int, default=100_000, help="mutants (default: 100000)")
    p.add_argument("--seed", type=int, default=1, help="another seed makes other mutants (default: 1)")
    p.add_argument("--seconds", type=float, default=0.0, help="stop after so many seconds (default: never)")
    p.add_argument(
        "--start",
        type=int,
        default=0,
        help="number of the first mutant, to go on or to look at one again (default: 0)",
    )
    p.add_argument(
        "--keep",
        type=Path,
        default=ROOT / "results" / "fuzz",
        help="folder for the files of failures (default: results/fuzz)",
    )
    p.add_argument(
        "--thorough", action="store_true", help="build, write and check all that stay valid, not one in ten"
    )
    p.add_argument(
        "--files", type=int, default=20_000, help="mutants of survey and XML files besides (default: 20000)"
    )
    given = p.parse_args()
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    import petsc4py

    petsc4py.init(["fuzz"])
    began = time.monotonic()
    tally = run(
        given.count,
        given.seed,
        given.seconds,
        given.start,
        given.keep,
        lambda line: print(line, file=sys.stderr, flush=True),
        given.thorough,
    )
    print("\n".join(table(tally)))
    done, took = sum(tally.outcomes.values()), time.monotonic() - began
    print(
        f"\n{done} mutants of {len(case_files())} case files and of random cases in {took:.0f} s, seed {given.seed}: "
        f"{len(tally.failures)} distinct failures"
    )
    with tempfile.TemporaryDirectory() as name:
        say = lambda line: print(line, file=sys.stderr, flush=True)  # noqa: E731
        of_files = fuzz_files.run(given.files, given.seed, Path(name), given.keep, say)
    print("\n".join(["", *fuzz_files.table(of_files)]))
    return 1 if tally.failures or of_files.failures else 0


if __name__ == "__main__":
    sys.exit(main())
