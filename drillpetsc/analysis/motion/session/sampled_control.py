"""Speed controllers that sample: Python functions of the user, and the built-in laws.

Manual: sec-python-controller, sec-top-drive-sampled.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from drillpetsc.case.blocks.top_drive import PythonController
from drillpetsc.errors import SolveError
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.own_code import parameters_of
from drillpetsc.parallel import total
from drillpetsc.physics.top.sampled_law import SampledLaw, SampledTorque
from drillpetsc.physics.top.top_drive import MotorDrive

#: what is measured at the top, in the order of ``MotorDrive.figures``
MEASURED = ("top_speed", "set_point", "motor_torque", "pipe_torque")


class SampledControl:
    """Calls the function or the laws of ``top.control`` at its samples; every rank calls it with the same numbers.

    model: with a sampled controller; period: between two samples [s].
    """

    def __init__(self, model: DrillingModel) -> None:
        controller = model.case.top.control[0]
        drive = model.part(MotorDrive)
        assert drive is not None and isinstance(drive.torque_input, SampledTorque)
        self.period, self._name = controller.sample, str(controller.kind)
        self._model, self._drive, self._held = model, drive, drive.torque_input
        self._law: SampledLaw | None = None
        if not isinstance(controller, PythonController):
            delays = [getattr(q, "delay", 0.0) for q in model.case.top.control]
            self._law = SampledLaw(drive.described, delays, self.period, drive.motor)
            self._function: Callable[..., Any] = self._law.torque
            self._parameters = 3
            self._held.kind = self._law.laws[0].kind
            return
        self._name = controller.function
        self._function = controller.call
        self._parameters = len(parameters_of(self._function))

    def __call__(self, t: float) -> None:
        """Set the torque from the time ``t`` [s] on; collective.  Raises SolveError for anything but a finite number."""
        model, drive = self._model, self._drive
        local = np.append(drive.figures(t, model.system.assembly)[: len(MEASURED)], drive.start_torque)
        figures = total(model.system.comm, local)
        measured = dict(zip((*MEASURED, "start_torque"), map(float, figures), strict=True))
        if self._held.resumed:
            measured["motor_torque"], measured["pipe_torque"] = map(float, self._held.measured)
        more = (self._held.memory,) if self._parameters == 3 else ()
        torque = self._function(t, measured, *more)
        try:
            value = float(torque)
        except (TypeError, ValueError):
            value = np.nan
        if not np.isfinite(value):
            raise SolveError(
                f"top.control: {self._name} gave {torque!r} at {t:g} s; a finite torque [N m] is needed"
            )
        self._held.torque = value
        if self._law is not None:
            self._held.kind = self._law.laws[self._law.phase(t)].kind


def sampled_control(model: DrillingModel) -> SampledControl | None:
    """The controller of a model that samples; None if it has none."""
    drive = model.part(MotorDrive)
    if drive is not None and isinstance(drive.torque_input, SampledTorque):
        return SampledControl(model)
    return None
