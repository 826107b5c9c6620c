"""EDM exports through welleng. Rows and attributes are those that welleng reads; figures follow from 1 ft, 1 in and 1 lb/ft."""

from __future__ import annotations

import math
import sys
from pathlib import Path

import pytest

from drillpetsc.case import load_case
from drillpetsc.case.files.survey_file import read_survey
from drillpetsc.case.importers.edm import Wanted
from drillpetsc.case.importers.fragment import fragment
from drillpetsc.case.importers.stations import Rules
from drillpetsc.cli import main
from drillpetsc.errors import CaseError
from tests.helpers.tables import each_row

FOOT, INCH, LB_PER_FT = 0.3048, 0.0254, 0.45359237 / 0.3048


def row(tag: str, **attributes: object) -> str:
    words = " ".join(f'{key}="{value}"' for key, value in attributes.items())
    return f"<{tag} {words}/>\n"


def stations(header: str, *rows: tuple[float, ...]) -> str:
    return "".join(
        row(
            "CD_DEFINITIVE_SURVEY_STATION",
            def_survey_header_id=header,
            md=md,
            inclination=inclination,
            azimuth=azimuth,
            sequence_no=i,
        )
        for i, (md, inclination, azimuth) in enumerate(rows)
    )


def item(assembly: str, number: int, code: str, length: float, od: float, bore: float, **more: object) -> str:
    return row(
        "CD_ASSEMBLY_COMP",
        assembly_id=assembly,
        sequence_no=number,
        sect_type_code=code,
        length=length,
        od_body=od,
        id_body=bore,
        **more,
    )


STRING = (
    row(
        "CD_ASSEMBLY", assembly_id="A1", wellbore_id="B1", string_type="Drillstring", assembly_name="8 1/2 in"
    )
    + item(
        "A1",
        1,
        "DP",
        1000,
        5,
        4.276,
        approximate_weight=22.6,
        od_connection=6.625,
        id_connection=2.75,
        length_tool_joint=1.4,
    )
    + item(
        "A1", 2, "DC", 180, 6.75, 2.8125, approximate_weight=100.8, catalog_key_desc="6 3/4 non-mag collar"
    )
    + item("A1", 3, "SUB", 3, 6.5, 3, approximate_weight=4, catalog_key_desc="Bit sub")
    + item("A1", 4, "BIT", 1, 8.5, 2.25, tfa=0.3313, comp_name="PDC bit")
)
HOLE = (
    row(
        "CD_HOLE_SECT",
        hole_sect_group_id="H1",
        wellbore_id="B1",
        sect_type_code="CAS",
        id_casing=12.415,
        md_top=0,
        length=600,
        md_shoe=600,
        cof=0.2,
    )
    + row(
        "CD_HOLE_SECT",
        hole_sect_group_id="H1",
        wellbore_id="B1",
        sect_type_code="CAS",
        id_casing=8.921,
        length=400,
        md_shoe=900,
        cof=0.25,
    )
    + row(
        "CD_HOLE_SECT",
        hole_sect_group_id="H1",
        wellbore_id="B1",
        sect_type_code="OPEN",
        hole_size=8.5,
        length=300,
        md_shoe=1200,
        effective_diameter=8.75,
    )
)
BORES = row("CD_WELLBORE", wellbore_id="B1", wellbore_name="W-1 A", well_id="W1")
SURVEY = row(
    "CD_DEFINITIVE_SURVEY_HEADER",
    def_survey_header_id="S1",
    wellbore_id="B1",
    phase="ACTUAL",
    name="as drilled",
) + stations("S1", (1000, 0, 0), (0, 0, 0), (1200, 6, 45))
PLAN = row(
    "CD_DEFINITIVE_SURVEY_HEADER", def_survey_header_id="S2", wellbore_id="B1", phase="PLAN", name="plan"
) + stations("S2", (0, 0, 0), (1200, 9, 45))


def export(*parts: str) -> str:
    return (
        "<?xml version='1.0' encoding='UTF-8'?>\n<export>\n<TOPLEVEL>\n"
        + "".join(parts)
        + "</TOPLEVEL>\n</export>\n"
    )


def imported(text: str, folder: Path, wanted: Wanted | None = None) -> tuple[str, list[str]]:
    pytest.importorskip("welleng.exchange.edm_stream")
    (folder / "e.xml").write_text(text, encoding="utf-8")
    return fragment([folder / "e.xml"], folder, wanted)


