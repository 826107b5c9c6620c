"""WITSML 1.4.1.1 documents. The elements are those of the schema; the figures follow from their definitions."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from drillpetsc.case import Case, load_case
from drillpetsc.case.files.survey_file import read_survey
from drillpetsc.case.importers.fragment import fragment
from drillpetsc.case.importers.stations import Rules
from drillpetsc.cli import main
from drillpetsc.errors import CaseError
from tests.helpers.command import main_succeeds

FOOT, INCH, POUND = 0.3048, 0.0254, 0.45359237
HEAD = '<?xml version="1.0" encoding="UTF-8"?>\n'
SPACE = 'xmlns="http://www.witsml.org/schemas/1series" version="1.4.1.1"'


def station(md: float, inclination: float, azimuth: float, more: str = "") -> str:
    return (
        f'<trajectoryStation><typeTrajStation>magnetic MWD</typeTrajStation><md uom="ft">{md}</md>'
        f'<incl uom="dega">{inclination}</incl><azi uom="dega">{azimuth}</azi>{more}</trajectoryStation>\n'
    )


def trajectory(stations: str, space: str = SPACE) -> str:
    return (
        f"{HEAD}<trajectorys {space}><trajectory><nameWell>W-1</nameWell><nameWellbore>W-1A</nameWellbore>"
        f"<name>T</name><aziRef>grid north</aziRef>\n{stations}</trajectory></trajectorys>"
    )


STATIONS = (
    station(1000, 0, 0)
    + station(0, 0, 0)
    + station(1200, 6, 45)
    + "<trajectoryStation><md uom='ft'>1300</md></trajectoryStation>"
)

TUBULAR = f"""{HEAD}<tubulars {SPACE}><tubular><nameWell>W-1</nameWell><name>BHA 3</name>
<tubularComponent><sequence>1</sequence><typeTubularComp>bit PDC</typeTubularComp><id uom="in">2.25</id><od uom="in">8.5</od>
<len uom="ft">1</len><areaNozzleFlow uom="in2">0.3313</areaNozzleFlow></tubularComponent>
<tubularComponent><sequence>3</sequence><typeTubularComp>drill collar</typeTubularComp><id uom="in">2.8125</id><od uom="in">6.75</od>
<len uom="ft">180</len><wtPerLen uom="lbm/ft">100.8</wtPerLen></tubularComponent>
<tubularComponent><sequence>2</sequence><typeTubularComp>stabilizer</typeTubularComp><id uom="in">2.8125</id><od uom="in">6.75</od>
<len uom="ft">6</len><stabilizer><odBladeMx uom="in">8.375</odBladeMx></stabilizer></tubularComponent>
<tubularComponent><sequence>4</sequence><typeTubularComp>drill pipe</typeTubularComp><id uom="in">4.276</id><od uom="in">5</od>
<len uom="ft">1000</len><wtPerLen uom="lbm/ft">22.6</wtPerLen>
<connection><od uom="in">6.625</od><id uom="in">2.75</id><len uom="in">10</len></connection>
<connection><od uom="in">6.625</od><id uom="in">2.75</id><len uom="in">7</len></connection></tubularComponent>
<tubularComponent><sequence>5</sequence><typeTubularComp>sub-cross over</typeTubularComp><name>XO</name><id uom="in">3</id><od uom="in">6.5</od>
<len uom="ft">3</len><wtPerLen uom="lbm/ft">4</wtPerLen></tubularComponent>
</tubular></tubulars>"""

GEOMETRY = f"""{HEAD}<wbGeometrys {SPACE}><wbGeometry><nameWell>W-1</nameWell>
<wbGeometrySection><typeHoleCasing>casing</typeHoleCasing><mdTop uom="ft">0</mdTop><mdBottom uom="ft">600</mdBottom>
<idSection uom="in">12.415</idSection><factFric>0.2</factFric></wbGeometrySection>
<wbGeometrySection><typeHoleCasing>liner</typeHoleCasing><mdTop uom="ft">500</mdTop><mdBottom uom="ft">900</mdBottom>
<idSection uom="in">8.921</idSection><factFric>0.25</factFric></wbGeometrySection>
<wbGeometrySection><typeHoleCasing>open hole</typeHoleCasing><mdTop uom="ft">900</mdTop><mdBottom uom="ft">1200</mdBottom>
<idSection uom="in">8.5</idSection></wbGeometrySection>
</wbGeometry></wbGeometrys>"""


@pytest.fixture
def files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    monkeypatch.chdir(tmp_path)
    for name, text in (("t.xml", trajectory(STATIONS)), ("s.xml", TUBULAR), ("g.xml", GEOMETRY)):
        Path(name).write_text(text)
    return ["t.xml", "s.xml", "g.xml"]


def test_a_trajectory_is_a_survey(files: list[str]) -> None:
    found = read_survey("t.xml", Rules())
    assert found.md == pytest.approx([0, 1000 * FOOT, 1200 * FOOT])
    assert found.inclination == pytest.approx([0, 0, math.radians(6)])
    assert found.azimuth[-1] == pytest.approx(math.radians(45))
    assert any("grid north" in remark for remark in found.remarks)
    assert any("1 stations without" in remark for remark in found.remarks)


def test_positions_of_a_trajectory_are_compared(files: list[str]) -> None:
    more = '<tvd uom="m">500</tvd>'
    Path("t.xml").write_text(trajectory(station(0, 0, 0) + station(1000, 3, 10, more)))
    assert any("TVD" in remark for remark in read_survey("t.xml", Rules()).remarks)


def test_import_writes_a_case(files: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    main_succeeds("import", *files, "--out", "case.yaml")
    assert "XO" in capsys.readouterr().out
    text = Path("case.yaml").read_text()
    Path("whole.yaml").write_text(text + "top: clamped\nbottom: bit\ncontact: none\n")
    case = load_case("whole.yaml")
    assert case.title == "W-1"
    assert [item.kind for item in case.string] == ["tool", "drill_pipe", "drill_collar", "stabilizer", "bit"]
    assert case.string_length == pytest.approx(1190 * FOOT, rel=1e-5)
    crossover, pipe, collar, stabilizer, bit = case.string
    assert pipe.od == pytest.approx(5 * INCH) and pipe.id == pytest.approx(4.276 * INCH, rel=1e-5)
    assert pipe.adjusted_weight == pytest.approx(22.6 * POUND / FOOT, rel=1e-5)  # type: ignore[attr-defined]
    assert pipe.tool_joint.od == pytest.approx(6.625 * INCH) and pipe.tool_joint.id == pytest.approx(
        2.75 * INCH
    )  # type: ignore[attr-defined]
    assert pipe.tool_joint.length == pytest.approx(17 * INCH, rel=1e-5)  # type: ignore[attr-defined]
    assert collar.adjusted_weight == pytest.approx(100.8 * POUND / FOOT, rel=1e-5)  # type: ignore[attr-defined]
    assert bit.bit_type == "PDC"  # type: ignore[attr-defined]
    assert stabilizer.body_od == pytest.approx(6.75 * INCH)  # type: ignore[attr-defined]
    assert crossover.material.density == 7850 and "WARNING: XO: 5.953 kg/m is not a plausible weight" in text  # type: ignore[union-attr]
    assert stabilizer.od == pytest.approx(8.375 * INCH) and collar.id == pytest.approx(2.8125 * INCH)
    assert bit.nozzle_area == pytest.approx(0.3313 * INCH**2, rel=1e-5)
    sections = case.well.sections  # type: ignore[union-attr]
    assert [section.to for section in sections] == pytest.approx(
        [500 * FOOT, 900 * FOOT, 1200 * FOOT], rel=1e-5
    )
    assert [section.friction for section in sections] == [0.2, 0.25, 0.3]
    assert [section.kind for section in sections] == ["casing", "casing", "open_hole"]
    assert sections[2].diameter == pytest.approx(8.5 * INCH)


def test_import_to_the_screen_and_over_a_file(files: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    main_succeeds("import", "t.xml")
    assert "survey: t.xml" in capsys.readouterr().out
    Path("case.yaml").write_text("mine")
    assert main(["import", "t.xml", "--out", "case.yaml"]) == 2 and Path("case.yaml").read_text() == "mine"
    main_succeeds("import", "t.xml", "--out", "case.yaml", "--overwrite")
    assert "left to do: string" in Path("case.yaml").read_text()


def test_a_pipe_without_connections_is_a_plain_tube_of_the_weight(files: list[str]) -> None:
    text = Path("s.xml").read_text()
    cut = text[: text.index("<connection>")] + text[text.rindex("</connection>") + len("</connection>") :]
    Path("s.xml").write_text(cut)
    text, remarks = fragment(["s.xml"], Path())
    Path("whole.yaml").write_text(text + "top: clamped\n")
    pipe = load_case("whole.yaml").string[1]
    assert pipe.kind == "pipe" and any("no connections" in remark for remark in remarks)
    weight = pipe.material.density * math.pi / 4 * (pipe.od**2 - pipe.id**2)  # type: ignore[union-attr, operator]
    assert weight == pytest.approx(22.6 * POUND / FOOT, rel=1e-4)


def test_nozzles_of_a_bit(files: list[str]) -> None:
    nozzles = '<nozzle><index>1</index><diaNozzle uom="in">0.375</diaNozzle></nozzle>' * 3
    Path("s.xml").write_text(TUBULAR.replace('<areaNozzleFlow uom="in2">0.3313</areaNozzleFlow>', nozzles))
    text, _ = fragment(["s.xml"], Path())
    assert f"{3 * math.pi / 4 * 9.525**2:.6g} mm2" in text  # 3 x 12/32 in


def test_sections_and_survey_that_end_apart(files: list[str]) -> None:
    Path("t.xml").write_text(trajectory(station(0, 0, 0) + station(2000, 3, 10)))
    _, remarks = fragment(files, Path())
    assert any("sections end at 365.76 m, the survey at 609.6 m" in remark for remark in remarks)


@pytest.mark.parametrize(
    ("name", "old", "new", "want"),
    [
        ("t.xml", 'version="1.4.1.1"', 'version="1.3.1.1"', "WITSML 1.4.1"),
        ("t.xml", "schemas/1series", "schemas/131", "WITSML 1.4.1"),
        ("t.xml", HEAD, HEAD + '<!DOCTYPE x [<!ENTITY a "b">]>\n', "document type"),
        ("t.xml", "</trajectorys>", "", "an XML file"),
        ("t.xml", 'uom="ft">1200', ">1200", "uom"),
        ("t.xml", 'uom="ft">1200', 'uom="kg">1200', "a length"),
        ("t.xml", ">1200<", ">12OO<", "a number"),
        ("t.xml", 'uom="dega">45', 'uom="dega">445', "azimuth"),
        ("t.xml", "trajectorys", "logs", "trajectorys, tubulars"),
        ("s.xml", '<od uom="in">6.5</od>', "", "outer diameter"),
        ("s.xml", '<id uom="in">3</id>', '<id uom="in">7</id>', "below od"),
        ("s.xml", '<len uom="ft">3</len>', "", "length above 0"),
        ("s.xml", "<sequence>1</sequence>", "<sequence>9</sequence>", "the lowest"),
        ("g.xml", '<mdTop uom="ft">900</mdTop>', '<mdTop uom="ft">950</mdTop>', "without a gap"),
        ("g.xml", "<typeHoleCasing>liner<", "<typeHoleCasing>other<", "casing, liner"),
        ("g.xml", '<idSection uom="in">8.5</idSection>', "", "with its uom"),
    ],
)
def test_refused(name: str, old: str, new: str, want: str, files: list[str]) -> None:
    text = Path(name).read_text()
    assert old in text
    Path(name).write_text(text.replace(old, new))
    with pytest.raises(CaseError) as caught:
        fragment([name], Path())
    assert want in caught.value.want and caught.value.file == name and caught.value.line


def test_two_of_a_kind(files: list[str]) -> None:
    with pytest.raises(CaseError) as caught:
        fragment(["t.xml", "t.xml"], Path())
    assert "one file with a survey" in caught.value.want
    with pytest.raises(CaseError):
        fragment(["none.xml"], Path())


def test_a_trajectory_in_a_case(files: list[str]) -> None:
    well = {"survey": "t.xml", "sections": [{"kind": "open_hole", "diameter": "8.5 in"}]}
    string = [{"kind": "pipe", "length": "9 m", "od": "5 in"}]
    case = Case(well=well, string=string, top="clamped", units="field")
    assert case.well.survey.md[-1] == pytest.approx(1200 * FOOT)  # type: ignore[union-attr]
