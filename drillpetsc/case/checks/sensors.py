"""Checks of the sensors against string, mud and run."""

from __future__ import annotations

from drillpetsc.case.blocks.case_blocks import CaseBlocks
from drillpetsc.case.blocks.sensors import Sensor, sensor_depth
from drillpetsc.case.key_paths import refuse, suggestion
from drillpetsc.case.quantities import said

LENGTH_TOLERANCE = 1e-6  # [m]
MAX_SAMPLES = 10**9
MAX_WINDOWS = 10**5


def check_sensors(case: CaseBlocks) -> None:
    """Raise on the first sensor that this string and this run cannot have."""
    indices, end = case.output.indices, 0.0 if case.time is None else case.time.end
    if indices is not None and end > MAX_WINDOWS * indices.every:
        want = f"at least {end / MAX_WINDOWS:g} s: {MAX_WINDOWS:g} windows in the run"
        raise refuse("output", "indices", "every", got=indices.every, want=want)
    for i, sensor in enumerate(case.output.sensors):
        at = "output", "sensors", i
        if case.hold_string:
            raise refuse(*at, got=sensor.name, want="no sensors with hold_string: the string does not move")
        if case.time is not None and case.time.mode != "dynamic":
            raise refuse(*at, got=sensor.name, want="no sensors in a quasi_static run, which has no motion")
        depth = _depth(case, i, sensor)
        _place(case, i, sensor, depth)
        if "pressure" in sensor.channels and not (case.has_bore or case.has_annulus):
            raise refuse(
                *at, "channels", got="pressure", want="no channel pressure without mud", hint="give a fluid"
            )
        if case.time is not None and sensor.rate * case.time.end > MAX_SAMPLES:
            raise refuse(
                *at,
                "rate",
                got=f"{sensor.rate:g} Hz",
                want=f"at most {MAX_SAMPLES / case.time.end:g} Hz: {MAX_SAMPLES:g} samples in the run",
            )


def _depth(case: CaseBlocks, i: int, sensor: Sensor) -> float:
    depth = sensor_depth(case.string, case.item_depths, sensor)
    if depth is None:
        names = [item.name for item in case.string if getattr(item, "name", "")]
        twice = names.count(str(sensor.at)) > 1
        want = (
            "a measured depth: several items have this name"
            if twice
            else "a measured depth, or an item's name"
        )
        hint = (
            ""
            if twice
            else suggestion(str(sensor.at), names) or f"items: {', '.join(names) or 'without names'}"
        )
        raise refuse("output", "sensors", i, "at", got=sensor.at, want=want, hint=hint)
    if depth > case.string_length + LENGTH_TOLERANCE:
        want = f"a measured depth on the string, 0 to {said(case.string_length, 'length')}"
        raise refuse("output", "sensors", i, "at", got=depth, want=want)
    return depth


def _place(case: CaseBlocks, i: int, sensor: Sensor, depth: float) -> None:
    """Raise if the accelerometers are outside the pipe."""
    if not sensor.radius:
        return
    for item, (above, below) in zip(case.string, case.item_depths, strict=True):
        od = getattr(item, "od", None)
        if above - LENGTH_TOLERANCE <= depth <= below + LENGTH_TOLERANCE and od is not None:
            if sensor.radius <= 0.5 * od:
                return
            last = od
        elif above - LENGTH_TOLERANCE <= depth <= below + LENGTH_TOLERANCE:
            return  # without a diameter there is nothing to compare with
    want = f"at most {said(0.5 * last, 'diameter')}, half the outer diameter of the string at {said(depth, 'length')}"
    raise refuse("output", "sensors", i, "radius", got=sensor.radius, want=want)
