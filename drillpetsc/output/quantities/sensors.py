"""Columns of the files of sensors."""

from __future__ import annotations

from typing import Any

from drillpetsc.fem.quantity import Quantity
from drillpetsc.output.quantities.along_string import STRING_FIELDS
from drillpetsc.output.quantities.history import TIME
from drillpetsc.output.quantities.mud import MUD_FIELDS


def _column(name: str, unit: str, label: str, mnemonic: str, sign: str, doc: str, **more: Any) -> Quantity:
    return Quantity(name, unit, on="item", label=label, mnemonic=mnemonic, sign=sign, doc=doc, **more)


_AXES = {
    "ax": ("Acceleration along the string", "ACX", "downward along the string"),
    "ay": ("Acceleration outward", "ACY", "towards the accelerometers, from the axis"),
    "az": ("Acceleration sideways", "ACZ", "to the right of ay, looking down"),
}
ACCELERATIONS = tuple(
    _column(
        name,
        "m/s2",
        label,
        mnemonic,
        sign,
        "Reading of an accelerometer, less gravity unless the sensor has gravity: false.",
    )
    for name, (label, mnemonic, sign) in _AXES.items()
)
MOTIONS = tuple(
    _column(
        f"{name}_motion",
        "m/s2",
        f"{label}, without gravity",
        f"{mnemonic}M",
        sign,
        "Acceleration of the place of the accelerometers.",
    )
    for name, (label, mnemonic, sign) in _AXES.items()
)
SPIN = next(q for q in STRING_FIELDS if q.name == "spin")
SPIN_ACCELERATION = _column(
    "spin_acceleration",
    "rad/s2",
    "Spin acceleration",
    "ACT",
    "clockwise (looking down)",
    "Rate of the spin rate.",
)
MAGNETIC_RATE = _column(
    "magnetic_rate",
    "rad/s",
    "Magnetic tool-face rate",
    "RPMM",
    "clockwise (looking down)",
    "Rate of the angle of the magnetic field in the section: a magnetometer.",
)
TORQUE = _column(
    "downhole_torque",
    "N m",
    "Torque in the string",
    "TQA",
    "as the surface torque: the part above turns the part below clockwise",
    "Torque in the section.",
)
WOB = _column(
    "downhole_wob",
    "N",
    "Downhole weight",
    "DWOB",
    "compression",
    "Compression of the section: the effective tension with opposite sign.",
)
BENDING = (
    _column(
        "bending_y",
        "N m",
        "Bending moment towards ay",
        "BMY",
        "bends the string towards ay",
        "Bending moment of the element's shape, beyond the stress-free one; turns with the pipe.",
    ),
    _column(
        "bending_z",
        "N m",
        "Bending moment towards az",
        "BMZ",
        "bends the string towards az",
        "Bending moment of the element's shape, beyond the stress-free one; turns with the pipe.",
    ),
)
PRESSURES = {
    name: next(q for q in MUD_FIELDS if q.name == f"{part}_pressure")
    for name, part in (("bore", "internal"), ("annulus", "annulus"))
}

SENSORS = (
    TIME,
    *ACCELERATIONS,
    SPIN,
    MAGNETIC_RATE,
    TORQUE,
    WOB,
    *BENDING,
    *PRESSURES.values(),
    *MOTIONS,
    SPIN_ACCELERATION,
)


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
        chosen |= {PRESSURES[name].name for name in pressures}
    if motion and sensor.accelerations:
        chosen |= {f"{name}_motion" for name in sensor.accelerations if sensor.gravity}
        if sensor.radius:
            chosen |= {"spin_acceleration"}
    return tuple(q for q in SENSORS if q.name in chosen)
