"""`drillpetsc paraview RUN`: the frames of a run as curves, with contact and mud on grids of their own, and a scene.

The frames of a run hold its nodes only: as cubic curves they would take three times the disk. Here they are drawn out: each
element becomes ``pieces`` straight lines along its cubic, in one curve from joint to joint, which ParaView's filter *Tube* takes as it is.
"""

from __future__ import annotations

import math
import os
from collections.abc import Iterator, Set
from dataclasses import dataclass
from pathlib import Path
from string import Template

import numpy as np

from drillpetsc.output.files.fields import read_series, write_series
from drillpetsc.output.files.run_folder import RunFolder
from drillpetsc.output.files.tables import split_name
from drillpetsc.output.files.vtk import Frame, read_frame, write_vtp, write_vtu
from drillpetsc.output.quantities.mud import MUD_FIELDS
from drillpetsc.plotting.run.place import Place, Wall, place_of, read_wall
from drillpetsc.plotting.run.shape import central_slopes, colour_field, hermite

Grid = tuple[np.ndarray, np.ndarray, dict[str, np.ndarray]]
"""Points (n, 3) [m], ends of the curves (k,), data at the points by title."""

MUD = frozenset(q.title for q in MUD_FIELDS)
HOLE_SHARE = 0.02  # radius of the hole over the extent of the well, as drawn
CONTACT, CONTACT_VECTOR, TUBE_RADIUS = "contact_force [N/m]", "contact_vector [N/m]", "tube_radius [m]"


@dataclass(frozen=True)
class Scene:
    """What was written: its script, how many times larger lateral lengths are than along the hole, number of frames."""

    script: Path
    lateral_scale: float
    frames: int


def export_scene(
    run: str | os.PathLike,
    out: str | os.PathLike | None = None,
    *,
    field: str | None = None,
    pieces: int = 4,
    lateral_scale: float | None = None,
) -> Scene:
    """Write string.pvd, contact.pvd, mud.pvd, well.vtu, as far as the run has them, and scene.py, which shows them.

    out: folder, by default ``paraview`` in the run folder.
    field: what colours the string, as in ``view``.
    pieces: straight lines per element.
    lateral_scale: how many times larger lengths across the hole are; by default the hole shows.
    """
    source = RunFolder.open(run)
    series = read_series(source.path)
    if not series:
        raise FileNotFoundError(f"{source.path} holds no string.pvd with frames (is field_every set?)")
    wall = read_wall(source.well) if source.well.is_file() else None
    last = read_frame(series[-1][1])
    colour = colour_field(field, last.point_data.keys() - MUD)
    scale = lateral_scale if lateral_scale is not None else _hole_shows(wall)
    if scale <= 0:
        raise ValueError(f"lateral scale {scale:g}: wanted a positive factor")
    folder = Path(out) if out is not None else source.paraview
    listed: dict[str, list[tuple[float, str]]] = {}
    for number, (time, file) in enumerate(series):
        for name, grid in _grids(read_frame(file), wall, pieces, scale):
            written = f"{name}/{number:06d}.vtp"
            (folder / name).mkdir(parents=True, exist_ok=True)
            write_vtp(folder / written, *grid)
            listed.setdefault(name, []).append((time, written))
    for name, entries in listed.items():
        write_series(folder / f"{name}.pvd", entries)
    if wall is not None:
        _write_wall(source.well, folder / "well.vtu", wall, scale)
    script = folder / "scene.py"
    name, unit = split_name(colour)
    pushes = np.asarray(last.point_data.get(CONTACT, np.zeros(1)))
    force = float(np.quantile(pushes[pushes > 0], 0.9)) if (pushes > 0).any() else 0.0
    words = {
        "folder": str(folder.resolve()),
        "field": name,
        "unit": unit,
        "scale": f"{scale:g}",
        "force": f"{force:.6g}",
    }
    script.write_text(Template(SCENE).substitute(words), encoding="utf-8")
    return Scene(script, scale, len(series))


def _hole_shows(wall: Wall | None) -> float:
    """A factor of one digit with which the hole's radius is ``HOLE_SHARE`` of the well's extent."""
    if wall is None:
        return 1.0
    raw = HOLE_SHARE * float(np.ptp(wall.centre, axis=0).max()) / float(wall.radius.max())
    digit = 10.0 ** math.floor(math.log10(raw))
    return max(math.floor(raw / digit) * digit, 1.0)


