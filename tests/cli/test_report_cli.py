"""The command `report`: what the page holds, that it needs nothing else, and what is refused."""

from __future__ import annotations

import base64
import json
import re
import shutil
import sys
from html.parser import HTMLParser
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from drillpetsc.case import load_case
from drillpetsc.cli import main
from drillpetsc.output import RunFolder
from drillpetsc.output.files.tables import read_table
from drillpetsc.output.shown_units import lengths_shown
from drillpetsc.reporting.answer import answer, checks
from drillpetsc.reporting.results import Run
from drillpetsc.reporting.units import in_units, texts, unit_of
from tests.helpers.command import main_succeeds

CASE = """
title: '<script>alert(1)</script> $x_{$ & "quoted" '
units: field
rig: {datum: RKB, block_weight: 10 klb}
well:
  survey: {md: [0, 1000, 1900], inclination: [0, 0, 90], azimuth: [90, 90, 90]}
  sections: [{to: 500, kind: casing, diameter: 8.681}, {to: end, kind: open_hole, diameter: 8.5}]
string:
  - {kind: pipe, name: '<b>drill pipe</b> $\\frac{', length: 1800, od: 5, id: 4.276}
  - {kind: bit, length: 1, od: 8.5, nozzle_area: 0.5 in2}
top: {kind: top_drive, rotation: 60}
bottom: bit
"""
MUD = "fluid: {density: 10, flow_rate: 400, rheology: {pv: 20 cP, yp: 10}}\n"
FACTOR = 1e-3 / 4.4482216152605  # klbf per N


