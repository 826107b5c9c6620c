"""Laws of speed controllers of a top drive as plain numbers, and the wave that a controlled top reflects.

Manual: sec-top-drive-control.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drillpetsc.arrays import FloatArray

#: numbers of the kinds in the output ``control_mode``; 0: the torque is prescribed
MODES = {"torque": 0, "pi": 1, "stiff": 2, "soft_torque": 3, "z_torque": 4, "python": 5}


@dataclass(frozen=True)
class Law:
    """A controller from the time ``start`` on (manual: eq-top-drive-law).

    kind: one of ``MODES``; start: [s].
    p: [N m s/rad]; i: [N m/rad].
    compensation: inertia cancelled by a torque proportional to the acceleration [kg m2].
    coupling: change of the set point by the torque of the pipe [rad/(N m s)].
    low_pass, high_pass: time constants of the filters of this torque [s], 0: none.
    estimated: the torque of the pipe is computed from the motor's torque and the filtered acceleration.
    delay: of the whole output [s].
    frequency: to which the law is tuned [Hz], 0: none.
    """

    kind: str
    start: float = 0.0
    p: float = 0.0
    i: float = 0.0
    compensation: float = 0.0
    coupling: float = 0.0
    low_pass: float = 0.0
    high_pass: float = 0.0
    estimated: bool = False
    delay: float = 0.0
    frequency: float = 0.0

    @property
    def filters(self) -> bool:
        """Whether the law uses the filtered torque of the pipe."""
        return self.coupling != 0.0


@dataclass(frozen=True)
class Motor:
    """A motor at the quill.

    inertia: [kg m2].
    max_torque, min_torque: [N m]; power: [W]; torque_rate: [N m/s]; 0: no such limit.
    lag: time constant of the torque [s], 0: none.
    """

    inertia: float
    max_torque: float = 0.0
    min_torque: float = 0.0
    power: float = 0.0
    torque_rate: float = 0.0
    lag: float = 0.0


def top_impedance(law: Law, motor: Motor, frequency: FloatArray) -> np.ndarray:
    """Compute the torsional impedance Z (k,) [N m s/rad] of a controlled top (manual: eq-top-drive-impedance).

    It is the torque of the pipe on the drive over the speed of the top, at a constant set point, within the limits.

    frequency: (k,) above 0 [Hz].
    """
    s = 2j * np.pi * np.asarray(frequency, dtype=float)
    lag = np.exp(-s * law.delay) / (1.0 + s * motor.lag)  # from the controller's output to the torque
    C = lag * (law.p + law.i / s)
    low = 1.0 / (1.0 + s * law.low_pass)
    high = s * law.high_pass / (1.0 + s * law.high_pass) if law.high_pass > 0 else np.ones_like(s)
    inertia = s * (motor.inertia - lag * law.compensation)
    # the torque T of the pipe on the drive: I s w = M - T, M = C (-w - k H (T or T + I s w (1 - low)))
    if law.estimated:
        torque = law.coupling * high * C
        return np.asarray((inertia + C + torque * s * motor.inertia * (1.0 - low)) / (1.0 + torque))
    return np.asarray((inertia + C) / (1.0 + law.coupling * high * low * C))


def reflection(law: Law, motor: Motor, impedance: float, frequency: FloatArray) -> np.ndarray:
    """Compute the reflection r (k,) [-] of a torsional wave at a controlled top (manual: eq-top-drive-reflection).

    impedance: of the uppermost pipe, zeta [N m s/rad]; frequency: (k,) above 0 [Hz].
    """
    Z = top_impedance(law, motor, frequency)
    return np.asarray((Z - impedance) / (Z + impedance))
