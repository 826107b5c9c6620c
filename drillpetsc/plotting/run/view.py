"""`drillpetsc view RUN`: the deformed string in its hole, as a picture or an animation, without a display.

A string of kilometres in a hole of centimetres shows nothing at true scale. The hole is therefore drawn
straight along measured depth, with lateral lengths enlarged by a stated factor. It is shown as a shaded view and as two
sections with the pipe's true width between the walls, beside the well's true path.
"""

from __future__ import annotations

import importlib.util
import math
import os
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np

from drillpetsc.output.files.fields import read_series
from drillpetsc.output.files.run_folder import RunFolder
from drillpetsc.output.files.vtk import read_frame
from drillpetsc.plotting import style
from drillpetsc.plotting.run import panels, render
from drillpetsc.plotting.run.panels import Paint, Update
from drillpetsc.plotting.run.shape import Shape, colour_field, cut, half_width, shape_of, smooth
from drillpetsc.plotting.source import Source
from drillpetsc.unit_systems import System


def check_suffix(path: Path) -> None:
    """Raise ValueError, before anything is drawn, for a film that cannot be written."""
    if path.suffix.lower() != ".gif" and importlib.util.find_spec("imageio") is None:
        raise ValueError(
            f"{path.name}: only .gif can be written here; a film (.mp4) needs imageio with ffmpeg"
        )