class Page(HTMLParser):
    """Tags, links, and the text of the cells of a page; open tags must be closed in order."""

    VOID = ("meta", "img", "br")

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.tags: list[str] = []
        self.links: list[str] = []
        self.texts: list[str] = []
        self.feed(text)
        assert self.open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.links += [value or "" for name, value in attrs if name in ("href", "src")]
        assert not [name for name, _ in attrs if name.startswith("on")]
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if self.open and self.open[-1] != "style":
            self.texts.append(data)

    @property
    def words(self) -> str:
        return re.sub(r"\s+", " ", " ".join(self.texts))


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a case and its run folders `still`, `flow` and `move`, and one of a dry case."""
    folder = tmp_path_factory.mktemp("report")
    (folder / "case.yaml").write_text(CASE + MUD + "time: {end: 0.05 s}\noutput: {probes: [1500]}\n")
    (folder / "dry.yaml").write_text(CASE)
    case = str(folder / "case.yaml")
    main_succeeds("statics", case, "--out", folder / "still")
    main_succeeds("statics", folder / "dry.yaml", "--out", folder / "dry")
    main_succeeds("hydraulics", case, "--out", folder / "flow")
    main_succeeds("run", case, "--out", folder / "move", "--progress", "silent")
    return folder


@pytest.fixture(scope="module")
def page(runs: Path) -> str:
    paths = [str(runs / name) for name in ("case.yaml", "still", "flow", "move")]
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("SOURCE_DATE_EPOCH", "86400")
        main_succeeds("report", *paths, "--out", runs / "all.html", rendered=True)
    return (runs / "all.html").read_text(encoding="utf-8")


def test_the_page_stands_alone_and_text_is_escaped(page: str) -> None:
    """No script, no outside resource; titles and names with markup come out as text."""
    read = Page(page)
    assert "script" not in read.tags
    assert "<script>alert(1)</script>" not in page and "&lt;script&gt;alert(1)" in page
    assert "<b>drill pipe</b>" not in page
    assert read.links and all(link.startswith(("data:", "#")) for link in read.links)
    assert "http" not in re.sub(r"base64,[^\"]*", "", page)
    targets = set(re.findall(r'id="([^"]+)"', page))
    assert {link[1:] for link in read.links if link.startswith("#")} <= targets
    assert len(page.encode()) < 5e6


def test_pictures_zoom_where_asked_for(runs: Path) -> None:
    """One script of plotly, and a figure as JSON for each picture of lines; titles with markup cannot end a script."""
    pytest.importorskip("plotly")
    file = runs / "zoom.html"
    main_succeeds("report", runs / "still", "--interactive", "--out", file)
    text = file.read_text(encoding="utf-8")
    figures = [
        json.loads(part) for part in re.findall(r'<script type="application/json">(.*?)</script>', text)
    ]
    assert figures and all(figure["data"] for figure in figures)
    assert text.count("Plotly.newPlot(box") == 1 and len(text.encode()) < 10e6
    assert text.count('<div class="plot" hidden>') == len(figures) <= text.count("<img ")
    assert "<script>alert(1)</script>" not in text


def test_pictures_that_zoom_need_plotly(
    runs: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("plotly", "plotly.offline"):
        monkeypatch.setitem(sys.modules, name, None)
    assert main(["report", str(runs / "still"), "--interactive", "--out", str(runs / "not.html")]) == 2
    assert "plotly" in capsys.readouterr().err and not (runs / "not.html").exists()


def test_pictures_are_whole(page: str) -> None:
    """Each picture is well-formed SVG or a PNG with its end mark."""
    found = re.findall(r'src="data:image/([^;]+);base64,([^"]+)"', page)
    assert len(found) >= 6  # views, string, statics, losses, flow curve, history
    for kind, text in found:
        content = base64.b64decode(text)
        if kind == "png":
            assert content.startswith(b"\x89PNG") and b"IEND" in content[-12:]
        else:
            assert ElementTree.fromstring(content).tag.endswith("svg")


def test_figures_are_those_of_the_runs(page: str, runs: Path) -> None:
    """Hook load and pump pressure in field units, with factors of their own; the survey ends at the hand-computed depth:
    1000 ft and a quarter circle of 900 ft, 1000 + 1800/pi."""
    words = Page(page).words
    still = json.loads((runs / "still" / "summary.json").read_text())
    flow = json.loads((runs / "flow" / "summary.json").read_text())["flows"][0]
    cells = [cell.strip() for cell in Page(page).texts]
    for value in (
        still["hook_load"] * FACTOR,
        still["hook_load_total"] * FACTOR,
        flow["pump_pressure"] / 6894.757293,
    ):
        assert texts(np.array([value]))[0] in cells
    assert "1573.0" in cells and round(1000 + 1800 / np.pi, 1) == 1573.0
    assert "10 klbf" in words and "RKB" in words


def test_tables_go_along_as_they_are(page: str, runs: Path) -> None:
    found = dict(re.findall(r'download="([^"]+)" href="data:text/csv;base64,([^"]+)"', page))
    assert base64.b64decode(found["statics.csv"]) == (runs / "still" / "statics.csv").read_bytes()
    assert base64.b64decode(found["hydraulics.csv"]) == (runs / "flow" / "hydraulics.csv").read_bytes()
    assert (
        base64.b64decode(found["survey.csv"]).decode().splitlines()[0].startswith("md [m],inclination [deg]")
    )


def test_same_input_same_bytes(page: str, runs: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Sections that are written again are those of the page, pictures included; one function writes the pictures of all."""
    paths = [str(runs / name) for name in ("case.yaml", "still", "flow", "move")]
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "86400")
    chosen = ["--sections", "well,string,mud,hydraulics,inputs,solver"]
    main_succeeds("report", *paths, *chosen, "--out", runs / "again.html", rendered=True)
    again = (runs / "again.html").read_text(encoding="utf-8")
    sections = re.findall(r"<section id=.*?</section>", again, re.DOTALL)
    assert len(sections) == 6 and all(section in page for section in sections) and "1970-01-02" in page
    assert sum(section.count("data:image") for section in sections) >= 3
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "yesterday")
    assert main(["report", *paths, *chosen, "--out", str(runs / "third.html")]) == 2


def test_missing_sections_say_why(runs: Path) -> None:
    main_succeeds("report", runs / "dry", "--units", "metric")
    words = Page((runs / "dry" / "report.html").read_text()).words
    assert words.count("no mud in this case") == 3  # mud, hydraulics, surge
    assert "no run folder of this report holds history.csv; 'drillpetsc run CASE.yaml' writes it" in words
    assert "another case" not in words


@pytest.mark.parametrize("command", ["limits", "statics"])
def test_an_operation_is_no_other_case(command: str, runs: Path) -> None:
    """The bottom and the weight on bit that an operation sets are those of its words, not of another file."""
    folder = runs / f"{command}-off-bottom"
    main_succeeds(command, runs / "case.yaml", "--operation", "trip_out", "--out", folder)
    main_succeeds("report", runs / "case.yaml", folder, "--sections", "solver", "--out", runs / "o.html")
    assert "another case" not in Page((runs / "o.html").read_text()).words


