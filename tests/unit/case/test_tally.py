"""Tallies and string sheets in CSV and xlsx."""

from __future__ import annotations

import random
from pathlib import Path

import pytest

from drillpetsc.case import load_case
from drillpetsc.case.importers.edm import Wanted
from drillpetsc.case.importers.fragment import fragment
from drillpetsc.errors import CaseError
from tests.helpers.records import record

G = 9.80665
SHEET = """\
# BHA 3
Item,Description,OD (in),ID (in),Length (ft),Weight (lb/ft),Grade
1,8 1/2 PDC bit,8.5,,1,,
2,MWD,6.75,2.8125,30,95,
3,Drill collar,6.75,2.8125,180,100.8,
4,HWDP,5,3,600,49.3,
5,Drill pipe,5,4.276,"9,000",19.5,S-135
"""


@pytest.fixture(autouse=True)
def _here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def read(text: str, assembly: str | None = None) -> tuple[str, list[str]]:
    Path("tally.csv").write_text(text)
    return fragment(["tally.csv"], Path(), Wanted(assembly=assembly))


def string(text: str) -> list[tuple[str, str, float]]:
    """(kind, name, length [ft]) of the items of a tally, as a case has them."""
    Path("case.yaml").write_text(read(text)[0] + "top: clamped\n")
    return [(item.kind, item.name, round(item.length / 0.3048, 3)) for item in load_case("case.yaml").string]


KINDS = [
    ("pipe", "Drill pipe", 9000), ("pipe", "HWDP", 600), ("drill_collar", "Drill collar", 180), ("tool", "MWD", 30),
    ("bit", "8 1/2 PDC bit", 1),
]  # fmt: skip


def test_a_sheet_from_the_bit_up_and_from_the_rig_down() -> None:
    assert string(SHEET) == KINDS
    comment, heads, *rows = SHEET.splitlines()
    assert string("\n".join([heads, *rows[::-1]])) == KINDS


@pytest.mark.parametrize("separator", [";", "\t"])
def test_separators_and_units_after_an_underscore(separator: str) -> None:
    text = "name,od_in,id_in,length_ft,weight_in_air_N_per_m\njar,8.375,3.25,32.8,1824\n"
    found = read(text.replace(",", separator))[0]
    assert f"weight: {1824 / G:.6g} kg/m" in found and "kind: tool" in found


def test_a_workbook() -> None:
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    for line in SHEET.splitlines():
        book.active.append([cell.strip('"') for cell in line.replace('"9,000"', "9000").split(",")])
    book.save("tally.xlsx")
    text, _ = fragment(["tally.xlsx"], Path())
    Path("case.yaml").write_text(text + "top: clamped\n")
    assert [item.name for item in load_case("case.yaml").string] == [name for _, name, _ in KINDS]


def test_commas_show_what_they_are_or_are_refused() -> None:
    """With semicolons a comma may mean decimals: 9,5 does, 12,345 alone may be both. An infinite length is not a number."""
    head = "name;od [in];id [in];length [m]\n"
    assert "length: 9.5 m" in read(head + "jar;8,375;3,25;9,5\n")[0]
    with pytest.raises(CaseError, match="may be 12345 or 12.345"):
        read(head + "jar;8;3;12,345\n")
    with pytest.raises(CaseError, match="a number, 0 or above"):
        read(head + "jar;8;3;1e999\n")


def test_diameters_as_fractions() -> None:
    """8 1/2 in of a tally is 8.5 in, also with a sign of inches."""
    sheet = SHEET.replace("bit,8.5,", "bit,8 1/2,").replace("collar,6.75,", 'collar,"6-3/4""",')
    assert read(sheet) == read(SHEET)


def test_a_row_that_begins_with_an_error_of_a_spreadsheet_is_not_a_comment() -> None:
    rows = "length [m],od [in],id [in],name\n9,8,3,jar\n"
    assert "jar" in read(rows + "# a comment,8,3,MWD\n")[0]
    with pytest.raises(CaseError, match="#REF!"):
        read(rows + "#REF!,8,3,MWD\n")


