"""Plans of sweeps: members, refused values, worker groups, restarts, and the table."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from drillpetsc.case import Case, case_from_data
from drillpetsc.errors import CaseError
from drillpetsc.output import read_table
from drillpetsc.studies.convergence.plan import read_base
from drillpetsc.studies.sweep.plan import plan_sweep, plan_wells
from drillpetsc.studies.sweep.table import Action, Member, Outcome, claim, outcomes, store_outcome, write
from drillpetsc.studies.sweep.variations import choices_from, choices_of, split_values, variations
from drillpetsc.studies.sweep.worker_groups import LEAST_ELEMENTS, group_sizes
from tests.helpers.tables import each_row

CASE = """
well:
  survey: {md: [0 m, 60 m], inclination: [60 deg, 60 deg], azimuth: [0 deg, 0 deg]}
  sections: [{to: 60 m, kind: casing, diameter: 215.9 mm, friction: 0.2}]
string: [{kind: pipe, length: 50 m, od: 127 mm, id: 108.6 mm}]
top: {kind: top_drive, rotation: 60 rpm}
fluid: {density: 1000, rheology: {model: newtonian, viscosity: 1 mPa s}, bulk_modulus: 2 GPa, flow_rate: 10 l/s}
time: {end: 0.05 s}
"""


@pytest.fixture
def file(tmp_path) -> Path:
    path = tmp_path / "small.yaml"
    path.write_text(CASE)
    return path


@each_row(
    "text, parts",
    [
        ("20 l/s,30 l/s", ["20 l/s", "30 l/s"]),
        ("[1 m, 2 m],[3 m]", ["[1 m, 2 m]", "[3 m]"]),
        ("{kind: top_drive, rotation: 1}, free", ["{kind: top_drive, rotation: 1}", "free"]),
        ("'a, b',c", ["'a, b'", "c"]),
        ("5.5',6'", ["5.5'", "6'"]),  # an apostrophe that ends a word opens no quote
        ("1", ["1"]),
    ],
)
def test_lists_split_at_commas_outside_brackets_and_quotes(text, parts):
    assert split_values(text) == parts


def test_every_combination_the_last_key_fastest_in_si(file):
    """1.2 g/cm3 = 1200 kg/m3, 20 l/s = 0.02 m3/s."""
    found = variations(file, choices_of(["fluid.density=1000,1.2 g/cm3", "fluid.flow_rate=20 l/s,30 l/s"]))
    numbers = [(v.number_of("fluid.density"), v.number_of("fluid.flow_rate")) for v in found]
    assert numbers == [(1000, 0.02), (1000, 0.03), (1200, 0.02), (1200, 0.03)]
    assert found[2].label == "fluid.density=1.2 g/cm3, fluid.flow_rate=20 l/s"


def test_a_block_that_is_off_makes_one_member_of_all_its_values(file):
    """2 x 2 with fluid and one without, in whatever order the keys stand."""
    found = variations(
        file, choices_of(["fluid.density=1000,1200", "fluid=on,off", "fluid.flow_rate=1 l/s,2 l/s"])
    )
    assert sorted(v.case.fluid is None for v in found) == [False] * 4 + [True]
    dry = next(v for v in found if v.case.fluid is None)
    assert (
        dry.values == {"fluid.density": "-", "fluid": "off", "fluid.flow_rate": "-"}
        and dry.number_of("fluid.density") is None
    )


def test_contact_is_switched_off_although_its_absence_would_mean_defaults(file):
    on, off = variations(file, choices_of(["contact=on,off"]))
    assert on.case.contact is not None and off.case.contact is None and off.case.well is not None


def test_python_values_are_those_of_the_words(file):
    words = variations(
        file,
        choices_of(["fluid.density=1000,1.2 g/cm3", "output.probes=[1, 2],[3]", "fluid.annulus=true,false"]),
    )
    values = {
        "fluid.density": [1000, "1.2 g/cm3"],
        "output.probes": ([1, 2], [3]),
        "fluid.annulus": [True, False],
    }
    assert [v.case for v in words] == [v.case for v in variations(file, choices_from(values))] and len(
        words
    ) == 8


@pytest.mark.parametrize(
    "words, at, got",
    [
        (["fluid.flow_rate=20 l/s,20 kg"], "fluid.flow_rate", "20 kg"),
        (["fluid.densty=1000"], "fluid.densty", "1000"),
        (["string[0].od=5 in,20 in"], "string[0].od", "20 in"),
        (["string[4].od=5 in"], "string[4].od", "5 in"), (["fluid.density={a"], "fluid.density", "{a"),
        (["fluid.density=1,"], "fluid.density", "1,"), (["fluid.density=1,1"], "fluid.density", "1"),
        (["fluid.density=1", "fluid.density=2"], "fluid.density", "2"),
        (["formation=on,off"], "formation", "on"), (["string[0]=off"], "string[0]", "off"),
        (["top=on,off"], "top", "on"), (["fluid.density"], "", "fluid.density"),
    ],
)  # fmt: skip
def test_errors_name_key_and_value(file, words, at, got):
    with pytest.raises(CaseError) as caught:
        variations(file, choices_of(words))
    assert (caught.value.at, caught.value.got) == (at, got)
    assert at in str(caught.value) and got in str(caught.value)


def test_all_wrong_values_are_reported_at_once_with_the_member(file):
    with pytest.raises(CaseError) as caught:
        variations(file, choices_of(["fluid.flow_rate=20 kg,20 l/s", "top.rotation=3 m"]))
    text = str(caught.value)
    assert (
        "20 kg" in text and "3 m" in text and "in the member fluid.flow_rate=20 kg, top.rotation=3 m" in text
    )


def test_a_case_without_time_is_refused(file):
    file.write_text(CASE.replace("time: {end: 0.05 s}\n", ""))
    with pytest.raises(CaseError, match="time"):
        variations(file, choices_of(["fluid.density=1000"]))


# ---------------------------------------------------------------------- ranks
BIG = 100 * LEAST_ELEMENTS


@each_row(
    "costs, elements, ranks, sizes",
    [
        ([1, 1, 1, 1], [BIG] * 4, 2, [1, 1]),  # two groups, the other members wait
        ([1, 1, 1, 1], [BIG] * 4, 4, [1, 1, 1, 1]),
        ([1, 1], [BIG] * 2, 4, [2, 2]),
        ([1, 1], [BIG] * 2, 5, [3, 2]),
        (
            [6, 1, 1],
            [BIG] * 3,
            4,
            [3, 1],
        ),  # a share of 3 ranks of 4; the two small ones follow each other on the fourth
        ([3, 1], [BIG] * 2, 4, [3, 1]),
        ([1, 1], [LEAST_ELEMENTS] * 2, 4, [1, 1]),  # strings too short for two ranks each
        ([1], [BIG], 3, [3]),
        ([], [], 3, []),
    ],
)
def test_ranks_follow_the_expected_cost(costs, elements, ranks, sizes):
    assert group_sizes(costs, elements, ranks) == sizes


def test_groups_never_outnumber_the_ranks():
    """For descending costs of any spread, every group has at least one rank; if members wait, the last group
    has one rank."""
    for spread in (1.0, 0.9, 0.5, 0.1, 1e-3):
        for members in range(1, 9):
            costs = [spread**k for k in range(members)]
            for ranks in range(1, 12):
                sizes = group_sizes(costs, [BIG] * members, ranks)
                assert sum(sizes) <= ranks and min(sizes) >= 1 and len(sizes) <= members
                assert len(sizes) == members or (sum(sizes) == ranks and sizes[-1] == 1)


# ---------------------------------------------------------------------- folders and table
def _members(file: Path, words: list[str]) -> list[Member]:
    return [
        Member(
            k,
            f"member-{k:03d}",
            v.values,
            v.case,
            5,
            {key: n for key in v.values if (n := v.number_of(key)) is not None},
        )
        for k, v in enumerate(variations(file, choices_of(words)), 1)
    ]


def _leave(folder: Path, member: Member, status: str, checkpoint: bool) -> None:
    """Create a run folder as a run writes it."""
    folder.mkdir()
    member.case.dump(folder / "case.yaml")
    (folder / "summary.json").write_text(json.dumps({"status": status}))
    if checkpoint:
        (folder / "checkpoint.h5").touch()


def test_a_restart_keeps_done_members_and_continues_those_with_a_checkpoint(file, tmp_path):
    """Members are identified by their case, so values may be added. Another case never gets a folder with
    results."""
    out = tmp_path / "out"
    old = _members(file, ["fluid.density=1000,1100,1200,1300"])
    plan = plan_sweep("", "small", old, out, False, False)
    assert [p.action for p in plan.folders] == [Action.NEW] * 4
    write(plan, {})
    _leave(plan.folders[0].folder, old[0], "done", True)
    _leave(plan.folders[1].folder, old[1], "failed: x", True)
    _leave(plan.folders[2].folder, old[2], "failed: x", False)
    again = plan_sweep(
        "", "small", _members(file, ["fluid.density=900,1000,1100,1200,1300"]), out, True, False
    )
    assert [(p.folder.name, p.action) for p in again.folders] == [
        ("member-006", Action.NEW), ("member-001", Action.KEEP), ("member-002", Action.CONTINUE),
        ("member-003", Action.AGAIN), ("member-005", Action.NEW),
    ]  # fmt: skip


def test_an_existing_folder_is_refused_and_one_without_a_sweep_not_continued(file, tmp_path):
    members = _members(file, ["fluid.density=1000"])
    (tmp_path / "out").mkdir()
    with pytest.raises(FileExistsError, match="--restart"):
        plan_sweep("", "small", members, tmp_path / "out", False, False)
    with pytest.raises(CaseError, match="sweep"):
        plan_sweep("", "small", members, tmp_path / "out", True, False)
    with pytest.raises(FileNotFoundError):
        plan_sweep("", "small", members, tmp_path / "none", True, False)


def test_overwrite_removes_members_and_nothing_else(file, tmp_path):
    members, out = _members(file, ["fluid.density=1000,1100"]), tmp_path / "out"
    write(plan_sweep("", "small", members, out, False, False), {})
    for member in members:
        _leave(out / member.name, member, "done", True)
    (out / "notes.txt").write_text("a note")
    (out / "member-002" / "notes.txt").write_text("a note")
    plan_sweep("", "small", members, out, False, True)
    assert (
        (out / "notes.txt").exists()
        and not (out / "member-001").exists()
        and not (out / "sweep.csv").exists()
    )
    assert [p.name for p in (out / "member-002").iterdir()] == ["notes.txt"]


def test_wells_go_to_folders_of_their_own_names(file, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    case = _members(file, ["fluid.density=1000"])[0].case
    wells = [Member(k, name, {"case": name}, case, 5) for k, name in enumerate(("a", "b"), 1)]
    numbered = plan_wells(wells, None, False, False)
    assert [str(p.folder) for p in numbered.folders] == ["results/a-001", "results/b-001"]
    assert [p.folder.name for p in plan_wells(wells, tmp_path / "pad", False, False).folders] == ["a", "b"]


def test_the_table_has_the_state_of_each_member(file, tmp_path):
    members = _members(file, ["fluid.density=1000,1100 kg/m3,1200"])
    plan = plan_sweep("title", "small", members, tmp_path / "out", False, False)
    assert claim(plan, members[0]) and claim(plan, members[1]) and not claim(plan, members[1])
    store_outcome(plan, Outcome(1, "done", "", (2, 3), 1.5, {"wob [N]": 7.0, "rop [m/s]": float("nan")}))
    write(plan, {"ranks": 4})
    table = read_table(tmp_path / "out" / "sweep.csv")
    assert table["status"].tolist() == ["done", "running", "waiting"]
    assert table["fluid.density"].tolist() == ["1000", "1100 kg/m3", "1200"] and table[
        "fluid.density (SI)"
    ].tolist() == [1000, 1100, 1200]
    assert table["wob [N]"][0] == 7 and table["ranks"].tolist() == [2, 0, 0]
    store_outcome(plan, Outcome(2, "failed", 'broke, "so"', (0,), 0.5))
    store_outcome(plan, Outcome(3, "done", "", (1,), 0.5))
    write(plan, {"ranks": 4})
    assert read_table(tmp_path / "out" / "sweep.csv")["message"].tolist() == ["", 'broke, "so"', ""]
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert (summary["status"], summary["done"], summary["failed"], summary["title"]) == (
        "failed", 2, 1, "title",
    )  # fmt: skip
    assert [m["computed_by"] for m in summary["members"]] == [[2, 3], [0], [1]] and set(outcomes(plan)) == {
        1,
        2,
        3,
    }
    assert summary["units"] == {"fluid.density": "kg/m3"}


def test_a_case_built_in_python_is_varied_like_its_file() -> None:
    """Bare numbers keep the units of the case (1 ft = 0.3048 m), and an error names no file."""
    case = Case(
        units="field",
        string=[{"kind": "pipe", "length": 300, "od": 5, "id": 4.276}],
        top="clamped",
        time={"end": 1.0},
    )
    found = variations(case, choices_from({"string[0].length": [400, 500]}))
    assert [v.case.string[0].length for v in found] == pytest.approx([121.92, 152.4], rel=1e-14)
    base = read_base(case, {})
    assert base.end == 1.0 and case_from_data(base.data, base.path, base.lines).string == case.string
    with pytest.raises(CaseError) as caught:
        variations(case, choices_from({"string[0].length": ["3 s"]}))
    assert caught.value.file is None and "string[0].length" in str(caught.value)
