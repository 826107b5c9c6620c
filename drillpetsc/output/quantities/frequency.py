"""Columns of the tables over speeds and frequencies: response.csv, campbell.csv, critical.csv, stability_map.csv, reflection.csv."""

from __future__ import annotations

from drillpetsc.fem.quantity import Quantity
from drillpetsc.output.quantities.along_string import MD
from drillpetsc.output.quantities.modes import MODES


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
        "Largest bending moment of the motion, without the steady state's moment.",
    ),
    _column(
        "clearance_use", "-", "Use of the clearance", "CLUS",
        "Lateral amplitude over the radial clearance; nan without a hole.",
    ),
    _column(
        "validity", "-", "Validity of the linear result", "VALD",
        "Linear: the result holds; touches: the amplitude closes an open gap somewhere; lifts: it opens a closed contact; infinite: an "
        "undamped resonance.",
    ),
)  # fmt: skip

#: more columns of the response, with --stress
RESPONSE_STRESS: tuple[Quantity, ...] = (
    _column(
        "stress_amplitude", "Pa", "Amplitude of the stress", "STAM",
        "Largest alternating normal stress at the surface of the pipe that turns: axial force and bending of the response, and bending of the "
        "steady state.", "tension",
    ),
    _column(
        "shear_stress_amplitude", "Pa", "Amplitude of the shear stress", "SSAM", "Of the torque of the response, at the surface of the pipe."
    ),
    _column("mean_stress", "Pa", "Mean stress", "MNST", "Of the axial force of the steady state.", "tension"),
)  # fmt: skip

_MODE = {q.name: q for q in MODES}
BRANCH = _column(
    "branch", "-", "Branch", "BRCH", "Number of a mode that is followed over the speeds, from 1."
)
WHIRL_SENSE = _column(
    "whirl_sense",
    "-",
    "Sense of the whirl",
    "WHSE",
    "Sense of the orbits, forward with the rotation; mixed if neither prevails, none for other kinds of modes.",
)
CAMPBELL: tuple[Quantity, ...] = (
    ROTARY_SPEED,
    BRANCH,
    _MODE["frequency"],
    _column(
        "natural_frequency", "Hz", "Natural frequency", "NFRQ", "Size of the eigenvalue over 2 pi, damping included."
    ),
    _MODE["damping_ratio"],
    _column(
        "log_decrement", "-", "Logarithmic decrement", "LDEC", "Logarithm of the ratio of successive peaks; inf without oscillation.",
        "the mode decays",
    ),
    _MODE["growth"],
    _MODE["kind"],
    WHIRL_SENSE,
    _column(
        "mac", "-", "Modal assurance", "MAC", "Agreement of the shape with the shape at the speed before; 1 at the first speed."
    ),
    _column(
        "tracking", "-", "State of the tracking", "TRCK",
        "Tracked; at the end of a branch lost (no shape agrees at the next speed), outside (above the modes computed) or rest (no friction at 0 rpm).",
    ),
)  # fmt: skip

_CRITICAL_SPEED = _column(
    "critical_rotary_speed",
    "rpm",
    "Critical rotary speed",
    "CSPD",
    "Rotary speed at which the line meets the branch, interpolated.",
)
CRITICAL: tuple[Quantity, ...] = (
    BRANCH,
    _MODE["kind"],
    WHIRL_SENSE,
    _column(
        "excitation", "-", "Kind of the excitation", "XKND",
        "Turn: cycles per turn of the string; motor: the orbit of a motor's rotor.",
    ),
    _column("excitation_line", "-", "Excitation line", "XLIN", "Cycles of the excitation per turn."),
    _CRITICAL_SPEED,
    _MODE["frequency"],
    _MODE["damping_ratio"],
    _column(
        "amplification", "-", "Amplification", "AMPL",
        "Half the inverse of the damping ratio; inf without damping, nan for a mode that grows.",
    ),
    _column(
        "speed_margin", "%", "Margin to the speed of the case", "SMRG",
        "Critical speed minus speed of the case, over the latter; nan for a case that does not turn.", "the critical speed is higher",
    ),
)  # fmt: skip
CRITICAL_MAP: tuple[Quantity, ...] = (
    _column("wall_stiffness", "Pa", "Stiffness of the wall", "WSTF", "Force per length and penetration."),
    *CRITICAL[:5],
    _CRITICAL_SPEED,
    _MODE["frequency"],
)

WEIGHT = _column(
    "weight_on_bit", "N", "Weight on bit of the state", "WOBS", "Weight on bit of the steady state."
)
STABILITY_MAP: tuple[Quantity, ...] = (
    ROTARY_SPEED,
    WEIGHT,
    _column(
        "largest_growth", "1/s", "Largest growth rate", "LGRW", "Largest real part of the eigenvalues that were found.",
        "steady motion is unstable",
    ),
    _MODE["frequency"],
    _MODE["kind"],
    _column(
        "state_imbalance", "N", "Unbalanced force of the state", "SIMB",
        "Largest force on a node that is not in equilibrium in the steady state.",
    ),
)  # fmt: skip
STABILITY_BOUNDARY: tuple[Quantity, ...] = (
    WEIGHT,
    _column(
        "boundary_speed", "rpm", "Speed of the stability boundary", "BSPD", "Rotary speed at which the largest growth changes its sign."
    ),
    _column("stable_side", "-", "Stable side", "SSID", "Stable above or below this speed."),
)  # fmt: skip
STABILITY_RUNS: tuple[Quantity, ...] = (
    ROTARY_SPEED,
    WEIGHT,
    _column(
        "run_stick_slip_index", "-", "Stick-slip index", "SSIR", "Difference of largest and smallest over twice the mean of the bit's speed in the last third of the run."
    ),
    _column("run_stick_slip_index_before", "-", "Stick-slip index before", "SSIB", "The same in the third before."),
    _column("run_stuck_share", "-", "Share of the time at rest", "STSH", "Share of the last third in which the bit is below 1 rpm."),
    _column(
        "run_behaviour", "-", "Behaviour", "BHVR", "One of steady, decays, grows, stick_slip, or failed if the run could not be computed."
    ),
)  # fmt: skip

REFLECTION: tuple[Quantity, ...] = (
    Quantity(
        "controller",
        "-",
        on="item",
        label="Controller",
        mnemonic="CTRL",
        doc="Number of the controller in the case, from 1.",
    ),
    Quantity(
        "wave_frequency",
        "Hz",
        on="item",
        label="Frequency of the wave",
        mnemonic="WFRQ",
        sign="positive",
        doc="Frequency of a torsional wave.",
    ),
    Quantity(
        "reflection",
        "-",
        on="item",
        label="Reflected part of the wave",
        mnemonic="RFL",
        doc="Amplitude of the reflected wave over amplitude of the incoming wave.",
    ),
)
