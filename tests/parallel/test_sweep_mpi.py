"""Sweeps and several wells on 2 and 3 ranks."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from drillpetsc.output import read_table
from tests.cli.test_sweep_cli import CASE, HOPELESS, WORDS
from tests.helpers.mpi import run_mpi

SCRIPT = Path(__file__).parent / "run_sweep.py"
MACHINE = ("wall [s]", "real_time_factor [-]", "ranks")
FINE = CASE.replace("element_length: 10 m", "element_length: 0.5 m")

pytestmark = pytest.mark.parallel


@pytest.fixture
def small(tmp_path) -> Path:
    (tmp_path / "small.yaml").write_text(CASE)
    (tmp_path / "fine.yaml").write_text(FINE)  # 100 elements: enough for two ranks
    return tmp_path


def job(ranks: int, what: str, *words: str) -> str:
    return run_mpi(ranks, SCRIPT, [what, *words], timeout=100)


def computed_by(out: Path) -> list[list[int]]:
    return [m["computed_by"] for m in json.loads((out / "summary.json").read_text())["members"]]


def test_the_table_does_not_depend_on_the_ranks(small):
    """Four members that run on one rank each, whatever their number: identical results."""
    tables = []
    for n in (1, 2, 3):
        out = small / f"out{n}"
        assert "exit status 0" in job(
            n, "plain", "sweep", str(small / "small.yaml"), *WORDS, "--out", str(out)
        )
        tables.append(read_table(out / "sweep.csv"))
        assert {rank for ranks in computed_by(out) for rank in ranks} == set(range(n))
    for other in tables[1:]:
        assert list(other) == list(tables[0])
        for title in set(other) - set(MACHINE):
            assert np.array_equal(other[title], tables[0][title]), title


def test_four_equal_members_on_two_ranks_are_two_each(small):
    job(2, "sleep", "sweep", str(small / "small.yaml"), *WORDS, "--out", str(small / "out"))
    ranks = [r for (r,) in computed_by(small / "out")]
    assert sorted(ranks) == [0, 0, 1, 1] and ranks[:2] == [0, 1]


def test_a_failing_member_leaves_the_others_complete(small):
    words = (f"petsc={{ts_rtol: 1e-3}},{HOPELESS}", "top.rotation=60 rpm,90 rpm")
    assert "exit status 1" in job(
        2, "plain", "sweep", str(small / "small.yaml"), *words, "--out", str(small / "out")
    )
    table = read_table(small / "out" / "sweep.csv")
    assert table["status"].tolist() == ["done"] * 2 + ["failed"] * 2
    assert np.all(table["time [s]"][:2] == 0.05)


def test_an_option_that_no_member_reads_is_refused_on_all_ranks(small):
    words = ("petsc={ts_rtol: 1e-3},{ts_rtoll: 1}", "top.rotation=60 rpm,90 rpm")
    assert "exit status 2" in job(
        2, "plain", "sweep", str(small / "small.yaml"), *words, "--out", str(small / "out")
    )
    assert not (small / "out").exists()


def test_a_group_of_two_ranks_survives_a_member_that_fails_on_both(small):
    """Five wells on three ranks. The first is the most expensive and fails on both ranks of its group; the
    others are computed."""
    (small / "bad.yaml").write_text(
        FINE.replace("{ts_rtol: 1e-3}", HOPELESS).replace("end: 0.05 s", "end: 5 s")
    )
    cases = [str(small / f"{name}.yaml") for name in ("bad", "fine", "small", "fine", "small")]
    assert "exit status 1" in job(3, "plain", "run", *cases, "--out", str(small / "out"))
    table = read_table(small / "out" / "wells.csv")
    assert table["status"].tolist() == ["failed"] + ["done"] * 4 and "Newton" in table["message"][0]
    assert table["folder"].tolist() == ["bad", "fine", "small", "fine-2", "small-2"]
    assert computed_by(small / "out")[0] == [0, 1]
    one, two = (
        read_table(small / "out" / name / "history.csv")["hook_load [N]"] for name in ("fine", "fine-2")
    )
    assert one == pytest.approx(two, rel=1e-6)  # one of them may have run on two ranks


def test_a_rank_that_is_lost_in_a_group_blocks_no_other_group(small):
    """The rank cannot be released, so the job ends, but only after the other groups have computed all their
    members."""
    with pytest.raises(AssertionError, match="exit status 1 on 3 ranks"):
        job(
            3,
            "lost",
            "sweep",
            str(small / "fine.yaml"),
            "time.end=1 s,0.01 s,0.02 s,0.03 s",
            "--out",
            str(small / "out"),
        )
    table = read_table(small / "out" / "sweep.csv")
    assert table["status"].tolist() == ["failed", "done", "done", "done"] and table["ranks"].tolist() == [
        2, 1, 1, 1,
    ]  # fmt: skip
    assert "on rank 1 alone: RuntimeError: gone" in table["message"][0]
