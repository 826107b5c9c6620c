"""Readings of a sensor between steps, its filter, and its samples at multiples of 1/rate (manual: sec-vibration-sensors)."""

from __future__ import annotations

from typing import Any

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.case.blocks.sensors import Sensor
from drillpetsc.fem.quantity import Quantity
from drillpetsc.geometry.frames import turned_directors
from drillpetsc.output.quantities.tables import COLUMNS
from drillpetsc.output.sensors.files import SENSOR_TABLE
from drillpetsc.output.sensors.section import PARTS, unit_motion
from drillpetsc.vibration.filters import LowPass, butterworth

AT_ONCE = 20_000  # samples that are computed together
MOST_TURNED = 0.1  # turn of the string between two points of a filter [rad]
_ACCELERATION = PARTS["acceleration"]


def columns_of(sensor: Any, pressures: tuple[str, ...], motion: bool) -> tuple[Quantity, ...]:
    """Columns of a sensor's file, in their order.

    sensor: block of the case; pressures: of bore, annulus that exist; motion: with the accelerations without gravity, for indices.
    """
    wanted = set(sensor.channels)
    chosen = {"time", *sensor.accelerations, *(f"downhole_{c}" for c in ("torque", "wob") if c in wanted)}
    if "rpm" in wanted:
        chosen |= {"spin", "magnetic_rate"}
    if "bending" in wanted:
        chosen |= {"bending_y", "bending_z"}
    if "pressure" in wanted:
        chosen |= {{"bore": "internal_pressure", "annulus": "annulus_pressure"}[name] for name in pressures}
    if motion and sensor.accelerations:
        chosen |= {f"{name}_motion" for name in sensor.accelerations if sensor.gravity}
        if sensor.radius:
            chosen |= {"spin_acceleration"}
    return tuple(q for q in COLUMNS[SENSOR_TABLE] if q.name in chosen)


