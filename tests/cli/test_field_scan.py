"""Screens, pictures and reports of a case in field units contain no SI unit: every command, and every text that is drawn.

Columns and keys of the files that the commands write are those of the catalogue.
"""

from __future__ import annotations

import html
import re
import shutil
from io import BytesIO, StringIO
from pathlib import Path

import pytest
from matplotlib.text import Text

from drillpetsc import cli
from drillpetsc.output import read_table
from drillpetsc.output.catalogue import all_quantities, listed_by_file, outputs_by_file
from drillpetsc.output.files.json_file import read_summary
from drillpetsc.output.files.tables import split_name
from drillpetsc.output.shown_units import unit_of
from drillpetsc.output.summary_keys import SUMMARY_KEYS
from drillpetsc.plotting.notebook import Picture
from tests.helpers.si_words import ONE, si_units

WELL = """
units: field
well:
  survey: {md: [0, 300, 700, 900], inclination: [0, 0, 20, 20], azimuth: [0, 0, 0, 0]}
  sections:
    - {to: 400, kind: casing, diameter: 8.681, friction: 0.2}
    - {to: end, kind: open_hole, diameter: 8 1/2, friction: 0.3}
rig: {datum: RKB, elevation: 25, block_weight: 60, max_hookload: 500, max_surface_torque: 30000, max_spp: 5000}
bottom: bit
formation: {drillability: 4.2e-8 m/(s N), strength: 8700 psi}
fluid: {density: 10.5, flow_rate: 550, rheology: {dial: {600: 64, 300: 41, 200: 32, 100: 22, 6: 8, 3: 7}}, surface_line: {case: 3}}
window: {tvd: [390, 890], pore: [8.8, 9.6], frac: [12.6, 13.6]}
"""
ROTARY = """
string:
  - {kind: drill_pipe, length: 770, pipe: 5in 19.50 S-135 NC50 premium, element_length: 60}
  - {kind: drill_collar, length: 90, od: 6 3/4, id: 2 13/16, eccentricity: 0.02, element_length: 30}
  - {kind: stabilizer, length: 6, blade_od: 8 3/8, blade_length: 18 in, body_od: 6 3/4, id: 2 13/16}
  - {kind: drill_collar, length: 30, od: 6 3/4, id: 2 13/16, element_length: 30}
  - {kind: bit, length: 1, od: 8 1/2, nozzles: 5 x 14/32 in}
top: {kind: top_drive, rotation: 120, lowering: 60 ft/h}
initial: {wob: 4}
roadmap: {bit_depth: {from: 500, to: 800, step: 150}}
time: {end: 0.3 s}
output:
  probes: [400, 700]
  history_every: 0.01 s
  sensors: [{name: mwd, at: 700, rate: 200 Hz, radius: 2, channels: [ax, ay, az, rpm]}]
"""
TOOLS = """
string:
  - {kind: drill_pipe, length: 645, pipe: 5in 19.50 S-135 NC50 premium, element_length: 60}
  - {kind: jar, name: jar, length: 30, od: 6.5, id: 2.75, joint_at: 15, jar: {action: hydraulic, direction: up, stroke: 7 in,
     threshold: 12, metering_stroke: 3 in, metering_resistance: 20 klbf s/in, seal_area: 6 in2}}
  - {kind: drill_collar, length: 180, od: 6 3/4, id: 2 13/16, element_length: 30}
  - {kind: shock_sub, name: shock, length: 10, od: 6.75, id: 2.5, joint_at: 5, stiffness: 10 klbf/in, damping: 30 lbf s/in, stroke: [-2, 2]}
  - {kind: pdm, name: motor, length: 27, od: 6.75, id: 4, mass: 2300 lb, bend: {angle: 1.25, tool_face: 60, position: 7}, joint_at: 25,
     pdm: {rev_per_volume: 0.29 rev/gal, efficiency: 0.85, no_load_pressure: 90, stall_torque: 10000, lobes: [7, 8], rotor_inertia: 70 lb ft2}}
  - {kind: bit, length: 1, od: 8 1/2, nozzles: 5 x 14/32 in}
top:
  kind: top_drive
  rotation: 30
  lowering: 60 ft/h
  hoist: {block_mass: 55 klb, lines: 10, line: {diameter: 1.375 in}, height: 60, sheave_efficiency: 0.98}
  autodriller: {mode: [wob, rop], wob: 10, rop: 60 ft/h, p: 4.0e-7 m/(s N), i: 1.0e-8 m/(s2 N), from: 0.1 s, ramp: 500 lbf/s, filter: 0.5 s}
  motor: {inertia: 68000 lb ft2, max_torque: 30000, power: 800 hp}
  control: {kind: soft_torque, frequency: 0.2 Hz}
initial: {wob: 3}
time: {end: 0.05 s}
output: {probes: [400, 700], history_every: 0.01 s}
"""
LOG = "Bit Depth [ft], Operation, HKLD [klbf], TQ [kft-lbf]\n500, POOH, 75, 0\n800, POOH, 83, 0\n800, Drilling, 70, 1.2\n"