def test_sections_are_chosen(runs: Path) -> None:
    main_succeeds("report", runs / "dry", "--sections", "string,solver", "--out", runs / "s.html")
    text = (runs / "s.html").read_text()
    assert re.findall(r"<h2>([^<]+)</h2>", text)[-2:] == ["String", "Solver"] and "<h2>Well" not in text


def test_warnings_come_first(runs: Path) -> None:
    """A run that failed, rows that failed, and a run of another case are reported before any result."""
    doubtful = runs / "doubtful"
    shutil.copytree(runs / "dry", doubtful)
    summary = json.loads((doubtful / "summary.json").read_text())
    summary |= {
        "status": "failed: <no convergence>",
        "warnings": ["look at <this>"],
        "notes": ["60 rpm assumed"],
    }
    (doubtful / "summary.json").write_text(json.dumps(summary))
    (doubtful / "roadmap.csv").write_text("bit_depth [m],status [-]\n100,ok\n200,failed\n")
    main_succeeds("report", runs / "still", doubtful, "--out", runs / "w.html")
    text = (runs / "w.html").read_text()
    warned = text[text.index('id="warnings"') : text.index("<nav>")]
    for words in (
        "failed: &lt;no convergence&gt;",
        "look at &lt;this&gt;",
        "roadmap.csv: 1 of 2 rows have the status &#39;failed&#39;",
        "another case than case.yaml: fluid",
    ):
        assert words in warned
    assert text.index('id="warnings"') < text.index("<h2>Well")
    # what a run assumes is no warning
    noted = text[text.index('id="notes"') : text.index('id="conventions"')]
    assert "assumed" in noted and "assumed" not in warned and "failed" not in noted


def test_margins_of_limits_have_units_and_places(runs: Path) -> None:
    """A summary of limits written by hand: 444822 N is 100 klbf, 304.8 m is 1000 ft."""
    folder = runs / "limits"
    folder.mkdir()
    shutil.copy(runs / "still" / "case.yaml", folder)
    margin = {"margin": 444822.16152605, "md": 304.8, "item": "HWDP", "ratio": 2.0}
    (folder / "summary.json").write_text(json.dumps({"margin_of_overpull": margin, "notes": ["mind <that>"]}))
    (folder / "contacts.csv").write_text("item [-],md [m],side_force [N]\nHWDP,304.8,1000\n")
    main_succeeds("report", folder, "--sections", "limits", "--out", runs / "l.html")
    words = Page((runs / "l.html").read_text()).words
    assert (
        "Margin of overpull 100 klbf 1000 HWDP" in words
        and "What the results assume and leave out limits mind <that>" in words
    )


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["still", "--out", "x.txt"], "a file whose name ends with .html"),
        (["still", "--sections", "hole"], "well, string, mud"),
        (["nowhere"], "a run folder that exists"),
        (["empty"], "a run folder that holds results"),
        (["swept"], "this is a sweep"),
        (["case.yaml", "dry.yaml"], "one case file"),
        (["still", "--sections", "solver", "--out", "nowhere.html/x/y.html"], "a file that can be written"),
    ],
)
def test_what_is_refused(
    words: list[str], message: str, runs: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    monkeypatch.chdir(runs)
    (runs / "empty").mkdir(exist_ok=True)
    (runs / "swept").mkdir(exist_ok=True)
    (runs / "swept" / "sweep.csv").touch()
    (runs / "nowhere.html").touch()
    assert main(["report", *words]) == 2
    assert message in capsys.readouterr().err


def test_numbers_as_text() -> None:
    assert texts(np.array([1234.5678, 0.01, np.nan, -0.00001])) == ["1234.6", "0.0", "-", "0.0"]
    assert texts(np.array([0.0, 5.0, -3.0])) == ["0", "5", "-3"]
    assert texts(np.array([])) == []
    assert texts(np.array([1e-12])) == ["1e-12"]
    assert texts(np.array([np.inf])) == ["-"]


def test_units_of_columns() -> None:
    """Rows of the table of units (manual: guide-units): a diameter in inches, a depth in feet, a dogleg per 100 ft."""
    assert unit_of("od [m]", "field")[2] == "in" and unit_of("md [m]", "field")[2] == "ft"
    assert in_units("od [m]", [0.2159], "field") == pytest.approx([8.5])
    assert in_units("dogleg_severity [deg/30m]", [3.0], "field") == pytest.approx([3.048])
    assert in_units("dogleg_severity [deg/30m]", [3.0], "metric") == pytest.approx([3.0])
    assert (
        unit_of("yield_strength [Pa]", "metric")[2] == "MPa" and unit_of("ecd [kg/m3]", "field")[2] == "ppg"
    )
    assert unit_of("hook_load [N]", "metric_t")[2] == "t" and unit_of("regime [-]", "field")[2] == ""


def test_a_command_writes_its_report_at_once(runs: Path, tmp_path: Path) -> None:
    out = tmp_path / "flow"
    words = ["hydraulics", str(runs / "case.yaml"), "--out", str(out), "--units", "field", "--report"]
    main_succeeds(*words)
    read = Page((out / "report.html").read_text(encoding="utf-8"))
    assert "psi" in read.words and "hydraulics" in read.words.lower()
    assert not (runs / "flow" / "report.html").exists()


def test_the_command_export(runs: Path, capsys: pytest.CaptureFixture, tmp_path: Path) -> None:
    out = tmp_path / "tables"
    main_succeeds("export", runs / "move", "--units", "field", "--columns", "hook_load", "--out", out)
    assert capsys.readouterr().out.split() == [str(out / "history.csv")]
    assert "Hook load [klbf]" in (out / "history.csv").read_text().splitlines()[0]
    main_succeeds("export", runs / "move", "--format", "las", "--out", out)
    assert "history.las" in capsys.readouterr().out
    assert main(["export", str(runs / "move"), "--columns", ",", "--out", str(out)]) == 2
    assert main(["export", str(runs / "nowhere")]) == 2
    assert "--columns" in (errors := capsys.readouterr().err) and "Traceback" not in errors


@pytest.mark.parametrize("words", [["4 kg", "5 m"], ["a", "b"], ["nan", "1"], ["", "1"]])
def test_a_wrong_interval_of_view(runs: Path, words: list[str], capsys: pytest.CaptureFixture) -> None:
    assert main(["view", str(runs / "still"), "--interval", *words]) == 2
    assert "--interval" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("text", "field"),
    [
        ("pore at TVD 1233 m", "pore at TVD 4045 ft"),
        ("open hole to 3144.62 m", "open hole to 10317 ft"),
        (
            "the string ends at MD 304.8 m, 609.6 m above the end",
            "the string ends at MD 1000 ft, 2000 ft above the end",
        ),
        ("at 0.3 m/s and 5 m2, to 3 mm, MD 4 min", "at 0.3 m/s and 5 m2, to 3 mm, MD 4 min"),
    ],
)
def test_lengths_in_texts_have_the_units_of_the_page(text: str, field: str) -> None:
    assert lengths_shown(text, "field") == field and lengths_shown(text, "metric") == text


