"""Quantities of the commands `roadmap` and `calibrate`."""

from __future__ import annotations

from drillpetsc.fem.quantity import Quantity
from drillpetsc.output.quantities.history import HOOK_LOAD_TOTAL, LOWER_END
from drillpetsc.output.quantities.hydraulics import SURGE
from drillpetsc.output.quantities.statics import STATIC_SUMMARY
from drillpetsc.physics.quantities import BIT

_STATIC = {q.name: q for q in STATIC_SUMMARY}
_BIT = {q.name: q for q in BIT}
_DEPTH = next(q for q in LOWER_END if q.name == "bit_depth")


def _row(
    name: str, unit: str, label: str, mnemonic: str, doc: str, sign: str = "", kind: str = ""
) -> Quantity:
    return Quantity(name, unit, on="item", label=label, mnemonic=mnemonic, doc=doc, sign=sign, kind=kind)


OPERATION = SURGE[0]
FF_CASED = _row("ff_cased", "-", "Friction factor, cased", "FFCS", "Friction coefficient in cased hole.")
FF_OPEN_HOLE = _row(
    "ff_open_hole", "-", "Friction factor, open hole", "FFOH", "Friction coefficient in open hole."
)
FF_GROUPS = _row(
    "ff_groups",
    "-",
    "Friction factors of groups",
    "FFGR",
    "Friction coefficients of the further groups of sections, by name.",
)
ROADMAP: tuple[Quantity, ...] = (
    _DEPTH,
    OPERATION,
    FF_CASED,
    FF_OPEN_HOLE,
    FF_GROUPS,
    _STATIC["hook_load"],
    HOOK_LOAD_TOTAL,
    _row(
        "hook_load_reading",
        "N",
        "Hook load as read",
        "HKLR",
        "What a sensor in the dead line indicates for the total hook load.",
        "the hook pulls up",
    ),
    _STATIC["surface_torque"],
    _STATIC["stretch"],
    _STATIC["twist"],
    _STATIC["wob"],
    _row(
        "min_effective_tension",
        "N",
        "Smallest effective tension",
        "TMIN",
        "Smallest effective axial force along the string.",
        "tension",
    ),
    _row("md_of_min", "m", "Depth of the smallest tension", "MTMN", "Measured depth of that place."),
    _row(
        "neutral_point",
        "m",
        "Neutral point",
        "NEUT",
        "Measured depth of the first place from the top without effective tension; empty if the top is in compression.",
    ),
    _row(
        "sinusoidal_ratio",
        "-",
        "Compression over the sinusoidal limit",
        "SRAT",
        "Largest compression along the string over the load at which it buckles sinusoidally there; 0 in tension throughout.",
    ),
    _row(
        "helical_ratio",
        "-",
        "Compression over the helical limit",
        "HRAT",
        "The same of the load at which it coils.",
    ),
    _row(
        "buckling_state",
        "-",
        "Buckling",
        "BUCK",
        "State by the limits: none, sinusoidal, helical, lock_up; of the whole string the worst; - without a limit in compression.",
    ),
    _row(
        "max_side_force_per_joint",
        "N",
        "Largest side force per joint",
        "SFJX",
        "Largest wall force over the length of a joint of the item (default 31 ft).",
        "not negative",
    ),
    _row(
        "min_safety_factor",
        "-",
        "Smallest safety factor",
        "SFAC",
        "Yield strength over von Mises stress of the worn section, smallest along the items with a yield strength.",
    ),
    _row(
        "overpull_margin",
        "N",
        "Overpull margin",
        "OPMG",
        "Smallest difference of 0.9 times yield strength and worn area from the tension in the wall.",
        "pull left",
    ),
    _row("status", "-", "Status", "STAT", "Why the row is unreliable, otherwise ok."),
)
MEASURED: tuple[Quantity, ...] = (
    _DEPTH,
    OPERATION,
    _row(
        "compared",
        "-",
        "Compared reading",
        "CMPD",
        "Quantity compared in the row: hook_load or surface_torque.",
    ),
    _row("measured", "N or N m", "Measured", "MEAS", "The reading, as in the file.", "pull, resistance"),
    _row(
        "computed",
        "N or N m",
        "Computed",
        "COMP",
        "The soft string's value, with the fitted factors or with the friction of the case; empty if the string cannot be there.",
        "pull, resistance",
    ),
    _row(
        "residual",
        "N or N m",
        "Residual",
        "RESI",
        "Computed less measured, as corrected.",
        "computed above measured",
    ),
    _row(
        "sigma",
        "N or N m",
        "Standard error",
        "SIGM",
        "Standard error of the reading.",
        "not negative",
    ),
    _row("part", "-", "Part", "PART", "Whether the reading was fitted or held_out, and then predicted."),
    _row(
        "band",
        "N or N m",
        "Half width of the band",
        "BAND",
        "Half width of the 90 % band of a prediction; empty for a reading that was fitted.",
        "not negative",
    ),
    _row(
        "ff_open_hole_alone",
        "-",
        "Friction factor of the point alone",
        "FFPT",
        "Open-hole factor that meets this point alone, with the cased factor as fitted; empty if there is none from 0 to 1.",
    ),
)
#: after the time; COLUMN stands for the name of a column of history.csv, whose unit the columns have
CALIBRATION_SERIES: tuple[Quantity, ...] = (
    _row(
        "COLUMN read",
        "-",
        "Read",
        "CRED",
        "Reading of the log, as a column of history.csv; empty where nothing was read.",
        kind="none",
    ),
    _row(
        "COLUMN computed", "-", "Computed", "CCMP", "The same, computed with the fitted numbers.", kind="none"
    ),
)

_CALIBRATED = {q.name: q for q in MEASURED}
BESIDE: tuple[Quantity, ...] = (
    _DEPTH,
    OPERATION,
    _CALIBRATED["compared"],
    _CALIBRATED["measured"],
    _row(
        "corrected",
        "N or N m",
        "Corrected reading",
        "CORR",
        "The weight on the hook that a sensor in the dead line reads so; otherwise the reading.",
        "pull, resistance",
    ),
    _CALIBRATED["computed"],
    _CALIBRATED["residual"],
    _CALIBRATED["sigma"],
    _row(
        "band_low",
        "N or N m",
        "Lower end of the band",
        "BNDL",
        "Smallest value over the friction factors of the roadmap, less 1.645 standard errors.",
        "pull, resistance",
    ),
    _row(
        "band_high",
        "N or N m",
        "Upper end of the band",
        "BNDH",
        "Largest value over the friction factors of the roadmap, plus 1.645 standard errors.",
        "pull, resistance",
    ),
)
