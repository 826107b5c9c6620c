"""Surveys as they come out of other programs: what is read, what is reported, what is refused."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest

from drillpetsc.case.files.survey_file import read_survey
from drillpetsc.case.importers.stations import Rules, Stations, dogleg, minimum_curvature_step
from drillpetsc.errors import CaseError
from tests.helpers.tables import each_row

FOOT = 0.3048


def read(tmp_path: Path, text: str, encoding: str = "utf-8", **rules: Any) -> Stations:
    (tmp_path / "well.csv").write_bytes(text.encode(encoding))
    return read_survey(str(tmp_path / "well.csv"), Rules(**rules))


def check(found: Stations, md: list[float], inclination: list[float], azimuth: list[float]) -> None:
    assert found.md == pytest.approx(md, rel=1e-12)
    assert [math.degrees(angle) for angle in found.inclination] == pytest.approx(inclination, abs=1e-9)
    assert [math.degrees(angle) for angle in found.azimuth] == pytest.approx(azimuth, abs=1e-9)


# ---------------------------------------------------------------------- closed forms and published values
def test_minimum_curvature_of_a_published_example() -> None:
    """100 ft from 15 deg N20E to 25 deg N45E: dogleg 12.95165 deg, 27.218 ft N, 19.451 ft E, 94.012 ft down
    (petrocalchub.com and drillingformulas.com, recomputed with the formulas of Sawaryn and Thorogood, SPE 84246)."""
    angles = [math.radians(angle) for angle in (15, 20, 25, 45)]
    assert math.degrees(dogleg(*angles)) == pytest.approx(12.95165, rel=1e-5)
    assert minimum_curvature_step(100, *angles) == pytest.approx((27.218, 19.451, 94.012), abs=6e-4)


@pytest.mark.parametrize(
    ("length", "stations", "severity"),
    [  # feet, degrees, degrees per 100 ft
        (
            31,
            (13.5, 10, 14.7, 19),
            8.051,
        ),  # Lapeyrouse, Formulas and Calculations, dogleg severity by minimum curvature
        (
            95,
            (45, 130, 52, 139),
            10.217,
        ),  # the same inputs give 1.07 by the "tangential method" of some pages, which is wrong
    ],
)
def test_dogleg_severity(length: float, stations: tuple[float, ...], severity: float) -> None:
    angle = math.degrees(dogleg(*[math.radians(angle) for angle in stations]))
    assert angle / length * 100 == pytest.approx(severity, rel=1e-3)


def test_a_quarter_circle() -> None:
    """From vertical to level along an arc of 90 m: r = 180/pi m north and down (closed form)."""
    step = minimum_curvature_step(90, 0, 0, math.pi / 2, 0)
    assert step == pytest.approx((180 / math.pi, 0, 180 / math.pi))


# ---------------------------------------------------------------------- spellings
@each_row(
    "text",
    [
        "Measured Depth (ft),Incl.,Azim\n0,0,0\n98.4251968503937,1.5,359\n",
        "MD,Inc,Azi\nft,deg,deg\n0,0,0\n98.4251968503937,1.5,359\n",
        "MD, INC, AZI\n(ft), (deg), (deg)\n0,0,0\n98.4251968503937,1.5,359\n",
        "# Depth unit: ft\nDepth;Inclination;Azimuth\n0;0;0\n98,4251968503937;1,5;359\n",
        "Company: ACME\nWell: X-1\n\nMD/ft\tIncl/deg\tAzi/deg\t\n0\t0\t0\t\n98.4251968503937\t1.5\t359\t\n",
        "! export\r\n// of a program\r\nDEPT [FT],DRIFT [DEG],HAZI [DEG],,\r\n0,0,0,,\r\n98.4251968503937,1.5,359,,\r\n",
        "Meas. Depth [ft]   Inclination [deg]   Azimuth [deg]\n0   0  0\n98.4251968503937  1.5   359\n",
        "#MD [ft], Inc, Azi\n0,0,0\n98.4251968503937,1.5,359\n",
        "md {usft} ; inc ; az\n0;0;0\n98,4250000000;1,5;359\n",
        'MD (ft),Inc (deg),Azi (deg)\n"0","0","0"\n"98.4251968503937","1.5","359"\n',
    ],
)
def test_spellings(text: str, tmp_path: Path) -> None:
    check(read(tmp_path, text), [0, 30], [0, 1.5], [0, 359])


@each_row("encoding", ["utf-8", "utf-8-sig", "utf-16", "cp1252"])
def test_encodings(encoding: str, tmp_path: Path) -> None:
    found = read(tmp_path, "MD (m),Inc (°),Azi (°)\n0,0,0\n30,1.5,359\n", encoding)
    check(found, [0, 30], [0, 1.5], [0, 359])
    assert any("1252" in remark for remark in found.remarks) == (encoding == "cp1252")


def test_units_of_the_case_stand_in_for_missing_ones(tmp_path: Path) -> None:
    text = "md,inc,azi\n0,0,0\n100,1,45\n"
    assert read(tmp_path, text, units="field").md[1] == pytest.approx(100 * FOOT)
    assert read(tmp_path, text, units="metric").md[1] == 100 and read(tmp_path, text).md[1] == 100
    assert (
        "metres taken" in read(tmp_path, text).remarks[0] and not read(tmp_path, text, units="field").remarks
    )
    commented = "# all depths in feet\n" + text
    assert read(tmp_path, commented).md[1] == pytest.approx(100 * FOOT)


def test_thousands(tmp_path: Path) -> None:
    check(read(tmp_path, "MD (m)\tInc\tAzi\n0\t0\t0\n1,234.5\t1\t45\n"), [0, 1234.5], [0, 1], [0, 45])
    check(read(tmp_path, 'MD (m),Inc,Azi\n0,0,0\n"1,234.5",1,45\n'), [0, 1234.5], [0, 1], [0, 45])
    check(read(tmp_path, "MD (m);Inc;Azi\n0;0;0\n1,234.5;1.5;45\n"), [0, 1234.5], [0, 1.5], [0, 45])
    check(read(tmp_path, "MD (m);Inc;Azi\n0;0;0\n1.234,5;1,5;45\n"), [0, 1234.5], [0, 1.5], [0, 45])


def test_an_ambiguous_comma_is_refused(tmp_path: Path) -> None:
    with pytest.raises(CaseError) as caught:
        read(tmp_path, "MD (m);Inc;Azi\n0;0;0\n1,234;1;45\n")
    assert caught.value.line == 3 and "1234 or 1.234" in caught.value.hint


def test_two_columns_that_fit(tmp_path: Path) -> None:
    """The plain name wins, and the reader says so; two plain names are refused."""
    found = read(tmp_path, "MD (m),Inc,Azi Grid,Azi\n0,0,0,0\n30,5,12,10\n")
    check(found, [0, 30], [0, 5], [0, 10])
    assert any("'Azi', not 'Azi Grid'" in remark for remark in found.remarks)
    with pytest.raises(CaseError) as caught:
        read(tmp_path, "MD (m),Inc,Azi,Azimuth\n0,0,0,0\n30,5,12,10\n")
    assert caught.value.got == "Azi, Azimuth" and caught.value.line == 1
    check(read(tmp_path, "MD (m),Inc,Azi Grid\n0,0,0\n30,5,12\n"), [0, 30], [0, 5], [0, 12])


# ---------------------------------------------------------------------- rows
def test_missing_rows_are_left_out_with_a_remark(tmp_path: Path) -> None:
    found = read(tmp_path, "MD (m),Inc,Azi\n0,0,0\n30,,\n60,-999.25,10\n90,3,10\n,,\n")
    check(found, [0, 90], [0, 3], [0, 10])
    assert any("2 rows" in remark and "lines 3, 4" in remark for remark in found.remarks)


def test_ties(tmp_path: Path) -> None:
    found = read(tmp_path, "MD (m),Inc,Azi\n0,0,0\n30,1,370\n30,1,10\n60,2,10\n".replace("370", "-350"))
    check(found, [0, 30, 60], [0, 1, 2], [0, -350, 10])
    assert any("1 repeated" in remark for remark in found.remarks)
    with pytest.raises(CaseError) as caught:
        read(tmp_path, "MD (m),Inc,Azi\n0,0,0\n30,1,10\n30,2,10\n")
    assert caught.value.line == 4 and "line 3" in caught.value.want


def test_all_bad_lines_at_once(tmp_path: Path) -> None:
    rows = [
        "0,0,0", *(f"{30 * k},1,N23E" for k in range(1, 4)), "200,abc,0", "230,181,0", "260,1,400", "-5,0,0",
    ]  # fmt: skip
    with pytest.raises(CaseError) as caught:
        read(tmp_path, "md [m],inc,azi\n" + "\n".join(rows))
    errors = [caught.value, *caught.value.also]
    assert [error.line for error in errors] == [3, 4, 5, 6, 7, 8, 9]
    assert [error.at for error in errors] == ["azimuth"] * 3 + ["inclination"] * 2 + ["azimuth", "md"]
    assert "decimal degrees" in errors[0].want and "23.0" in errors[0].want
    with pytest.raises(CaseError) as caught:
        read(tmp_path, "md [m],inc,azi\n" + "x,0,0\n" * 50)
    assert len(caught.value.also) == 9


def test_falling_depths(tmp_path: Path) -> None:
    with pytest.raises(CaseError) as caught:
        read(tmp_path, "MD (m),Inc,Azi\n0,0,0\n60,1,10\n30,2,10\n")
    assert caught.value.line == 4 and "above 60 m" in caught.value.want


def test_blanks_between_cells_must_count(tmp_path: Path) -> None:
    """A missing cell would move the others into a wrong column."""
    with pytest.raises(CaseError) as caught:
        read(tmp_path, "MD  Inc  Azi  TVD\n0 0 0 0\n30 1 30\n")
    assert caught.value.line == 3 and caught.value.got == "3 cells"


# ---------------------------------------------------------------------- start, doglegs, positions
def test_a_start_below_zero(tmp_path: Path) -> None:
    found = read(tmp_path, "MD (ft),Inc,Azi\n98,1,45\n200,2,45\n")
    check(found, [0, 98 * FOOT, 200 * FOOT], [0, 1, 2], [45, 45, 45])
    assert any("vertical station at 0 m" in remark for remark in found.remarks)
    with pytest.raises(CaseError) as caught:
        read(tmp_path, "MD (m),Inc,Azi\n812,34,45\n842,35,45\n")
    assert caught.value.got == "survey starts at 812 m with 34 deg" and "tie_in" in caught.value.hint


def test_a_tie_in_station(tmp_path: Path) -> None:
    text = "MD (m),Inc,Azi\n812,34,45\n842,35,45\n"
    found = read(tmp_path, text, tie_in=(0.0, math.radians(20), math.radians(40)))
    check(found, [0, 812, 842], [20, 34, 35], [40, 45, 45])
    found = read(tmp_path, text, tie_in=(300.0, 0.0, 0.0))  # the hole above is vertical
    check(found, [0, 300, 812, 842], [0, 0, 34, 35], [0, 0, 45, 45])
    with pytest.raises(CaseError):
        read(tmp_path, text, tie_in=(900.0, 0.0, 0.0))


def test_sharp_bends(tmp_path: Path) -> None:
    text = "MD (m),Inc,Azi\n0,0,0\n30,3,10\n60,35,10\n"
    with pytest.raises(CaseError) as caught:
        read(tmp_path, text)
    assert caught.value.line == 4 and "allow_dogleg" in caught.value.hint
    assert len(read(tmp_path, text, allow_dogleg=True).md) == 3


def test_crossing_north_is_no_bend(tmp_path: Path) -> None:
    assert len(read(tmp_path, "MD (m),Inc,Azi\n0,0,0\n900,60,359\n930,60,1\n").md) == 3


def test_azimuths_of_vertical_stations(tmp_path: Path) -> None:
    found = read(tmp_path, "MD (m),Inc,Azi\n0,0,0\n30,0.2,250\n60,0.4,100\n90,1.0,30\n")
    check(found, [0, 30, 60, 90], [0, 0.2, 0.4, 1.0], [0, 30, 30, 30])
    assert any("2 stations below 0.5 deg" in remark for remark in found.remarks)


ARC = [  # (md, inclination) along a circle of 300 m radius towards the east, closed form
    (0.0, 0.0), (30.0, math.degrees(0.1)), (60.0, math.degrees(0.2)), (150.0, math.degrees(0.5)), (300.0, math.degrees(1.0)),
]  # fmt: skip


@each_row(("column", "wrong", "warned"), [("", 0.0, False), ("tvd", 2.0, True), ("ew", 1.5, True)])
def test_positions_in_the_file_are_compared(column: str, wrong: float, warned: bool, tmp_path: Path) -> None:
    rows = ["MD (m),Inc,Azi,TVD,+N/-S,+E/-W"]
    for md, inclination in ARC:
        angle = math.radians(inclination)
        at = {"tvd": 300 * math.sin(angle), "ns": 500.0, "ew": 300 * (1 - math.cos(angle))}
        if column and md == 300:
            at[column] += wrong
        rows.append(f"{md},{inclination},90,{at['tvd']},{at['ns']},{at['ew']}")
    found = read(tmp_path, "\n".join(rows))
    warnings = [remark for remark in found.remarks if "WARNING" in remark]
    assert bool(warnings) == warned and all("MD 300 m" in warning for warning in warnings)


def test_positions_below_a_start_that_was_put_in_front(tmp_path: Path) -> None:
    """TVD 30 m at the first station, at 30 m of vertical hole."""
    text = "MD (m),Inc,Azi,TVD\n30,0,0,30\n300,0,0,300\n"
    found = read(tmp_path, text)
    assert not any("WARNING" in remark for remark in found.remarks)
    found = read(tmp_path, text.replace("300\n", "303\n"))
    assert [remark for remark in found.remarks if "WARNING" in remark and "MD 300 m" in remark]


def test_a_position_without_a_unit_has_that_of_the_depth(tmp_path: Path) -> None:
    found = read(tmp_path, "MD (ft),Inc,Azi,TVD\n0,0,0,0\n3000,0,0,3000\n")
    assert not any("WARNING" in remark for remark in found.remarks)


def test_missing_values_with_a_decimal_comma(tmp_path: Path) -> None:
    found = read(tmp_path, "MD (m);Inc;Azi\n0;0;0\n30,5;-999,25;-999,25\n60,5;1,5;10\n")
    check(found, [0, 60.5], [0, 1.5], [0, 10])


def test_depths_in_feet_told_as_metres_are_found_by_the_tvd(tmp_path: Path) -> None:
    text = "MD (m),Inc,Azi,TVD (ft)\n0,0,0,0\n1000,0,0,1000\n"
    assert any("TVD" in remark for remark in read(tmp_path, text).remarks)


# ---------------------------------------------------------------------- no survey
@each_row(
    ("text", "line", "got"),
    [
        ("", 1, "an empty file"),
        ("password: secret\nuser: root\n", 1, "lines without these names"),
        ("MD,Inc,TVD\n0,0,0\n", 1, "MD, Inc, TVD"),
        ("MD [s],Inc,Azi\n0,0,0\n", 1, "MD [s]"),
    ],
)
def test_no_survey(text: str, line: int, got: str, tmp_path: Path) -> None:
    with pytest.raises(CaseError) as caught:
        read(tmp_path, text)
    assert (caught.value.line, caught.value.got) == (line, got)
    assert "secret" not in str(caught.value)


def test_a_binary_file(tmp_path: Path) -> None:
    (tmp_path / "well.csv").write_bytes(b"MD,Inc,Azi\n\0\0")
    with pytest.raises(CaseError):
        read_survey(str(tmp_path / "well.csv"), Rules())


# ---------------------------------------------------------------------- spreadsheets and logs
def test_a_spreadsheet(tmp_path: Path) -> None:
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    sheet = book.active
    sheet.title = "Notes"
    sheet.append(["nothing here"])
    sheet = book.create_sheet("Plan")
    for row in (
        ["Well X"],
        [],
        ["MD", "Incl", "Azim", "Remark"],
        ["ft", "deg", "deg"],
        [0, 0, 0],
        [None, None, None],
        [98, 1.5, 359, "x"],
    ):
        sheet.append(row)
    file = tmp_path / "well.xlsx"
    book.save(file)
    for name in (str(file), f"{file}#Plan"):
        check(read_survey(name, Rules()), [0, 98 * FOOT], [0, 1.5], [0, 359])
    with pytest.raises(CaseError) as caught:
        read_survey(f"{file}#Sheet9", Rules())
    assert "Notes, Plan" in caught.value.want
    book.copy_worksheet(sheet)
    book.save(file)
    with pytest.raises(CaseError) as caught:
        read_survey(str(file), Rules())
    assert "2 sheets" in str(caught.value.got)
    (tmp_path / "broken.xlsx").write_bytes(b"PK\x03\x04 no zip")
    with pytest.raises(CaseError):
        read_survey(str(tmp_path / "broken.xlsx"), Rules())


LAS = """~VERSION INFORMATION
 VERS. 2.0 :
 WRAP. NO :
