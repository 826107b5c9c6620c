"""Criteria of the cases with rock under the bit: X04, X17, X18, X21 (manual: sec-verif-robustness)."""

from __future__ import annotations

import numpy as np

from tests.robustness.contact import GRAVITY, pipe_mass
from tests.robustness.criteria import Row, Runs, at_least, at_most, common, holds, near

CUT_PER_TURN = 3e-3  # depth of cut per turn, plus 2 ms between rows at 0.5 m/s [m]
INTERPOLATION_ERROR = 1e-7  # error of a row, which is interpolated by a parabola between two steps [m]


def stick_slip(runs: Runs) -> list[Row]:
    """X04 (manual: verif-robust-stick-slip): period of one mode whose torque falls from T_s to T_c at once.

    With J = J_bit + rho I_p L/3 (the string's part in the first mode), k = GJ/L, w = sqrt(k/J) and x = (T_s -
    T_c)/k the bit slips for 2 (pi - atan(x w/Omega))/w and sticks for 2 x/Omega (manual:
    verif-stick-slip-one-mode).
    """
    run = runs["x04-stick-slip"]
    pipe, bit = run.case.string
    law = run.case.formation.bit_law
    polar = np.pi / 32 * (pipe.od**4 - pipe.id**4)
    stiffness = pipe.material.young / (2 * (1 + pipe.material.poisson)) * polar / pipe.length
    inertia = bit.inertia.axial + pipe.material.density * polar * pipe.length / 3
    w, top = np.sqrt(stiffness / inertia), run.case.top.rotation.value(100.0)
    drop = (law.static - law.dynamic) / stiffness
    period = 2 * (np.pi - np.arctan(drop * w / top)) / w + 2 * drop / top
    t, speed = run.history["time"], run.history["bit_speed"]
    slips = [k for k in range(1, len(t)) if speed[k] > 1 >= speed[k - 1]]
    periods = np.diff(t[slips])
    rest = max(float(np.abs(speed[a:b]).min()) for a, b in zip(slips, slips[1:], strict=False))
    rounding = min(run.case.contact.slip_velocity if run.case.contact else 0.01, 1.0) / (bit.od / 3)
    rounding = min(rounding, law.speed / 100)  # drillpetsc/physics/bit/rock_bit.py
    return [
        *common("X04", run),
        at_least("X04", "slips in 300 s", len(slips), 9),
        at_most("X04", "sticks each cycle: least |speed| between slips [rad/s]", rest, 10 * rounding),
        near("X04", "period [s]", float(periods[2:].mean()), float(period), 0.10),
        at_least("X04", "backward rotation [rad/s]", float(speed.min()), -0.1),
    ]


def off_bottom(runs: Runs) -> list[Row]:
    """X17 (manual: verif-robust-off-bottom): lift-off and return of the bit.

    A negative depth of cut would pull the bit down and show in the weight on bit. If the rock profile changed
    while the bit hangs, the bit would meet it deeper than it left it, by more than the cut per turn (2 mm at
    15 kN).
    """
    run = runs["x17-off-bottom"]
    h = run.history
    t = h["time"]
    off = h["wob"] <= 0
    lift = float((h["hole_depth"] - h["bit_depth"]).max())
    first, last = h["hole_depth"][(t > 1.5) & (t < 2.0)], h["hole_depth"][-1]
    hanging = (t > 1.3) & (t < 2.2)
    back = int(np.flatnonzero((t > 2.0) & (h["wob"] > 0))[0])
    return [
        *common("X17", run),
        at_least("X17", "lift-off [m]", lift, 0.10),
        at_most(
            "X17",
            "fall of the hole's depth between rows [m]",
            float(max(0.0, -np.diff(h["hole_depth"]).min())),
            INTERPOLATION_ERROR,
        ),
        at_most("X17", "rate of penetration off bottom [m/s]", float(np.abs(h["rop"][off]).max()), 0.0),
        at_most(
            "X17", "growth of the hole while the bit hangs [m]", float(np.ptp(first)), INTERPOLATION_ERROR
        ),
        holds(
            "X17",
            "weight and torque while it hangs [N], [N m]",
            f"{h['wob'][hanging].max():g}, {h['bit_torque'][hanging].max():g}",
            "0, 0",
            float(h["wob"][hanging].max()) == 0.0 and float(np.abs(h["bit_torque"][hanging]).max()) == 0.0,
        ),
        at_least("X17", "least weight on bit (a negative chip would pull) [N]", float(h["wob"].min()), 0.0),
        holds(
            "X17",
            "drills on after it is back, hole grown by [m]",
            float(last - first[-1]),
            "> 0",
            bool(last > first[-1]),
        ),
        at_most(
            "X17",
            "rock met again where it was left: distance [m]",
            abs(float(h["bit_depth"][back] - h["hole_depth"][back])),
            CUT_PER_TURN,
        ),
    ]


def reverse(runs: Runs) -> list[Row]:
    """X18 (manual: verif-robust-reverse-rotation): without forward rotation the bit does not cut."""
    back, still = runs["x18-reverse"], runs["x18-zero-rotation"]
    h = back.history
    turned = h["bit_speed"] < -0.1
    rows = [*common("X18", back), *common("X18", still, gain=False)]
    return [
        *rows,
        at_most(
            "X18",
            "reverse: rate of penetration while it turns back [m/s]",
            float(np.abs(h["rop"][turned]).max()),
            0.0,
        ),
        holds(
            "X18",
            "reverse: torque turns over",
            f"{h['bit_torque'][~turned].max():.4g} to {h['bit_torque'][turned].min():.4g}",
            "+ to -",
            bool(h["bit_torque"][turned].min() < 0),
        ),
        at_most(
            "X18",
            "no rotation: metres drilled",
            float(still.history["hole_depth"][-1] - still.history["hole_depth"][0]),
            1e-12,
        ),
        at_most(
            "X18", "no rotation: energy error [J]", float(np.abs(still.history["energy_error"]).max()), 1e-6
        ),
        *(
            at_most("X18", f"{q.name}: Newton iterations of a step", float(q.history["newton"].max()), 14)
            for q in (back, still)
        ),
    ]


def rock_extremes(runs: Runs) -> list[Row]:
    """X21 (manual: verif-robust-rock-extremes): rate = D W at the reference speed; hook load plus weight on bit
    is the weight of the string."""
    rows: list[Row] = []
    for name in ("x21-soft-rock", "x21-undrillable"):
        run = runs[name]
        h, (collar, bit) = run.history, run.case.string
        weight = (pipe_mass(collar) * collar.length + bit.mass) * GRAVITY
        rate = run.case.formation.drillability * h["wob"][-1]
        steps = h["step"][h["time"] > 0.1]
        rows += [
            *common("X21", run),
            near("X21", f"{name}: rate of penetration, D W [m/s]", float(h["rop"][-1]), float(rate), 0.01),
            near(
                "X21",
                f"{name}: metres drilled, rate x time",
                float(h["hole_depth"][-1] - h["hole_depth"][0]),
                float(rate * h["time"][-1]),
                0.01,
            ),
            near(
                "X21",
                f"{name}: hook load + weight on bit [N]",
                float(h["hook_load"][-1] + h["wob"][-1]),
                weight,
                0.01,
            ),
            at_least("X21", f"{name}: shortest step [s]", float(steps.min()), 1e-3),
        ]
    return rows