def write_animation(
    drawing: Any, draw: Callable[[Shape], None], shapes: list[Shape], path: Path, rate: float, colormap: Any
) -> None:
    """Write one picture per shape into a GIF (pillow) or, for another suffix, a film (imageio).

    drawing: the figure; draw: draws one time into it. rate: pictures a second. colormap: of the field.
    """
    images = []
    for shape in shapes:
        draw(shape)
        drawing.canvas.draw()
        images.append(np.asarray(drawing.canvas.buffer_rgba())[..., :3].copy())
    if path.suffix.lower() == ".gif":
        from PIL import Image

        palette = _palette(images, colormap)
        pages = [
            Image.fromarray(image).quantize(255, palette=palette, dither=Image.Dither.NONE)
            for image in images
        ]
        pages[0].save(
            path, save_all=True, append_images=pages[1:], duration=round(1000 / rate), loop=0, disposal=1
        )
        return
    import imageio.v3 as imageio

    imageio.imwrite(
        path, [image[: image.shape[0] // 2 * 2, : image.shape[1] // 2 * 2] for image in images], fps=rate
    )


def _palette(images: list[np.ndarray], colormap: Any) -> Any:
    """Palette image of 255 colours: 96 of the field's colormap, for a few thin lines, and 159 for the rest.

    The latter are chosen from an image in which each colour occurs once; otherwise the wide background would
    get all of them.
    """
    from PIL import Image

    seen = np.zeros(0, dtype=np.int32)
    for image in images[:: max(len(images) // 8, 1)]:
        coarse = (
            image[::2, ::2].reshape(-1, 3).astype(np.int32) & 0xFC
        )  # steps of four: invisible, and fewer colours
        seen = np.union1d(seen, coarse[:, 0] << 16 | coarse[:, 1] << 8 | coarse[:, 2])
    once = np.stack((seen >> 16 & 255, seen >> 8 & 255, seen & 255), axis=-1).astype(np.uint8)[None]
    colours = Image.fromarray(once).quantize(158).getpalette() or []
    others = np.array(colours[: 3 * 158], dtype=np.uint8)
    own = (255 * colormap(np.linspace(0, 1, 96))[:, :3]).round().astype(np.uint8)
    palette = Image.new("P", (1, 1))
    palette.putpalette(np.concatenate((others, own.ravel(), np.full(3, 255, dtype=np.uint8))).tolist())
    return palette


Renderer = Literal["auto", "pyvista", "matplotlib"]
Interval = tuple[float, float]
SIZE = (15.0, 9.4)  # inches
TRACKS_HEIGHT = 7.55  # inches of a depth track
TRACK_WIDTH = 1.75
SHADED_WIDTH = 2.6


@dataclass(frozen=True)
class Look:
    """How the string is viewed; the fields are those of ``view``."""

    lateral_scale: float | None
    interval: Interval | None
    renderer: Renderer
    say: Callable[[str], None] | None


def view(
    run: str | os.PathLike,
    out: str | os.PathLike | None = None,
    *,
    field: str | None = None,
    time: float | int | None = None,
    animate: bool = False,
    lateral_scale: float | None = None,
    interval: Interval | None = None,
    renderer: Renderer = "auto",
    max_frames: int = 60,
    frames_per_second: float = 10.0,
    say: Callable[[str], None] | None = None,
    units: System | None = None,
) -> Path:
    """Draw the string of a run; returns the file written.

    out: file to write; by default view.png or view.gif in the run's plots folder. A .mp4 needs imageio with
    ffmpeg.
    field: what colours the string, with or without its unit; by default the effective tension, which decides on
    buckling, or the first of ``shape.COLOURS`` that exists.
    time: a float is a simulated time [s] (the nearest frame is taken), an int an index (-1 the last, as by
    default).
    animate: all times, at most max_frames evenly chosen ones.
    lateral_scale: how many times larger lateral lengths are drawn than depths; by default the clearance
    shows.
    interval: (from, to) measured depth [m] shown.
    renderer: the shaded view by pyvista, or flat by matplotlib without OpenGL ("auto" finds out).
    say: receives a message when another renderer had to be used.
    units: field, metric, metric_t or SI; by default the case's.
    """
    folder = RunFolder.open(run)
    chosen = _chosen(read_series(folder.path), time, animate, max_frames, folder.path)
    frames = [(moment, read_frame(file)) for moment, file in chosen]
    field = colour_field(field, frames[-1][1].point_data)
    shapes = [shape_of(frame, moment, field) for moment, frame in frames]
    if any(shape.bent for shape in shapes):
        shapes = [replace(shape, bent=True) for shape in shapes]
    path = Path(out) if out is not None else folder.plots / ("view.gif" if animate else "view.png")
    if animate:
        check_suffix(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    with style.of_case(folder.case, units):
        paint = _paint(shapes, field, interval)
        drawing = style.figure(*SIZE, dpi=72 if animate else 120)
        look = Look(lateral_scale, interval, renderer, say)
        draw = _compose(drawing, shapes, paint, Source(folder).title, look)
        if not animate:
            draw(shapes[-1])
            drawing.savefig(path)
        else:
            write_animation(drawing, draw, shapes, path, frames_per_second, paint.cmap)
    return path


def _chosen(
    series: list[tuple[float, Path]], time: float | int | None, animate: bool, max_frames: int, folder: Path
) -> list[tuple[float, Path]]:
    """The frames to draw."""
    if not series:
        raise FileNotFoundError(
            f"{folder} holds no string.pvd with frames: nothing to view (is field_every set?)"
        )
    if animate:
        picks = np.unique(np.linspace(0, len(series) - 1, min(max_frames, len(series))).round().astype(int))
        return [series[k] for k in picks]
    if time is None:
        return [series[-1]]
    if isinstance(time, int | np.integer):
        if not -len(series) <= time < len(series):
            raise ValueError(f"time index {time}, but the run has {len(series)} frames")
        return [series[time]]
    return [min(series, key=lambda entry: abs(entry[0] - time))]


def _paint(shapes: list[Shape], field: str, interval: Interval | None) -> Paint:
    """Colours common to all times."""
    values = np.concatenate([cut(shape, interval).values for shape in shapes])
    size, unit = style.display_unit(field, values)
    finite = values[np.isfinite(values)] / size
    low, high = (float(finite.min()), float(finite.max())) if finite.size else (0.0, 1.0)
    norm, cmap = style.color_scale(field, low, high)
    return Paint(field, unit, size, low, high, norm, cmap)


def _compose(
    drawing: Any,
    shapes: list[Shape],
    paint: Paint,
    title: str,
    look: Look,
) -> Callable[[Shape], None]:
    """Lay the panels out; returns the function that draws one time."""
    heading = drawing.text(0.03, 0.965, "", fontsize=13, fontweight="bold", va="center")
    note = drawing.text(0.03, 0.935, "", fontsize=9.5, va="center", color="0.25")
    if shapes[0].bent:
        updates, remark = _true_shape(drawing, shapes, paint), "true scale, no exaggeration"
    else:
        updates, remark = _straightened(drawing, shapes, paint, look)
    note.set_text(remark)
    bar = drawing.add_axes((0.94, 0.12, 0.011, 0.72))
    colorbar = drawing.colorbar(_mappable(paint), cax=bar)
    ticks = _ticks(paint.low, paint.high)
    colorbar.set_ticks(ticks)
    colorbar.ax.set_title(paint.label(), fontsize=9, loc="right", pad=10)

    def draw(shape: Shape) -> None:
        heading.set_text(f"{title}    t = {shape.time:.4g} s")
        for update in updates:
            update(shape)

    return draw


def _ticks(low: float, high: float) -> list[float]:
    """Round numbers on each side of zero, so that a small compressive range also has labels."""
    from matplotlib.ticker import MaxNLocator

    def inside(a: float, b: float, count: int) -> list[float]:
        return [float(tick) for tick in MaxNLocator(count).tick_values(a, b) if a <= tick <= b]

    if low < 0 < high and min(-low, high) > 1e-3 * (high - low):
        return sorted(set(inside(low, 0.0, 4) + [0.0] + inside(0.0, high, 5)))
    return inside(low, high, 7)


def _mappable(paint: Paint) -> Any:
    from matplotlib.cm import ScalarMappable

    return ScalarMappable(norm=paint.norm, cmap=paint.cmap)


def _auto_scale(half: float, span: float) -> float:
    """A factor of two digits with which twice `half` fills most of a track."""
    raw = 0.86 * (TRACK_WIDTH / TRACKS_HEIGHT) * span / (2 * half)
    digits = 10.0 ** (math.floor(math.log10(raw)) - 1)
    return max(math.floor(raw / digits) * digits, 1e-6)


def _straightened(drawing: Any, shapes: list[Shape], paint: Paint, look: Look) -> tuple[list[Update], str]:
    """Shaded view, two sections and the field along measured depth; path and clearance at the right."""
    whole, interval, lateral_scale = shapes[-1], look.interval, look.lateral_scale
    parts = [cut(shape, interval) for shape in shapes]
    first = parts[-1]
    top, bottom = interval if interval is not None else (float(first.md[0]), float(first.md[-1]))
    edge = 0.015 * (bottom - top)
    upper, lower = top - edge, bottom + edge
    span = lower - upper
    if lateral_scale is not None and lateral_scale <= 0:
        raise ValueError(f"lateral_scale {lateral_scale:g}: wanted a positive factor")
    scale = lateral_scale or _auto_scale(max(half_width(part) for part in parts), span)
    half = 0.5 * span * TRACK_WIDTH / TRACKS_HEIGHT / scale

    def place(left: float, width: float) -> Any:
        return drawing.add_axes((left / SIZE[0], 0.75 / SIZE[1], width / SIZE[0], TRACKS_HEIGHT / SIZE[1]))

    shaded, track_x, track_y, track_f = (
        place(0.75, SHADED_WIDTH),
        place(3.75, TRACK_WIDTH),
        place(5.75, TRACK_WIDTH),
        place(7.75, TRACK_WIDTH),
    )
    for axes, name in (
        (shaded, "In the hole" if first.hole_radius is not None else "The string"),
        (track_x, "Section x"),
        (track_y, "Section y"),
        (track_f, "Along the string"),
    ):
        axes.set_ylim(lower, upper)
        axes.set_title(name)
        if axes is not shaded:
            axes.tick_params(labelleft=False)
    size, unit = style.depth_unit()
    for axes in (shaded, track_x, track_y, track_f):
        style.show_in(axes.yaxis, size)
    shaded.set_ylabel(f"measured depth [{unit}]")

    def parted(update: Update) -> Update:
        return lambda shape: update(smooth(cut(shape, interval), 3))

    updates = [
        parted(_shaded_panel(drawing, shaded, smooth(first, 3), paint, scale, (upper, lower), look)),
        parted(panels.offset_track(track_x, smooth(first, 3), paint, 0, half)),
        parted(panels.offset_track(track_y, smooth(first, 3), paint, 1, half)),
        parted(panels.field_track(track_f, paint)),
    ]
    right = drawing.add_axes((10.35 / SIZE[0], 4.65 / SIZE[1], 3.2 / SIZE[0], 3.65 / SIZE[1]))
    updates.append(panels.path_panel(right, whole, paint, interval))
    if first.hole_radius is not None and first.outer_radius is not None:
        below = drawing.add_axes((10.45 / SIZE[0], 0.75 / SIZE[1], 3.0 / SIZE[0], 3.0 / SIZE[1]))
        updates.append(parted(panels.clearance_panel(below, smooth(first, 3), paint)))
    hole = first.hole_radius is not None
    what = "offset from the hole's centre" if hole else "displacement"
    remark = (
        f"{'hole' if hole else 'string'} drawn straight along measured depth; lateral lengths ({what}, diameters) "
        f"are drawn {scale:,.5g} times larger than depths"
    )
    return updates, remark


def _shaded_panel(
    drawing: Any,
    axes: Any,
    shape: Shape,
    paint: Paint,
    scale: float,
    span: Interval,
    look: Look,
) -> Update:
    """Shaded view of the hole by pyvista, or a coloured line between the walls if pyvista cannot draw."""
    wide = (span[1] - span[0]) * SHADED_WIDTH / TRACKS_HEIGHT  # depth metres across the panel
    reason = "" if look.renderer == "matplotlib" else render.why_no_rendering()
    if reason and look.renderer == "pyvista":
        raise RuntimeError(f"pyvista cannot draw here: {reason}; renderer='matplotlib' needs no OpenGL")
    if reason and look.say is not None:
        look.say(f"pyvista cannot draw here ({reason}); the hole is drawn by matplotlib instead")
    if reason or look.renderer == "matplotlib":
        return _flat_panel(axes, shape, paint, 0.5 * wide / scale)
    axes.set_xlim(-0.5 * wide, 0.5 * wide)
    axes.set_xticks([])
    axes.grid(False)
    axes.spines["bottom"].set_visible(False)
    pixels = (round(SHADED_WIDTH * drawing.dpi), round(TRACKS_HEIGHT * drawing.dpi))
    rendering = render.Rendering(shape, scale, span, pixels)
    picture = axes.imshow(
        np.zeros((2, 2, 4)),
        extent=(-0.5 * wide, 0.5 * wide, span[1], span[0]),
        aspect="auto",
        interpolation="antialiased",
        zorder=2,
    )

    def update(now: Shape) -> None:
        picture.set_data(rendering.image(now, paint.colors(now.values)))

    return update


def _flat_panel(axes: Any, shape: Shape, paint: Paint, half: float) -> Update:
    """Hole and string projected as in the shaded view, in flat colours. half: width to each side [m]."""

    def turned(now: Shape) -> Shape:
        return replace(now, offset=np.column_stack((render.project(now.offset), np.zeros(len(now.md)))))

    update = panels.offset_track(axes, turned(shape), paint, 0, half)
    axes.set_xlabel(f"offset across the view [{style.lateral_unit(half)[1]}]")
    return lambda now: update(turned(now))


def _true_shape(drawing: Any, shapes: list[Shape], paint: Paint) -> list[Update]:
    """Two views at true scale of a string with large displacements."""
    moves = [max(float(np.ptp(shape.points[:, across])) for shape in shapes) for across in (0, 1)]
    sides = [
        across for across in (0, 1) if moves[across] > 1e-3 * max(moves)
    ]  # a plane motion needs one view
    left = {1: (0.2,), 2: (0.05, 0.51)}[len(sides)]
    boxes = [drawing.add_axes((start, 0.08, 0.42 if len(sides) > 1 else 0.55, 0.8)) for start in left]
    return [
        panels.true_shape_panel(axes, shapes, paint, across)
        for axes, across in zip(boxes, sides, strict=True)
    ]