class Sampler:
    """Samples of one sensor from the records of its section; used on the first rank.

    sensor: of the case; gravity: (3,) [m/s2]; stiffness: EI of the section [N m2]; curvature: (2,) stress-free, along its directors [1/m].
    channels: pressures that exist, bore and annulus.  motion: whether to add the accelerations without gravity.
    period: multiple [rad] up to which spin angles are known; 0: they count all turns.
    """

    def __init__(
        self,
        sensor: Sensor,
        gravity: FloatArray,
        stiffness: float,
        curvature: FloatArray,
        channels: tuple[str, ...],
        motion: bool,
        period: float = 0.0,
    ) -> None:
        self.period = period
        self.sensor, self.gravity = sensor, np.asarray(gravity, dtype=float)
        self.stiffness, self.curvature = stiffness, curvature
        self.quantities = columns_of(sensor, channels, motion)
        self.columns = [q.column for q in self.quantities]
        given = sensor.filter
        self.filter: LowPass | None = None if given is None else butterworth(given.order, given.cutoff)
        self.next = 0  # number of the next sample
        self.clipped = 0  # points at which an accelerometer was at the end of its range
        self._state: np.ndarray | None = None
        self._last: tuple[float, FloatArray] | None = None  # time and readings of the last point

    def _width(self) -> int:
        return len(self.columns) - 1

    def samples(self, times: FloatArray, starts: FloatArray, ends: FloatArray) -> FloatArray:
        """(k, columns) rows of the samples that are due in steps that follow one another; time [s] first.

        times: (n + 1,) ends of the steps [s]; starts, ends: (n, WIDTH) records at the beginning and at the end of each.
        """
        if self._last is None:
            first = self._readings(times[:1], np.zeros(1, int), times, starts, ends)
            self._last = float(times[0]), first[0]
        count = max(1, int(np.ceil((times[-1] - times[0]) * self.sensor.rate / AT_ONCE)))
        cuts = [*np.linspace(times[0], times[-1], count + 1)[1:-1], times[-1]]
        return np.vstack([self._samples_until(float(cut), times, starts, ends) for cut in cuts])

    def _samples_until(
        self, end: float, times: FloatArray, starts: FloatArray, ends: FloatArray
    ) -> FloatArray:
        """Rows of the samples that are due up to the time ``end`` [s]."""
        assert self._last is not None
        points, due = self._points(end, times, ends), self._due(end)
        step = np.clip(np.searchsorted(times[1:], points, side="left"), 0, len(ends) - 1)
        t = np.concatenate([[self._last[0]], points])
        values = np.vstack([self._last[1], self._readings(points, step, times, starts, ends)])
        self._last = float(t[-1]), values[-1]
        if self.filter is not None:
            if self._state is None:
                self._state = self.filter.at_rest(values.shape[1])
            values, self._state = self.filter.run(t, values, self._state)
        at = np.minimum(np.searchsorted(t, due, side="left"), len(t) - 1)
        self.next += len(due)
        return np.column_stack([due, values[at]])

    def _due(self, end: float) -> FloatArray:
        """Times of the samples up to ``end`` [s] that are not taken yet."""
        last = int(np.floor(end * self.sensor.rate * (1 + 1e-12) + 1e-9))
        return np.arange(self.next, last + 1) / self.sensor.rate

    def _points(self, end: float, times: FloatArray, ends: FloatArray) -> FloatArray:
        """Times up to ``end`` [s] at which readings are taken: samples, ends of steps, and with a filter points between."""
        assert self._last is not None
        begin = self._last[0]
        parts = [times[1:][(times[1:] > begin) & (times[1:] <= end)], self._due(end)]
        if self.filter is not None:
            h = np.diff(times)
            spin = np.maximum(np.abs(ends[:, 13]), 1e-9)
            pieces = np.ceil(h / np.minimum(1.0 / self.sensor.rate, MOST_TURNED / spin)).astype(int)
            for i in np.flatnonzero((pieces > 1) & (times[1:] > begin) & (times[:-1] < end)):
                low, high = ((t - times[i]) / h[i] * pieces[i] for t in (begin, end))
                k = np.arange(max(1, int(low)), min(pieces[i], int(high) + 1) + 1)
                between = times[i] + h[i] * k / pieces[i]
                parts.append(between[(between > begin) & (between < min(end, times[i + 1]))])
        return np.unique(np.concatenate(parts))

    def _readings(
        self, t: FloatArray, step: np.ndarray, times: FloatArray, starts: FloatArray, ends: FloatArray
    ) -> FloatArray:
        """(k, columns - 1) what the sensor measures at times t (k,) in the steps ``step`` (k,)."""
        first, last = starts[step], ends[step]
        h = (times[step + 1] - times[step])[:, None]
        s = np.clip((t[:, None] - times[step][:, None]) / h, 0.0, 1.0)
        record = (
            first + (last - first) * s
        )  # straight lines; the rates of position and angle give them a cubic
        slope, rate = PARTS["slope"], PARTS["slope_rate"]
        v = _hermite(s, h, first[:, slope], first[:, rate], last[:, slope], last[:, rate])
        w = record[:, rate]
        tangent, td, tdd = unit_motion(v, w, record[:, PARTS["slope_acceleration"]])
        end = last[:, 12:13]
        if self.period:  # the angle of the element does not count the turns
            ahead = first[:, 12:13] + 0.5 * h * (first[:, 13:14] + last[:, 13:14])
            end = end + self.period * np.round((ahead - end) / self.period)
        angle = _hermite(s, h, first[:, 12:13], first[:, 13:14], end, last[:, 13:14])
        spin = _hermite(s, h, first[:, 13:14], first[:, 14:15], last[:, 13:14], last[:, 14:15])
        spinning = record[:, 14:15]
        reference = last[:, PARTS["reference"]]
        axes = reference[:, :3], reference[:, 3:]
        y, z = turned_directors(*axes, tangent, angle + self.sensor.angle)
        omega = np.cross(tangent, td) + spin * tangent
        out: dict[str, FloatArray] = {}
        if self.sensor.accelerations:
            lever = self.sensor.radius * y
            turning = np.cross(tangent, tdd) + spinning * tangent + spin * td
            motion = (
                record[:, _ACCELERATION] + np.cross(turning, lever) + np.cross(omega, np.cross(omega, lever))
            )
            felt = motion - self.gravity if self.sensor.gravity else motion
            for name, axis in (("ax", tangent), ("ay", y), ("az", z)):
                if name in self.sensor.accelerations:
                    out[name] = self._in_range(np.sum(felt * axis, axis=1))
                    out[f"{name}_motion"] = np.sum(motion * axis, axis=1)
        out["spin"] = spin[:, 0]
        out["spin_acceleration"] = spinning[:, 0]
        out["magnetic_rate"] = self._magnetic_rate(omega, y, z)
        out["downhole_torque"], out["downhole_wob"] = -record[:, 24], -record[:, 25]
        out["internal_pressure"], out["annulus_pressure"] = record[:, 26], record[:, 27]
        if "bending" in self.sensor.channels:
            d2, d3 = turned_directors(*axes, tangent, angle)
            free = self.curvature[1] * d2 - self.curvature[0] * d3
            bend = self.stiffness * (record[:, PARTS["bend"]] - free)
            out["bending_y"], out["bending_z"] = np.sum(bend * y, axis=1), np.sum(bend * z, axis=1)
        return np.column_stack([out[name] for name, _ in self.columns[1:]])

    def _in_range(self, values: FloatArray) -> FloatArray:
        """Accelerations [m/s2] within the range of the accelerometers; values beyond it are counted."""
        most = self.sensor.range
        if most is None:
            return values
        self.clipped += int(np.sum(np.abs(values) > most))
        return np.clip(values, -most, most)

    def _magnetic_rate(self, omega: FloatArray, y: FloatArray, z: FloatArray) -> FloatArray:
        """(k,) rate [rad/s] of the angle of the magnetic field in the section."""
        dip = self.sensor.magnetic_dip
        field = np.array([np.cos(dip), 0.0, np.sin(dip)])
        along_y, along_z, rate_y, rate_z = (
            np.sum(axis * field, axis=1) for axis in (y, z, np.cross(omega, y), np.cross(omega, z))
        )
        size = np.maximum(along_y**2 + along_z**2, 1e-12)
        return np.asarray((along_z * rate_y - along_y * rate_z) / size)

    # ------------------------------------------------------------------ checkpoints
    def get_state(self) -> FloatArray:
        """Numbers that a continued run needs: next sample, clipped points, last point, its readings, state of the filter."""
        width = self._width()
        time, readings = self._last if self._last is not None else (np.nan, np.zeros(width))
        state = self._state if self._state is not None else np.zeros((width, 0))
        return np.concatenate(
            [[self.next, self.clipped, time], readings, state.real.ravel(), state.imag.ravel()]
        )

    def set_state(self, saved: FloatArray) -> None:
        """Continue from ``get_state``."""
        width = self._width()
        self.next, self.clipped = int(saved[0]), int(saved[1])
        self._last = None if np.isnan(saved[2]) else (float(saved[2]), np.array(saved[3 : 3 + width]))
        rest = np.array(saved[3 + width :])
        if len(rest):
            half = len(rest) // 2
            self._state = (rest[:half] + 1j * rest[half:]).reshape(width, -1)


def _hermite(
    s: FloatArray, h: FloatArray, p0: FloatArray, m0: FloatArray, p1: FloatArray, m1: FloatArray
) -> FloatArray:
    """Cubic through values p with derivatives m at both ends of a step h, at the part s of it."""
    d = p1 - p0
    return p0 + s * (h * m0 + s * (3 * d - h * (2 * m0 + m1) + s * (h * (m0 + m1) - 2 * d)))
