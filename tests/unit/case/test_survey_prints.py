"""Headings of real surveys: units after an underscore, prints with headings of several lines, columns named by the user;
and WITSML trajectories on one line."""

from __future__ import annotations

import csv
import math
import random
from pathlib import Path

import pytest

from drillpetsc.case.files.survey_file import read_survey
from drillpetsc.case.importers.stations import Rules, Stations
from drillpetsc.case.importers.witsml import trajectory_table
from drillpetsc.errors import CaseError
from tests.helpers.records import record

FOOT = 0.3048
SPACE = 'xmlns="http://www.witsml.org/schemas/1series" version="1.4.1.1"'


def read(folder: Path, text: str, **rules: object) -> Stations:
    (folder / "survey.txt").write_text(text)
    return read_survey(str(folder / "survey.txt"), Rules(**rules))  # type: ignore[arg-type]


@pytest.mark.parametrize("separator", [",", ";", "\t", "  "])
@pytest.mark.parametrize(
    "heads", ["md_m,inc_deg,azi_deg", "MD_ft,Incl_deg,Azi_deg,TVD_ft", "MD_RKB_m,INC_DEG,AZI_DEG"]
)
def test_units_after_an_underscore(tmp_path: Path, heads: str, separator: str) -> None:
    count = heads.count(",") + 1
    rows = [[0, 0, 0, 0], [100, 0, 0, 100], [200, 3, 45, 199.954]][:]
    text = "\n".join(separator.join(map(str, row[:count])) for row in rows)
    found = read(tmp_path, heads.replace(",", separator) + "\n" + text)
    assert found.md[-1] == pytest.approx(200 * (FOOT if "ft" in heads else 1.0))
    assert (found.inclination[-1], found.azimuth[-1]) == pytest.approx((math.radians(3), math.radians(45)))
    assert not [remark for remark in found.remarks if "WARNING" in remark or "metres taken" in remark]


def test_units_on_the_next_line(tmp_path: Path) -> None:
    found = read(tmp_path, "MD;Incl;Azi\nft;deg;deg\n0;0;0\n1000;2;10\n")
    assert found.md[-1] == pytest.approx(1000 * FOOT)


PRINT = """\
                         Final survey report
  Company: none        Well: A-1           Field: X

  Measured     Incl      Azim       Vertical     Northing   Easting   Dogleg
  Depth                             Depth                             Severity
  (ft)         (deg)     (deg)      (ft)         (ft)       (ft)      (deg/100ft)
  ---------------------------------------------------------------------------
     0.00       0.00      0.00          0.00        0.00       0.00      0.00
  1000.00       0.00      0.00       1000.00        0.00       0.00      0.00
  2000.00      10.00     30.00       1994.93       75.44      43.56      1.00

  Page 2
  Measured     Incl      Azim       Vertical     Northing   Easting   Dogleg
  3000.00      10.00     30.00       2979.74      225.83     130.38      0.00
"""


def test_print_with_headings_of_three_lines(tmp_path: Path) -> None:
    """Positions by minimum curvature: an arc of 10 deg over 1000 ft, then straight."""
    found = read(tmp_path, PRINT)
    assert found.md == pytest.approx([0, 1000 * FOOT, 2000 * FOOT, 3000 * FOOT])
    assert found.inclination[-1] == pytest.approx(math.radians(10))
    assert not [remark for remark in found.remarks if "WARNING" in remark]
    assert any("lines between the rows left out (lines 12, 13)" in remark for remark in found.remarks)


def test_print_with_a_row_of_another_length(tmp_path: Path) -> None:
    with pytest.raises(CaseError, match="line 10[\\s\\S]*6 numbers[\\s\\S]*7 numbers"):
        read(tmp_path, PRINT.replace("      43.56      1.00", "      43.56"))


def test_columns_named_by_the_user(tmp_path: Path) -> None:
    text = "Tiefe;Neigung_rad;Richtung;Azi\n0;0;0;7\n100;0.05;45;7\n"
    columns = {"md": "Tiefe", "inclination": "Neigung_rad", "azimuth": "richtung"}
    found = read(tmp_path, text, columns=columns)
    assert (found.inclination[-1], found.azimuth[-1]) == pytest.approx((0.05, math.radians(45)))
    with pytest.raises(CaseError, match="columns[\\s\\S]*Teufe"):
        read(tmp_path, text, columns={"md": "Teufe"})


def test_a_column_named_without_its_unit(tmp_path: Path) -> None:
    """The hint about an unknown heading names titles without their brackets; a title given in full comes first, and two that fit are refused."""
    text = "Tiefe (ft);Neigung [°];Richtung\n0;0;0\n1000;5;45\n"
    columns = {"md": "Tiefe", "inclination": "neigung", "azimuth": "Richtung"}
    found = read(tmp_path, text, columns=columns)
    assert (found.md[-1], found.inclination[-1]) == pytest.approx((1000 * FOOT, math.radians(5)))
    two = (
        text.replace("Richtung", "Richtung;Tiefe (m)").replace("0;0;0\n", "0;0;0;0\n").replace("45", "45;300")
    )
    with pytest.raises(CaseError, match="several columns fit"):
        read(tmp_path, two, columns=columns)
    assert read(tmp_path, two, columns=columns | {"md": "Tiefe (m)"}).md[-1] == pytest.approx(300)


def test_unknown_headings_show_the_key(tmp_path: Path) -> None:
    with pytest.raises(CaseError, match="columns: {md"):
        read(tmp_path, "Tiefe;Inc;Azi\n0;0;0\n100;5;45\n")


