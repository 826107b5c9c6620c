"""A user's own catalogue: rows before the built-in ones; errors with file, line and column."""

from __future__ import annotations

from pathlib import Path

import pytest

import drillpetsc
from drillpetsc.case import Case, load_case
from drillpetsc.case.catalogue import Catalogue, find_pipe
from drillpetsc.errors import CaseError
from tests.helpers.tables import each_row

JOINTS = """# rig 7
size [in],nominal [lb/ft],grade,connection,od [in],id [in],length [in],adjusted [lb/ft],source
5,19.50,S-135,HT55,7,4,25,26.48,Workstrings sheet
5,19.50,S,NC50,6 5/8,3 1/2,21,23.52,Workstrings sheet
"""
CASE = """catalogue: {catalogue}
string:
  - {{kind: drill_pipe, length: 90 m, pipe: {pipe}}}
top: clamped
"""


def test_rows_of_the_user_come_first(tmp_path: Path) -> None:
    (tmp_path / "pipes").mkdir()
    (tmp_path / "pipes" / "tool_joint-rig7.csv").write_text(JOINTS)
    (tmp_path / "case.yaml").write_text(CASE.format(catalogue="pipes", pipe="5in 19.50 S-135 HT55"))
    case = load_case(tmp_path / "case.yaml")
    pipe = case.string[0]
    assert pipe.tool_joint.od == pytest.approx(7 * 0.0254)
    assert pipe.adjusted_weight == pytest.approx(26.48 * 0.45359237 / 0.3048)
    sources = {figure.key: figure.source for figure in case.figures.of_item[0]}
    assert sources["tool_joint.od"] == "catalogue tool_joint-rig7.csv line 3"
    # the same connection as a built-in row: the user's is taken
    (tmp_path / "case.yaml").write_text(CASE.format(catalogue="pipes", pipe="5in 19.50 S-135 NC50"))
    assert load_case(tmp_path / "case.yaml").string[0].tool_joint.id == pytest.approx(3.5 * 0.0254)
    # the case that was written out needs no catalogue
    again = tmp_path / "elsewhere.yaml"
    again.write_text(case.to_yaml())
    (tmp_path / "pipes" / "tool_joint-rig7.csv").unlink()
    assert load_case(again) == case


def test_one_file_of_a_user(tmp_path: Path) -> None:
    file = tmp_path / "drill_pipe.csv"
    file.write_text("size [in],nominal [lb/ft],id [in]\n4.75,18.00,4.0\n")
    row = find_pipe(Catalogue.built_in().with_files(file), "4 3/4 18.00", joint_needed=False).tube
    assert row["wall"] == pytest.approx(0.375)
    assert row["plain_end"] == pytest.approx(3.3996 * 0.7853982 * (4.75**2 - 16), rel=1e-4)
    assert "no source" in row.source
    assert drillpetsc.catalogue("4 3/4", file)[0]["id"] == 4.0


