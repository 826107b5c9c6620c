"""The catalogue describes every column and array that runs write, once, in words of its own."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from drillpetsc import Case, run
from drillpetsc.analysis.commands.statics import run_statics
from drillpetsc.analysis.linear.modal import run_modes
from drillpetsc.output import conditions as where
from drillpetsc.output import read_frame, read_series, read_table
from drillpetsc.output.catalogue import (
    all_quantities,
    find,
    in_order,
    label,
    listed_by_file,
    outputs_by_file,
    records,
)
from drillpetsc.output.files.tables import split_name
from drillpetsc.output.job import Job
from drillpetsc.output.summary_keys import SUMMARY_KEYS
from drillpetsc.physics.quantities import BIT
from tests.helpers.tables import each_row
from tests.helpers.wells import simple_well

PIPE = {"kind": "pipe", "length": 29.6, "od": 0.127, "id": 0.1086, "element_length": 5.0}
BIT_ITEM = {"kind": "bit", "length": 0.5, "od": 0.2, "mass": 60}
WELL = simple_well(30, 0.2159, 0.3, kind="casing", friction=0.2)
DRIVE = {"kind": "top_drive", "rotation": 1.0}
SHORT = {"time": {"end": 0.01}, "output": {"history_every": 0.005, "field_every": 0.01}}
QUASI = {"mode": "quasi_static", "end": 0.01}
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
        "rig": {"block_weight": 1e5},
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
    "quasi-steady mud": {
        "string": [PIPE],
        "top": DRIVE,
        "well": WELL,
        "fluid": MUD | {"dynamics": "quasi_steady"},
    },
    "drilling with mud": {
        "string": [PIPE | {"length": 29.5}, BIT_ITEM | {"nozzle_area": 4e-4}],
        "top": DRIVE,
        "bottom": "bit",
        "formation": {"drillability": 3e-8, "strength": 60e6},
        "well": WELL,
        "fluid": MUD | {"cuttings": "returned"},
    },
    "held": {"string": [PIPE], "top": "clamped", "well": WELL, "fluid": MUD, "hold_string": True},
    "free top, quasi-static": {"string": [PIPE], "top": "free", "bottom": "clamped", "time": QUASI},
}
#: conditions under which outputs exist, in each case
_STRING = {"", where.STRING, where.INERTIA, where.STATIC_START}
_MUD = {where.MUD, where.BORE, where.ANNULUS}
_IN_WELL = {where.WELL, where.CONTACT, where.TOP}
CONDITIONS: dict[str, set[str]] = {
    "dry with bit": {*_STRING, *_IN_WELL, where.TUBES, where.SLOPES, where.BIT, where.BLOCK},
    "mud": {*_STRING, *_IN_WELL, *_MUD, where.TUBES, where.SLOPES, where.MUD_AND_STRING},
    "quasi-steady mud": {
        *_STRING, *_IN_WELL, *_MUD, where.TUBES, where.SLOPES, where.MUD_AND_STRING, where.FOLLOWS,
    },
    "joints": {*_STRING, where.TUBES, where.SLOPES, where.TOP, where.JOINTS},
    "drilling with mud": {
        *_STRING, *_IN_WELL, *_MUD, where.TUBES, where.SLOPES, where.MUD_AND_STRING, where.BIT, where.DRILLS,
        where.CUTS_SIDE, where.CUTTINGS,
    },
    "held": {"", *_MUD, where.WELL, where.INERTIA, where.STATIC_START},
    "free top, quasi-static": {"", where.STRING, where.TUBES, where.SLOPES, where.STATIC_START},
}  # fmt: skip


def described(title: str, file: str) -> None:
    """A heading has the name and unit of one output of the file."""
    name, unit = split_name(title)
    matching = [q for q in outputs_by_file()[file] if q.matches(name)]
    assert len(matching) == 1, title
    assert matching[0].unit == unit, title


def described_and_complete(titles: list[str], file: str, conditions: set[str]) -> None:
    """A file has all outputs that the catalogue lists for its conditions, in order, and no others."""
    for title in titles:
        described(title, file)
    entries = listed_by_file()[file]
    wanted = [entry.quantity for entry in entries if entry.condition in conditions]
    found = [q for q in outputs_by_file()[file] if any(q.matches(split_name(title)[0]) for title in titles)]
    assert [q.name for q in found] == [q.name for q in wanted], file
    order = [q.title for q in wanted]
    assert [title for title in titles if title in order] == [title for title in order if title in titles], (
        file
    )


def summary_keys(block: dict[str, Any], path: str = "") -> Iterator[str]:
    """Paths of the keys of summary.json, without units."""
    for key, value in block.items():
        name = path + split_name(key)[0]
        yield name
        if isinstance(value, dict):
            yield from summary_keys(value, f"{name}.")


def summary_is_described(folder: Path, file: str, conditions: set[str]) -> None:
    """summary.json has the keys that the catalogue lists for its conditions; others are parts of a listed block."""
    found = set(summary_keys(json.loads((folder / "summary.json").read_text())))
    listed = {r["name"]: r["condition"] for r in records() if r["file"] == file}
    wanted = {name for name, condition in listed.items() if condition in conditions}
    assert wanted <= found and not found & (set(listed) - wanted)
    for name in found - wanted:
        is_part = any(name.startswith(f"{block}.") for block in wanted)
        is_block = any(key.startswith(f"{name}.") for key in wanted)
        assert is_part or is_block, name


@pytest.mark.parametrize("name", CASES)
def test_every_output_is_described_with_its_condition(name: str, tmp_path: Path) -> None:
    case, conditions = Case(**{**SHORT, **CASES[name]}), CONDITIONS[name]
    run(case, tmp_path / "run", progress="silent")
    run_statics(Job(case, tmp_path / "statics"))
    tables = {"run/history.csv", "statics/statics.csv"}
    tables |= {"run/probes.csv"} if case.output.probes else set()
    tables |= {"run/trajectory.csv"} if case.well is not None else set()
    for table in sorted(tables):
        described_and_complete(list(read_table(tmp_path / table)), Path(table).name, conditions)
    for folder in ("run", "statics"):
        fields = list(read_frame(read_series(tmp_path / folder)[-1][1]).point_data)
        described_and_complete(fields, "string/*.vtu", conditions)
        summary_is_described(tmp_path / folder, f"summary.json of {folder}", conditions)


def test_the_table_of_modes_is_described(tmp_path: Path) -> None:
    run_modes(Job(Case(string=[PIPE], top="clamped"), tmp_path / "modes"), count=2)
    summary_is_described(tmp_path / "modes", "summary.json of modes", {""})
    titles = list(read_table(tmp_path / "modes" / "modes.csv"))
    assert titles == [entry.quantity.title for entry in listed_by_file()["modes.csv"] if not entry.condition]


def test_names_and_mnemonics_are_unique() -> None:
    outputs = all_quantities()
    for names in ([q.name for q in outputs], [q.mnemonic for q in outputs]):
        assert len(set(names)) == len(names), [n for n in names if names.count(n) > 1]
    named: dict[str, object] = {}
    for q in (q for several in outputs_by_file().values() for q in several):
        assert named.setdefault(q.name, q) is q, q.name  # one object, whatever file it stands in


@each_row("quantity", all_quantities(), ids=lambda q: q.name)
def test_an_output_has_words_for_people(quantity) -> None:
    """A label without underscores, a short mnemonic, one sentence; a signed quantity has a sign."""
    assert quantity.label and "_" not in quantity.label and quantity.label[0].isupper()
    assert (
        1 < len(quantity.mnemonic.replace("NNN", "").replace("NAME", "")) <= 4 and quantity.mnemonic.isupper()
    )
    assert quantity.doc.endswith(".") and (quantity.doc[0].isupper() or quantity.doc[0].isdigit())
    assert quantity.sign or quantity.unit in ("-", "s", "J", "m", "kg/m3"), quantity.name
    assert ("NNN" in quantity.name) == (quantity.on in ("joint", "probe", "rigid_item"))
    assert ("NAME" in quantity.name) == (quantity.on == "sensor")


def test_an_output_is_found_at_any_depth() -> None:
    for name, pattern in (
        ("x_600", "x_NNN"),
        ("joint_1.5_side_force", "joint_NNN_side_force"),
        ("wob", "wob"),
        ("rms_lateral_mwd-2", "rms_lateral_NAME"),
        ("whirl_ratio_600", "whirl_ratio_NNN"),
        ("whirl_600", "whirl_NNN"),
    ):
        found = find(name)
        assert found is not None and found.name == pattern
    assert find("x_") is None and find("mean_wob") is None and find("joint_1_nothing") is None
    assert label("impacts_mwd") == "Impacts of mwd"
    assert label("spin_600.5") == "Spin rate at 600.5 m" and label("nothing") is None


def test_records_are_one_sentence_each() -> None:
    for record in records():
        assert (
            record["doc"].endswith(".")
            and record["name"]
            and all(isinstance(v, str) for v in record.values())
        )
    assert {r["file"] for r in records()} == {*outputs_by_file(), *SUMMARY_KEYS}
    places = [(r["file"], r["name"]) for r in records()]
    assert len(set(places)) == len(places)


def test_an_output_that_the_catalogue_does_not_list_comes_last() -> None:
    from dataclasses import replace

    own = replace(BIT[0], name="own")
    known = [(None, q) for q in reversed(BIT)]
    assert [q.name for _, q in in_order([(None, own), *known], "history.csv")] == ["wob", "bit_torque", "own"]
