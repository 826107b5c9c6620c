"""Pictures of new hole: comparison with holes on circles, line styles, and robustness of a sweep against failing
pictures."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from drillpetsc.case.schema import unit_of
from drillpetsc.geometry.trajectory import angles
from drillpetsc.geometry.well import Well, direction
from drillpetsc.output import RunFolder, read_table, write_summary, write_table
from drillpetsc.output.files.run_folder import SWEEP_PICTURES
from drillpetsc.plotting import style
from drillpetsc.plotting.command.sweep import (
    build_rates,
    draw_sweep,
    drilled_paths,
    inclinations,
    round_scale,
    trajectories,
)
from drillpetsc.plotting.run import hole_path
from drillpetsc.plotting.run.plot import plot
from drillpetsc.studies.sweep import sweep as sweep_module
from drillpetsc.studies.sweep.table import Plan
from tests.helpers.command import unrendered

START = 100.0  # depth of the old hole, straight from the surface [m]
COLUMNS = [
    ("md", "m"), ("inclination", "deg"), ("azimuth", "deg"), ("north", "m"), ("east", "m"), ("tvd", "m"),
    ("dogleg_severity", "deg/30m"),
]  # fmt: skip


def write_hole(
    file: Path, inclination: float, azimuth: float, build: float, turn: float, length: float
) -> None:
    """Write a straight hole of START [m] with these angles [deg], then ``length`` [m] of new hole with
    constant build and turn [deg in total]."""
    md = np.array([0.0, START, START + length])
    angle, aim = (
        np.radians([inclination, inclination, inclination + build]),
        np.radians([azimuth, azimuth, azimuth + turn]),
    )
    hole = Well.from_survey(md, angle, aim, [md[-1]], [0.1], [0.3])
    s = np.unique(np.r_[np.linspace(0, START, 11), np.linspace(START, md[-1], 41)])
    place, tangent, _ = hole.at(s)
    one, two = map(np.degrees, angles(tangent))
    write_table(file, COLUMNS, [s, one, two, *place.T, np.full(len(s), 7.0)])


def make_sweep(
    folder: Path, header: str, rows: list[str], holes: list[tuple[float, ...]], status: str = "done"
) -> Path:
    """A sweep's folder: rows ``values,si`` and holes (inclination, azimuth, build, turn, length)."""
    folder.mkdir()
    names, *si = header.split("|")
    titles = ",".join([names, *si])
    lines = [f"member,{titles},status,folder,ranks,drilled [m],build_rate [deg/30m],message"]
    for k, (row, hole) in enumerate(zip(rows, holes, strict=True), 1):
        run = RunFolder.create("x", out=folder / f"member-{k:03d}")
        write_hole(run.trajectory, *hole)
        member_status = status if k == len(rows) else "done"
        lines.append(f"{k},{row},{member_status},member-{k:03d},1,{hole[4]},{30 * hole[2] / hole[4]},")
    (folder / "sweep.csv").write_text("\n".join(lines) + "\n")
    units = {key: unit_of(key) for key in names.split(",")}
    write_summary(folder / "summary.json", {"title": "made by hand", "units": units})
    return folder


def density_sweep(folder: Path, inclination: float = 40.0) -> Path:
    """Sweep of flow rate 10 l/s and 20 l/s times density 1000 and 1200, and a member without fluid."""
    rows = [
        "on,10 l/s,1000,0.01", "on,10 l/s,1200,0.01", "on,20 l/s,1000,0.02", "on,20 l/s,1200,0.02",
        "off,-,-,nan",
    ]  # fmt: skip
    holes = [(inclination, 30.0, 0.5 + 0.1 * k, 0.02 * k, 20.0) for k in range(5)]
    return make_sweep(folder, "fluid,fluid.flow_rate,fluid.density|fluid.flow_rate (SI)", rows, holes)


@pytest.mark.parametrize("inclination", [0.0, 40.0])
def test_every_picture_of_a_sweep_has_content(inclination: float, tmp_path: Path) -> None:
    files = draw_sweep(density_sweep(tmp_path / "out", inclination))
    assert [file.stem for file in files] == list(SWEEP_PICTURES)
    for file in files:
        assert (
            file.parent == tmp_path / "out" and len(np.unique(np.asarray(Image.open(file).convert("L")))) > 20
        )


