"""The view: frames, fields, scales, and comparison of the picture with the files."""

from __future__ import annotations

from pathlib import Path
from subprocess import CompletedProcess

import numpy as np
import pytest
from PIL import Image

from drillpetsc.output import Frame
from drillpetsc.output.files.run_folder import RunFolderMissing
from drillpetsc.plotting.run import render
from drillpetsc.plotting.run.shape import cut, find_field, half_width, shape_of, smooth
from drillpetsc.plotting.run.view import TRACK_WIDTH, TRACKS_HEIGHT, _auto_scale, view
from drillpetsc.plotting.style import color_scale, display_unit
from tests.helpers.command import unrendered
from tests.helpers.output_samples import AMPLITUDE, HOLE, LENGTH, PIPE, helix_frame, make_pendulum, make_run
from tests.helpers.tables import each_row


def frame(time: float = 0.0, without: tuple[str, ...] = ()) -> Frame:
    points, data = helix_frame(time)
    return Frame(points, {name: values for name, values in data.items() if name not in without}, {}, {})


def colors_in(path: Path) -> int:
    return len(np.unique(np.asarray(Image.open(path).convert("RGB")).reshape(-1, 3), axis=0))


def test_a_picture_by_default(tmp_path: Path) -> None:
    run = make_run(tmp_path / "run")
    path = view(run.path, renderer="matplotlib")
    assert path == run.plots / "view.png"
    assert colors_in(path) > 200


def test_a_shaded_picture_where_there_is_opengl(tmp_path: Path) -> None:
    if reason := render.why_no_rendering():
        pytest.skip(reason)
    run = make_run(tmp_path / "run")
    shaded, flat = (
        view(run.path, tmp_path / "a.png"),
        view(run.path, tmp_path / "b.png", renderer="matplotlib"),
    )
    image, other = (np.asarray(Image.open(path).convert("RGB"), dtype=int) for path in (shaded, flat))
    width = image.shape[1]
    assert np.abs(image - other)[:, int(0.06 * width) : int(0.22 * width)].mean() > 2  # the shaded panel
    assert np.array_equal(image[:, int(0.25 * width) :], other[:, int(0.25 * width) :])  # all the others


def test_the_shaded_hole_shows_the_string_where_it_is_and_in_its_colour(tmp_path: Path) -> None:
    """A straight string at the hole's centre, red in its upper half and blue below, gives these colours in
    the middle column."""
    if reason := render.why_no_rendering():
        pytest.skip(reason)
    points, data = helix_frame(0.0)
    data["offset_x [m]"] = data["offset_y [m]"] = np.zeros(len(points))
    shape = shape_of(Frame(points, data, {}, {}), 0.0, "axial_force [N]")
    model = render.Rendering(shape, 1000.0, (-50.0, LENGTH + 50.0), (200, 600))
    upper = shape.md[:, None] < 0.5 * LENGTH
    red, blue = np.array([[1.0, 0, 0]]), np.array([[0, 0, 1.0]])
    first = model.image(shape, np.where(upper, red, blue)).astype(int)
    second = model.image(shape, np.where(upper, blue, red)).astype(
        int
    )  # an animation changes the colours of the same rendering
    model.close()
    for image, top in ((first, 0), (second, 2)):
        bottom = 2 - top
        assert image[200, 100, top] > image[200, 100, bottom] + 60
        assert image[400, 100, bottom] > image[400, 100, top] + 60
    drawn = np.flatnonzero(first[:, 100, 3] > 0)
    metres_per_pixel = (LENGTH + 100.0) / 600
    tilt = HOLE * 1000.0 * np.tan(render.ELEVATION)  # the ends' ellipses, seen from above
    assert abs(drawn[0] * metres_per_pixel - 50.0) < tilt + 2 * metres_per_pixel
    assert abs(drawn[-1] * metres_per_pixel - (LENGTH + 50.0)) < tilt + 2 * metres_per_pixel


