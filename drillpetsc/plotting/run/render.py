"""The straightened string in its hole as a shaded picture, by pyvista off screen.

Measured depth runs downward and straight; lateral lengths are drawn `scale` times larger than depths. The
projection is parallel and slightly from above. So heights in the picture are proportional to depth and fit a depth axis.
"""

from __future__ import annotations

import ctypes
import functools
import os
import subprocess
import sys
import weakref

import numpy as np

from drillpetsc.plotting.run.shape import Shape

ELEVATION = np.deg2rad(8.0)  # of the camera above the horizontal
AZIMUTH = np.deg2rad(35.0)  # of the camera, from the first lateral axis
SIDES = 20

_PROBE = """
import sys, pyvista
plotter = pyvista.Plotter(off_screen=True, window_size=(32, 32))
plotter.add_mesh(pyvista.Sphere())
image = plotter.screenshot(return_img=True)
print(plotter.render_window.GetClassName() if plotter.render_window else "")
sys.exit(0 if image.std() > 0 else 3)
"""


#: VTK's windows that need no screen, and the libraries one of which each opens when it draws
OFFSCREEN = {
    "vtkEGLRenderWindow": ("libEGL.so.1", "libEGL.so"),
    "vtkOSOpenGLRenderWindow": ("libOSMesa.so", "libOSMesa.so.8", "libOSMesa.so.6"),
}


def _opens(library: str) -> bool:
    try:
        ctypes.CDLL(library)
    except OSError:
        return False
    return True


def offscreen_window() -> str | None:
    """Value for VTK_DEFAULT_OPENGL_WINDOW: a window whose library exists.

    None if VTK (with a screen, or on another system) or the user chooses. Empty if there is no such window;
    VTK must not be started then, because it may end the process.
    """
    if (
        "VTK_DEFAULT_OPENGL_WINDOW" in os.environ
        or os.environ.get("DISPLAY")
        or not sys.platform.startswith("linux")
    ):
        return None
    return next((window for window, libraries in OFFSCREEN.items() if any(map(_opens, libraries))), "")


@functools.cache
def why_no_rendering() -> str:
    """Reason why pyvista cannot draw on this machine; empty if it can.

    Call it before VTK is imported, which reads its choice of window then. The test runs in a separate process,
    because VTK without usable OpenGL may end its process.
    """
    window = offscreen_window()
    if window == "":
        return "there is no screen, and libEGL and libOSMesa, which draw without one, are missing"
    try:
        chosen = {} if window is None else {"VTK_DEFAULT_OPENGL_WINDOW": window}
        asked = subprocess.run(
            [sys.executable, "-c", _PROBE],
            capture_output=True,
            text=True,
            timeout=120,
            check=False,
            env={**os.environ, **chosen},
        )
    except subprocess.TimeoutExpired:
        return "a first off-screen picture took longer than two minutes"
    if asked.returncode != 0:
        last = (asked.stderr.strip().splitlines() or ["no message"])[-1]
        return f"a first off-screen picture failed (status {asked.returncode}: {last})"
    window = asked.stdout.strip()
    if window:
        os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", window)  # spares VTK the search and its warnings
    return ""


def loft(md: np.ndarray, offset: np.ndarray, radius: np.ndarray, scale: float) -> np.ndarray:
    """Points (n * SIDES, 3) of rings around the centre line, in depth metres: x, y lateral, z up.

    Rings are level, as seen when lateral lengths are drawn far larger than depths.
    """
    angle = 2 * np.pi * np.arange(SIDES) / SIDES
    lateral = (
        offset[:, None, :] + radius[:, None, None] * np.column_stack((np.cos(angle), np.sin(angle)))[None]
    )
    depth = np.broadcast_to(-md[:, None, None], (len(md), SIDES, 1))
    return np.concatenate((scale * lateral, depth), axis=2).reshape(-1, 3)