def test_offsets_are_those_of_a_circle(tmp_path: Path) -> None:
    """New hole on a circle that builds 0.6 deg in 20 m: R = 20 m/0.6 deg, up R (1 - cos 0.6 deg), along R sin
    0.6 deg."""
    folder = make_sweep(
        tmp_path / "out", "top.rotation|top.rotation (SI)", ["60 rpm,6.28"], [(40.0, 30.0, 0.6, 0.0, 20.0)]
    )
    (path,) = drilled_paths(folder)
    turn = np.radians(0.6)
    radius = 20.0 / turn
    assert (path.md[0], path.md[-1], path.azimuth) == (START, START + 20.0, pytest.approx(30.0))
    assert path.up[-1] == pytest.approx(radius * (1 - np.cos(turn)), rel=1e-6)
    assert path.along[-1] == pytest.approx(radius * np.sin(turn), rel=1e-9)
    assert path.right == pytest.approx(np.zeros(len(path.md)), abs=1e-9) and np.degrees(
        path.tilt
    ) == pytest.approx(40.0)


def test_a_turn_to_larger_azimuth_lies_to_the_right(tmp_path: Path) -> None:
    """Looking north, east is on the right: a level hole that turns by 1 deg in 20 m ends at an offset R (1 -
    cos 1 deg)."""
    folder = make_sweep(
        tmp_path / "out", "top.rotation|top.rotation (SI)", ["60 rpm,6.28"], [(90.0, 0.0, 0.0, 1.0, 20.0)]
    )
    (path,) = drilled_paths(folder)
    assert path.right[-1] == pytest.approx(20.0 / np.radians(1.0) * (1 - np.cos(np.radians(1.0))), rel=1e-6)
    assert abs(path.up[-1]) < 1e-9


def test_offsets_in_the_section_have_the_stated_scale(tmp_path: Path) -> None:
    """Largest offset 0.157 m (0.9 deg in 20 m: L^2/2R): 0.35 of 20 m is 44.6 times that; the next round
    number below is 20."""
    drawing = trajectories(drilled_paths(density_sweep(tmp_path / "out")), "t")
    section, plan, ends = drawing.axes[:3]
    assert section.get_title().endswith(" 20 times")
    paths = drilled_paths(tmp_path / "out")
    for path, line in zip(paths, section.lines, strict=False):
        s, c = np.sin(path.tilt), np.cos(path.tilt)
        assert line.get_xdata() * c - line.get_ydata() * s == pytest.approx(20 * path.up, abs=1e-9)
        assert line.get_xdata() * s + line.get_ydata() * c == pytest.approx(path.along, abs=1e-9)
    for path, line, end in zip(paths, plan.lines, ends.lines, strict=False):
        assert line.get_xdata() == pytest.approx(path.right)
        assert (end.get_xdata()[0], end.get_ydata()[0]) == pytest.approx((path.right[-1], path.up[-1]))
    scale = float(plan.get_title().split()[-2])
    assert plan.get_aspect() == pytest.approx(1 / scale)  # a metre of depth is as long as 1/scale of offset
    drawing.canvas.draw()
    ticks = [(q.get_loc(), q.label1.get_text()) for q in plan.xaxis.get_major_ticks()]
    assert plan.get_xlabel().endswith("[mm]") and all(1e3 * x == pytest.approx(float(mm)) for x, mm in ticks)


def test_a_sweep_of_a_field_case_is_in_feet_and_inches(tmp_path: Path) -> None:
    """The same lines; 20 m of new hole are 65.6 ft; 0.75 deg/30 m are 0.762 deg/100 ft."""
    paths = drilled_paths(density_sweep(tmp_path / "out"))
    with style.in_units("field"):
        assert inclinations(paths, "t").axes[0].lines[0].get_xdata()[-1] == pytest.approx(120 / 0.3048)
        rates = build_rates(paths, "t").axes[0]
        drawing = trajectories(paths, "t")
    assert rates.get_ylabel() == "Average build rate [deg/100ft]"
    assert rates.lines[0].get_ydata() == pytest.approx(np.array([0.75, 1.05]) * 30.48 / 30)
    assert drawing.get_suptitle() == "t: new hole, 65.62 ft"
    drawing.canvas.draw()
    for axes, size in zip(drawing.axes[:3], (0.3048, 0.3048, 0.0254), strict=True):
        for q in axes.yaxis.get_major_ticks():
            assert q.get_loc() == pytest.approx(float(q.label1.get_text()) * size, abs=1e-9)


