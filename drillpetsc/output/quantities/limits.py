"""Quantities of the command `limits`: limits.csv along the string, contacts.csv by item."""

from __future__ import annotations

from drillpetsc.fem.quantity import Quantity
from drillpetsc.output.quantities.along_string import (
    AXIAL_FORCE,
    BENDING_MOMENT,
    EFFECTIVE_TENSION,
    INCLINATION,
    MD,
    TORQUE,
)
from drillpetsc.output.quantities.hydraulics import LOSS_ROWS
from drillpetsc.output.quantities.mud import MUD_FIELDS
from drillpetsc.output.quantities.statics import CURVATURE
from drillpetsc.output.quantities.torque_drag import ROADMAP
from drillpetsc.output.quantities.trajectory import TRAJECTORY
from drillpetsc.physics.quantities import CONTACT

_PRESSURE = {q.name: q for q in MUD_FIELDS}
_TVD = next(q for q in TRAJECTORY if q.name == "tvd")
_CONTACT_FORCE = next(q for q in CONTACT if q.name == "contact_force")
_BUCKLING_STATE = next(q for q in ROADMAP if q.name == "buckling_state")


def _node(
    name: str, unit: str, label: str, mnemonic: str, doc: str, sign: str = "not negative", kind: str = ""
) -> Quantity:
    return Quantity(name, unit, on="node", label=label, mnemonic=mnemonic, doc=doc, sign=sign, kind=kind)


def _item(
    name: str, unit: str, label: str, mnemonic: str, doc: str, sign: str = "", kind: str = ""
) -> Quantity:
    return Quantity(name, unit, on="item", label=label, mnemonic=mnemonic, doc=doc, sign=sign, kind=kind)


ITEM = next(q for q in LOSS_ROWS if q.name == "item")
_WHERE_KNOWN = "nan without a yield strength."
LIMITS: tuple[Quantity, ...] = (
    MD,
    _TVD,
    ITEM,
    _item("grade", "-", "Grade", "GRAD", "Steel grade; - if the case names none."),
    _item("class", "-", "Class", "CLAS", "Class of wear of drill pipe; - for other items."),
    INCLINATION,
    EFFECTIVE_TENSION,
    AXIAL_FORCE,
    TORQUE,
    BENDING_MOMENT,
    CURVATURE,
    _PRESSURE["internal_pressure"],
    _PRESSURE["annulus_pressure"],
    _node(
        "axial_stress",
        "Pa",
        "Axial stress",
        "ASTR",
        "Axial force over the worn section.",
        "tension positive",
        "stress",
    ),
    _node(
        "worst_bending_stress",
        "Pa",
        "Bending stress of the worn tube",
        "WBST",
        "At the outer fibre of the worn tube, beside tool joints, where tension concentrates the bending (Lubinski 1961).",
        kind="stress",
    ),
    _node(
        "torsional_stress",
        "Pa",
        "Torsional stress",
        "TSTR",
        "Of the torque, at the outer fibre.",
        kind="stress",
    ),
    _node(
        "hoop_stress",
        "Pa",
        "Hoop stress",
        "HSTR",
        "At the bore, by Lame.",
        "tension positive",
        "stress",
    ),
    _node(
        "von_mises",
        "Pa",
        "Von Mises stress",
        "VMIS",
        "Largest of inner and outer fibre, on the worse side of the bend.",
        kind="stress",
    ),
    _node(
        "yield_strength",
        "Pa",
        "Yield strength",
        "YLDS",
        "Of the pipe, by its grade; nan if unknown.",
        kind="stress",
    ),
    _node(
        "safety_factor", "-", "Safety factor", "SAFF", f"Yield strength over von Mises stress; {_WHERE_KNOWN}"
    ),
    _node(
        "tension_limit",
        "N",
        "Tension limit",
        "TLIM",
        f"Yield strength times worn section times tension_fraction; {_WHERE_KNOWN}",
    ),
    _node(
        "torque_limit",
        "N m",
        "Torque limit",
        "QLIM",
        f"Torque at which the worn tube yields under its axial force (API RP 7G); {_WHERE_KNOWN}",
    ),
    _node(
        "tension_ratio",
        "-",
        "Tension over limit",
        "TRAT",
        f"Axial force over tension limit; {_WHERE_KNOWN}",
        "tension positive",
    ),
    _node(
        "make_up_torque",
        "N m",
        "Make-up torque",
        "MUTQ",
        "Make-up torque of the tool joints; empty if the threads are unknown.",
    ),
    _node(
        "make_up_ratio",
        "-",
        "Torque over make-up torque",
        "MRAT",
        "Torque over make-up torque; above 1 the connection makes up further in the hole.",
    ),
    _node("torque_ratio", "-", "Torque over limit", "QRAT", f"Torque over torque limit; {_WHERE_KNOWN}"),
    _node(
        "sinusoidal_limit",
        "N",
        "Sinusoidal buckling limit",
        "SLIM",
        "Dawson and Paslay (1984); below 3 deg of inclination 1.94 (EI w^2)^(1/3), Lubinski (1950); nan without a wall.",
        "compression",
    ),
    _node(
        "helical_limit",
        "N",
        "Helical buckling limit",
        "HLIM",
        "Chen et al. (1990) or Wu and Juvkam-Wold (1993); below 3 deg 3.75 (EI w^2)^(1/3), Lubinski (1950).",
        "compression",
    ),
    _BUCKLING_STATE,
    _CONTACT_FORCE,
    _node(
        "side_force_per_joint",
        "N",
        "Side force per joint",
        "SFOJ",
        "Push of the wall on a joint of pipe whose middle is here; nan for pipe without joints.",
    ),
    _node(
        "fatigue_dls",
        "1/m",
        "Permissible dogleg",
        "FDLS",
        "Curvature in which drill pipe may rotate without fatigue (API RP 7G); nan in compression, and for other grades.",
    ),
    _node("fatigue_ratio", "-", "Dogleg over permissible", "FRAT", "Curvature over permissible dogleg."),
    _node(
        "burst_ratio",
        "-",
        "Inside pressure over burst",
        "BURR",
        "Pressure inside above that outside, over the pressure at which the tube yields (Barlow, API RP 7G); 0 the other way.",
    ),
    _node(
        "collapse_ratio",
        "-",
        "Outside pressure over collapse",
        "COLR",
        "Pressure outside above that inside, over the collapse pressure under the tension there (API 5C3); 0 the other way.",
    ),
    _node(
        "damage_per_hour",
        "1/h",
        "Miner's damage per hour",
        "DMGH",
        "Damage of an hour of rotation by the S-N curve of --sn, 1 at failure; nan above the curve. Only with --sn.",
    ),
    _node(
        "casing_wear_rate",
        "W/m",
        "Rate of casing wear",
        "CWRT",
        "Side force on a joint over its length (default 31 ft), times the sliding speed of the turning string; nan below the casing. Times a wear factor and time it is the worn volume per length.",
    ),
)