def test_without_welleng(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The message names the package and how to install it; nothing is written."""
    for name in ("welleng", "welleng.exchange", "welleng.exchange.edm_stream"):
        monkeypatch.setitem(sys.modules, name, None)
    (tmp_path / "e.xml").write_text(export(BORES, SURVEY))
    assert main(["import", str(tmp_path / "e.xml"), "--out", str(tmp_path / "c.yaml")]) == 2
    said = capsys.readouterr().err
    assert "welleng" in said and "drillpetsc[edm]" in said and not (tmp_path / "c.yaml").exists()


def test_an_export_is_no_survey_file(tmp_path: Path) -> None:
    (tmp_path / "e.xml").write_text(export(BORES, SURVEY))
    with pytest.raises(CaseError) as caught:
        read_survey(str(tmp_path / "e.xml"), Rules())
    assert "drillpetsc import e.xml" in caught.value.hint


def test_a_whole_export_becomes_a_case(tmp_path: Path) -> None:
    text, remarks = imported(export(BORES, SURVEY, PLAN, STRING, HOLE), tmp_path)
    (tmp_path / "whole.yaml").write_text(text + "top: clamped\nbottom: bit\ncontact: none\n")
    case = load_case(tmp_path / "whole.yaml")
    assert case.title == "W-1 A" and case.well is not None
    survey = case.well.survey
    assert survey.md == pytest.approx([0, 1000 * FOOT, 1200 * FOOT], rel=1e-9)
    assert survey.inclination[-1] == pytest.approx(math.radians(6), rel=1e-9)
    assert survey.azimuth[-1] == pytest.approx(math.radians(45), rel=1e-9)
    assert any("as drilled (ACTUAL), 3 stations; 1 other" in remark for remark in remarks)
    pipe, collar, sub, bit = case.string
    assert [entry.kind for entry in case.string] == ["drill_pipe", "drill_collar", "tool", "bit"]
    assert pipe.adjusted_weight == pytest.approx(22.6 * LB_PER_FT, rel=1e-5)  # type: ignore[union-attr]
    joint = pipe.tool_joint  # type: ignore[union-attr]
    assert (joint.od, joint.id, joint.length) == pytest.approx(
        (6.625 * INCH, 2.75 * INCH, 1.4 * FOOT), rel=1e-5
    )
    assert collar.nonmagnetic and collar.length == pytest.approx(180 * FOOT, rel=1e-5)  # type: ignore[union-attr]
    assert sub.material.density == 7850 and any(
        "WARNING: Bit sub: 5.953 kg/m" in remark for remark in remarks
    )  # type: ignore[union-attr]
    assert bit.nozzle_area == pytest.approx(0.3313 * INCH**2, rel=1e-5) and bit.bit_type == "PDC"  # type: ignore[union-attr]
    sections = case.well.sections
    assert [section.to for section in sections] == pytest.approx(
        [500 * FOOT, 900 * FOOT, 1200 * FOOT], rel=1e-5
    )
    assert [section.diameter for section in sections] == pytest.approx(
        [12.415 * INCH, 8.921 * INCH, 8.75 * INCH], rel=1e-5
    )
    assert [section.friction for section in sections] == [0.2, 0.25, 0.3]


def test_the_bit_says_which_end_is_the_lowest(tmp_path: Path) -> None:
    """The same tally from the bit up; without a bit, the flag of the assembly; a bit in the middle is refused."""
    kinds = []
    upward = STRING
    for old, new in (("1", "9"), ("2", "8"), ("3", "7"), ("4", "6")):
        upward = upward.replace(f'sequence_no="{old}"', f'sequence_no="{new}"')
    for text in (STRING, upward):
        (tmp_path / "w.yaml").write_text(imported(export(BORES, text), tmp_path)[0] + "top: clamped\n")
        kinds.append([entry.kind for entry in load_case(tmp_path / "w.yaml").string])
    assert kinds[0] == kinds[1] == ["drill_pipe", "drill_collar", "tool", "bit"]
    bare = "".join(line for line in STRING.splitlines(True) if "BIT" not in line)
    text, remarks = imported(export(BORES, bare), tmp_path)
    assert any("no bit and no order" in remark for remark in remarks)
    flagged = bare.replace("assembly_name", 'is_top_down="Y" assembly_name')
    other, remarks = imported(export(BORES, flagged), tmp_path)
    assert not any("no order" in remark for remark in remarks)
    assert text.index("name: Bit sub") < text.index("kind: drill_pipe") and other.index(
        "kind: drill_pipe"
    ) < other.index("name: Bit sub")
    middle = STRING.replace('sequence_no="4"', 'sequence_no="1.5"')
    with pytest.raises(CaseError, match="bit"):
        imported(export(BORES, middle.replace('sequence_no="1"', 'sequence_no="0"')), tmp_path)


def test_a_choice_is_never_guessed(tmp_path: Path) -> None:
    """Several wellbores are refused with their names; several strings or designs are left out with theirs."""
    second = BORES.replace("B1", "B2").replace("W-1 A", "W-1 B")
    both = export(BORES, second, SURVEY, SURVEY.replace("B1", "B2").replace("S1", "S9"), STRING, HOLE)
    with pytest.raises(CaseError, match="W-1 A, W-1 B"):
        imported(both, tmp_path)
    text, _ = imported(both, tmp_path, Wanted(wellbore="w-1 b"))
    assert "title: W-1 B" in text and "kind: " not in text
    with pytest.raises(CaseError) as caught:
        imported(both, tmp_path, Wanted(wellbore="W-1 AA"))
    assert "W-1 A" in caught.value.want and caught.value.at == "--wellbore"
    more = STRING.replace("A1", "A2").replace("8 1/2 in", "6 in")
    text, remarks = imported(export(BORES, SURVEY, STRING, more), tmp_path)
    assert any("2 drill strings (6 in, 8 1/2 in)" in remark for remark in remarks) and "kind: bit" not in text
    assert "kind: bit" in imported(export(BORES, SURVEY, STRING, more), tmp_path, Wanted(assembly="6 in"))[0]
    designs = HOLE + HOLE.replace("H1", "H2").replace("8.75", "9")
    cases = row("CD_CASE", hole_sect_group_id="H1", case_name="as run") + row(
        "CD_CASE", hole_sect_group_id="H2", case_name="washed out"
    )
    _, remarks = imported(export(BORES, SURVEY, designs, cases), tmp_path)
    assert any("2 designs of the hole (as run, washed out)" in remark for remark in remarks)
    text, _ = imported(export(BORES, SURVEY, designs, cases), tmp_path, Wanted(hole="washed out"))
    assert "228.6 mm" in text
    same = HOLE + HOLE.replace("H1", "H2")
    assert "222.25 mm" in imported(export(BORES, SURVEY, same, cases), tmp_path)[0]


def test_options_need_an_export(tmp_path: Path) -> None:
    (tmp_path / "s.csv").write_text("md [m],inc [deg],azi [deg]\n0,0,0\n100,0,0\n")
    with pytest.raises(CaseError, match="EDM"):
        fragment([tmp_path / "s.csv"], tmp_path, Wanted(assembly="x"))


@each_row(
    ("text", "want"),
    [
        (export(BORES, SURVEY, HOLE.replace('"CAS"', '"XYZ"')), "CAS, OPEN"),
        (
            export(
                BORES, SURVEY, HOLE.replace('hole_size="8.5"', "").replace('effective_diameter="8.75"', "")
            ),
            "above 0",
        ),
        (export(BORES, SURVEY, HOLE.replace('length="300"', 'length="250"')), "without a gap"),
        (export(BORES, STRING.replace('length="3"', 'length="nan"')), "a length above 0"),
        (export(BORES, STRING.replace('od_body="6.5"', "")), "outer diameter"),
        (export(BORES, STRING.replace('id_body="3"', 'id_body="7"')), "below od"),
        (export(), "EDM export that can be read"),
        (export(row("CD_WELLBORE", wellbore_name="x")), "EDM export that can be read"),
        (export(BORES, SURVEY)[:-30], "EDM export that can be read"),
        (
            export(BORES, SURVEY).replace("<export>", '<!DOCTYPE x [<!ENTITY a "b">]>\n<export>'),
            "document type",
        ),
        (export(BORES, SURVEY.replace('md="1000"', 'md="1200"')), "one direction at each depth"),
    ],
)
def test_refused(text: str, want: str, tmp_path: Path) -> None:
    with pytest.raises(CaseError) as caught:
        imported(text, tmp_path)
    assert want in caught.value.want and str(caught.value)