def _grids(frame: Frame, wall: Wall | None, pieces: int, scale: float) -> Iterator[tuple[str, Grid]]:
    """The grids of a frame, by name."""
    place, data = place_of(frame, wall), frame.point_data
    cell, x, ends = _curves(place.md, frame.points, pieces)
    slope = data.get("slope [-]", central_slopes(place.md, frame.points))
    centre = hermite(place.md, place.centre, central_slopes(place.md, place.centre), cell, x)
    string = hermite(place.md, frame.points, slope, cell, x)

    def along(titles: Set[str], radius: str) -> dict[str, np.ndarray]:
        found = {t: _linear(np.asarray(data[t], dtype=float), cell, x) for t in data if t in titles}
        if radius in data:
            found[TUBE_RADIUS] = scale * _linear(data[radius], cell, x)
        return found

    yield "string", (centre + scale * (string - centre), ends, along(data.keys() - MUD, "outer_radius [m]"))
    if CONTACT in data:
        yield "contact", _contact(place, data, scale)
    if MUD & data.keys():
        yield "mud", (centre, ends, along((MUD & data.keys()) | {"md [m]"}, "hole_radius [m]"))


def _curves(md: np.ndarray, points: np.ndarray, pieces: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Where the points of curves through the nodes lie: elements (m,), shares of them (m, 1), ends of the curves (k,).

    Curves end at joints, whose two nodes are at one place: a tube has no direction there.
    """
    apart = (np.diff(md) > 0) & (np.linalg.norm(np.diff(points, axis=0), axis=1) > 0)
    runs = [run for run in np.split(np.arange(len(apart)), np.flatnonzero(~apart)) if apart[run].any()]
    cells, shares = [], []
    for run in runs:
        elements = run[apart[run]]  # the first of a run may be the joint before it
        cells.append(np.append(np.repeat(elements, pieces), elements[-1]))
        shares.append(np.append(np.tile(np.arange(pieces) / pieces, len(elements)), 1.0))
    return np.concatenate(cells), np.concatenate(shares)[:, None], np.cumsum([len(each) for each in cells])


def _linear(values: np.ndarray, cell: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Values (n,) or (n, k) of nodes at the shares x (m, 1) of elements (m,)."""
    x = x if values.ndim == 2 else x[:, 0]
    return np.ascontiguousarray((1 - x) * values[cell] + x * values[cell + 1])


def _contact(place: Place, data: dict[str, np.ndarray], scale: float) -> Grid:
    """The points at which the wall pushes the string, each with the force per length as a vector [N/m]."""
    push, away = data[CONTACT], np.linalg.norm(place.lateral, axis=1)
    touching = np.flatnonzero((push > 0) & (away > 0))
    outward = place.lateral[touching] / away[touching, None]
    radius = np.asarray(data.get("outer_radius [m]", np.zeros_like(away)))[touching, None]
    points = place.centre[touching] + scale * (place.lateral[touching] + radius * outward)
    values = {
        "md [m]": place.md[touching],
        CONTACT: push[touching],
        CONTACT_VECTOR: -push[touching, None] * outward,
    }
    return points, np.arange(1, len(touching) + 1), {t: np.ascontiguousarray(v) for t, v in values.items()}


def _write_wall(source: Path, target: Path, wall: Wall, scale: float) -> None:
    """The hole's wall with lengths across it enlarged."""
    frame = read_frame(source)
    centre = np.repeat(wall.centre, len(frame.points) // len(wall.centre), axis=0)
    points = np.ascontiguousarray(centre + scale * (frame.points - centre))
    write_vtu(target, points, "quad", frame.cells["quad"], frame.point_data, {}, True)


SCENE = '''"""The run in ParaView: `paraview --script=scene.py`, or `pvbatch scene.py picture.png` for a picture.

Lengths across the hole are ${scale} times larger than along it; x is north, y east, z down.
"""

import os
import sys

from paraview.simple import *

FOLDER = os.path.dirname(os.path.abspath(__file__)) if "__file__" in globals() else r"${folder}"
FIELD, UNIT = "${field}", "${unit}"
PUSH = ${force}  # of the wall in the last frame, which a tenth of the touching nodes exceed [N/m]


def series(name):
    path = os.path.join(FOLDER, name + ".pvd")
    return PVDReader(registrationName=name, FileName=path) if os.path.exists(path) else None


def tube(source):
    if source.PointData.GetArray("tube_radius") is None:
        return source
    made = Tube(registrationName=source.SMProxy.GetLogName() or "tube", Input=source)
    made.Scalars, made.VaryRadius = ["POINTS", "tube_radius"], "By Absolute Scalar"
    made.NumberofSides = 16
    return made


def plain(display, *colour):
    display.ColorArrayName = ["POINTS", ""]  # ColorBy(display, None) fails in ParaView 5.11
    display.DiffuseColor = display.AmbientColor = colour


view = GetActiveViewOrCreate("RenderView")
string, contact, mud = series("string"), series("contact"), series("mud")
GetAnimationScene().UpdateAnimationUsingDataTimeSteps()
GetAnimationScene().GoToLast()
for source in filter(None, (string, contact, mud)):
    source.UpdatePipeline(GetAnimationScene().AnimationTime)

shown = tube(string)
display = Show(shown, view)
ColorBy(display, ("POINTS", FIELD))
display.RescaleTransferFunctionToDataRange(False, True)
colours = GetColorTransferFunction(FIELD)
low, high = string.PointData.GetArray(FIELD).GetRange()
if low < 0 < high:  # as in `drillpetsc view`: blue above zero, red below, each side stretched to its extreme
    colours.ColorSpace = "Diverging"
    colours.RGBPoints = [low, 0.71, 0.02, 0.15, 0.0, 0.86, 0.86, 0.86, high, 0.23, 0.3, 0.75]
else:
    colours.RescaleTransferFunction(low, high)
bar = GetScalarBar(colours, view)
bar.Title, bar.ComponentTitle = FIELD.replace("_", " "), "[" + UNIT + "]"
bar.TitleFontSize = bar.LabelFontSize = 9
display.SetScalarBarVisibility(view, True)

if os.path.exists(os.path.join(FOLDER, "well.vtu")):
    well = XMLUnstructuredGridReader(registrationName="well", FileName=[os.path.join(FOLDER, "well.vtu")])
    wall = Show(well, view)
    plain(wall, 0.61, 0.5, 0.35)
    wall.Opacity = 0.2

ResetCamera(view)
if contact is not None and PUSH > 0:
    arrows = Glyph(registrationName="push of the wall", Input=contact, GlyphType="Arrow")
    arrows.OrientationArray = arrows.ScaleArray = ["POINTS", "contact_vector"]
    arrows.VectorScaleMode = "Scale by Magnitude"
    bounds = string.GetDataInformation().GetBounds()
    arrows.ScaleFactor = 0.04 * max(bounds[i + 1] - bounds[i] for i in (0, 2, 4)) / PUSH
    arrows.GlyphMode = "All Points"
    plain(Show(arrows, view), 0.8, 0.1, 0.1)
if mud is not None:  # in the pipeline, to be switched on
    annulus = Show(tube(mud), view)
    ColorBy(annulus, ("POINTS", "annulus_pressure" if mud.PointData.GetArray("annulus_pressure") else "internal_pressure"))
    annulus.Opacity, annulus.Visibility = 0.3, 0

low = string.GetDataInformation().GetBounds()
middle = [0.5 * (low[i] + low[i + 1]) for i in (0, 2, 4)]
reach = max(low[i + 1] - low[i] for i in (0, 2, 4))
view.CameraFocalPoint, view.CameraViewUp = middle, [0.0, 0.0, -1.0]
view.CameraPosition = [middle[0] - 1.2 * reach, middle[1] - 1.8 * reach, middle[2] - 0.5 * reach]
view.OrientationAxesVisibility = 1
ResetCamera(view)
Render(view)
if len(sys.argv) > 1 and sys.argv[-1].endswith(".png"):
    SaveScreenshot(sys.argv[-1], view, ImageResolution=[1200, 900])
'''
