"""`top.motor` and `top.control`: the motor of a top drive, its limits and its speed controller."""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import BeforeValidator, Field, model_validator

from drillpetsc.case.block import Block, ByKind
from drillpetsc.case.blocks.own_law import FunctionName, OwnFunction
from drillpetsc.case.key_paths import refuse
from drillpetsc.case.quantities import Quantity, WordOrNumber, one_as_list, said
from drillpetsc.own_code import parameters_of

POWER_TOLERANCE = 0.01  # by which power and max_torque times base_speed may differ [-]


class TopMotor(Block):
    """The motor of a top drive at the quill: inertia and limits. Without it the speed is prescribed."""

    inertia: Annotated[float, Quantity("kg m^2", above=0)] = Field(
        description="inertia at the quill: of the motors times the squared gear ratio, and of the quill"
    )
    max_torque: Annotated[float, Quantity("N m", above=0)] | None = Field(
        default=None, description="largest torque; without it the torque has no limits"
    )
    min_torque: Annotated[float, Quantity("N m", at_most=0)] | None = Field(
        default=None,
        description="torque of the strongest braking, at most 0; a drive that cannot brake has 0; default -max_torque",
    )
    power: Annotated[float, Quantity("W", above=0)] | None = Field(
        default=None, description="largest power: above base_speed the torque is at most power/speed"
    )
    base_speed: Annotated[float, Quantity("rad/s", above=0)] | None = Field(
        default=None, description="speed above which the power limits the torque; default power/max_torque"
    )
    torque_rate: Annotated[float, Quantity("N m/s", above=0)] | None = Field(
        default=None, description="largest rate of the torque; without it there is no such limit"
    )
    time_constant: Annotated[float, Quantity("s", at_least=0)] = Field(
        default=0.0,
        description="time constant with which the torque follows the controller; 0: at once "
        "(5 ms with a torque_rate)",
    )

    @model_validator(mode="after")
    def _limits(self) -> TopMotor:
        for key in ("min_torque", "power", "base_speed"):
            if getattr(self, key) is not None and self.max_torque is None:
                raise refuse("max_torque", want=f"a largest torque, which {key} needs")
        if (
            self.max_torque is not None
            and self.min_torque is not None
            and -self.min_torque > 1e3 * self.max_torque
        ):
            raise refuse(
                "min_torque", got=self.min_torque, want=f"at least {said(-1e3 * self.max_torque, 'torque')}"
            )
        if self.power is not None and self.base_speed is not None and self.max_torque is not None:
            if not math.isclose(self.power, self.base_speed * self.max_torque, rel_tol=POWER_TOLERANCE):
                raise refuse(
                    "base_speed",
                    got=self.base_speed,
                    want=f"power/max_torque, {self.power / self.max_torque:.4g} rad/s, or only two of the three",
                    hint="at another speed the limit of the torque would jump",
                )
        return self

    @property
    def limit_power(self) -> float | None:
        """Largest power [W]; None without a limit."""
        if self.power is None and self.base_speed is not None and self.max_torque is not None:
            return self.base_speed * self.max_torque
        return self.power


#: the delay is approximated to second order (manual: eq-top-drive-delay), which holds up to a phase of about 2 rad: 0.3 Hz,
#: the second mode of a long string, at this delay [s]
LONGEST_DELAY = 1.0


class Controller(Block):
    """Base of all speed controllers."""

    from_: Annotated[float, Quantity("s", at_least=0)] = Field(
        default=0.0, alias="from", description="time from which it acts"
    )
    delay: Annotated[float, Quantity("s", at_least=0, at_most=LONGEST_DELAY)] = Field(
        default=0.0, description="delay of the controller's output"
    )
    sample: Annotated[float, Quantity("s", at_least=0, at_most=LONGEST_DELAY)] = Field(
        default=0.0,
        description="time between two samples of a controller that holds its torque in between; 0: continuous. "
        "With it, delay is a multiple of it",
    )

    @model_validator(mode="after")
    def _whole_samples(self) -> Controller:
        if self.sample > 0:
            late = self.delay / self.sample
            if abs(late - round(late)) > 1e-6:
                low = int(late) * self.sample
                want = f"a multiple of sample, such as {low:g} s or {low + self.sample:g} s"
                raise refuse("delay", got=self.delay, want=want)
        return self