def test_colour_shows_the_first_key_the_marker_the_second_and_the_dry_member_is_dashed(
    tmp_path: Path,
) -> None:
    lines = inclinations(drilled_paths(density_sweep(tmp_path / "out")), "t").axes[0].lines
    assert [line.get_label() for line in lines] == [
        "10 l/s, 1000 kg/m3", "10 l/s, 1200 kg/m3", "20 l/s, 1000 kg/m3", "20 l/s, 1200 kg/m3", "no fluid",
    ]  # fmt: skip
    colors, markers = [line.get_color() for line in lines], [line.get_marker() for line in lines]
    assert colors[0] == colors[1] != colors[2] == colors[3] and colors[4] == "black"
    assert markers[0] == markers[2] != markers[1] == markers[3]
    assert [line.get_linestyle() for line in lines] == ["-"] * 4 + ["--"]
    assert lines[4].get_ydata()[[0, -1]] == pytest.approx([40.0, 40.9])


def test_build_rates_over_the_first_key_a_line_a_density(tmp_path: Path) -> None:
    """30 m/20 m times the 0.5, 0.6, ... deg that were built; flow rates in the unit they were given in."""
    axes = build_rates(drilled_paths(density_sweep(tmp_path / "out")), "t").axes[0]
    light, heavy, dry = axes.lines
    assert axes.get_xlabel() == "fluid.flow_rate [l/s]"
    assert light.get_xdata() == pytest.approx([10, 20]) and heavy.get_xdata() == pytest.approx([10, 20])
    assert light.get_ydata() == pytest.approx([0.75, 1.05]) and heavy.get_ydata() == pytest.approx([0.9, 1.2])
    assert dry.get_ydata() == pytest.approx([1.35, 1.35]) and dry.get_linestyle() == "--"


@pytest.mark.parametrize(
    ("header", "rows", "pictures"),
    [
        (
            "top.rotation|top.rotation (SI)",
            [f"{k} rpm,{k / 9.55}" for k in range(60, 72)],
            2,
        ),  # more values than colours
        ("fluid", ["on", "off"], 2),
        ("bottom", ["bit", "{kind: bit}"], 2),
        (
            "top.rotation,formation.bit_anisotropy|top.rotation (SI)",
            ["60 rpm,0.1,6.28", "60 rpm,0.2,6.28", "1 Hz,0.2,6.28"],
            3,
        ),
        ("fluid.density,title,top.rotation", ["1000,a,6", "1000,b,7", "1200,a,6", "1200,b,7"], 3),
    ],
)
def test_other_sweeps(header: str, rows: list[str], pictures: int, tmp_path: Path) -> None:
    holes = [(40.0, 30.0, 0.1 * k, 0.0, 10.0 + k) for k in range(len(rows))]
    folder = make_sweep(tmp_path / "out", header, rows, holes)
    with unrendered():
        drawn = plot(folder, tmp_path / "again")  # as `drillpetsc plot` draws them
    assert [file.parent for file in drawn] == [tmp_path / "again"] * pictures


def test_failed_members_and_members_without_new_hole_are_not_drawn(tmp_path: Path) -> None:
    holes = [(40.0, 30.0, 0.5, 0.0, 20.0), (40.0, 30.0, 0.1, 0.0, 3.0)]
    folder = make_sweep(tmp_path / "out", "fluid.density", ["1000", "1200"], holes, status="failed")
    assert [path.values for path in drilled_paths(folder)] == [{"fluid.density": "1000 kg/m3"}]
    (folder / "sweep.csv").write_text("member,fluid.density,status,folder,message\n1,1000,done,member-001,\n")
    assert draw_sweep(folder) == []
    with pytest.raises(FileNotFoundError, match="drilled"):
        plot(folder)


def test_scales_are_round() -> None:
    assert [round_scale(x) for x in (0.3, 1.0, 1.9, 2.0, 4.9, 5.0, 9.9, 10.0, 499.0, 500.0)] == [
        1, 1, 1, 2, 2, 5, 5, 10, 200, 500,
    ]  # fmt: skip


def test_units_of_keys() -> None:
    known = {
        "fluid.density": "kg/m3",
        "string[2].od": "m",
        "formation.layers[0].drillability": "m/(s N)",
        "top.rotation": "rad/s",
    }
    assert {key: unit_of(key) for key in known} == known
    assert [
        unit_of(key) for key in ("title", "well.sections[0].friction", "nonsense", "top.nonsense[2]")
    ] == [""] * 4


# ---------------------------------------------------------------------- at the end of a sweep
def plan_of(folder: Path, table: str = "sweep.csv") -> Plan:
    return Plan("", table, folder, folder, (), ())


