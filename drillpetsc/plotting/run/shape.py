"""The string at one time, for the pictures: depth, offset from the hole centre, radii, and a field."""

from __future__ import annotations

import difflib
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from drillpetsc.output.files.tables import split_name
from drillpetsc.output.files.vtk import Frame
from drillpetsc.plotting import style
from drillpetsc.plotting.run.place import at_rest, offset_across

LARGE = (
    0.02  # lateral displacement over length above which a string without a hole is drawn in its true shape
)


@dataclass(frozen=True)
class Shape:
    """The string at one time.

    time [s].
    md: (n,) measured depth [m].
    offset: (n, 2) string centre from the hole centre; without a hole from its position at rest [m].
    hole_radius, outer_radius: (n,) [m] or None.
    points: (n, 3) [m].
    values: (n,) values of the field [SI].
    bent: whether a string without hole has such large displacements that its true shape is drawn.
    """

    time: float
    md: np.ndarray
    offset: np.ndarray
    hole_radius: np.ndarray | None
    outer_radius: np.ndarray | None
    points: np.ndarray
    values: np.ndarray
    bent: bool

    def with_nodes(self, change: Callable[[np.ndarray], np.ndarray]) -> Shape:
        """The shape with ``change`` of each array over its nodes."""
        changed: dict[str, Any] = {
            name: change(values) for name, values in vars(self).items() if isinstance(values, np.ndarray)
        }
        return replace(self, **changed)


#: fields that colour the string, the first that a run has; the last two are of a string that is held
COLOURS = (
    "effective_tension [N]",
    "axial_force [N]",
    "annulus_pressure [Pa]",
    "internal_pressure [Pa]",
)


def colour_field(wanted: str | None, available: Iterable[str]) -> str:
    """Full name of the field that colours the string; ValueError as of ``find_field``."""
    names = set(available)
    return find_field(wanted or next((name for name in COLOURS if name in names), COLOURS[1]), names)


def find_field(wanted: str, available: Iterable[str]) -> str:
    """Full name of a field given with or without its unit; ValueError lists the existing names."""
    names = sorted(available)
    for name in names:
        if wanted in (name, split_name(name)[0]):
            return name
    near = difflib.get_close_matches(wanted, names, n=1, cutoff=0.5)
    raise ValueError(
        f"no field {wanted!r} in this run"
        + (f" (did you mean {near[0]!r}?)" if near else "")
        + f"; it has {', '.join(names)}"
    )


def shape_of(frame: Frame, time: float, field: str) -> Shape:
    """Shape of a frame; field as in the file. A vector field is replaced by its magnitude."""
    data, points = frame.point_data, np.asarray(frame.points, dtype=float)
    values = np.asarray(data[field], dtype=float)
    values = np.linalg.norm(values, axis=1) if values.ndim == 2 else values
    hole, outer = data.get("hole_radius [m]"), data.get("outer_radius [m]")
    md, rest = at_rest(frame)
    if "offset_x [m]" in data and "offset_y [m]" in data:
        offset = np.column_stack((data["offset_x [m]"], data["offset_y [m]"]))
    else:
        offset = offset_across(rest, points - rest)
    length = max(float(md[-1] - md[0]), 1e-12)
    bent = hole is None and float(np.abs(offset).max()) > LARGE * length
    return Shape(time, md, offset, hole, outer, points, values, bent)


def cut(shape: Shape, interval: tuple[float, float] | None) -> Shape:
    """The nodes with a measured depth in the interval [m], and one more on each side."""
    if interval is None:
        return shape
    low, high = interval
    inside = np.flatnonzero((shape.md >= low) & (shape.md <= high))
    if low >= high or inside.size == 0:
        size, unit = style.depth_unit()
        raise ValueError(
            f"no node between {low / size:g} {unit} and {high / size:g} {unit}: "
            f"the string reaches from {shape.md[0] / size:g} {unit} to {shape.md[-1] / size:g} {unit}"
        )
    part = slice(max(inside[0] - 1, 0), min(inside[-1] + 2, len(shape.md)))
    return shape.with_nodes(lambda values: values[part])


def smooth(shape: Shape, pieces: int) -> Shape:
    """The same string with `pieces` parts between two nodes: cubic through the nodes with slopes by central
    differences; field and radii are linear between nodes. Values at nodes do not change."""
    if pieces < 2 or len(shape.md) < 3:
        return shape
    md = shape.md
    grown = np.concatenate(
        [np.linspace(md[k], md[k + 1], pieces, endpoint=False) for k in range(len(md) - 1)] + [md[-1:]]
    )

    def between(values: np.ndarray) -> np.ndarray:
        return _cubic(md, values, grown) if values.ndim == 2 else np.interp(grown, md, values)

    return replace(shape.with_nodes(between), md=grown)


def _cubic(md: np.ndarray, values: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Cubic interpolation of values (n, k) at depths md (n,), slopes from central differences."""
    cell = np.clip(np.searchsorted(md, at, side="right") - 1, 0, len(md) - 2)
    step = (md[cell + 1] - md[cell])[:, None]
    x = (at - md[cell])[:, None] / np.where(step > 0, step, 1.0)
    return hermite(md, values, central_slopes(md, values), cell, x)


def central_slopes(md: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Slopes (n, k) by central differences of values (n, k) at depths md (n,).

    A joint has two nodes at one depth: slopes do not go across it, and values jump there.
    """
    parts = np.split(np.arange(len(md)), np.flatnonzero(np.diff(md) <= 0) + 1)
    return np.concatenate(
        [
            np.gradient(values[p], md[p], axis=0) if len(p) > 1 else np.zeros((1, values.shape[1]))
            for p in parts
        ]
    )


def hermite(
    md: np.ndarray, values: np.ndarray, slopes: np.ndarray, cell: np.ndarray, x: np.ndarray
) -> np.ndarray:
    """Cubic Hermite interpolation (m, k) of values and slopes (n, k) at depths md (n,), at the shares x (m, 1) of cells (m,)."""
    step = (md[cell + 1] - md[cell])[:, None]
    return (
        (1 + 2 * x) * (1 - x) ** 2 * values[cell]
        + x * (1 - x) ** 2 * step * slopes[cell]
        + x**2 * (3 - 2 * x) * values[cell + 1]
        + x**2 * (x - 1) * step * slopes[cell + 1]
    )


def half_width(shape: Shape) -> float:
    """Lateral distance shown on each side [m]: the hole's radius, or the largest offset."""
    body = 0.0 if shape.outer_radius is None else float(np.max(shape.outer_radius))
    reach = float(np.abs(shape.offset).max()) + body
    hole = 0.0 if shape.hole_radius is None else float(np.max(shape.hole_radius))
    return max(reach, hole, 1e-6)