class PiController(Controller):
    """Torque p e + i times the integral of e, with e the set point minus the speed."""

    kind: Literal["pi"] = Field(description="proportional and integral gain")
    p: Annotated[float, Quantity("N m s/rad", at_least=0)] = Field(description="proportional gain")
    i: Annotated[float, Quantity("N m/rad", at_least=0)] = Field(description="integral gain")

    @model_validator(mode="after")
    def _gain(self) -> PiController:
        if self.p == 0:
            raise refuse(
                "p", got=0.0, want="a gain above 0", hint="without it the speed oscillates without decay"
            )
        return self


class StiffController(Controller):
    """PI control with gains that follow from the pipe and the inertia of the drive."""

    kind: Literal["stiff"] = Field(description="stiff PI control of the speed")
    p: Annotated[float, Quantity("", above=0)] = Field(
        default=50.0, description="proportional gain, times the impedance of the uppermost pipe"
    )
    i: Annotated[float, Quantity("1/s^2", at_least=0)] = Field(
        default=5.0, description="integral gain, times the inertia of the drive"
    )


_AUTO_FREQUENCY = WordOrNumber(("auto",), Quantity("1/s", above=0), none=False)


class SoftTorqueController(Controller):
    """Impedance control: the drive absorbs torsional waves about one frequency."""

    kind: Literal["soft_torque", "soft_speed"] = Field(description="impedance control (soft torque)")
    damping: Annotated[float, Quantity("", above=0)] = Field(
        default=4.0,
        description="proportional gain, times the impedance of the uppermost pipe; a wave of the tuned frequency "
        "is reflected by (damping - 1)/(damping + 1)",
    )
    frequency: Annotated[float | Literal["auto"], _AUTO_FREQUENCY] = Field(
        default="auto",
        description="tuned frequency; auto: the lowest torsional frequency of the string with its top held",
    )
    inertia_compensation: Annotated[float, Quantity("", at_least=0, at_most=0.95)] = Field(
        default=0.0,
        description="share of the drive's inertia compensated by a torque proportional to the acceleration",
    )


class ZTorqueController(Controller):
    """Stiff control whose set point follows the high-passed torque of the pipe."""

    kind: Literal["z_torque"] = Field(description="impedance matching by the torque of the pipe (Z-torque)")
    factor: Annotated[float, Quantity("", at_least=0)] = Field(
        default=0.25, description="share of the matched impedance; 1: waves are absorbed"
    )
    high_pass: Annotated[float, Quantity("s", above=0)] = Field(
        default=20.0, description="period of the high-pass filter of the pipe's torque"
    )
    low_pass: Annotated[float, Quantity("s", at_least=0)] = Field(
        default=0.005, description="period of the low-pass filter of the pipe's torque; 0: none"
    )
    p: Annotated[float, Quantity("", above=0)] = Field(
        default=50.0, description="proportional gain, times the impedance of the uppermost pipe"
    )
    i: Annotated[float, Quantity("1/s^2", at_least=0)] = Field(
        default=5.0, description="integral gain, times the inertia of the drive"
    )
    estimate: Literal["sensor", "motor"] = Field(
        default="sensor",
        description="torque of the pipe: sensor, as measured; motor, from the motor's torque and the filtered acceleration",
    )


class PythonController(OwnFunction):
    """A function of the user that gives the torque at every sample; between two samples the torque is held."""

    kind: Literal["python"] = Field(description="a function in Python")
    function: FunctionName = Field(
        description="file.py:function or module:function, of the time [s], of what is measured (a dictionary) and of a memory; returns "
        "the torque [N m]"
    )
    sample: Annotated[float, Quantity("s", above=0)] = Field(description="time between two samples")

    @property
    def from_(self) -> float:
        """Time from which it acts [s]."""
        return 0.0

    def check_signature(self) -> None:
        if (count := len(parameters_of(self.call))) not in (2, 3):
            want = "a function of t and measured, or of t, measured and memory"
            raise refuse("function", got=f"{self.function} with {count} parameters", want=want)


AnyController = Annotated[
    PiController | StiffController | SoftTorqueController | ZTorqueController | PythonController,
    ByKind("stiff", "soft_torque", "soft_speed", "z_torque"),
]


Controllers = Annotated[
    tuple[AnyController, ...],
    BeforeValidator(one_as_list, json_schema_input_type=AnyController | tuple[AnyController, ...]),
]
