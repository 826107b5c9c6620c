"""`pressure_loss` of a string item: loss of the mud in a tool besides friction."""

from __future__ import annotations

import math
from functools import lru_cache
from itertools import pairwise
from typing import Annotated

from pydantic import BeforeValidator, Field, model_validator

from drillpetsc.case.block import Block
from drillpetsc.case.files.quantity_file import QuantityColumn, QuantityFile
from drillpetsc.case.key_paths import refuse
from drillpetsc.case.quantities import Quantity, said

_Flow = Annotated[float, Quantity("m^3/s", above=0, at_most=10)]
_Loss = Annotated[float, Quantity("Pa", at_least=0, at_most=1e9, kind="pressure")]


@lru_cache(maxsize=64)
def _table(flow_rate: tuple[float, ...], loss: tuple[float, ...]) -> tuple[tuple[float, float, float], ...]:
    """`LossCurve.table`.

    Between the points the loss is a monotone cubic of the squared flow rate, so points of a square law reproduce the whole law. Beyond
    the last one it is extrapolated linearly.  The slopes at the points follow Fritsch and Butland (1984); at both ends they are the
    slopes of the chords (manual: eq-mud-tool-curve).
    """
    square, lost = [0.0, *(q**2 for q in flow_rate)], [0.0, *loss]
    steps = [b - a for a, b in pairwise(square)]
    chords = [(b - a) / h for (a, b), h in zip(pairwise(lost), steps, strict=True)]
    slopes = [chords[0]]
    for (a, b), (h, k) in zip(pairwise(chords), pairwise(steps), strict=True):
        first, second = 2 * k + h, k + 2 * h
        slopes.append((first + second) / (first / a + second / b) if a > 0 and b > 0 else 0.0)
    return tuple(zip(square, lost, (*slopes, chords[-1]), strict=True))


class LossCurve(Block):
    """Measured losses of a tool, one value of each list a point; without flow there is no loss."""

    flow_rate: tuple[_Flow, ...] = Field(description="flow rates, rising")
    loss: tuple[_Loss, ...] = Field(description="pressure loss at each flow rate, not falling")

    @model_validator(mode="after")
    def _rising(self) -> LossCurve:
        flow, loss = self.flow_rate, self.loss
        if len(loss) != len(flow):
            raise refuse("loss", got=f"{len(loss)} values", want=f"{len(flow)}, one for each flow_rate")
        if len(flow) < 2:
            hint = "one measured loss is value, with at and density"
            raise refuse("flow_rate", got=f"{len(flow)} value(s)", want="two flow rates or more", hint=hint)
        for k in range(1, len(flow)):
            if not flow[k] > flow[k - 1]:
                want = f"more than the flow rate before, {said(flow[k - 1], 'flow')}"
                raise refuse("flow_rate", k, got=said(flow[k], "flow"), want=want)
            if loss[k] < loss[k - 1]:
                want = f"at least the loss before, {said(loss[k - 1], 'pressure')}"
                hint = "a loss that falls with the flow rate has several flow rates for one pressure"
                raise refuse("loss", k, got=said(loss[k], "pressure"), want=want, hint=hint)
        return self

    @property
    def table(self) -> tuple[tuple[float, float, float], ...]:
        """Rows of flow rate squared [m6/s2], loss [Pa] and its slope by the square, from no flow up."""
        return _table(self.flow_rate, self.loss)

    def at(self, flow: float) -> float:
        """Loss at a flow rate [m3/s], of the other sign at a flow back."""
        rows, u = self.table, flow**2
        end = rows[-1]
        if u >= end[0]:
            return math.copysign(end[1] + end[2] * (u - end[0]), flow)
        below, above = next(pair for pair in pairwise(rows) if u < pair[1][0])
        h = above[0] - below[0]
        s = (u - below[0]) / h
        low = below[1] * (1 + 2 * s) + below[2] * h * s
        high = above[1] * (3 - 2 * s) - above[2] * h * (1 - s)
        return math.copysign((1 - s) ** 2 * low + s**2 * high, flow)


