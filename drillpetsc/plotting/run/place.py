"""Where the string of a frame lies: its offset in the hole, and the centre of the hole beside it."""

from __future__ import annotations

import os
from dataclasses import dataclass

import numpy as np

from drillpetsc.geometry.frames import high_sides
from drillpetsc.output.files.fields import cross_section_axes
from drillpetsc.output.files.vtk import Frame, read_frame


@dataclass(frozen=True)
class Wall:
    """Stations of the hole [m]: md (n,), radius (n,), centre (n, 3); friction (n,) [-] if known."""

    md: np.ndarray
    radius: np.ndarray
    centre: np.ndarray
    friction: np.ndarray | None = None

    def tangents(self, md: np.ndarray) -> np.ndarray:
        """Unit tangents (n, 3) of the hole at depths (n,) [m], interpolated between its stations."""
        keep = np.append(True, np.diff(self.md) > 0)  # a step of the radius is a station given twice
        at, centre = self.md[keep], self.centre[keep]
        along = np.gradient(centre, at, axis=0)
        out = np.column_stack([np.interp(md, at, along[:, k]) for k in range(3)])
        return np.asarray(out / np.linalg.norm(out, axis=1, keepdims=True))


@dataclass(frozen=True)
class Place:
    """Where the string is [m].

    md (n,): measured depth.
    offset (n, 2): to the high side and to the right.
    centre (n, 3): of the hole at the node; without a hole the place at rest.
    lateral (n, 3): from the centre to the string.
    """

    md: np.ndarray
    offset: np.ndarray
    centre: np.ndarray
    lateral: np.ndarray


def read_wall(path: str | os.PathLike) -> Wall:
    """The hole of a well.vtu.  Raises as ``read_frame`` does."""
    frame = read_frame(path)
    sides = int(frame.cells["quad"][0][3])  # the fourth corner of the first face is in the second ring
    at = {name: values[::sides] for name, values in frame.point_data.items()}
    centre = frame.points.reshape(len(at["md [m]"]), sides, 3).mean(axis=1)
    return Wall(at["md [m]"], at["radius [m]"], centre, at.get("friction [-]"))


def place_of(frame: Frame, wall: Wall | None) -> Place:
    """Place of the string of a frame in its hole, None without one."""
    data, points = frame.point_data, np.asarray(frame.points, dtype=float)
    md, rest = at_rest(frame)
    if wall is not None and "offset_x [m]" in data:
        along = wall.tangents(md)
        first = high_sides(along)
        second = np.cross(along, first)
        offset = np.column_stack((data["offset_x [m]"], data["offset_y [m]"]))
        lateral = offset[:, :1] * first + offset[:, 1:] * second
        return Place(md, offset, points - lateral, lateral)
    return Place(md, offset_across(rest, points - rest), rest, points - rest)


def at_rest(frame: Frame) -> tuple[np.ndarray, np.ndarray]:
    """Measured depth (n,) and points (n, 3) of a string at rest [m]."""
    data, points = frame.point_data, np.asarray(frame.points, dtype=float)
    rest = points - data.get("displacement [m]", np.zeros_like(points))
    along = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(rest, axis=0), axis=1)))
    return np.asarray(data.get("md [m]", along), dtype=float), rest


def offset_across(rest: np.ndarray, moved: np.ndarray) -> np.ndarray:
    """Components (n, 2) of displacements (n, 3) across a string through the points ``rest`` (n, 3)."""
    return np.column_stack([np.sum(moved * axis, axis=1) for axis in cross_section_axes(rest)])
