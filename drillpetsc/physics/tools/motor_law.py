"""Law of a positive displacement motor: speed, differential pressure and leak by torque and flow rate.

Kernel: kernels/tools/motor_law.hpp.  Manual: sec-motor-law.
"""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from dataclasses import dataclass
from math import pi
from typing import NamedTuple

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.kernels import function, pointer
from drillpetsc.kernels.parameters import Table, columns, constant, structure

_points = function("motor_law_points", "ippppp")
_Record = structure("motor_table")
SHARES = 65  # columns of a table: equal steps of torque over stall torque
SLIP = constant("motor_slip")  # loss of speed under the stall torque that keeps the law invertible [rad/s]


class MotorPoint(NamedTuple):
    """A point of a motor's law.

    speed: of the rotor from the stator [rad/s]; differential_pressure [Pa]; leak: flow rate past the rotor [m3/s];
    load: torque over stall torque [-].
    """

    speed: float
    differential_pressure: float
    leak: float
    load: float

    @property
    def stalled(self) -> bool:
        """Whether the rotor is stalled under its load."""
        return self.load >= 1.0


@dataclass(frozen=True)
class MeasuredCurve:
    """Performance of a motor at one flow rate, by rising torque.

    flow [m3/s]; torque, pressure, speed: (n,) [N m], [Pa], [rad/s]; the last torque is the stall torque.
    """

    flow: float
    torque: FloatArray
    pressure: FloatArray
    speed: FloatArray


class MotorLaw:
    """Speed, differential pressure and leak of a motor (manual: eq-motor-speed to eq-motor-leak).

    rev_per_volume: revolutions of the rotor per volume of mud [1/m3].
    efficiency: of the conversion of pressure into torque [-].
    no_load_pressure: differential pressure without torque [Pa].
    stall_torque [N m]; droop: exponent of the loss of speed [-].
    bypass: flow rate past the rotor by its nozzle [m3/s].
    curves: measured performance instead of the other numbers; () for none.
    """

    def __init__(
        self,
        rev_per_volume: float = 0.0,
        efficiency: float = 1.0,
        no_load_pressure: float = 0.0,
        stall_torque: float = 1.0,
        droop: float = 4.0,
        bypass: float = 0.0,
        curves: Sequence[MeasuredCurve] = (),
    ):
        self.curves = tuple(sorted(curves, key=lambda c: c.flow))
        self.parameters = Table(
            columns("motor_law_parameters"),
            1,
            turn=2 * pi * rev_per_volume,
            efficiency=efficiency,
            no_load=no_load_pressure,
            stall=stall_torque,
            droop=droop,
            bypass=bypass,
        )
        self.bypass = bypass
        #: address of the table of measured curves, 0 without
        self.address = 0
        if self.curves:
            self._record, self._keep = _table(self.curves)
            self.address = ctypes.addressof(self._record)

    def point(self, torque: float, flow: float) -> MotorPoint:
        """The motor under ``torque`` [N m] at the flow rate ``flow`` through the tool [m3/s]."""
        return MotorPoint(*map(float, self.points(np.array([torque]), np.array([flow]))[0]))

    def points(self, torque: FloatArray, flow: FloatArray) -> FloatArray:
        """(n, 4) speed [rad/s], differential pressure [Pa], leak [m3/s], torque over stall torque [-].

        torque: (n,) [N m]; flow: (n,) through the tool [m3/s].
        """
        torque, flow = (
            np.ascontiguousarray(q, dtype=float).ravel() for q in np.broadcast_arrays(torque, flow)
        )
        out = np.zeros((len(torque), 4))
        _points(
            len(out),
            pointer(self.parameters.array),
            self.address,
            pointer(flow),
            pointer(torque),
            pointer(out),
        )
        return out

    def speed(self, torque: float, flow: float) -> float:
        """Speed of the rotor from the stator [rad/s]."""
        return self.point(torque, flow).speed

    def free_speed(self, flow: float) -> float:
        """Speed without torque [rad/s]."""
        return self.point(0.0, flow).speed

    def stall_torque(self, flow: float) -> float:
        """Torque at which the rotor stalls [N m]."""
        return 1.0 / self.point(1.0, flow).load

    def torque(self, speed: float, flow: float) -> float:
        """Torque at which the rotor turns with ``speed`` [rad/s] between standstill and free speed [N m].

        Raises ValueError for another speed.
        """
        free = self.free_speed(flow)
        if not 0 <= speed <= free:
            raise ValueError(f"speed {speed:g} rad/s is not between 0 and the free speed, {free:g} rad/s")
        low, high = 0.0, self.stall_torque(flow)
        for _ in range(100):  # the speed falls with the torque
            middle = 0.5 * (low + high)
            low, high = (middle, high) if self.speed(middle, flow) > speed else (low, middle)
        return 0.5 * (low + high)

    def efficiency(self, torque: float, flow: float) -> float:
        """Mechanical over hydraulic power [-]; 0 without flow."""
        p = self.point(torque, flow)
        power = p.differential_pressure * max(flow - self.bypass, 0.0)
        return torque * p.speed / power if power > 0 else 0.0