def test_the_box_compares_with_the_limits_of_rig_string_and_hole(tmp_path: Path) -> None:
    """Each figure is the worst of its table; its word follows the limits of the case: exceeded, close, within, none given."""
    rig = "rig: {block_weight: 10 klb, max_hookload: HOOK klbf, max_surface_torque: 60 kft-lbf}\n"
    extra = (
        MUD + "roadmap: {operations: [pickup, drilling], bit_depth: [900, 1801], trip_speed: 100 ft/min}\n"
    )
    text = re.sub(r"rig: .*\n", "", CASE) + extra
    pipe = "{kind: drill_pipe, name: drill pipe, length: 1800, pipe: 5in 19.50 S-135 NC50 premium}"
    text = re.sub(r"- {kind: pipe.*", f"- {pipe}", text)
    (tmp_path / "case.yaml").write_text(rig.replace("HOOK", "900") + text)
    for command in ("roadmap", "limits", "hydraulics"):
        main_succeeds(command, tmp_path / "case.yaml", "--out", tmp_path / command)
    surge = ["--speeds", "60", "--window", "9.5,11", "--out", str(tmp_path / "surge")]
    main_succeeds("surge", tmp_path / "case.yaml", *surge)
    runs = [Run.open(tmp_path / name) for name in ("roadmap", "limits", "hydraulics", "surge")]
    table = read_table(tmp_path / "roadmap" / "roadmap.csv")
    heaviest = float(table["hook_load_total [N]"].max())
    for hook, state in (
        ("900", "within"),
        (f"{heaviest * FACTOR / 0.95:.6g}", "close"),
        (f"{heaviest * FACTOR * 0.99:.6g}", "exceeded"),
    ):
        (tmp_path / "case.yaml").write_text(rig.replace("HOOK", hook) + text)
        case = load_case(tmp_path / "case.yaml")
        found = {check.name: check for check in checks(runs, case)}
        assert (found["Hook load"].value, found["Hook load"].state) == (heaviest, state)
        assert found["Hook load"].margin == pytest.approx(float(hook) / FACTOR - heaviest)
        shown = answer(runs, case, "field")
        assert shown is not None
        if state != "within":
            assert shown.rows[0][0] == "Hook load" and "Hook load" in shown.sentence
            assert "friction factors" in shown.rows[0][5] and " ft" in shown.rows[0][5]
    torque, twisted = found["Surface torque"], float(table["surface_torque [N m]"].max())
    assert torque.value == twisted and torque.share == pytest.approx(twisted / (60e3 * 1.3558179483314004))
    weakest = runs[1].summary["weakest"]["safety_factor"]
    assert found["Safety factor against yield"].share == pytest.approx(1.25 / weakest["value"])
    assert found["Pump pressure"].state == "not compared" and found["Pump pressure"].missing == "rig.max_spp"
    # the fastest trips of surge are those within its window; the plan is the roadmap's
    fastest = min(
        row["max_trip_speed"] for row in runs[3].summary["max_trip_speed"] if row["operation"] == "trip_out"
    )
    pulled = found["Trip speed, pulling out"]
    assert pulled.limit == fastest and pulled.value == pytest.approx(100 * 0.3048 / 60)
    assert pulled.state == ("exceeded" if pulled.value > fastest else pulled.state)
    page = tmp_path / "page.html"
    main_succeeds(
        "report",
        tmp_path / "case.yaml",
        *[run.folder.path for run in runs],
        "--sections",
        "solver",
        "--out",
        page,
    )
    assert "Limit exceeded: Hook load" in Page(page.read_text(encoding="utf-8")).words


