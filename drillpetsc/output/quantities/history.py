"""Columns of history.csv: the row itself, ends of the string, drilled hole, energies."""

from __future__ import annotations

from drillpetsc.fem.quantity import Quantity

TIME = Quantity(
    "time",
    "s",
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
        label="Hook load",
        mnemonic="HKLD",
        sign="the drive pulls the string up",
        doc="Pull of the top on the string: the reaction, or the given force.",
        values=lambda top, steps: top.hook_loads(steps),
        panel=1,
        interest=3,
    ),
    Quantity(
        "surface_torque",
        "N m",
        label="Surface torque",
        mnemonic="STOR",
        sign="the drive turns the string clockwise (looking down)",
        doc="Torque of the drive on the string.",
        values=lambda top, steps: top.surface_torques(steps),
        panel=3,
        interest=6,
    ),
)
HOOK_LOAD_TOTAL = Quantity(
    "hook_load_total",
    "N",
    label="Total hook load",
    mnemonic="HKLX",
    sign="the hook pulls up",
    doc="Hook load and the weight of the block.",
    values=lambda top, steps: top.hook_load_totals(steps),
    panel=1,
)
TOP_TRAVEL = Quantity(
    "top_travel",
    "m",
    label="Travel of the top",
    mnemonic="TTRV",
    sign="down",
    doc="Distance along the hole of the string's top below its place in the string free of stress at the start.",
    interpolate="motion",
    mean=False,
    values=lambda top, steps: top.positions(steps),
    size=3,
    finish=lambda top, point, depth: (top.travel(point),),
)
LOWER_END: tuple[Quantity, ...] = (
    Quantity(
        "bit_speed",
        "rad/s",
        label="Bit speed",
        mnemonic="BRPM",
        sign="clockwise (looking down)",
        doc="Spin rate of the lower end of the string.",
        interpolate="motion",
        values=lambda end, steps: end.motions(steps)[:, 3],
        panel=4,
        interest=1,
    ),
    Quantity(
        "bit_depth",
        "m",
        label="Bit depth",
        mnemonic="DBTM",
        sign="down",
        doc="Measured depth of the face of the string's lower end.",
        interpolate="motion",
        mean=False,
        values=lambda end, steps: end.motions(steps)[:, :3],
        size=3,
        finish=lambda end, point, depth: (end.depth_of(point),),
        finish_rows=lambda end, points: end.depths_of(points)[:, None],
        panel=5,
        interest=5,
    ),
)
HOLE: tuple[Quantity, ...] = (
    Quantity(
        "hole_depth",
        "m",
        label="Hole depth",
        mnemonic="DMEA",
        sign="down",
        doc="Measured depth of the end of the hole.",
        interpolate="motion",
        mean=False,
        values=lambda hole, steps: hole.bit.progress_of(steps)[:, 0],
        finish=lambda hole, drilled, depth: (hole.start + drilled[0],),
        panel=5,
    ),
    Quantity(
        "rop",
        "m/s",
        kind="rop",
        label="Rate of penetration",
        mnemonic="ROP",
        sign="the hole grows",
        doc="Rate at which the bit lengthens the hole.",
        values=lambda hole, steps: hole.bit.progress_of(steps)[:, 1],
        panel=6,
        interest=8,
    ),
)


ENERGY: tuple[Quantity, ...] = (
    Quantity(
        "kinetic_energy",
        "J",
        kind="energy",
        label="Kinetic energy",
        mnemonic="EKIN",
        doc="Kinetic energy of string and mud.",
        interpolate="none",
        mean=False,
        value=lambda balance, sample: balance.energies[0],
        panel=9,
        numerics=True,
    ),
    Quantity(
        "strain_energy",
        "J",
        kind="energy",
        label="Strain energy",
        mnemonic="ESTR",
        doc="Energy stored in the string, in contacts, springs and compressed mud.",
        interpolate="none",
        mean=False,
        value=lambda balance, sample: balance.energies[1],
        panel=9,
        numerics=True,
    ),
    Quantity(
        "energy_error",
        "J",
        kind="energy",
        label="Energy error",
        mnemonic="EERR",
        sign="the time integration created energy",
        doc="Stored energy gained plus dissipated less supplied energy since the start.",
        interpolate="none",
        mean=False,
        value=lambda balance, sample: balance.error,
        panel=10,
        numerics=True,
    ),
)
#: samples of the energy balance: dissipated and supplied power; not written to files
POWERS = Quantity(
    "powers",
    "W",
    label="Powers",
    doc="Dissipated and supplied power.",
    value=lambda balance, sample: sample.system.local_powers(sample.time),
    values=lambda balance, steps: steps.system.powers_of(steps),
    size=2,
)