#: command -> pieces of text that may hold an SI unit, with the reason
COMMANDS: dict[str, tuple[str, ...]] = {
    "check rotary.yaml": (),
    "check tools.yaml": (),
    "statics rotary.yaml --out st": (),
    "statics tools.yaml --out st2": (),
    "limits rotary.yaml --out li --sn 14,4": (),
    "limits tools.yaml --operation trip_out --out li2": (),
    "roadmap rotary.yaml --out ro": (),
    "calibrate rotary.yaml --measured log.csv --out ca": (),
    "hydraulics rotary.yaml --out hy": (),
    "surge rotary.yaml --speeds 60,120ft/min --out su": (),
    "freepoint rotary.yaml --stretch 4,10in --pull 10,20klbf": (),
    "run rotary.yaml --out run --progress log": (),
    "run tools.yaml --out run2 --progress log": (),
    "plot run": (),
    "plot run2": (),
    "view run --out view.png": (),
    "vibration run": (),
    "export run --out ex": (),
    "modes rotary.yaml --out mo --count 6": (),
    "plot mo": (),
    "campbell rotary.yaml --out cam --speeds 60,120rpm --count 2 --stiffness 1e6Pa": (),
    "stability rotary.yaml --speeds 60,120rpm --wob 4,5 --count 4 --out sta": (),
    "response rotary.yaml --excite unbalance --speeds 60:120:20rpm --out re --stress": (),
    "response rotary.yaml --excite 700ft --amplitude 5klbf --speeds 60,80rpm --out res2": (),
    # the units of the matrices that it writes, which are in SI as all files
    "linearise rotary.yaml --inputs top.rotation --outputs bit_speed --out lin": (
        "top.rotation [rad/s]",
        "bit_speed [rad/s]",
    ),
    "top-drive tools.yaml --out top": (),
    "sweep rotary.yaml top.rotation=60,100 --out sw --progress silent": (),
    "report rotary.yaml st li ro hy run --out report.html": (),
}
#: folder -> command that makes it
MAKERS = {
    words[words.index("--out") + 1]: command for command in COMMANDS if "--out" in (words := command.split())
}
#: tables of the report that say SI in their captions: the case resolved, and the files summary.json as they are
IN_SI = r'<section id="(inputs|solver)-.*?</section>'

#: commands whose columns have names of probes and joints, or words for people
WITH_NAMES = ("run", "export")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("field")
    (made / "rotary.yaml").write_text(WELL + ROTARY)
    (made / "tools.yaml").write_text(WELL + TOOLS)
    (made / "log.csv").write_text(LOG)
    return made


@pytest.mark.parametrize("command", COMMANDS)
def test_no_si_unit(command: str, folder: Path, monkeypatch, capsys) -> None:
    """`plot` and `report` show the folders of other commands, which run before them if another process has their tests."""
    drawn: list[str] = []

    def spy(self, file, **more):
        self.draw_without_rendering()  # ticks have their texts then
        drawn.extend(q.get_text() for q in self.findobj(Text) if q.get_visible())
        if isinstance(file, StringIO):
            file.write("<svg></svg>")
        elif not isinstance(file, BytesIO):
            Path(file).touch()

    monkeypatch.setattr(Picture, "savefig", spy)
    monkeypatch.setattr(Picture, "fitted", lambda picture, *place, **more: picture)
    monkeypatch.chdir(folder)
    for word in command.split()[1:]:
        maker = MAKERS.get(word)
        if maker is not None and maker != command and not Path(word).exists():
            assert cli.main(maker.split()) == 0
    if MAKERS.get(own := command.partition("--out ")[2].partition(" ")[0]) == command and Path(own).is_dir():
        shutil.rmtree(own)  # a test that needs it came first
    drawn.clear()
    capsys.readouterr()
    assert cli.main(command.split()) == 0
    screen = capsys.readouterr()
    texts = [screen.out, screen.err, *drawn]
    if (Path(own) / "summary.json").is_file() and (
        file := f"summary.json of {command.split()[0]}"
    ) in SUMMARY_KEYS:
        written = {split_name(key)[0] for key in read_summary(Path(own) / "summary.json")}
        listed = {key.name.partition(".")[0]: key.condition for key in SUMMARY_KEYS[file]}
        quantities = {q.name for q in outputs_by_file().get(file, ())}
        assert (
            {key for key, condition in listed.items() if not condition} <= written <= {*listed, *quantities}
        )
    if command.startswith("plot"):
        assert len(drawn) > 50
    if command.startswith("report"):
        page = re.sub(IN_SI + r"|<(script|style).*?</\2>", " ", Path("report.html").read_text(), flags=re.S)
        texts.append(html.unescape(re.sub(r"<[^>]+>", " ", page)))
        assert "Hook load" in texts[-1]
    found = [words for text in texts for words in si_units(text)]
    assert [words for words in found if not any(allowed in words for allowed in COMMANDS[command])] == []
    for table in Path(own or ".").glob("*.csv"):
        listed = {q.quantity.title: q.condition for q in listed_by_file().get(table.name, ())}
        if listed and command.split()[0] not in WITH_NAMES:
            columns = set(read_table(table))
            assert {title for title, condition in listed.items() if not condition} <= columns <= {*listed}, (
                table
            )


def test_the_scan_finds_what_it_looks_for() -> None:
    """Words of the kind that were found, and units of the field that look alike."""
    bad = (
        "Whirl at 121.92 m: 3",
        "up to 583 N are",
        "Depth [m]",
        "bulk modulus 2e+09 Pa",
        "at 12.5664 rad/s",
        "is 0.127 m.",
    )
    assert [len(si_units(text)) for text in bad] == [1] * len(bad)
    good = (
        "5 min",
        "12 klbf",
        "3 ms",
        "[ft]",
        "1/s",
        "8.5 in",
        "string[3] m",
        "MD 400 ft",
        "4 N1",
        "0.2 Hz",
        "7 kft-lbf",
    )
    assert [si_units(text) for text in good] == [[]] * len(good)


#: quantities with no unit of their own in the field
NO_FIELD_UNIT = {"spin_acceleration"}


def test_every_column_has_a_unit_of_the_field() -> None:
    for quantity in all_quantities():
        unit = unit_of(quantity.title, "field")[2]
        assert quantity.name in NO_FIELD_UNIT or not re.fullmatch(ONE, unit), (quantity.title, unit)
