"""Columns of history.csv: the row itself, ends of the string, drilled hole."""

from __future__ import annotations

from drillpetsc.fem.quantity import Quantity

TIME = Quantity(
    "time",
    "s",
    on="scalar",
    label="Time",
    mnemonic="TIME",
    doc="Simulated time.",
    interpolate="none",
    mean=False,
    value=lambda row, sample: row.time,
    numerics=True,
)
STEP = Quantity(
    "step",
    "s",
    on="scalar",
    label="Time step",
    mnemonic="STEP",
    doc="Last time step before the row.",
    interpolate="none",
    mean=False,
    value=lambda row, sample: row.step,
    panel=11,
    numerics=True,
)
NEWTON = Quantity(
    "newton",
    "-",
    on="scalar",
    label="Newton iterations",
    mnemonic="NEWT",
    doc="Newton iterations of the last time step before the row.",
    interpolate="none",
    mean=False,
    value=lambda row, sample: row.newton,
    panel=12,
    numerics=True,
)
ROW_START, ROW_END = (TIME,), (STEP, NEWTON)

TOP_END: tuple[Quantity, ...] = (
    Quantity(
        "hook_load",
        "N",
        on="scalar",
        label="Hook load",
        mnemonic="HKLD",
        sign="the drive pulls the string up",
        doc="Pull of the top on the string: the reaction, or the given force.",
        value=lambda top, sample: top.hook_load(sample),
        panel=1,
        interest=3,
    ),
    Quantity(
        "surface_torque",
        "N m",
        on="scalar",
        label="Surface torque",
        mnemonic="STOR",
        sign="the drive turns the string clockwise (looking down)",
        doc="Torque of the drive on the string.",
        value=lambda top, sample: top.surface_torque(sample),
        panel=3,
        interest=6,
    ),
)
HOOK_LOAD_TOTAL = Quantity(
    "hook_load_total",
    "N",
    on="scalar",
    label="Total hook load",
    mnemonic="HKLX",
    sign="the hook pulls up",
    doc="Hook load and the weight of the block.",
    value=lambda top, sample: top.hook_load_total(sample),
    panel=1,
)
LOWER_END: tuple[Quantity, ...] = (
    Quantity(
        "bit_speed",
        "rad/s",
        on="scalar",
        label="Bit speed",
        mnemonic="BRPM",
        sign="clockwise (looking down)",
        doc="Spin rate of the lower end of the string.",
        interpolate="motion",
        value=lambda end, sample: sample.once(end.motion)[3],
        panel=4,
        interest=1,
    ),
    Quantity(
        "bit_depth",
        "m",
        on="scalar",
        label="Bit depth",
        mnemonic="DBTM",
        sign="down",
        doc="Measured depth of the face of the string's lower end.",
        interpolate="motion",
        mean=False,
        value=lambda end, sample: sample.once(end.motion)[:3],
        size=3,
        finish=lambda end, point, depth: (end.depth_of(point),),
        panel=5,
        interest=5,
    ),
)
HOLE: tuple[Quantity, ...] = (
    Quantity(
        "hole_depth",
        "m",
        on="scalar",
        label="Hole depth",
        mnemonic="DMEA",
        sign="down",
        doc="Measured depth of the end of the hole.",
        interpolate="motion",
        mean=False,
        value=lambda hole, sample: sample.once(hole.bit.progress)[0],
        finish=lambda hole, drilled, depth: (hole.start + drilled[0],),
        panel=5,
    ),
    Quantity(
        "rop",
        "m/s",
        kind="rop",
        on="scalar",
        label="Rate of penetration",
        mnemonic="ROP",
        sign="the hole grows",
        doc="Rate at which the bit lengthens the hole.",
        value=lambda hole, sample: sample.once(hole.bit.progress)[1],
        panel=6,
        interest=8,
    ),
)