def test_animations_have_their_frames_and_they_differ(tmp_path: Path) -> None:
    run = make_run(tmp_path / "run", frames=7)
    path = view(run.path, animate=True, renderer="matplotlib", max_frames=4, frames_per_second=5)
    assert path.name == "view.gif"
    film = Image.open(path)
    assert film.n_frames == 4 and film.info["duration"] == 200
    pictures = []
    for k in range(4):
        film.seek(k)
        pictures.append(np.asarray(film.convert("RGB"), dtype=int))
    assert all(np.abs(a - b).max() > 50 for a, b in zip(pictures, pictures[1:], strict=False))


def test_one_frame_makes_an_animation_too(tmp_path: Path) -> None:
    assert (
        Image.open(
            view(make_run(tmp_path / "run", frames=1).path, animate=True, renderer="matplotlib")
        ).n_frames
        == 1
    )


def test_without_a_well_the_displacement_is_drawn(tmp_path: Path) -> None:
    assert (
        colors_in(view(make_run(tmp_path / "run", well=False).path, renderer="matplotlib", field="spin"))
        > 100
    )


def test_a_string_that_swings_far_is_drawn_in_its_true_shape(tmp_path: Path) -> None:
    assert colors_in(view(make_pendulum(tmp_path / "run").path)) > 50
    assert Image.open(view(tmp_path / "run", animate=True)).n_frames == 3


def test_bad_requests_list_the_alternatives(tmp_path: Path) -> None:
    run = make_run(tmp_path / "run")
    with pytest.raises(ValueError, match=r"no field 'axial'.*axial_force \[N\]"):
        view(run.path, field="axial")
    with pytest.raises(ValueError, match="4 frames"):
        view(run.path, time=7)
    with pytest.raises(ValueError, match="from 0 m to 2000 m"):
        view(run.path, interval=(3000.0, 4000.0), renderer="matplotlib")
    with pytest.raises(ValueError, match="positive"):
        view(run.path, lateral_scale=-1.0, renderer="matplotlib")
    with pytest.raises(RunFolderMissing, match="does not exist"):
        view(tmp_path / "nowhere")
    (tmp_path / "empty").mkdir()
    with pytest.raises(FileNotFoundError, match="nothing to view"):
        view(tmp_path / "empty")


def test_an_unsupported_film_is_refused_before_drawing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    run = make_run(tmp_path / "run")
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(ValueError, match=r"film.mp4: only .gif"):
        view(run.path, tmp_path / "film.mp4", animate=True)


