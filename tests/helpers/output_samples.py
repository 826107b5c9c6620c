"""Synthetic run folders for the tests of output and plotting: a helix of known size in a hole, and a
pendulum."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from drillpetsc.output import FieldWriter, RunFolder, Table, write_summary, write_table, write_well

LENGTH, HOLE, PIPE, AMPLITUDE = 2000.0, 0.10, 0.06, 0.03  # [m]
PITCH = 400.0  # [m]


def helix_frame(time: float, count: int = 81) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Deformed positions (n, 3) [m] and point data of a vertical string with the shape of a helix in its hole
    that rotates with 1 rad/s. The axial force decreases linearly from 800 kN to -50 kN."""
    md = np.linspace(0.0, LENGTH, count)
    angle = 2 * np.pi * md / PITCH - time
    offset = AMPLITUDE * np.column_stack((np.cos(angle), np.sin(angle)))
    points = np.column_stack((offset, md))
    data = {
        "displacement [m]": np.column_stack((offset, np.zeros(count))),
        "axial_force [N]": 8e5 - 8.5e5 * md / LENGTH,
        "spin [rad/s]": np.full(count, 8.0) + time * md / LENGTH,
        "md [m]": md,
        "offset_x [m]": offset[:, 0],
        "offset_y [m]": offset[:, 1],
        "hole_radius [m]": np.full(count, HOLE),
        "outer_radius [m]": np.full(count, PIPE),
    }
    return points, data


def make_run(folder: Path, frames: int = 4, well: bool = True) -> RunFolder:
    """A run folder with frames at 0, 1, 2, ... s, histories, one probe at 600 m, statics, trajectory and
    summary."""
    run = RunFolder.create("helix", out=folder)
    fields = FieldWriter(run.path)
    for k in range(frames):
        points, data = helix_frame(float(k))
        if not well:
            data = {
                name: array for name, array in data.items() if "offset" not in name and "radius" not in name
            }
        fields.write(float(k), points, data)
    time = np.linspace(0.0, frames - 1.0, 101)
    history = [
        ("time", "s"), ("hook_load", "N"), ("wob", "N"), ("surface_torque", "N m"), ("bit_torque", "N m"),
        ("bit_speed", "rad/s"), ("energy_error", "J"), ("newton", "-"),
    ]  # fmt: skip
    with Table(run.history, history) as table:
        for t in time:
            table.add([t, 8e5 + 1e3 * np.sin(t), 5e4, 9e3, 4e3, 8.0 + np.sin(t), 1e-3 * t, 2])
    with Table(run.probes, [("time", "s"), ("x_600", "m"), ("y_600", "m"), ("spin_600", "rad/s")]) as table:
        for t in time:
            table.add([t, AMPLITUDE * np.cos(t), AMPLITUDE * np.sin(t), 8.0])
    md = np.linspace(0.0, LENGTH, 21)
    write_table(
        run.statics,
        [("md", "m"), ("axial_force", "N"), ("torque", "N m")],
        [md, 8e5 - 8.5e5 * md / LENGTH, 9e3 + 0 * md],
    )
    if well:
        zero = 0.0 * md
        write_table(
            run.trajectory,
            [
                ("md", "m"), ("inclination", "deg"), ("azimuth", "deg"), ("north", "m"), ("east", "m"),
                ("tvd", "m"),
            ],
            [md, zero, zero, zero, zero, md],
        )  # fmt: skip
        write_well(run.well, md, np.column_stack((zero, zero, md)), np.full(21, HOLE), np.full(21, 0.3))
    write_summary(run.summary, {"title": "A helix in a hole"})
    return run


def make_pendulum(folder: Path) -> RunFolder:
    """A rod of 0.5 m without a hole that swings through 90 degrees in the north plane."""
    run = RunFolder.create("pendulum", out=folder)
    fields = FieldWriter(run.path)
    s = np.linspace(0.0, 0.5, 11)
    rest = np.column_stack((s, 0 * s, 0 * s))
    for k, angle in enumerate((0.0, 0.8, 1.5)):
        points = np.column_stack((s * np.cos(angle), 0 * s, s * np.sin(angle)))
        fields.write(0.1 * k, points, {"displacement [m]": points - rest, "axial_force [N]": 1.0 - s})
    return run
