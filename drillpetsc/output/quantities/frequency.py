"""Columns of the tables over rotary speeds: response.csv, campbell.csv, critical.csv, stability_map.csv."""

from __future__ import annotations

from drillpetsc.fem.quantity import Quantity
from drillpetsc.output.quantities.along_string import MD


def _column(
    name: str, unit: str, label: str, mnemonic: str, doc: str, sign: str = "not negative", kind: str = ""
) -> Quantity:
    return Quantity(name, unit, on="item", label=label, mnemonic=mnemonic, sign=sign, doc=doc, kind=kind)


ROTARY_SPEED = _column("rotary_speed", "rpm", "Rotary speed", "RSPD", "Speed at which the string turns.")

RESPONSE: tuple[Quantity, ...] = (
    ROTARY_SPEED,
    _column(
        "excitation_frequency", "Hz", "Frequency of the excitation", "EXFR", "Frequency of excitation and response."
    ),
    _column("place", "-", "Place", "PLAC", "Place along the string: top, a probe, a rigid item, lower end."),
    MD,
    _column(
        "lateral_amplitude", "m", "Lateral amplitude", "LATA", "Half the long axis of the orbit; inf at an undamped resonance."
    ),
    _column(
        "lateral_phase",
        "deg",
        "Phase of the lateral motion",
        "LATP",
        "Phase of the larger of the forward and the backward whirl against the excitation.",
        "ahead of the excitation",
    ),
    _column(
        "whirl",
        "-",
        "Sense of whirl",
        "WHRL",
        "Short over long axis of the orbit: 1 forward circle, 0 straight line, -1 backward circle.",
        "forward: with the rotation",
    ),
    _column("axial_amplitude", "m", "Axial amplitude", "AXIA", "Amplitude of the motion along the string.", kind="diameter"),
    _column(
        "axial_phase", "deg", "Phase of the axial motion", "AXIP",
        "Phase of the motion down the string against the excitation.", "ahead of the excitation",
    ),
    _column("twist_amplitude", "rad", "Amplitude of the twist", "TWIA", "Amplitude of the angle about the axis."),
    _column(
        "twist_phase", "deg", "Phase of the twist", "TWIP", "Phase of that angle against the excitation.",
        "ahead of the excitation",
    ),
    _column("axial_force_amplitude", "N", "Amplitude of the axial force", "AXFA", "Amplitude of the tension in the pipe."),
    _column("torque_amplitude", "N m", "Amplitude of the torque", "TRQA", "Amplitude of the torque in the pipe."),
    _column(
        "bending_moment_amplitude", "N m", "Amplitude of the bending moment", "BMAM",
        "Largest bending moment of the motion, without that of the steady state.",
    ),
    _column(
        "clearance_use", "-", "Use of the clearance", "CLUS",
        "Lateral amplitude over the radial clearance; nan without a hole.",
    ),
    _column(
        "validity", "-", "Validity of the linear result", "VALD",
        "Linear where the result holds; touches: the amplitude closes an open gap somewhere; lifts: it opens a closed contact; infinite: an "
        "undamped resonance.",
    ),
)  # fmt: skip