CONTACTS: tuple[Quantity, ...] = (
    ITEM,
    _item("item_kind", "-", "Kind of item", "IKND", "Kind of the item."),
    MD,
    _item(
        "side_force",
        "N",
        "Side force",
        "SFRC",
        "Resultant of the wall's normal forces on an item; for pipe, from their components summed over its length.",
        "push of the wall on the string",
    ),
    _item(
        "side_high",
        "N",
        "Side force to the high side",
        "SFHI",
        "Component to the high side (vertical hole: north) of the wall's forces across the hole, friction included.",
        "on the string to the high side; the bit pushes the rock to the other side",
    ),
    _item(
        "side_right",
        "N",
        "Side force to the right",
        "SFRI",
        "Component to the right of the high side of the wall's forces across the hole, friction included.",
        "on the string to the right, looking down",
    ),
    _item(
        "side_couple",
        "N m",
        "Couple of the wall",
        "SCPL",
        "Size of the couple across the hole of the wall's forces about the middle of a rigid item; nan for pipe.",
        "not negative",
    ),
    _item(
        "contact_force_sum",
        "N",
        "Sum of contact forces",
        "CSUM",
        "Sum of the sizes of the wall's normal forces, from which friction follows.",
        "not negative",
    ),
    _item(
        "direction",
        "rad",
        "Direction of the side force",
        "SFDR",
        "Direction of the side force on a rigid item; nan without contact and for pipe.",
        "from the high side (north below 5 deg), clockwise looking down",
    ),
    _item(
        "gap",
        "m",
        "Gap",
        "GAPW",
        "Least distance of a rigid item from the wall, at its middle and both ends.",
        "negative if the item presses into the wall",
        "diameter",
    ),
    _item("axial_drag", "N", "Axial drag", "DRAG", "Force of the wall along the hole.", "down the hole"),
    _item(
        "contact_torque", "N m", "Torque of the wall", "CTRQ", "Torque of friction on the item.", "clockwise"
    ),
    _item(
        "tilt",
        "rad",
        "Tilt",
        "TILT",
        "Angle between the axis of a rigid item and the hole axis (for the bit: bit tilt).",
        "not negative",
    ),
    _item(
        "tilt_direction",
        "rad",
        "Direction of the tilt",
        "TLDR",
        "Direction to which the lower end points.",
        "from the high side (north below 5 deg), clockwise looking down",
    ),
)