def test_swapped_weights_are_named() -> None:
    """Drill pipe at 49.3 lb/ft and heavy-wall pipe at 19.5 lb/ft: 2.8 and 0.46 times steel of their size."""
    swapped = SHEET.replace("600,49.3", "600,19.5").replace('"9,000",19.5', '"9,000",49.3')
    said = read(swapped)[1]
    assert any("Drill pipe and HWDP fit if they are swapped" in line for line in said)
    assert sum("times a steel tube" in line for line in said) == 2
    assert not any("WARNING" in line for line in read(SHEET)[1])


def test_a_total_instead_of_a_weight_per_length() -> None:
    said = read(SHEET.replace("180,100.8", "180,18144"))[1]
    assert any("Drill collar: " in line and "not a plausible weight" in line for line in said)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("6.75,2.8125,30", "six,2.8125,30", "line 4: od[\\s\\S]*six"),
        ("600,49.3", ",49.3", "length[\\s\\S]*above 0"),
        ("OD (in)", "OD", "no unit"),
        ("1,8 1/2 PDC bit,8.5,,1,,\n2,MWD,6.75,2.8125,30,95,", "2,MWD,6.75,2.8125,30,95,\n1,8 1/2 PDC bit,8.5,,1,,", "first or in the last row"),
        ("2,MWD", "2,", "line 4: name"),
    ],
)  # fmt: skip
def test_refused(old: str, new: str, words: str) -> None:
    with pytest.raises(CaseError, match=words):
        read(SHEET.replace(old, new))


def test_several_strings() -> None:
    text = "run,name,od_m,length_m\n1,pipe,0.127,9\n2,tubing,0.1778,12\n"
    with pytest.raises(CaseError, match="--assembly with 1 or 2"):
        read(text)
    assert "177.8 mm" in read(text, "2")[0]
    with pytest.raises(CaseError, match="--assembly[\\s\\S]*one of 1, 2"):
        read(text, "3")


def test_mutants_of_a_tally_are_read_or_refused() -> None:
    """No traceback, whatever is in the cells."""
    rng = random.Random(5)
    for _ in range(300):
        letters = list(SHEET)
        for _ in range(rng.randint(1, 6)):
            letters[rng.randrange(len(letters))] = rng.choice('0.,;"x-\n\t()é ')
        try:
            read("".join(letters))
        except CaseError:
            pass


def test_the_sheet_of_volve_f5() -> None:
    """Ten rows from the bit up; weights in N/m as in the file."""
    text, said = fragment([record("volve-f5/string-12in.csv")], Path())
    assert not any("WARNING" in line for line in said)
    Path("case.yaml").write_text(text + "top: clamped\n")
    items = load_case("case.yaml").string
    assert len(items) == 10 and items[0].length == 1481 and items[3].name == "jar"
    ring = 3.141592653589793 / 4 * (0.212725**2 - 0.08255**2)
    assert items[3].material.density * ring * G == pytest.approx(1824.04, rel=1e-5)  # type: ignore[union-attr]


def test_a_string_that_does_not_reach_the_rig_is_named() -> None:
    Path("survey.csv").write_text("md_ft,inc_deg,azi_deg\n0,0,0\n12000,0,0\n")
    Path("tally.csv").write_text(SHEET)
    text, said = fragment(["survey.csv", "tally.csv"], Path())
    assert any(
        "2990.39 m long, the survey ends at 3657.6 m" in line and "length: fill" in line for line in said
    )
    Path("survey.csv").write_text("md_ft,inc_deg,azi_deg\n0,0,0\n9820,0,0\n")
    assert not any("length: fill" in line for line in fragment(["survey.csv", "tally.csv"], Path())[1])
