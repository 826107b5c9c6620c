"""Measured points with the loads on hook and bit in place of what the instruments show (manual: sec-roadmap-sensor)."""

from __future__ import annotations

from collections.abc import Sequence

from drillpetsc.analysis.hydraulics.flow_model import FlowModel, string_at
from drillpetsc.analysis.hydraulics.losses import balance
from drillpetsc.analysis.loads.torque_drag.operations import load_of, plan_of
from drillpetsc.analysis.loads.torque_drag.readings.calibration import Calibration
from drillpetsc.analysis.loads.torque_drag.readings.sensor import DIRECTION, sensor_of
from drillpetsc.case.blocks.ends import BitBottom
from drillpetsc.case.blocks.roadmap import MeasuredPoint
from drillpetsc.case.case import Case


def corrected_points(
    case: Case, points: Sequence[MeasuredPoint], excludes_block: bool
) -> tuple[MeasuredPoint, ...]:
    """Points with the weight on the hook in place of the readings, and their standard errors with it. Weights on bit are
    corrected for an old zero and for the pressure drop of the bit.

    excludes_block: the instrument subtracts the block, whose weight is on the line all the same.
    """
    sensor, out = sensor_of(case), []
    points = _with_pump_off(case, _zeroed(case, points))
    block = (case.rig.block_weight if case.rig is not None else None) or 0.0
    hidden = block if excludes_block else 0.0
    for point in points:
        factor = sensor.factor(DIRECTION[point.operation])
        if point.hook_load is not None and factor != 1.0:
            weight = factor * (point.hook_load + hidden) - hidden
            sigma = None if point.sigma is None else factor * point.sigma
            point = point.model_copy(update={"hook_load": weight, "sigma": sigma})
        out.append(point)
    return tuple(out)


def _zeroed(case: Case, points: Sequence[MeasuredPoint]) -> Sequence[MeasuredPoint]:
    """Points whose weight on bit is the hook load off bottom at their own depth and flow rate less the hook load on bottom.

    The indicator subtracts the hook load from the one at zeroing. It lacks what the string has gained in weight since.
    """
    zero = None if case.rig is None else case.rig.wob_zero
    number = [i for i, p in enumerate(points) if p.operation in ("drilling", "sliding") and p.wob is not None]
    if zero is None or not number:
        return points
    off = [
        MeasuredPoint(
            bit_depth=depth, operation="rotate_off_bottom", hook_load=0.0, rpm=rpm, flow_rate=flow or 0.0
        )
        for depth, rpm, flow in [
            (zero.bit_depth, None, zero.flow_rate),
            *((points[i].bit_depth, points[i].rpm, points[i].flow_rate) for i in number),
        ]
    ]
    weight = Calibration(case, tuple(off)).computed([{}])[0]
    out = list(points)
    for i, now in zip(number, weight[1:], strict=True):
        wob = max((points[i].wob or 0.0) + float(now - weight[0]), 0.0)
        out[i] = points[i].model_copy(update={"wob": wob})
    return out


def _with_pump_off(case: Case, points: Sequence[MeasuredPoint]) -> Sequence[MeasuredPoint]:
    """Points whose weight on bit is the weight read plus the pressure drop of the bit times `bottom.pump_off_area`."""
    bottom = case.bottom
    if not isinstance(bottom, BitBottom) or not bottom.pump_off_area:
        return points
    drops: dict[float, float] = {}
    out = []
    for point in points:
        flow = point.flow_rate
        if flow is None and point.operation in ("drilling", "sliding"):
            flow = load_of(case, plan_of(case), point.operation).flow
        if flow and point.wob is not None:
            if flow not in drops:
                model = FlowModel(case, string_at(case, point.bit_depth), "pumping")
                model.solve(flow)
                drops[flow] = balance(model)["bit_loss"]
            wob = point.wob + drops[flow] * bottom.pump_off_area
            point = point.model_copy(update={"wob": wob})
        out.append(point)
    return out