~WELL INFORMATION
 STRT.{unit} 0 :
 STOP.{unit} 200 :
 STEP.{unit} 0 :
 NULL. -999.25 :
~CURVE INFORMATION
 DEPT.{unit} :
 INCL.DEG :
 AZIM.DEG :
~A
0 0 0
100 -999.25 -999.25
200 4 10
"""


@pytest.mark.parametrize(("unit", "size"), [("M", 1.0), ("F", FOOT), ("FT", FOOT)])
def test_a_log(unit: str, size: float, tmp_path: Path) -> None:
    pytest.importorskip("lasio")
    (tmp_path / "well.las").write_text(LAS.replace("{unit}", unit))
    found = read_survey(str(tmp_path / "well.las"), Rules())
    check(found, [0, 200 * size], [0, 4], [0, 10])
    (tmp_path / "well.las").write_text("no log")
    with pytest.raises(CaseError):
        read_survey(str(tmp_path / "well.las"), Rules())


@pytest.mark.parametrize(("name", "package"), [("well.xlsx", "openpyxl"), ("well.las", "lasio")])
def test_a_missing_package_is_told(
    name: str, package: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(__import__("sys").modules, package, None)
    (tmp_path / name).write_bytes(b"")
    with pytest.raises(CaseError) as caught:
        read_survey(str(tmp_path / name), Rules())
    assert package in caught.value.want and "pip install 'drillpetsc[files]'" in caught.value.hint