# ---------------------------------------------------------------------- WITSML
def trajectory(rows: list[tuple[float, float, float, float]]) -> str:
    """All stations on one line, as stores send them. (md, inclination, azimuth [deg], tvd) [m]."""
    stations = "".join(
        f'<trajectoryStation uid="s{i}"><md uom="m">{md}</md><tvd uom="m">{tvd}</tvd><incl uom="dega">{inc}</incl>'
        f'<azi uom="dega">{azi}</azi></trajectoryStation>'
        for i, (md, inc, azi, tvd) in enumerate(rows)
    )
    return f"<trajectorys {SPACE}><trajectory><nameWell>W</nameWell>{stations}</trajectory></trajectorys>"


def rows_of(name: str) -> list[tuple[float, float, float, float]]:
    scale = FOOT if "16b" in name else 1.0
    with record(name).open(newline="") as lines:
        table = [[float(value) for value in list(row.values())[:4]] for row in csv.DictReader(lines)]
    return [(row[0] * scale, row[1], row[2], row[3] * scale) for row in table]


@pytest.mark.parametrize("name", ["volve-f4/survey.csv", "volve-f9a/survey.csv", "forge-16b/survey_16b.csv"])
def test_one_line_document_without_a_false_alarm(tmp_path: Path, name: str) -> None:
    (tmp_path / "t.xml").write_text(trajectory(rows_of(name)))
    found = read_survey(str(tmp_path / "t.xml"), Rules())
    assert not [remark for remark in found.remarks if "WARNING" in remark]


@pytest.mark.parametrize("name", ["volve-f4/survey.csv", "volve-f9a/survey.csv"])
def test_a_planted_error_of_one_tvd_names_its_station(tmp_path: Path, name: str) -> None:
    rows = rows_of(name)
    at = len(rows) // 2
    md, inc, azi, tvd = rows[at]
    rows[at] = (md, inc, azi, tvd + 5)
    (tmp_path / "t.xml").write_text(trajectory(rows))
    warned = [q for q in read_survey(str(tmp_path / "t.xml"), Rules()).remarks if "WARNING" in q]
    assert len(warned) == 1
    assert f"station 's{at}'" in warned[0] and f"MD {md:.6g} m" in warned[0] and "5 m" in warned[0]
    assert "other stations" not in warned[0]


@pytest.mark.parametrize("name", [
    "volve-f5/survey.csv", "volve-f5/survey-for-case.csv", "volve-f4/survey.csv", "volve-f4/survey-for-case.csv",
    "volve-f9a/survey.csv", "forge-16b/survey_16b.csv", "forge-16b/survey-8585.csv", "td-field-dogleg/survey.csv",
])  # fmt: skip
def test_surveys_of_the_records_read_without_a_false_alarm(name: str) -> None:
    found = read_survey(str(record(name)), Rules())
    with record(name).open() as lines:
        assert len(found.md) == sum(1 for line in lines if line.strip()) - 1
    assert not [remark for remark in found.remarks if "WARNING" in remark]


def test_vertical_stations_have_the_positions_of_their_own_azimuths(tmp_path: Path) -> None:
    """Northing of a hole of 0.4 deg to the north, above an inclined part to the east: 1000 m sin 0.4 deg."""
    north = 2000 * math.sin(math.radians(0.4))
    text = f"md_m,inc_deg,azi_deg,N/S (m)\n0,0.4,0,0\n2000,0.4,0,{north}\n2100,0.4,0,{north + north / 20}\n2200,3,90,\n"
    assert not [q for q in read(tmp_path, text).remarks if "WARNING" in q]


def test_a_bad_cell_names_its_station(tmp_path: Path) -> None:
    text = trajectory([(0, 0, 0, 0), (100, 2, 10, 100)]).replace(
        '<incl uom="dega">2</incl>', '<incl uom="dega">two</incl>'
    )
    (tmp_path / "t.xml").write_text(text)
    with pytest.raises(CaseError, match="trajectoryStation 's1': incl"):
        trajectory_table(tmp_path / "t.xml")
    (tmp_path / "t.xml").write_text(trajectory([(0, 0, 0, 0), (100, 200, 10, 100)]))
    with pytest.raises(CaseError, match="trajectoryStation 's1': inclination"):
        read_survey(str(tmp_path / "t.xml"), Rules())


def test_version_2_is_refused_by_name(tmp_path: Path) -> None:
    space = 'xmlns="http://www.energistics.org/energyml/data/witsmlv2" schemaVersion="2.0"'
    (tmp_path / "t.xml").write_text(f"<Trajectory {space}/>")
    with pytest.raises(CaseError, match="WITSML 2.0[\\s\\S]*WITSML 1.4.1"):
        trajectory_table(tmp_path / "t.xml")


def test_mutants_of_a_print_are_read_or_refused(tmp_path: Path) -> None:
    """No traceback, and no station that is not in the file."""
    rng = random.Random(7)
    depths = {0.0, 1000 * FOOT, 2000 * FOOT, 3000 * FOOT}
    for _ in range(300):
        letters = list(PRINT)
        for _ in range(rng.randint(1, 4)):
            letters[rng.randrange(len(letters))] = rng.choice("x-.,;\n\t ")
        try:
            found = read(tmp_path, "".join(letters))
        except CaseError:
            continue
        except Exception as error:
            raise AssertionError("".join(letters)) from error
        assert len(found.md) <= len(depths) + 2
