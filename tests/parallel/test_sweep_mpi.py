"""Sweeps and several wells on 2 and 3 ranks."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from drillpetsc.output import read_table
from tests.cli.test_sweep_cli import CASE, HOPELESS, WORDS
from tests.helpers.command import drillpetsc
from tests.helpers.mpi import run_mpi

SCRIPT = Path(__file__).parent / "run_sweep.py"
MACHINE = ("wall [s]", "real_time_factor [-]", "ranks")
FINE = CASE.replace("element_length: 10 m", "element_length: 0.5 m")  # 100 elements: enough for two ranks

pytestmark = pytest.mark.parallel


#: by ranks, the lines that run in turn in one job, by name: WHAT of `run_sweep.py` and words without ``--out``
LINES: dict[int, dict[str, tuple[str, ...]]] = {
    2: {
        "table": ("plain", "sweep", "small.yaml", *WORDS),
        "equal": ("sleep", "sweep", "small.yaml", *WORDS),
        "failing": (
            "plain",
            "sweep",
            "small.yaml",
            f"petsc={{ts_rtol: 1e-3}},{HOPELESS}",
            "top.rotation=60 rpm,90 rpm",
        ),
        "refused": (
            "plain",
            "sweep",
            "small.yaml",
            "petsc={ts_rtol: 1e-3},{ts_rtoll: 1}",
            "top.rotation=60 rpm,90 rpm",
        ),
    },
    3: {
        "table": ("plain", "sweep", "small.yaml", *WORDS),
        "wells": (
            "plain",
            "run",
            "bad.yaml",
            "fine.yaml",
            "small.yaml",
            "fine.yaml",
            "small.yaml",
        ),
    },
}


def job(folder: Path, ranks: int, lines: dict[str, tuple[str, ...]]) -> dict[str, str]:
    """What a job prints of its exit statuses, by the names of the lines."""
    words = [
        [
            what,
            command,
            *(str(folder / w) if w.endswith(".yaml") else w for w in rest),
            "--out",
            str(folder / f"{name}{ranks}"),
        ]
        for name, (what, command, *rest) in lines.items()
    ]
    (folder / "lines.json").write_text(json.dumps(words))
    printed = run_mpi(ranks, SCRIPT, [str(folder / "lines.json")], timeout=150)
    statuses = [line for line in printed.splitlines() if line.startswith("exit status")]
    return dict(zip(lines, statuses, strict=True))


@dataclass(frozen=True)
class Jobs:
    folder: Path
    status: dict[int, dict[str, str]]


@pytest.fixture(scope="module")
def jobs(tmp_path_factory) -> Jobs:
    """The lines on two and three ranks: a start of a job takes longer than most of them."""
    folder = tmp_path_factory.mktemp("jobs")
    write_cases(folder)
    return Jobs(folder, {ranks: job(folder, ranks, lines) for ranks, lines in LINES.items()})


def write_cases(folder: Path) -> None:
    """A small case; a fine one of 100 elements, enough for two ranks; and a long one of them that fails."""
    (folder / "small.yaml").write_text(CASE)
    (folder / "fine.yaml").write_text(FINE)
    bad = FINE.replace("{ts_rtol: 1e-3}", HOPELESS).replace("end: 0.05 s", "end: 5 s")
    (folder / "bad.yaml").write_text(bad)


def computed_by(out: Path) -> list[list[int]]:
    return [m["computed_by"] for m in json.loads((out / "summary.json").read_text())["members"]]


def test_the_table_does_not_depend_on_the_ranks(jobs):
    """Four members that run on one rank each, whatever their number: identical results."""
    done = drillpetsc("sweep small.yaml", *WORDS, "--out", "table1", cwd=jobs.folder)
    assert done.returncode == 0, done.stderr
    tables = []
    for n in (1, 2, 3):
        assert n == 1 or jobs.status[n]["table"] == "exit status 0"
        tables.append(read_table(jobs.folder / f"table{n}" / "sweep.csv"))
        assert {rank for ranks in computed_by(jobs.folder / f"table{n}") for rank in ranks} == set(range(n))
    for other in tables[1:]:
        assert list(other) == list(tables[0])
        for title in set(other) - set(MACHINE):
            assert np.array_equal(other[title], tables[0][title]), title


def test_four_equal_members_on_two_ranks_are_two_each(jobs):
    ranks = [r for (r,) in computed_by(jobs.folder / "equal2")]
    assert sorted(ranks) == [0, 0, 1, 1] and ranks[:2] == [0, 1]


def test_a_failing_member_leaves_the_others_complete(jobs):
    assert jobs.status[2]["failing"] == "exit status 1"
    table = read_table(jobs.folder / "failing2" / "sweep.csv")
    assert table["status"].tolist() == ["done"] * 2 + ["failed"] * 2
    assert np.all(table["time [s]"][:2] == 0.05)


def test_an_option_that_no_member_reads_is_refused_on_all_ranks(jobs):
    assert jobs.status[2]["refused"] == "exit status 2"
    assert not (jobs.folder / "refused2").exists()


def test_a_group_of_two_ranks_survives_a_member_that_fails_on_both(jobs):
    """Five wells on three ranks. The first is the most expensive and fails on both ranks of its group; the
    others are computed."""
    assert jobs.status[3]["wells"] == "exit status 1"
    out = jobs.folder / "wells3"
    table = read_table(out / "wells.csv")
    assert table["status"].tolist() == ["failed"] + ["done"] * 4 and "Newton" in table["message"][0]
    assert table["folder"].tolist() == ["bad", "fine", "small", "fine-2", "small-2"]
    assert computed_by(out)[0] == [0, 1]
    one, two = (read_table(out / name / "history.csv")["hook_load [N]"] for name in ("fine", "fine-2"))
    assert one == pytest.approx(two, rel=1e-6)  # one of them may have run on two ranks


def test_a_rank_that_is_lost_in_a_group_blocks_no_other_group(tmp_path):
    """The rank cannot be released, so the job ends, but only after the other groups have computed all their
    members."""
    write_cases(tmp_path)
    lost = ("lost", "sweep", "fine.yaml", "time.end=1 s,0.01 s,0.02 s,0.03 s")
    with pytest.raises(AssertionError, match="exit status 1 on 3 ranks"):
        job(tmp_path, 3, {"lost": lost})
    table = read_table(tmp_path / "lost3" / "sweep.csv")
    assert table["status"].tolist() == ["failed", "done", "done", "done"] and table["ranks"].tolist() == [
        2, 1, 1, 1,
    ]  # fmt: skip
    assert "on rank 1 alone: RuntimeError: gone" in table["message"][0]
