"""Columns of history.csv: the row itself, ends of the string, drilled hole, energies."""

from __future__ import annotations

from pathlib import Path

from drillpetsc.fem.quantity import Quantity, quantities_of

quantity = quantities_of(Path(__file__).with_name("measured.csv"))

TIME = quantity("time", value=lambda row, sample: row.time)
STEP = quantity("step", value=lambda row, sample: row.step)
NEWTON = quantity("newton", value=lambda row, sample: row.newton)
ROW_START, ROW_END = (TIME,), (STEP, NEWTON)

TOP_END: tuple[Quantity, ...] = (
    quantity("hook_load", values=lambda top, steps: top.hook_loads(steps)),
    quantity("surface_torque", values=lambda top, steps: top.surface_torques(steps)),
)
HOOK_LOAD_TOTAL = quantity("hook_load_total", values=lambda top, steps: top.hook_load_totals(steps))
TOP_TRAVEL = quantity(
    "top_travel",
    values=lambda top, steps: top.positions(steps),
    size=3,
    finish=lambda top, point, depth: (top.travel(point),),
)
LOWER_END: tuple[Quantity, ...] = (
    quantity("bit_speed", values=lambda end, steps: end.motions(steps)[:, 3]),
    quantity(
        "bit_depth",
        values=lambda end, steps: end.motions(steps)[:, :3],
        size=3,
        finish=lambda end, point, depth: (end.depth_of(point),),
        finish_rows=lambda end, points: end.depths_of(points)[:, None],
    ),
)
HOLE: tuple[Quantity, ...] = (
    quantity(
        "hole_depth",
        values=lambda hole, steps: hole.bit.progress_of(steps)[:, 0],
        finish=lambda hole, drilled, depth: (hole.start + drilled[0],),
    ),
    quantity("rop", values=lambda hole, steps: hole.bit.progress_of(steps)[:, 1]),
)


ENERGY: tuple[Quantity, ...] = (
    quantity("kinetic_energy", value=lambda balance, sample: balance.energies[0]),
    quantity("strain_energy", value=lambda balance, sample: balance.energies[1]),
    quantity("energy_error", value=lambda balance, sample: balance.error),
)
#: samples of the energy balance: dissipated and supplied power; not written to files
POWERS = quantity(
    "powers",
    value=lambda balance, sample: sample.system.local_powers(sample.time),
    values=lambda balance, steps: steps.system.powers_of(steps),
    size=2,
)
