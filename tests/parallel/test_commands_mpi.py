"""The matrix of commands: every row of `commands.py` on one rank in this process, and on two and three by mpirun."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.helpers.command import drillpetsc
from tests.helpers.mpi import have_mpi, run_mpi
from tests.helpers.tables import each_row
from tests.parallel.commands import DRILLING, LOOP, ROWS, out_folder

pytestmark = [pytest.mark.parallel, pytest.mark.skipif(not have_mpi(), reason="no mpirun")]


def test_ranks_agree(tmp_path: Path) -> None:
    for name in ROWS:
        done = drillpetsc(*ROWS[name].line(tmp_path, name, 1), cwd=tmp_path)
        assert done.returncode == 0, f"{name}: {done.stderr}"
    for ranks in (2, 3):
        lines = [ROWS[name].line(tmp_path, name, ranks) for name in ROWS if ranks in ROWS[name].ranks]
        (tmp_path / "jobs.json").write_text(json.dumps(lines))
        run_mpi(
            ranks, Path(__file__).with_name("run_commands.py"), [str(tmp_path / "jobs.json")], timeout=900
        )

    @each_row("name", ROWS)
    def agree(name: str) -> None:
        one, *others = (out_folder(tmp_path, name, ranks) for ranks in (1, *ROWS[name].ranks))
        ROWS[name].shows(one)
        for other in others:
            ROWS[name].same(one, other)

    agree()


def test_an_fmu_is_written_on_one_rank(tmp_path: Path) -> None:
    """Refused before anything is written, by all ranks."""
    (tmp_path / "case.yaml").write_text(DRILLING + LOOP)
    words = ["fmu", str(tmp_path / "case.yaml"), "--out", str(tmp_path / "well.fmu")]
    with pytest.raises(AssertionError, match="one rank: an FMU"):
        run_mpi(2, Path(__file__).with_name("run_command.py"), words)
    assert not (tmp_path / "well.fmu").exists()