@each_row(
    ("name", "text", "line", "at", "want"),
    [
        ("drill_pipe.csv", "", 1, "", "a header such as: size [in]"),
        ("drill_pipe.csv", "size [in],weight [lb/ft]\n", 1, "weight", "each column once"),
        ("drill_pipe.csv", "size [in],size [in],nominal [lb/ft]\n", 1, "size", "each column once"),
        ("drill_pipe.csv", "size [mm],nominal [lb/ft]\n", 1, "size", "size [in]"),
        ("drill_pipe.csv", "size [in],id [in]\n", 1, "nominal", "a column nominal"),
        ("drill_pipe.csv", "size [in],nominal [lb/ft]\n5,19.50\n", 2, "id", "an inner diameter or a wall"),
        ("drill_pipe.csv", "size [in],nominal [lb/ft],id [in]\n5,x,4\n", 2, "nominal", "a number above 0"),
        ("drill_pipe.csv", "size [in],nominal [lb/ft],id [in]\n5,nan,4\n", 2, "nominal", "a number above 0"),
        ("drill_pipe.csv", "size [in],nominal [lb/ft],id [in]\n\n#\n5,19.5,6\n", 4, "id", "below the outer"),
        ("drill_pipe.csv", "size [in],nominal [lb/ft],id [in]\n5,19.5\n", 2, "", "3 cells"),
        ("drill_pipe.csv", "size [in],nominal [lb/ft],id [in]\n5,,4\n", 2, "nominal", "a value"),
        (
            "drill_pipe.csv", "size [in],nominal [lb/ft],id [in],plain_end [lb/ft]\n5,19.5,4.276,19\n", 2,
            "plain_end", "17.93",
        ),
        (
            "tool_joint.csv",
            "size [in],nominal [lb/ft],grade,connection,od [in],id [in],length [in]\n5,19.5,S,X,4,3,9\n",
            2,
            "od",
            "at least the size of the pipe",
        ),
        ("class.csv", "class,wall\nworn,1.2\n", 2, "wall", "at most 1"),
        (
            "hwdp.csv",
            "size [in],id [in],connection,tool_joint_od [in],tool_joint_id [in],tool_joint_length [in],weight [lb/ft]\n5,3,NC50,6.5,3,48,30\n",
            2,
            "weight",
            "plain tube",
        ),
        ("pipes.csv", "size [in]\n5\n", None, "catalogue", "drill_pipe.csv"),
    ],
)  # fmt: skip
def test_bad_files(tmp_path: Path, name: str, text: str, line: int | None, at: str, want: str) -> None:
    (tmp_path / name).write_text(text)
    with pytest.raises(CaseError) as caught:
        Catalogue.built_in().with_files(tmp_path / name)
    assert caught.value.line == line
    assert caught.value.at == at
    assert want in caught.value.want
    assert name in str(caught.value)


def test_a_catalogue_that_is_not_there(tmp_path: Path) -> None:
    (tmp_path / "pipes").mkdir()
    (tmp_path / "case.yaml").write_text(CASE.format(catalogue="pips", pipe="5in 19.50 S-135"))
    with pytest.raises(CaseError) as caught:
        load_case(tmp_path / "case.yaml")
    assert (caught.value.at, caught.value.line) == ("catalogue", 1)
    assert "did you mean 'pipes'" in caught.value.hint
    (tmp_path / "case.yaml").write_text(CASE.format(catalogue="pipes", pipe="5in 19.50 S-135"))
    with pytest.raises(CaseError, match="a folder with CSV files"):
        load_case(tmp_path / "case.yaml")


def test_search_from_python() -> None:
    rows = drillpetsc.catalogue("5in")
    assert {row.table for row in rows} == {"drill_pipe", "tool_joint", "hwdp", "casing"}
    assert all(row["size"] == 5.0 for row in rows)
    assert [row["nominal"] for row in rows if row.table == "drill_pipe"] == [16.25, 19.5, 25.6]
    assert [row["weight"] for row in drillpetsc.catalogue("8 x 3")] == [146.9]
    assert {row["connection"] for row in drillpetsc.catalogue("NC38")} == {"NC38"}
    assert {row["connection"] for row in drillpetsc.catalogue("3 1/2 IF")} == {"NC38"}
    assert [row.table for row in drillpetsc.catalogue("5in 19.50 S-135 NC50 premium")] == [
        "drill_pipe", "tool_joint", "grade", "class",
    ]  # fmt: skip
    text = str(drillpetsc.catalogue("5in 19.50"))
    assert "395,595 lbf" in text and "1760 kN" in text and "drill_pipe.csv line 19" in text
    assert "<td>19.50 lb/ft</td>" in drillpetsc.catalogue("5in")._repr_html_()
    assert len(drillpetsc.catalogue()) > 100
    assert "Rows marked NO" in text
    marks = [line.split("  ") for line in text.splitlines() if "as recalled: unverified" in line]
    assert marks and all("NO" in cells for cells in marks)
    assert "Rows marked NO" not in str(drillpetsc.catalogue("8 x 3"))
    with pytest.raises(CaseError, match="sizes of drill pipe"):
        drillpetsc.catalogue("5.2in")


def test_absent_catalogue_costs_nothing() -> None:
    """A string of plain pipe reads no table."""
    Catalogue.built_in.cache_clear()
    Case(string=[{"kind": "pipe", "length": 9, "od": 0.1}], top="clamped")
    assert Catalogue.built_in.cache_info().currsize == 0
