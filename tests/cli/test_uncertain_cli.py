"""`uncertain` as a user types it: files, picture, units, the Python function, refusals."""

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

ROADMAP = "roadmap: {operations: [trip_out, drilling], bit_depth: [700 m, 990 m]}\n"
FRICTION = "  well.sections[0].friction: {normal: [0.25, 0.03], correlated: {fluid.density: -0.4}}\n"
DENSITY = "  fluid.density: {uniform: [1150 kg/m3, 1.25 g/cm3]}\n"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder with small.yaml and the command done once."""
    path = tmp_path_factory.mktemp("uncertain")
    (path / "small.yaml").write_text(CASE + ROADMAP + "uncertain:\n" + FRICTION + DENSITY)
    words = ("--samples", "20", "--method", "both", "--quantiles", "5,95", "--units", "field", "--out", "r")
    done = succeeds("uncertain", "small.yaml", *words, cwd=path, rendered=True)
    (path / "screen").write_text(done.stdout)
    return path


def test_files(folder):
    """Every column and key is described; quantiles rise; shares of the linear method add up to 1; the picture is drawn."""
    for name in ("uncertain.csv", "uncertain_shares.csv"):
        table = read_table(folder / "r" / name)
        assert list(table) == [f"{q.name} [{q.unit}]" for q in outputs_by_file()[name]]
    table = read_table(folder / "r/uncertain.csv")
    quantile = np.asarray(table["quantile [-]"], float).reshape(-1, 2)
    assert (quantile[:, 1] >= quantile[:, 0]).all() and (quantile[:, 1] > quantile[:, 0]).any()
    summary = json.loads((folder / "r/summary.json").read_text())
    described = {r["name"] for r in records() if r["file"] == "summary.json of uncertain"}
    assert set(summary) - {"program", "version"} <= described
    assert summary["keys"][1]["uniform"] == pytest.approx([1150.0, 1250.0])
    shares = read_table(folder / "r/uncertain_shares.csv")
    of = (shares["output [-]"] == "trip_out.hook_load_total") & (shares["method [-]"] == "linear")
    assert np.asarray(shares["share [-]"], float)[of].reshape(2, 2).sum(axis=1) == pytest.approx(1.0)
    assert (folder / "r/plots/uncertain.png").stat().st_size > 10_000


def test_screen(folder):
    """In field units, with both methods and the larger share first."""
    screen = (folder / "screen").read_text()
    assert "trip_out.hook_load_total [klbf]" in screen
    assert "monte-carlo" in screen and "linear" in screen and "P95" in screen


def test_python_function(folder):
    """The same seed gives the same file; hydraulics has its own outputs; bare numbers have the units of the case."""
    with unrendered():
        found = dp.uncertain(
            folder / "small.yaml", folder / "p", samples=20, method="both", quantiles=[5, 95]
        )
    assert found.kind == "uncertain"
    assert (folder / "p/uncertain.csv").read_bytes() == (folder / "r/uncertain.csv").read_bytes()
    case = dp.load_case(folder / "small.yaml")
    flow = dp.uncertain(case, folder / "h", analysis="hydraulics", samples=20)
    assert set(read_table(flow.folder / "uncertain.csv")["output [-]"]) == {"pump_pressure", "ecd_bit"}
    again = dp.Case(
        **(case.given_keys[0] | {"units": "field", "uncertain": {"fluid.density": {"normal": [10.0, 0.1]}}})
    )
    assert again.uncertain["fluid.density"].normal == pytest.approx((1198.264, 11.98264), rel=1e-6)


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("", "distributions of numbers"),
        ("fluid.density: {normal: [1300 kg/m3, 10 kg/m3]}", "the case has 1200 kg/m3, the distribution 1300"),
        ("fluid.density: {uniform: [1300 kg/m3, 1400 kg/m3]}", "the case has 1200 kg/m3"),
        ("fluid.density: {normal: [1200 kg/m3, 0]}", "a standard deviation above 0"),
        ("fluid.density: {uniform: [1300 kg/m3, 1100 kg/m3]}", "the lowest value before the highest"),
        ("fluid.density: {normal: [1200 kg/m3, 10 m]}", "kg/m3"),
        ("fluid.density: {normal: [1200, 1], uniform: [1, 2]}", "one of normal: [mean, standard deviation]"),
        ("fluid.density: {lognormal: [-1, 0.1]}", "a mean above 0"),
        (
            "fluid.density: {triangular: [1100 kg/m3, 1300 kg/m3, 1200 kg/m3]}",
            "the lowest value before the highest",
        ),
        ("fluid.density: {triangular: [1250, 1300, 1400]}", "a range with the case's value"),
        ("cased: {normal: [0.25, 0.01]}", "groups of sections: open_hole"),
        ("open_hole: {normal: [0.25, 0.01]}\n  well.sections[0].friction: {normal: [0.25, 0.01]}", "once"),
        ("fluid.density: {normal: [1200, 1], correlated: {rig.block_weight: 0.5}}", "another key of"),
        ("fluid.density: {normal: [1200, 1], correlated: {fluid.density: 0.5}}", "another key of"),
        ("fluid.densty: {normal: [1200, 1]}", "did you mean 'fluid.density'?"),
        ("mesh.element_length: {normal: [1, 0.1]}", "the mesh is held"),
        ("string[2].kind: {normal: [1, 0.1]}", "a word"),
    ],
)
def test_refusals(tmp_path, line, said):
    (tmp_path / "small.yaml").write_text(CASE + ROADMAP + (f"uncertain:\n  {line}\n" if line else ""))
    done = drillpetsc("uncertain", "small.yaml", "--samples", "20", cwd=tmp_path)
    assert done.returncode == 2, done.stdout
    assert said in done.stderr


def test_too_few_samples_for_the_numbers(tmp_path):
    """Eleven sections with friction of their own: 20 samples cannot be ordered without correlations of their own."""
    one = "{kind: open_hole, diameter: 215.9 mm, friction: 0.25}"
    eleven = ", ".join(one.replace("{", f"{{to: {90 * (k + 1)} m, ") for k in range(10)) + ", " + one
    keys = "".join(f"  well.sections[{k}].friction: {{normal: [0.25, 0.01]}}\n" for k in range(11))
    (tmp_path / "small.yaml").write_text(CASE.replace(one, eleven) + ROADMAP + "uncertain:\n" + keys)
    done = drillpetsc("uncertain", "small.yaml", "--samples", "20", cwd=tmp_path)
    assert done.returncode == 2 and "at least 22" in done.stderr
    succeeds("uncertain", "small.yaml", "--samples", "22", cwd=tmp_path)


def test_hydraulics_has_one_depth_and_no_picture(tmp_path):
    """Nothing to draw is not an error of the command."""
    (tmp_path / "small.yaml").write_text(
        CASE + "uncertain:\n  fluid.density: {normal: [1200 kg/m3, 5 kg/m3]}\n"
    )
    done = succeeds("uncertain", "small.yaml", "--analysis", "hydraulics", "--samples", "20", cwd=tmp_path)
    assert "pump_pressure" in done.stdout and "nothing to plot" not in done.stderr