def test_without_opengl_a_message_and_another_picture(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(render, "why_no_rendering", lambda: "no libGL")
    run = make_run(tmp_path / "run")
    said: list[str] = []
    assert view(run.path, say=said.append).exists()
    assert len(said) == 1 and "no libGL" in said[0]
    with pytest.raises(RuntimeError, match="no libGL"):
        view(run.path, renderer="pyvista")


@each_row(
    ("there", "window"),
    [
        (("libEGL.so.1", "libOSMesa.so.8"), "vtkEGLRenderWindow"),
        (("libOSMesa.so.8",), "vtkOSOpenGLRenderWindow"),
        ((), ""),
    ],
)
def test_the_offscreen_window_has_an_existing_library(
    monkeypatch: pytest.MonkeyPatch, there: tuple[str, ...], window: str
) -> None:
    monkeypatch.setattr("sys.platform", "linux")
    monkeypatch.setattr(render, "_opens", lambda library: library in there)
    monkeypatch.delenv("VTK_DEFAULT_OPENGL_WINDOW", raising=False)
    monkeypatch.delenv("DISPLAY", raising=False)
    assert render.offscreen_window() == window
    asked: list[dict[str, str]] = []

    def answer(*arguments: object, env: dict[str, str], **more: object) -> CompletedProcess[str]:
        asked.append(env)
        return CompletedProcess([], 3, "", "a picture without colours")

    monkeypatch.setattr("subprocess.run", answer)
    reason = render.why_no_rendering.__wrapped__()
    if window:
        assert asked[0]["VTK_DEFAULT_OPENGL_WINDOW"] == window and "without colours" in reason
    else:
        assert not asked and "libEGL" in reason and "libOSMesa" in reason


@pytest.mark.parametrize(
    ("name", "value"), [("VTK_DEFAULT_OPENGL_WINDOW", "vtkXOpenGLRenderWindow"), ("DISPLAY", ":0")]
)
def test_a_screen_or_a_chosen_window_is_kept(monkeypatch: pytest.MonkeyPatch, name: str, value: str) -> None:
    for key in ("VTK_DEFAULT_OPENGL_WINDOW", "DISPLAY"):
        monkeypatch.delenv(key, raising=False)
    monkeypatch.setenv(name, value)
    monkeypatch.setattr(render, "_opens", lambda library: True)
    assert render.offscreen_window() is None


def test_a_time_takes_the_nearest_frame_and_an_index_counts(tmp_path: Path) -> None:
    run = make_run(tmp_path / "run")  # frames at 0, 1, 2, 3 s
    wanted = view(run.path, tmp_path / "a.png", time=1, renderer="matplotlib").read_bytes()
    for time, same in ((1.2, True), (-3, True), (None, False)):
        drawn = view(run.path, tmp_path / "b.png", time=time, renderer="matplotlib").read_bytes()
        assert (drawn == wanted) is same


def test_shapes_take_the_offset_of_the_file_or_the_displacement() -> None:
    """The helix has equal offset and displacement, except for the axes of the cross-section."""
    given = shape_of(frame(), 0.0, "axial_force [N]")
    none = ("offset_x [m]", "offset_y [m]", "hole_radius [m]", "outer_radius [m]", "md [m]")
    derived = shape_of(frame(without=none), 0.0, "axial_force [N]")
    assert np.allclose(np.hypot(*given.offset.T), AMPLITUDE) and np.allclose(
        np.hypot(*derived.offset.T), AMPLITUDE
    )
    assert np.allclose(derived.md, given.md)
    assert (
        half_width(given) == HOLE
        and PIPE < half_width(shape_of(frame(without=none[2:3]), 0.0, "spin [rad/s]")) < HOLE
    )
    assert not given.bent and not derived.bent


def test_vectors_are_shown_by_their_magnitude() -> None:
    assert np.allclose(shape_of(frame(), 0.0, "displacement [m]").values, AMPLITUDE)


def test_smoothing_keeps_nodes_and_reproduces_a_parabola() -> None:
    """Central differences are exact for a parabola in the interior, so its cubic pieces are the parabola."""
    points, data = helix_frame(0.0, count=9)
    md = data["md [m]"]
    data["offset_x [m]"] = (md / LENGTH) ** 2
    fine = smooth(shape_of(Frame(points, data, {}, {}), 0.0, "axial_force [N]"), 4)
    assert len(fine.md) == 33 and np.array_equal(fine.md[::4], md)
    inner = slice(4, -4)
    assert np.allclose(fine.offset[inner, 0], (fine.md[inner] / LENGTH) ** 2, rtol=0, atol=1e-14)
    assert np.allclose(fine.values, 8e5 - 8.5e5 * fine.md / LENGTH)


def test_smoothing_does_not_go_across_a_joint() -> None:
    """Two nodes at the depth of a joint: straight parts with another slope each stay straight, and finite."""
    points, data = helix_frame(0.0, count=9)
    data["md [m]"] = md = np.array([0.0, 100, 200, 300, 400, 400, 500, 600, 700])
    data["offset_x [m]"] = bent = np.where(np.arange(9) < 5, md, 400 - 2 * (md - 400)) * 1e-3
    fine = smooth(shape_of(Frame(points, data, {}, {}), 0.0, "axial_force [N]"), 4)
    wanted = np.where(fine.md <= 400, fine.md, 400 - 2 * (fine.md - 400)) * 1e-3
    assert np.allclose(fine.offset[:, 0], wanted, rtol=0, atol=1e-14) and bent[4] == bent[5]


def test_cutting_keeps_the_interval_and_a_neighbour() -> None:
    part = cut(shape_of(frame(), 0.0, "axial_force [N]"), (1000.0, 1100.0))  # nodes every 25 m
    assert part.md.tolist() == [975.0, 1000.0, 1025.0, 1050.0, 1075.0, 1100.0, 1125.0]


def test_the_stated_scale_is_the_drawn_scale() -> None:
    """With the chosen factor a hole of 0.2 m is at most 0.86 of a track wide, and at least 0.75 of it."""
    scale = _auto_scale(HOLE, LENGTH)
    inches_per_depth_metre = TRACKS_HEIGHT / LENGTH
    share = 2 * HOLE * scale * inches_per_depth_metre / TRACK_WIDTH
    assert 0.75 < share <= 0.86
    assert float(f"{scale:.1e}") == pytest.approx(scale, rel=1e-12)  # two digits


def test_fields_are_found_with_and_without_units() -> None:
    names = ["axial_force [N]", "spin [rad/s]"]
    assert find_field("spin", names) == find_field("spin [rad/s]", names) == "spin [rad/s]"
    with pytest.raises(ValueError, match="did you mean 'axial_force"):
        find_field("axial_forse", names)


@each_row(
    ("title", "largest", "size", "unit"),
    [
        ("hook_load [N]", 8e5, 1e3, "kN"), ("contact_force [N/m]", 300.0, 1.0, "N/m"),
        ("torque [N m]", 9e3, 1e3, "kN m"), ("bit_speed [rad/s]", 8.0, np.pi / 30, "rpm"),
        ("x_600 [m]", 0.04, 1e-3, "mm"), ("md [m]", 0.5, 1.0, "m"), ("rop [m/s]", 4e-3, 1 / 3600, "m/h"),
        ("pump_pressure [Pa]", 2e7, 1e6, "MPa"), ("outlet_flow [m3/s]", 0.03, 1e-3 / 60, "l/min"),
        ("newton [-]", 3.0, 1.0, ""), ("odd [furlong]", 3.0, 1.0, "furlong"),
        ("torque [N m]", 0.0, 1.0, "N m"),
    ],
)  # fmt: skip
def test_displayed_units(title: str, largest: float, size: float, unit: str) -> None:
    """Factors by definition: 1 rpm = 2 pi / 60 rad/s, 1 m/h = 1/3600 m/s, 1 l/min = 1e-3/60 m3/s."""
    given_size, given_unit = display_unit(title, np.array([0.0, -largest, np.nan]))
    assert given_size == pytest.approx(size) and given_unit == unit


def test_zero_has_the_same_colour_for_any_range() -> None:
    norm, cmap = color_scale("axial_force [N]", -50.0, 800.0)
    assert norm(0.0) == 0.5 and norm(-50.0) == 0.0 and norm(800.0) == 1.0
    tension, compression = cmap(1.0), cmap(0.0)
    assert tension[2] > tension[0] and compression[0] > compression[2]  # blue pulls, red pushes
    constant, _ = color_scale("axial_force [N]", 3.0, 3.0)
    assert 0.0 < float(constant(3.0)) < 1.0


def texts(drawn: list) -> str:
    return " ".join(
        text for drawing in drawn for axes in drawing.axes for text in (axes.get_xlabel(), axes.get_ylabel())
    )


def test_a_view_in_field_units(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Depths in feet at round numbers of feet, offsets in inches; SI and metric leave metres."""
    from drillpetsc.plotting import style

    drawn: list = []
    make = style.figure

    def figure(*arguments, **keywords):
        drawn.append(make(*arguments, **keywords))
        return drawn[-1]

    monkeypatch.setattr(style, "figure", figure)
    run = make_run(tmp_path / "run")
    with unrendered():
        view(run.path, tmp_path / "field.png", renderer="matplotlib", units="field")
    words = texts(drawn)
    assert (
        "measured depth [ft]" in words
        and "offset x [in]" in words
        and "[m]" not in words
        and "mm" not in words
    )
    depth = drawn[-1].axes[0].yaxis
    shown = [float(label.get_text().replace("\N{MINUS SIGN}", "-")) for label in depth.get_ticklabels()]
    assert depth.get_ticklocs() == pytest.approx(0.3048 * np.array(shown), abs=1e-6)
    assert all(value == round(value) for value in shown) and len(shown) > 3
    assert style.UNITS.get() is None
    drawn.clear()
    with unrendered():
        view(run.path, tmp_path / "plain.png", renderer="matplotlib")
    assert "measured depth [m]" in texts(drawn) and "offset x [mm]" in texts(drawn)
    drawn.clear()
    with unrendered():
        view(run.path, tmp_path / "si.png", renderer="matplotlib", units="SI")
    assert "offset x [m]" in texts(drawn)
