"""Columns of probes.csv."""

from __future__ import annotations

from typing import Any

import numpy as np

from drillpetsc.fem.quantity import FloatArray, Quantity, Sample


def _probe_position(probes: Any, sample: Sample) -> FloatArray:
    return np.asarray(sample.once(probes.motion)[:, :3])


def _probe_positions(probes: Any, steps: Any) -> FloatArray | None:
    motions = probes.motions(steps)
    return None if motions is None else motions[..., :3]


def _probe_spins(probes: Any, steps: Any) -> FloatArray | None:
    motions = probes.motions(steps)
    return None if motions is None else motions[..., 3]


def _probe_offset(probes: Any, positions: FloatArray, depths: FloatArray) -> FloatArray:
    return np.asarray(probes.offset(positions))


PROBES: tuple[Quantity, ...] = (
    Quantity(
        "x_NNN",
        "m",
        kind="diameter",
        on="probe",
        label="Offset to the high side at NNN m",
        mnemonic="OXNNN",
        sign="towards the high side (north in a vertical hole)",
        doc="Offset of the string's centre from the hole's axis.",
        interpolate="motion",
        value=_probe_position,
        values=_probe_positions,
        size=3,
        finish=_probe_offset,
        index=0,
    ),
    Quantity(
        "y_NNN",
        "m",
        kind="diameter",
        on="probe",
        label="Offset to the right at NNN m",
        mnemonic="OYNNN",
        sign="to the right of the high side, looking down (east in a vertical hole)",
        doc="Offset of the string's centre from the hole's axis.",
        interpolate="motion",
        value=_probe_position,
        values=_probe_positions,
        size=3,
        finish=_probe_offset,
        index=1,
    ),
    Quantity(
        "spin_NNN",
        "rad/s",
        on="probe",
        label="Spin rate at NNN m",
        mnemonic="RPMNNN",
        sign="clockwise (looking down)",
        doc="Spin rate of the string about its axis.",
        interpolate="motion",
        value=lambda probes, sample: sample.once(probes.motion)[:, 3],
        values=_probe_spins,
    ),
    Quantity(
        "contact_NNN",
        "N",
        on="probe",
        label="Contact force at NNN m",
        mnemonic="SFNNN",
        sign="push of the wall on the string, not negative",
        doc="Normal force of the wall on the element that holds the probe.",
        value=lambda probes, sample: probes.contact_force(),
        values=lambda probes, steps: probes.contact_forces(steps),
    ),
)
