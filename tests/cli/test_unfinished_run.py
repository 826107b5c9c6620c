"""`plot`, `export` and `vibration` of a run that did not reach its end say so."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.helpers.command import main_succeeds


@pytest.mark.parametrize("command", ["plot", "export"])
@pytest.mark.parametrize(
    ("status", "said"),
    [(None, "there is no summary.json"), ("failed: no step", "failed: no step"), ("done", "")],
)
def test_a_run_that_is_not_complete(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], command: str, status: str | None, said: str
) -> None:
    (tmp_path / "history.csv").write_text("time [s],hook_load [N]\n0,1\n0.1,2\n0.2,4\n")
    if status is not None:
        (tmp_path / "summary.json").write_text(json.dumps({"title": "x", "status": status}))
    main_succeeds(command, tmp_path)
    err = capsys.readouterr().err
    assert ("the run is not complete" in err) is bool(said) and said in err