def loft_faces(count: int) -> np.ndarray:
    """Quadrilaterals between `count` rings, in pyvista's format: (4, a, b, c, d) each, flat."""
    ring, corner = np.meshgrid(np.arange(count - 1) * SIDES, np.arange(SIDES), indexing="ij")
    beside = (corner + 1) % SIDES
    four = np.full_like(ring, 4)
    faces = np.stack(
        (four, ring + corner, ring + beside, ring + SIDES + beside, ring + SIDES + corner), axis=-1
    )
    return faces.reshape(-1)


class Rendering:
    """A pyvista rendering that is drawn again for each time; the hole is built once.

    pixels: (width, height) of the picture. span: (upper, lower) measured depth [m] at its upper and lower
    edge, for the hole's axis, which is the middle of the picture's width. A pixel is as many metres wide as
    it is high.
    """

    def __init__(
        self, shape: Shape, scale: float, span: tuple[float, float], pixels: tuple[int, int]
    ) -> None:
        import pyvista

        self.scale = scale
        self.plotter = pyvista.Plotter(off_screen=True, window_size=list(pixels), lighting="light kit")
        body = shape.outer_radius if shape.outer_radius is not None else np.full(len(shape.md), 0.0)
        width = (span[1] - span[0]) * pixels[0] / pixels[1]
        self.body = np.maximum(body, 0.006 * width / scale)  # a thin string keeps a few pixels
        if shape.hole_radius is not None:
            center = np.zeros((len(shape.md), 2))
            hole = pyvista.PolyData(
                loft(shape.md, center, shape.hole_radius, scale), loft_faces(len(shape.md))
            )
            self.plotter.add_mesh(hole, color="#9c8058", opacity=0.40, ambient=0.35, culling="back")
            self.plotter.add_mesh(hole, color="#9c8058", opacity=0.07, ambient=0.5, culling="front")
        self.string = pyvista.PolyData(
            loft(shape.md, shape.offset, self.body, scale), loft_faces(len(shape.md))
        )
        self.string.point_data["rgb"] = np.zeros((self.string.n_points, 3), dtype=np.uint8)
        self.plotter.add_mesh(self.string, scalars="rgb", rgb=True, ambient=0.38, diffuse=0.8, specular=0.15)
        self._aim(span)
        self.close = weakref.finalize(
            self, self.plotter.close
        )  # pyvista keeps every plotter until it is closed

    def _aim(self, span: tuple[float, float]) -> None:
        camera, height = self.plotter.camera, span[1] - span[0]
        focus = np.array([0.0, 0.0, -0.5 * (span[0] + span[1])])
        away = np.array(
            [np.cos(ELEVATION) * np.cos(AZIMUTH), np.cos(ELEVATION) * np.sin(AZIMUTH), np.sin(ELEVATION)]
        )
        camera.focal_point, camera.position, camera.up = focus, focus + 4 * height * away, (0.0, 0.0, 1.0)
        self.plotter.enable_parallel_projection()
        camera.parallel_scale = (
            0.5 * height * np.cos(ELEVATION)
        )  # depths are foreshortened by the camera's elevation
        self.plotter.reset_camera_clipping_range()

    def image(self, shape: Shape, colors: np.ndarray) -> np.ndarray:
        """The picture (h, w, 4) uint8 with transparent background. colors: (n, 3) in 0..1 at the nodes of
        shape."""
        self.string.points[:] = loft(shape.md, shape.offset, self.body, self.scale)
        self.string.point_data["rgb"][:] = np.repeat((255 * colors).astype(np.uint8), SIDES, axis=0)
        self.string.GetPoints().Modified()
        self.string.point_data["rgb"].VTKObject.Modified()
        self.string.Modified()
        self.plotter.render()
        return self.plotter.screenshot(return_img=True, transparent_background=True)


def project(offset: np.ndarray) -> np.ndarray:
    """Lateral position (n,) [m] of the string in the picture of the same camera, for pictures without pyvista."""
    return -np.sin(AZIMUTH) * offset[:, 0] + np.cos(AZIMUTH) * offset[:, 1]
