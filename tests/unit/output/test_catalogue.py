"""The catalogue describes every column and array that runs write, once, in words of its own."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from drillpetsc import Case, run
from drillpetsc.analysis.modal import run_modes
from drillpetsc.analysis.statics import run_statics
from drillpetsc.output import read_frame, read_series, read_table
from drillpetsc.output.catalogue import all_quantities, find, in_order, label, outputs_by_file
from drillpetsc.output.files.tables import split_name
from drillpetsc.physics.quantities import BIT

PIPE = {"kind": "pipe", "length": 29.6, "od": 0.127, "id": 0.1086, "element_length": 5.0}
BIT_ITEM = {"kind": "bit", "length": 0.5, "od": 0.2, "mass": 60}
WELL = {
    "survey": {"md": [0, 30], "inclination": [0.3, 0.3], "azimuth": [0, 0]},
    "sections": [{"to": 30, "kind": "casing", "diameter": 0.2159, "friction": 0.2}],
}
DRIVE = {"kind": "top_drive", "rotation": 1.0}
SHORT = {"time": {"end": 0.01}, "output": {"history_every": 0.005, "field_every": 0.01}}
MUD = {
    "density": 1200,
    "rheology": {"model": "bingham", "yield_stress": 5.0, "plastic_viscosity": 0.02},
    "flow_rate": 0.02,
}

CASES: dict[str, dict[str, Any]] = {
    "dry with bit": {
        "string": [PIPE | {"length": 29.5}, BIT_ITEM],
        "top": DRIVE,
        "bottom": "bit",
        "well": WELL,
        "output": SHORT["output"] | {"probes": [10.0]},
    },
    "mud": {"string": [PIPE], "top": DRIVE, "well": WELL, "fluid": MUD},
    "joints": {
        "string": [PIPE],
        "top": DRIVE,
        "joints": [{"at": 15.0, "kind": "universal"}],
        "output": SHORT["output"] | {"probes": [20.0]},
    },
}


def described(title: str, file: str) -> None:
    """A heading has the name and unit of one output of the file."""
    name, unit = split_name(title)
    matching = [q for q in outputs_by_file()[file] if q.matches(name)]
    assert len(matching) == 1, title
    assert matching[0].unit == unit, title


@pytest.mark.parametrize("name", CASES)
def test_every_column_and_array_is_described(name: str, tmp_path: Path) -> None:
    case = Case(**{**SHORT, **CASES[name]})
    run(case, tmp_path / "run", progress="silent")
    run_statics(case, tmp_path / "statics")
    tables = {"run/history.csv", "statics/statics.csv"} | (
        {"run/probes.csv"} if case.output.probes else set()
    )
    for table in sorted(tables | ({"run/trajectory.csv"} if case.well is not None else set())):
        titles = list(read_table(tmp_path / table))
        for title in titles:
            described(title, Path(table).name)
        order = [q.title for q in outputs_by_file()[Path(table).name]]
        assert [t for t in titles if t in order] == [t for t in order if t in titles], table
    for folder in ("run", "statics"):
        for title in read_frame(read_series(tmp_path / folder)[-1][1]).point_data:
            described(title, "string/*.vtu")


def test_the_table_of_modes_is_described(tmp_path: Path) -> None:
    run_modes(Case(string=[PIPE], top="clamped"), tmp_path / "modes", count=2)
    titles = list(read_table(tmp_path / "modes" / "modes.csv"))
    assert titles == [q.title for q in outputs_by_file()["modes.csv"]]


def test_names_and_mnemonics_are_unique() -> None:
    outputs = all_quantities()
    for names in ([q.name for q in outputs], [q.mnemonic for q in outputs]):
        assert len(set(names)) == len(names), [n for n in names if names.count(n) > 1]
    named: dict[str, object] = {}
    for q in (q for several in outputs_by_file().values() for q in several):
        assert named.setdefault(q.name, q) is q, q.name  # one object, whatever file it stands in


@pytest.mark.parametrize("quantity", all_quantities(), ids=lambda q: q.name)
def test_an_output_has_words_for_people(quantity) -> None:
    """A label without underscores, a short mnemonic, one sentence; a signed quantity tells its sign."""
    assert quantity.label and "_" not in quantity.label and quantity.label[0].isupper()
    assert 1 < len(quantity.mnemonic.replace("NNN", "")) <= 4 and quantity.mnemonic.isupper()
    assert quantity.doc.endswith(".") and (quantity.doc[0].isupper() or quantity.doc[0].isdigit())
    assert quantity.sign or quantity.unit in ("-", "s", "J", "m", "kg/m3"), quantity.name
    assert ("NNN" in quantity.name) == (quantity.on in ("joint", "probe"))


def test_an_output_is_found_at_any_depth() -> None:
    for name, pattern in (
        ("x_600", "x_NNN"),
        ("joint_1.5_side_force", "joint_NNN_side_force"),
        ("wob", "wob"),
    ):
        found = find(name)
        assert found is not None and found.name == pattern
    assert find("x_") is None and find("mean_wob") is None and find("joint_1_nothing") is None
    assert label("spin_600.5") == "Spin rate at 600.5 m" and label("nothing") is None


def test_an_output_that_the_catalogue_does_not_list_comes_last() -> None:
    from dataclasses import replace

    own = replace(BIT[0], name="own")
    known = [(None, q) for q in reversed(BIT)]
    assert [q.name for _, q in in_order([(None, own), *known], "history.csv")] == ["wob", "bit_torque", "own"]


def test_the_catalogue_needs_neither_petsc_nor_kernels() -> None:
    code = (
        "import sys, drillpetsc.output.catalogue as c; c.all_quantities(); "
        "print([m for m in ('petsc4py', 'mpi4py', 'drillpetsc.kernels') if m in sys.modules])"
    )
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stdout == "[]\n"
