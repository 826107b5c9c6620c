"""`Case.replace` and what a notebook shows of a case and of an error."""

from __future__ import annotations

import copy
import pickle
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from drillpetsc import Case, load_case
from drillpetsc.errors import CaseError, SolveError
from tests.helpers.tables import each_row

ROOT = Path(__file__).parents[3]
KEYS = {
    "units": "field",
    "well": {
        "survey": {"md": [0, 7000], "inclination": [0, 0], "azimuth": [0, 0]},
        "sections": [{"to": "end", "kind": "open_hole", "diameter": 8.5}],
    },
    "string": [
        {"kind": "drill_pipe", "pipe": "5in 19.50 S-135 NC50 premium", "length": 6000},
        {"kind": "pipe", "length": 500, "od": 6.5, "id": 2.8125},
    ],
    "top": {"kind": "top_drive"},
    "fluid": {"density": 10.0, "rheology": {"model": "newtonian", "viscosity": 10}, "flow_rate": 400},
}


def test_a_new_case_has_the_values_and_the_old_one_stays() -> None:
    case = Case(**KEYS)
    heavy = case.replace({"fluid.density": "11.2 ppg", "string[1].length": 600})
    assert case == Case(**KEYS)
    assert heavy.fluid.density == pytest.approx(11.2 * 119.826427, rel=1e-6)
    assert heavy.string[1].length == pytest.approx(600 * 0.3048)  # a bare number of a case in field units
    assert case.replace({}) == case


def test_derived_figures_follow() -> None:
    """The weight of the pipe comes from the catalogue again, not from the case that was completed before."""
    other = "5in 19.50 X-95 NC50 premium"
    case = Case(**KEYS).replace({"string[0].pipe": other})
    assert case == Case(**{**KEYS, "string": [{**KEYS["string"][0], "pipe": other}, KEYS["string"][1]]})
    assert case.string[0].tool_joint != Case(**KEYS).string[0].tool_joint


def test_blocks_are_switched_and_values_of_python_are_taken() -> None:
    case = Case(**KEYS)
    assert case.replace({"fluid": "off"}).fluid is None
    assert case.replace({"fluid.density": np.float64(9.0)}).fluid.density == pytest.approx(9 * 119.826427)
    assert case.replace({"top": {"kind": "top_drive", "rotation": "60 rpm"}}).top.rotation.value(0.0) > 6


def test_keys_given_are_copied() -> None:
    keys = copy.deepcopy(KEYS)
    case = Case(**keys)
    keys["string"][1]["length"] = 1
    assert case.replace({"title": "same"}).string[1].length == pytest.approx(500 * 0.3048)


def test_files_beside_the_case_are_found_from_elsewhere(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    case = load_case(ROOT / "cases" / "field" / "metric.yaml")
    monkeypatch.chdir(tmp_path)
    again = pickle.loads(pickle.dumps(case)).replace({"title": "other"})
    assert again.well == case.well and again.title == "other"
    assert copy.deepcopy(again) == again


@each_row(
    ("values", "at"),
    [
        ({"fluid.densty": 1.0}, "fluid.densty"), ({"string[7].length": 1.0}, "string[7].length"),
        ({"fluid.density": "10 m"}, "fluid.density"), ({"fluid.density": ""}, "fluid.density"),
        ({"string": "off"}, "string"), ("fluid.density=1", "replace"),
    ],
)  # fmt: skip
def test_wrong_values_are_refused_with_their_key(values: object, at: str) -> None:
    with pytest.raises(CaseError) as error:
        Case(**KEYS).replace(values)
    assert error.value.at == at


def test_the_string_table_of_a_notebook() -> None:
    shown = Case(**KEYS, title="A & B")._repr_html_()
    picture = ElementTree.fromstring(shown[shown.index("<svg") : shown.index("</svg>") + 6])
    widths = [float(part.attrib["width"]) for part in picture if part.tag.endswith("rect")]
    assert max(widths) == 60 and "<script" not in shown  # the widest item; diameters are to scale
    assert "A &amp; B" in shown and "5in 19.50 S-135 NC50 premium" in shown
    assert "<td>6000</td><td>6500</td><td>6.5</td><td>2.8125</td>" in shown and "outer diameter [in]" in shown
    assert "mud 10 ppg" in shown and "hole to MD 7000 ft" in shown
    # steel of 7850 kg/m3 in a ring of 6.5 x 2 13/16 in: 26.970 in2 * 0.28360 lb/in3 * 12 in/ft
    assert "91.78" in shown.split("<td>2.8125</td><td>")[1][:5]


def test_a_notebook_shows_an_error_on_one_line() -> None:
    with pytest.raises(CaseError) as error:
        Case(**{**KEYS, "top": {"kind": "topdrive"}})
    (line,) = error.value._render_traceback_()
    assert line.startswith("CaseError: top.kind") and "given: topdrive" in line and "allowed:" in line
    assert "\n" not in line and error.value.at and error.value.got and error.value.want
    (line,) = SolveError("no equilibrium", hint="a cure")._render_traceback_()
    assert line == "SolveError: no equilibrium; hint: a cure"


def test_the_shell_of_a_notebook_shows_that_line(capsys: pytest.CaptureFixture[str]) -> None:
    shell_of = pytest.importorskip("IPython.core.interactiveshell")
    shell = shell_of.InteractiveShell()
    shell.run_cell("from drillpetsc import Case; Case(string=[], top='clamped')")
    shown = capsys.readouterr()
    assert "CaseError: string" in shown.out + shown.err and "Traceback" not in shown.out + shown.err
