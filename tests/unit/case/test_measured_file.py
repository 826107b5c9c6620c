"""Measured points from files: aliases, units, bad cells."""

from __future__ import annotations

import pytest

from drillpetsc.case.case import Case
from drillpetsc.case.options.measured_option import measured_option
from drillpetsc.errors import CaseError
from tests.helpers.tables import each_row

STRING = [{"kind": "pipe", "length": "100 m", "od": "127 mm", "id": "108 mm"}]


def points(tmp_path, text, units="SI", name="log.csv"):
    (tmp_path / name).write_text(text)
    return measured_option(str(tmp_path / name), Case(units=units, string=STRING, top="clamped"))


def test_aliases_and_units(tmp_path):
    """1 klbf = 4448.2216 N, 1 kft-lbf = 1355.8179 N m, 1 ft = 0.3048 m."""
    text = (
        "# rig 7\nTrip of Monday\nBit Depth [ft], Rig Activity, HKLD (klbf), TQ (kft-lbf), RPM\n"
        "8000, POOH, 240,,\n\n8000, slack-off, 190, -999.25\n8000, Rotating off bottom, 215, 6.1, 60\n"
    )
    found = points(tmp_path, text)
    assert [p.operation for p in found] == ["trip_out", "trip_in", "rotate_off_bottom"]
    assert found[0].bit_depth == pytest.approx(2438.4)
    assert found[0].hook_load == pytest.approx(240 * 4448.2216) and found[0].torque is None
    assert found[2].torque == pytest.approx(6.1 * 1355.8179)
    assert found[2].rpm == pytest.approx(6.2831853)
    assert found[1].torque is None


def test_unit_line_and_semicolons(tmp_path):
    found = points(tmp_path, "DBTM;Operation;STOR;WOB\nm;-;kN.m;t\n1500;drilling;12.5;8\n")
    assert found[0].torque == pytest.approx(12.5e3) and found[0].wob == pytest.approx(8 * 9806.65)


def test_commas_between_semicolons(tmp_path):
    """Decimal commas as other columns show them; a torque of 6,125 kN m was 6125 kN m. A file that does not show it is refused."""
    head = "Bit depth (m);Operation;Torque (kN.m)\r\n"
    found = points(tmp_path, head + "950,0;ROB;6,125\r\n1030,5;ROB;7,250\r\n")
    assert [(p.bit_depth, p.torque) for p in found] == [(950.0, 6125.0), (1030.5, 7250.0)]
    with pytest.raises(CaseError, match="6,125 may be 6125 or 6.125"):
        points(tmp_path, head + "950;ROB;6,125\r\n")
    with pytest.raises(CaseError, match=r"1\.200 may be 1200 or 1\.200"):
        points(tmp_path, head + "1.200;ROB;6,1\r\n")
    found = points(tmp_path, head + "1.200;ROB;6,1\r\n1.210,5;ROB;6,2\r\n")
    assert [p.bit_depth for p in found] == [1200.0, 1210.5]
    assert points(tmp_path, head + "9,500;ROB;12.5\r\n")[0].bit_depth == 9500.0
    assert points(tmp_path, 'depth,op,torque\n"9,500",ROB,6\n')[0].bit_depth == 9500.0


@each_row(("units", "hook"), [("SI", 240.0), ("metric", 240e3), ("field", 240 * 4448.2216152605)])
def test_units_of_the_case(tmp_path, units, hook):
    found = points(tmp_path, "depth,op,hook load\n1000,PU,240\n", units)
    assert found[0].hook_load == pytest.approx(hook)
    assert found[0].bit_depth == pytest.approx(304.8 if units == "field" else 1000.0)


def test_in_a_case(tmp_path, monkeypatch):
    """The points stand in the case that is written, in SI, and read back the same."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "log.csv").write_text("depth,op,hook load\n1000,PU,240\n")
    case = Case(units="field", string=STRING, top="clamped", roadmap={"measured": "log.csv"})
    (point,) = case.roadmap.measured
    assert point.hook_load == pytest.approx(240 * 4448.2216152605) and point.operation == "trip_out"
    case.dump(tmp_path / "again.yaml")
    from drillpetsc.case import load_case

    assert load_case(tmp_path / "again.yaml").roadmap == case.roadmap


@each_row(
    ("text", "at", "line", "want"),
    [
        ("", "bit_depth", 1, "a header with bit depth"),
        ("a,b\n1,2\n", "bit_depth", 1, "a header with bit depth"),
        ("depth,op,hook load\n", None, 1, "at least one measured point"),
        ("depth,op,hook load\n1000,fishing,3\n", "operation", 2, "PU, SO, ROB"),
        ("depth,op,hook load\n1000,PU,abc\n", "hook_load", 2, "a number"),
        ("depth,op,hook load\n,PU,5\n", "bit_depth", 2, "a depth of the bit"),
        ("depth,op,hook load\n1000,PU,\n", "hook_load", 2, "a hook load or a torque"),
        ("depth,op,hook load [psi]\n1000,PU,5\n", "hook_load", 1, "a force"),
        ("depth [bar],op,hook load\n1000,PU,5\n", "bit_depth", 1, "a length"),
    ],
)
def test_refused(tmp_path, text, at, line, want):
    with pytest.raises(CaseError) as error:
        points(tmp_path, text)
    assert want in str(error.value) and error.value.line == line
    assert at is None or error.value.at == at


def test_bad_lines_together(tmp_path):
    with pytest.raises(CaseError) as error:
        points(tmp_path, "depth,op,hook load\n" + "x,PU,1\n" * 12)
    assert len(error.value.also) == 9


def test_no_file(tmp_path):
    with pytest.raises(CaseError, match="measured points that exists"):
        measured_option(str(tmp_path / "none.csv"), Case(string=STRING, top="clamped"))


def test_negative_depth(tmp_path):
    with pytest.raises(CaseError, match="above 0"):
        points(tmp_path, "depth,op,hook load\n-5,PU,5\n")