def test_ecd_is_compared_within_the_window_of_the_open_hole(tmp_path: Path) -> None:
    """The share of the window is 0 at pore and 1 at fracture pressure, the worst of all depths below the shoe."""
    window = "window: {tvd: [400, 1600], pore: [9.5, 9.8], frac: [FRAC, FRAC]}\n"
    states = {}
    for frac in (11.5, 10.2):
        (tmp_path / "case.yaml").write_text(CASE + MUD + window.replace("FRAC", str(frac)))
        out = tmp_path / f"flow{frac}"
        main_succeeds("hydraulics", tmp_path / "case.yaml", "--out", out)
        found = {c.name: c for c in checks([Run.open(out)], load_case(tmp_path / "case.yaml"))}
        table, ppg, ft = read_table(out / "pressure_profile.csv"), 0.45359237 / 3.785411784e-3, 0.3048
        below = (table["md [m]"] >= 500 * ft - 1e-6) & np.isfinite(table["ecd [kg/m3]"])
        ecd, tvd = table["ecd [kg/m3]"][below] / ppg, table["tvd [m]"][below] / ft
        pore = np.interp(tvd, [400, 1600], [9.5, 9.8])
        place = (ecd - pore) / (frac - pore)
        assert found["ECD below fracture gradient"].share == pytest.approx(place.max(), rel=1e-6)
        assert found["ECD above pore pressure"].share == pytest.approx(1 - place.min(), rel=1e-6)
        states[frac] = found["ECD below fracture gradient"].state
    assert states == {11.5: "within", 10.2: "exceeded"}


def test_a_limit_of_zero_is_exceeded(tmp_path: Path) -> None:
    """A string that can give no weight on bit, and a trip that leaves the window at any speed."""
    (tmp_path / "case.yaml").write_text(CASE + MUD + "roadmap: {trip_speed: 100 ft/min}\n")
    (tmp_path / "limits.csv").write_text("md [m]\n")
    (tmp_path / "surge.csv").write_text("bit_depth [m]\n")
    trip = {
        "operation": "trip_in",
        "pipe": "closed",
        "bit_depth": 500.0,
        "max_trip_speed": 0.0,
        "limited_by": "frac at TVD 400 m",
    }
    summary = {
        "operation": "sliding",
        "motion": {"rotation": 0.0},
        "choices": {"side_force_per_joint": 9e3},
        "weakest": {},
        "wob": 1e4,
        "available_wob": {"sliding": {"wob": 0.0, "limited_by": "helical"}},
        "max_trip_speed": [trip],
    }
    found = checks([Run(RunFolder(tmp_path), "one", summary)], load_case(tmp_path / "case.yaml"))
    assert {check.name: check.state for check in found} == {
        "Weight on bit": "exceeded",
        "Trip speed, running in": "exceeded",
    }