def test_a_drawing_that_fails_does_not_fail_the_sweep(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    """Here the folder of the members is missing. Without new hole, and for wells, nothing is drawn."""
    drilled = [{"drilled [m]": 2.0}]
    assert sweep_module._pictures(plan_of(tmp_path / "gone"), drilled) == []
    assert "no pictures of the sweep: FileNotFoundError" in capsys.readouterr().err
    assert sweep_module._pictures(plan_of(tmp_path / "gone"), [{"drilled [m]": np.nan}, {}]) == []
    assert sweep_module._pictures(plan_of(tmp_path / "gone", "wells.csv"), drilled) == []
    assert capsys.readouterr().err == ""
    with unrendered():
        assert len(sweep_module._pictures(plan_of(density_sweep(tmp_path / "out")), drilled)) == 3


# ---------------------------------------------------------------------- one run
def test_a_run_marks_its_new_hole(tmp_path: Path) -> None:
    run = RunFolder.create("x", out=tmp_path / "run")
    write_hole(run.trajectory, 40.0, 359.9, 0.6, 0.4, 20.0)
    assert [file.name for file in plot(run.path)] == ["trajectory.png"]  # no summary, or nothing drilled
    write_summary(run.summary, {"title": "a", "new_hole": {"drilled [m]": 20.0}})
    assert [file.name for file in plot(run.path)] == ["trajectory.png", "new_hole.png"]
    table = read_table(run.trajectory)
    section, plan = hole_path.well_path(table, "t", 20.0).axes
    assert section.lines[1].get_ydata()[[0, -1]] == pytest.approx(table["tvd [m]"][[10, -1]])
    assert section.lines[1].get_label() == "new hole, 20 m"
    assert plan.lines[0].get_ydata()[-1] == plan.lines[1].get_ydata()[0]


def test_tracks_of_the_new_hole(tmp_path: Path) -> None:
    """Straight, then a circle: dogleg severity 0, then the angle between the directions per 30 m; half of
    that where half of the short course is new; azimuth continues past north."""
    write_hole(tmp_path / "trajectory.csv", 40.0, 359.9, 0.6, 0.4, 20.0)
    inclination, azimuth, severity = hole_path.new_hole(
        read_table(tmp_path / "trajectory.csv"), "t", 20.0
    ).axes
    one, two = direction(np.radians([40.0, 40.6]), np.radians([359.9, 360.3]))
    rate = np.degrees(np.arccos(one @ two)) * 30 / 20
    depth, shown = severity.lines[0].get_ydata(), severity.lines[0].get_xdata()
    assert (
        depth[0] == START - 10
        and depth[-1] == START + 20
        and inclination.get_ylim() == pytest.approx((START + 20.4, START - 10))
    )
    assert shown[depth <= START] == pytest.approx(np.zeros((depth <= START).sum()), abs=1e-6)
    assert shown[-1] == pytest.approx(rate, rel=1e-3)
    assert shown[depth == START + 1.5] == pytest.approx(rate / 2, rel=1e-3)
    assert severity.lines[3].get_xdata()[-1] == pytest.approx(rate * 20 / 30, rel=1e-3)  # over the 30 m above
    assert inclination.lines[0].get_xdata()[[0, -1]] == pytest.approx([40.0, 40.6])
    assert azimuth.lines[0].get_xdata()[[0, -1]] == pytest.approx([359.9, 360.3])


def test_the_new_hole_of_a_field_case_is_in_feet(tmp_path: Path) -> None:
    """Depths over 0.3048 m, dogleg severity per 100 ft: 30.48/30 of that per 30 m; no metres in any text."""
    write_hole(tmp_path / "trajectory.csv", 40.0, 359.9, 0.6, 0.4, 20.0)
    table = read_table(tmp_path / "trajectory.csv")
    token = style.UNITS.set("field")
    try:
        drawing = hole_path.new_hole(table, "t", 20.0)
    finally:
        style.UNITS.reset(token)
    metric = hole_path.new_hole(table, "t", 20.0).axes[2].lines[0]
    severity = drawing.axes[2].lines[0]
    assert severity.get_ydata() * 0.3048 == pytest.approx(metric.get_ydata())
    assert severity.get_xdata()[-1] == pytest.approx(metric.get_xdata()[-1] * 30.48 / 30, rel=1e-3)
    texts = [t.get_text() for t in drawing.findobj(lambda a: hasattr(a, "get_text"))]
    assert any("[deg/100ft]" in t for t in texts) and any("over the 100 ft above" in t for t in texts)
    assert not [t for t in texts if re.search(r"\[m\]|\d m\b|30 ?m\b", t)]
