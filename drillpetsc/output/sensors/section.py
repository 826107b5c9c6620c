"""Motion and loads of the section of a sensor, recorded after every step (manual: sec-vibration-sensors)."""

from __future__ import annotations

from typing import Any

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.case.blocks.sensors import Sensor, sensor_depth
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.output.measured.flow_recorder import FlowRecorder
from drillpetsc.output.measured.probes import cubic_weights
from drillpetsc.physics.beam import RESULT_NAMES

_COLUMN = {name: i for i, name in enumerate(RESULT_NAMES)}
#: parts of a section's record, by name
PARTS = {
    "acceleration": slice(0, 3),  # of the centre [m/s2]
    "slope": slice(3, 6),  # dr/ds [-]
    "slope_rate": slice(6, 9),  # [1/s]
    "slope_acceleration": slice(9, 12),  # [1/s2]
    "spin": slice(12, 15),  # spin angle [rad], rate [rad/s], acceleration [rad/s2]
    "reference": slice(15, 21),  # reference direction and second reference director of the upper node
    "bend": slice(21, 24),  # curvature that points to the centre of the bend [1/m]
    "torque": slice(24, 25),  # [N m]
    "tension": slice(25, 26),  # effective tension [N]
    "pressure": slice(26, 28),  # in the bore and in the annulus [Pa]
}
WIDTH = 28
RAW_WIDTH = 56


class SensorSection:
    """The section of a sensor, on the rank that has its element.

    model: the drilling model; sensor: of the case; mud: None without mud.
    """

    def __init__(self, model: DrillingModel, sensor: Sensor, mud: FlowRecorder | None) -> None:
        self.model, self.mud, mesh, chain = model, mud, model.mesh, model.system.chain
        depth = sensor_depth(model.case.string, model.case.item_depths, sensor)
        assert depth is not None
        self.depth = depth
        self.cell, self.share = cell, _ = mesh.place_of(depth)
        # in a rigid item: below the end of the element
        self.lever = depth - float(np.clip(depth, mesh.upper[cell], mesh.lower[cell]))
        local = np.flatnonzero(chain.cells == cell)
        self.is_here = bool(len(local))
        self.period = model.beam.angle_period
        self.stiffness = float(mesh.bending_stiffness[cell])
        self.curvature = np.array(mesh.curvature[cell]) if mesh.curvature.any() else np.zeros(2)
        self._wants = set(sensor.channels)
        if not self.is_here:
            return
        self._local = int(local[0])
        self._vertices = chain.ends[self._local]
        layout = model.system.layout
        ratio = layout.dofs.get("string.ratio")
        at = -1 if ratio is None else int(ratio[self._vertices[0], 0])
        self._ratio = at if at >= 0 else None
        self._weights = _shape(self.share, float(mesh.length[cell]))
        self._rigid = float(mesh.rigid_above[cell])

    def raw(self) -> FloatArray:
        """Unknowns, rates and accelerations of the element's nodes, their reference frame and the loads; cheap."""
        asm, frames = self.model.system.assembly, self.model.frames
        cell, beam, out = self.cell, self.model.beam, np.empty(RAW_WIDTH)
        out[:42] = beam.nodal_motion(asm, self._vertices).ravel()
        out[42:45] = 1.0, 0.0, 0.0
        if self._ratio is not None:
            out[42:45] = asm.x[self._ratio], asm.y[self._ratio], asm.a[self._ratio]
        out[45:48], out[48:51] = frames.reference[cell], frames.second_director[cell]
        out[51] = frames.twist0[cell]
        out[52:] = 0.0
        self._loads(asm, out[52:])
        return out

    def _loads(self, asm: Any, out: FloatArray) -> None:
        """Write torque [N m], effective tension [N], pressures in bore and annulus [Pa] into ``out`` (4,) as far as requested."""
        s = self.share
        if self._wants & {"torque", "wob"}:
            row = asm.evaluate_once(self.model.beam.element_results, asm)[self._local]
            out[0] = row[_COLUMN["torque"]]
            out[1] = (1 - s) * row[_COLUMN["axial_upper"]] + s * row[_COLUMN["axial_lower"]]
            if self.mud is not None and "wob" in self._wants:
                added = (self.mud.wall_tension() + self.mud.pressure_force())[self._local]
                out[1] += (1 - s) * added[0] + s * added[1]
        if self.mud is not None and "pressure" in self._wants:
            for name, channel in self.mud.channels().items():
                upper, lower = channel.pressures(self.model.system)[self._vertices]
                out[2 + (name == "annulus")] = (1 - s) * upper + s * lower

    def section(self, raw: FloatArray) -> FloatArray:
        """(k, WIDTH) records of the section from (k, n) raw ones, by the cubic of the element (manual: eq-beam-slope)."""
        x, y, a = (raw[:, 14 * i : 14 * (i + 1)] for i in range(3))
        ratio, rest = raw[:, 42:45], raw[:, 45:]
        second = y[:, 3:6], a[:, 3:6]
        tangent = unit_motion(x[:, 3:6], *second)
        # slope of the element at its upper end: the node's, times the stretch ratio of a junction
        slope = [
            ratio[:, :1] * x[:, 3:6],
            ratio[:, 1:2] * x[:, 3:6] + ratio[:, :1] * y[:, 3:6],
            ratio[:, 2:] * x[:, 3:6] + 2 * ratio[:, 1:2] * y[:, 3:6] + ratio[:, :1] * a[:, 3:6],
        ]
        nodal = []
        for level, values in enumerate((x, y, a)):
            upper = values[:, :3] + self._rigid * tangent[level] if self._rigid else values[:, :3]
            nodal.append((upper, slope[level], values[:, 7:10], values[:, 10:13]))
        place, first, bend = self._weights
        out = np.zeros((len(raw), WIDTH))
        slopes = [_sum(first, values) for values in nodal]
        acceleration = _sum(place, nodal[2])
        if self.lever:
            acceleration = acceleration + self.lever * unit_motion(*slopes)[2]
        curved = _sum(bend, nodal[0])
        t = slopes[0] / np.linalg.norm(slopes[0], axis=1, keepdims=True)
        out[:, PARTS["acceleration"]] = acceleration
        for name, values in zip(("slope", "slope_rate", "slope_acceleration"), slopes, strict=True):
            out[:, PARTS[name]] = values
        s, twist0 = self.share, rest[:, 6]
        twist, period = x[:, 13] - x[:, 6] + twist0, self.period
        if period:
            twist = twist - period * np.round(twist / period)
        out[:, 12] = x[:, 6] + s * twist
        for k, values in enumerate((y, a)):
            out[:, 13 + k] = (1 - s) * values[:, 6] + s * values[:, 13]
        out[:, PARTS["reference"]] = rest[:, :6]
        out[:, PARTS["bend"]] = curved - t * np.sum(t * curved, axis=1, keepdims=True)
        out[:, 24:28] = rest[:, 7:11]
        return out


