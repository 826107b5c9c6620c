"""`sensitivities` as a user types it: files, picture, units on the screen, the Python function, refusals."""

from __future__ import annotations

import json

import numpy as np
import pytest

import drillpetsc as dp
from drillpetsc.output import read_table
from drillpetsc.output.catalogue import outputs_by_file, records
from tests.cli.test_cli import drillpetsc
from tests.cli.test_limits_cli import CASE
from tests.helpers.command import succeeds, unrendered

TO = "well.sections[0].friction,fluid.density,string[bit].nozzle_area"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder with small.yaml and the command done once."""
    path = tmp_path_factory.mktemp("sensitivities")
    (path / "small.yaml").write_text(CASE + "roadmap: {operations: [trip_out, drilling]}\n")
    words = ("--analysis", "roadmap", "--to", TO, "--units", "field", "--check", "2", "--out", "r")
    done = succeeds("sensitivities", "small.yaml", *words, cwd=path, rendered=True)
    (path / "screen").write_text(done.stdout)
    return path


def test_files(folder):
    """Every column and key is described; effects are derivatives times the stated change; the picture is drawn."""
    table = read_table(folder / "r/sensitivities.csv")
    assert list(table) == [f"{q.name} [{q.unit}]" for q in outputs_by_file()["sensitivities.csv"]]
    effect, derivative, per = (np.asarray(table[f"{q} [-]"], float) for q in ("effect", "derivative", "per"))
    assert effect == pytest.approx(derivative * per)
    summary = json.loads((folder / "r/summary.json").read_text())
    described = {r["name"] for r in records() if r["file"] == "summary.json of sensitivities"}
    assert set(summary) - {"program", "version"} <= described
    assert len(summary["checked"]) == 2 and max(c["error"] for c in summary["checked"]) < 1e-4
    assert summary["warnings"] == []
    assert (folder / "r/plots/tornado.png").stat().st_size > 10_000


def test_screen(folder):
    """In field units; a key without effect on any output is named once."""
    screen = (folder / "screen").read_text()
    assert "trip_out.hook_load" in screen and "klbf" in screen and "ppg" in screen
    assert "2 derivatives checked by full solutions" in screen


def test_python_function(folder):
    """Labelled arrays by output and key, equal to the file."""
    with unrendered():
        found = dp.sensitivities(
            folder / "small.yaml", folder / "p", analysis="roadmap", of="hook_load", to=TO.split(",")
        )
    assert found.kind == "sensitivities"
    array = found.sensitivities
    assert list(array["output"]) == ["trip_out.hook_load", "drilling.hook_load"]
    assert np.asarray(array["derivative"]).shape == (2, 3)
    assert np.asarray(array["relative"])[0, 0] > 0 > np.asarray(array["relative"])[0, 1]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--to", "fluid.density", "--of", "hok_load"], "did you mean 'hook_load'?"),
        (["--to", "fluid.densty"], "did you mean 'fluid.density'?"),
        (["--to", "fluid.density", "--of", "bit_depth"], "outputs that the case has: hook_load"),
        ([], "keys of the case"),
        (["--to", "string[bit].kind"], "a word"),
        (["--to", "fluid.density", "--analysis", "hydraulics", "--motion", "hoist"], "--analysis statics"),
    ],
)
def test_refusals(folder, words, said):
    done = drillpetsc("sensitivities", "small.yaml", *words, cwd=folder)
    assert done.returncode == 2
    assert said in done.stderr
