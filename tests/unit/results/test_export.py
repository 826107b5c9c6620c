"""Tables of a run folder for other programs: CSV, xlsx and LAS with units and headers as engineers write them."""

from __future__ import annotations

import csv
import math
import sys
from pathlib import Path

import pytest

from drillpetsc.errors import CaseError
from drillpetsc.output import write_summary, write_table
from drillpetsc.reporting import export
from drillpetsc.results import open_run

POUND_FORCE = 4.4482216152605  # [N], NIST SP 811 (2008), appendix B


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A run folder written by hand: 1 and 2 klbf, 60 rpm, probes at two depths, words that look like formulas."""
    history = [("time", "s"), ("hook_load", "N"), ("bit_speed", "rad/s")]
    loads = [1e3 * POUND_FORCE, 2e3 * POUND_FORCE, math.nan]
    run = tmp_path / "run"
    run.mkdir()
    write_table(run / "history.csv", history, [[0.0, 0.5, 1.0], loads, [2 * math.pi] * 3])
    probes = [("time", "s"), ("x_600", "m"), ("x_700", "m")]
    write_table(run / "probes.csv", probes, [[0.0, 1.0], [0.0254, 0.0508], [0.0, 0.0]])
    limits = [("md", "m"), ("item", "-"), ("inclination", "deg")]
    write_table(run / "limits.csv", limits, [[0.0, 304.8, 304.8], ["pipe", "=1+1", "b, c"], [0.0, 3.0, 4.0]])
    trips = [("operation", "-"), ("surge_pressure", "Pa")]
    write_table(run / "surge.csv", trips, [["trip_in"], [6894.757293168]])
    write_summary(run / "summary.json", {"title": "By hand: 1", "status": "done"})
    return run


def rows(file: Path) -> list[list[str]]:
    with file.open(encoding="utf-8", newline="") as opened:
        return list(csv.reader(opened))


def test_csv_has_words_and_units_of_people(folder: Path) -> None:
    files, remarks = export(folder, units="field")
    assert not remarks and {file.name for file in files} == {
        "history.csv", "probes.csv", "limits.csv", "surge.csv",
    }  # fmt: skip
    heads, *body = rows(folder / "export" / "history.csv")
    assert heads[1].startswith("Hook load") and heads[1].endswith("[klbf]") and heads[2].endswith("[rpm]")
    assert [float(row[1]) for row in body[:2]] == pytest.approx([1.0, 2.0]) and body[2][1] == ""
    assert float(body[0][2]) == pytest.approx(60.0)
    heads, *body = rows(folder / "export" / "probes.csv")
    assert "1968.5 ft" in heads[1] and "2296.59 ft" in heads[2] and float(body[0][1]) == pytest.approx(1.0)
    heads, *body = rows(folder / "export" / "limits.csv")
    assert float(body[1][0]) == pytest.approx(1000.0) and body[2][1] == "b, c"


def test_units_of_the_folder_are_metric_where_the_case_has_none(folder: Path) -> None:
    export(folder, columns=["hook_load"])
    heads, *body = rows(folder / "export" / "history.csv")
    assert len(heads) == 2 and heads[1].endswith("[kN]") and float(body[0][1]) == pytest.approx(POUND_FORCE)
    assert not (folder / "export" / "surge.csv").exists()


def test_rows_of_a_roadmap_keep_their_operation(folder: Path) -> None:
    """One column of a roadmap comes with the operation and friction of each row, without which its rows are alike."""
    (folder / "roadmap.csv").write_text(
        "bit_depth [m],operation [-],ff_cased [-],hook_load [N],stretch [m]\n100,trip_in,0.2,1,0\n100,trip_out,0.2,2,0\n"
    )
    export(folder, columns=["hook_load"])
    heads, *body = rows(folder / "export" / "roadmap.csv")
    assert len(heads) == 4 and [row[1] for row in body] == ["trip_in", "trip_out"]


def test_las_is_read_by_lasio(folder: Path) -> None:
    """lasio is an independent reader of LAS files."""
    lasio = pytest.importorskip("lasio")
    files, remarks = export(folder, units="field", format="las")
    assert sorted(file.name for file in files) == ["history.las", "limits.las", "probes.las"]
    assert any("surge is left out" in text for text in remarks)
    assert any("item is left out" in text for text in remarks)
    las = lasio.read(folder / "export" / "history.las")
    assert [curve.mnemonic for curve in las.curves][:2] == ["TIME", "HKLD"]
    assert las.curves["HKLD"].unit == "klbf" and las.well["STEP"].value == 0.5
    assert las["HKLD"][:2] == pytest.approx([1.0, 2.0]) and math.isnan(las["HKLD"][2])
    assert las.well["WELL"].value == "By hand, 1, history"
    probes = lasio.read(folder / "export" / "probes.las")
    assert len({curve.mnemonic for curve in probes.curves}) == 3
    depth = lasio.read(folder / "export" / "limits.las")
    assert depth["DEPT"] == pytest.approx([0.0, 1000.0]) and depth.curves["DEPT"].unit == "ft"
    assert any("the first is kept" in text for text in remarks)


def test_a_workbook_has_a_sheet_for_each_table(folder: Path) -> None:
    openpyxl = pytest.importorskip("openpyxl")
    (file,) = open_run(folder).export(folder / "out", units="field", format="xlsx")
    assert file == folder / "out" / "run.xlsx"
    book = openpyxl.load_workbook(file)
    assert book.sheetnames == ["history", "limits", "probes", "surge"]
    assert book["history"]["B2"].value == pytest.approx(1.0) and book["history"]["B4"].value is None
    assert book["limits"]["B3"].value == "=1+1" and book["limits"]["B3"].data_type == "s"


def test_parquet_holds_values_with_names_and_units(folder: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    files = open_run(folder).export(folder / "out", units="field", format="parquet")
    assert {file.name for file in files} == {
        f"{name}.parquet" for name in ("history", "limits", "probes", "surge")
    }
    table, text = (parquet.read_table(folder / "out" / f"{name}.parquet") for name in ("history", "limits"))
    assert table.column(1)[0].as_py() == pytest.approx(1.0)  # 1 klbf
    assert table.schema.field(1).metadata == {b"name": b"hook_load", b"unit": b"klbf"}
    assert "=1+1" in [cell for column in text.columns for cell in column.to_pylist()]
    assert (folder / "out" / "history.parquet").read_bytes() == files[0].read_bytes()


@pytest.mark.parametrize(
    ("keywords", "at"),
    [
        ({"format": "feather"}, "--format"),
        ({"units": "feet"}, "--units"),
        ({"columns": ["hook_lod"]}, "--columns"),
    ],
)
def test_wrong_options_are_refused(folder: Path, keywords: dict, at: str) -> None:
    with pytest.raises(CaseError) as caught:
        export(folder, **keywords)
    assert caught.value.at == at and not (folder / "export").exists()
    if at == "--columns":
        assert "hook_load" in caught.value.hint


def test_folders_without_tables_are_refused(folder: Path, tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    for path in (tmp_path / "empty", tmp_path / "nowhere", folder / "history.csv"):
        with pytest.raises(CaseError, match="RUN"):
            export(path)
    (tmp_path / "empty" / "notes.csv").write_text("mine\n1,2\n")
    with pytest.raises(CaseError, match="tables with rows"):
        export(tmp_path / "empty")
    (tmp_path / "empty" / "history.csv").write_text("time [s]\n1,2\n3\n")
    with pytest.raises(CaseError, match="a table of this program"):
        export(tmp_path / "empty")
    (tmp_path / "empty" / "sweep.csv").write_text("member [-]\n1\n")
    with pytest.raises(CaseError, match="a sweep"):
        export(tmp_path / "empty")
    for file in ("history.csv", "probes.csv", "limits.csv"):
        (folder / file).unlink()
    with pytest.raises(CaseError, match="time or depth"):
        export(folder, format="las")


def test_a_missing_package_is_named(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(CaseError, match="pyarrow"):
        export(folder, format="parquet")
    monkeypatch.setitem(sys.modules, "openpyxl", None)
    with pytest.raises(CaseError) as caught:
        export(folder, format="xlsx")
    assert "files" in caught.value.hint and not (folder / "export").exists()