def _sum(weights: tuple[float, ...], values: tuple[FloatArray, ...]) -> FloatArray:
    """Weighted sum of (k, 3) values, term by term: unlike a library's, its bits do not depend on k."""
    a, b, c, d = (w * q for w, q in zip(weights, values, strict=True))
    return ((a + b) + c) + d


def _shape(s: float, length: float) -> tuple[tuple[float, ...], ...]:
    """Weights of upper position and slope, lower position and slope in the cubic r(s), dr/ds and d2r/ds2."""
    return (
        cubic_weights(s, length),
        (
            (-6 * s + 6 * s**2) / length,
            1 - 4 * s + 3 * s**2,
            (6 * s - 6 * s**2) / length,
            3 * s**2 - 2 * s,
        ),
        (
            (-6 + 12 * s) / length**2,
            (-4 + 6 * s) / length,
            (6 - 12 * s) / length**2,
            (-2 + 6 * s) / length,
        ),
    )


def unit_motion(
    v: FloatArray, rate: FloatArray, second: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Unit vectors (k, 3) along v, and their first and second derivatives in time."""
    size = np.linalg.norm(v, axis=1, keepdims=True)
    t = v / size
    along = np.sum(t * rate, axis=1, keepdims=True)
    td = (rate - t * along) / size
    across = second - t * np.sum(t * second, axis=1, keepdims=True)
    tdd = across / size - 2 * along / size * td - np.sum(td * td, axis=1, keepdims=True) * t
    return t, td, tdd
