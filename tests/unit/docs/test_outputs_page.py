"""The page docs/guide/outputs.md: its tables are generated, and contain every output of a dry and of a wet run."""

from __future__ import annotations

import importlib
import re
import sys
from pathlib import Path
from typing import Any

import pytest

from drillpetsc import Case, run
from drillpetsc.analysis.commands.statics import run_statics
from drillpetsc.output import catalogue, read_frame, read_series, read_table
from drillpetsc.output.files.tables import split_name
from drillpetsc.output.job import Job
from tests.helpers.wells import simple_well

DOCS = Path(__file__).parents[3] / "docs"
sys.path.insert(0, str(DOCS))
generate = importlib.import_module("generate")

DRY: dict[str, Any] = {
    "string": [
        {"kind": "pipe", "length": 29.5, "od": 0.127, "id": 0.1086, "element_length": 5.0},
        {"kind": "bit", "length": 0.5, "od": 0.2, "mass": 60, "nozzle_area": 4e-4},
    ],
    "joints": [{"at": 15.0, "kind": "universal"}],
    "top": {"kind": "top_drive", "rotation": 1.0},
    "bottom": "bit",
    "well": simple_well(30, 0.2159, 0.3, kind="casing", friction=0.2),
    "time": {"end": 0.01},
    "output": {"history_every": 0.005, "field_every": 0.01, "probes": [10.0]},
}
MUD = {
    "density": 1200,
    "rheology": {"model": "bingham", "yield_stress": 5.0, "plastic_viscosity": 0.02},
    "flow_rate": 0.02,
}
WET = {key: value for key, value in DRY.items() if key != "joints"} | {"fluid": MUD}


def rows(page: str) -> dict[str, list[str]]:
    """Cells of each row of the page's table, by name."""
    lines = [line for line in page.splitlines() if line.startswith("| `")]
    cells = [[cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]] for line in lines]
    return {first.strip("`"): others for first, *others in cells}


def tables() -> dict[str, dict[str, list[str]]]:
    """Rows of the generated table of each file."""
    pages = generate.output_tables()
    return {file: rows(pages[page]) for page, (file, _) in generate.OUTPUT_TABLES.items()}


@pytest.mark.parametrize("data", [DRY, WET], ids=["dry", "wet"])
def test_every_column_of_a_run_is_on_the_page(data: dict[str, Any], tmp_path: Path) -> None:
    case, shown = Case(**data), tables()
    run(case, tmp_path / "run", progress="silent")
    run_statics(Job(case, tmp_path / "statics"))
    written = {
        "history.csv": read_table(tmp_path / "run" / "history.csv"),
        "probes.csv": read_table(tmp_path / "run" / "probes.csv"),
        "trajectory.csv": read_table(tmp_path / "run" / "trajectory.csv"),
        "statics.csv": read_table(tmp_path / "statics" / "statics.csv"),
        "string/*.vtu": read_frame(read_series(tmp_path / "run")[-1][1]).point_data,
    }
    for file, titles in written.items():
        for title in titles:
            name, unit = split_name(title)
            row = shown[file][re.sub(r"_(10|15)(?=_|$)", "_NNN", name)]
            assert row[0] == generate.markdown(generate.pretty(unit)), (file, title)
            assert len(row[1]) > 5, (file, title)


def test_the_tables_are_the_catalogue() -> None:
    shown = tables()
    for file, quantities in catalogue.outputs_by_file().items():
        assert [name for name in shown[file] if name in {q.name for q in quantities}] == [
            q.name for q in quantities
        ]
    assert "{eq}`eq-mud-effective-tension`" in " ".join(shown["statics.csv"]["effective_tension"])


def test_the_guide_includes_every_table_and_lists_no_column() -> None:
    guide = (DOCS / "guide" / "outputs.md").read_text(encoding="utf-8")
    included = re.findall(r"^```\{include\} \.\./_generated/(\S+)$", guide, re.MULTILINE)
    assert included == list(generate.OUTPUT_TABLES)
    names = {r["name"] for r in catalogue.records()}
    assert not [line for line in guide.splitlines() if line.startswith("| `") and line.split("`")[1] in names]


def test_references_of_the_program_become_links() -> None:
    text = generate.with_references("One (manual: eq-mud-effective-tension, sec-conventions-signs) (two).")
    assert text == "One {eq}`eq-mud-effective-tension`, ({ref}`sec-conventions-signs`) (two)."
    assert "(manual:" not in "".join(generate.output_tables().values())