def monotone_slopes(x: FloatArray, f: FloatArray) -> FloatArray:
    """(n, ...) derivatives of a smooth curve through the points (x (n,), f (n, ...)) without new extremes.

    Fritsch and Butland, SIAM J. Sci. Stat. Comput. 5:300 (1984); at the ends the derivative of the nearest interval is used.
    """
    h, d = np.diff(x), np.diff(f, axis=0) / np.diff(x).reshape(-1, *(1,) * (f.ndim - 1))
    if len(h) == 1:
        return np.concatenate([d, d])
    first = (h[:-1] + 2 * h[1:]).reshape(-1, *(1,) * (f.ndim - 1))
    last = (2 * h[:-1] + h[1:]).reshape(-1, *(1,) * (f.ndim - 1))
    rising = d[:-1] * d[1:] > 0
    with np.errstate(divide="ignore", invalid="ignore"):
        inner = np.where(rising, (first + last) / (first / d[:-1] + last / d[1:]), 0.0)
    return np.concatenate([d[:1], inner, d[-1:]])


def _resampled(curve: MeasuredCurve) -> tuple[FloatArray, FloatArray]:
    """(SHARES,) speed [rad/s] and pressure [Pa] at equal steps of torque over stall torque."""
    share, at = curve.torque / curve.torque[-1], np.linspace(0.0, 1.0, SHARES)
    k = np.clip(np.searchsorted(share, at, side="right") - 1, 0, len(share) - 2)
    h = np.diff(share)[k]
    s = (at - share[k]) / h
    out = []
    for f in (curve.speed, curve.pressure):
        m = monotone_slopes(share, f)
        low = (1 - s) ** 2 * (f[k] * (1 + 2 * s) + m[k] * s * h)
        out.append(low + s**2 * (f[k + 1] * (3 - 2 * s) - m[k + 1] * (1 - s) * h))
    return out[0], out[1]


def _table(curves: Sequence[MeasuredCurve]) -> tuple[ctypes.Structure, list[FloatArray]]:
    """The kernel's record of measured curves, and the arrays that it points to.

    A row without flow comes first: the motor is at rest, and its pressure is the pressure at the lowest flow minus its
    pressure at no load.
    """
    sampled = [_resampled(c) for c in curves]
    flow = np.array([0.0, *(c.flow for c in curves)])
    stall = np.array([curves[0].torque[-1], *(c.torque[-1] for c in curves)])
    least = sampled[0][1]
    speed = np.vstack([np.zeros(SHARES), *(q[0] for q in sampled)])
    pressure = np.vstack([least - least[0], *(q[1] for q in sampled)])
    share = np.linspace(0.0, 1.0, SHARES)
    arrays = {
        "flow": flow,
        "stall": stall,
        "stall_by_flow": monotone_slopes(flow, stall),
        "speed": speed,
        "speed_by_share": monotone_slopes(share, speed.T).T,
        "speed_by_flow": monotone_slopes(flow, speed),
        "pressure": pressure,
        "pressure_by_share": monotone_slopes(share, pressure.T).T,
        "pressure_by_flow": monotone_slopes(flow, pressure),
    }
    keep = {key: np.ascontiguousarray(value) for key, value in arrays.items()}
    record = _Record(flows=len(flow), shares=SHARES, **{key: pointer(value) for key, value in keep.items()})
    return record, list(keep.values())