#: a measured loss over the flow rate
LOSS_FILE = QuantityFile(
    {
        "flow_rate": QuantityColumn("m^3/s", ("flow", "flowrate", "q"), {}),
        "loss": QuantityColumn("Pa", ("loss", "pressureloss", "pressure", "dp", "differentialpressure"), {}),
    },
    "flow [gpm], loss [psi]",
    "{flow_rate: [...], loss: [...]}",
)


class PressureLoss(Block):
    """Pressure loss of a tool in the string, such as an MWD or a filter. It scales with the density of the mud.

    A measured value with its flow rate and density scales with the flow rate squared. So does a loss coefficient K: loss
    = K density velocity^2/2
    with the velocity in the item's bore. A curve gives the losses at several flow rates.
    """

    value: Annotated[float, Quantity("Pa", at_least=0, at_most=1e9, kind="pressure")] | None = Field(
        default=None, description="pressure loss; or a coefficient, or a curve"
    )
    at: Annotated[float, Quantity("m^3/s", above=0, at_most=10)] | None = Field(
        default=None, description="flow rate of the value"
    )
    density: Annotated[float, Quantity("kg/m^3", above=0, at_most=30e3, kind="mud_weight")] | None = Field(
        default=None, description="density of the fluid of the value, or of the curve"
    )
    coefficient: Annotated[float, Quantity("", at_least=0, at_most=1e6)] | None = Field(
        default=None,
        description="loss over half the density times the squared velocity in the item's bore, instead of a value",
    )
    curve: Annotated[
        LossCurve | None, BeforeValidator(LOSS_FILE.read_if_named, json_schema_input_type=str | LossCurve)
    ] = Field(
        default=None,
        description="losses at several flow rates instead of a value: {flow_rate: [..], loss: [..]}, or a CSV file with the columns flow and "
        "loss, each with its unit in brackets",
    )

    @model_validator(mode="after")
    def _one_form(self) -> PressureLoss:
        form = "coefficient" if self.coefficient is not None else "curve" if self.curve is not None else None
        others = {"value": self.value, "at": self.at, "density": self.density, "curve": self.curve}
        for key, given in others.items():
            if form == "coefficient" and given is not None:
                got = "a curve" if key == "curve" else given
                raise refuse(key, got=got, want=f"no {key} with a coefficient")
            if form == "curve" and key in ("value", "at") and given is not None:
                raise refuse(key, got=given, want=f"no {key} with a curve")
            if form == "curve" and key == "density" and given is None:
                raise refuse(key, want="the density of the fluid of the curve")
            if form is None and key != "curve" and given is None:
                raise refuse(
                    key,
                    want="a value with its flow rate (at) and density, a coefficient, or a curve with its density",
                )
        return self

    def times(self, share: float) -> PressureLoss:
        """The loss times ``share``."""
        if self.curve is not None:
            scaled = LossCurve.model_construct(
                flow_rate=self.curve.flow_rate, loss=tuple(share * q for q in self.curve.loss)
            )
            return self.model_copy(update={"curve": scaled})
        key = "value" if self.coefficient is None else "coefficient"
        return self.model_copy(update={key: getattr(self, key) * share})

    def resistance(self, bore: float | None) -> float:
        """Loss over density and flow rate squared [1/m4] in a bore of this diameter [m]; 0 of a curve."""
        if self.curve is not None:
            return 0.0
        if self.coefficient is not None:
            assert bore
            return 0.5 * self.coefficient / (math.pi / 4 * bore**2) ** 2
        assert self.value is not None and self.density is not None and self.at is not None
        return self.value / (self.density * self.at**2)

    def of_curve(self, flow: float, density: float) -> float:
        """Loss by the curve [Pa] at a flow rate [m3/s] of a fluid [kg/m3]; 0 without a curve."""
        if self.curve is None:
            return 0.0
        assert self.density is not None
        return density / self.density * self.curve.at(flow)
