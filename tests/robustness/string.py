"""Criteria of the cases of waves, statics and meshes: X01, X03, X09 to X14, X22
(manual: sec-verif-robustness)."""

from __future__ import annotations

import numpy as np
from scipy.integrate import trapezoid

from drillpetsc.fem.component import FloatArray
from tests.robustness.contact import GRAVITY, pipe_mass
from tests.robustness.criteria import Row, Run, Runs, allowed_penetration, at_most, common, holds, near


def section(item) -> tuple[float, float, float]:
    """EA [N], EI [N m2] and axial impedance Z_a = A sqrt(E rho) [N s/m] of a pipe item."""
    area, second = np.pi / 4 * (item.od**2 - item.id**2), np.pi / 64 * (item.od**4 - item.id**4)
    return (
        item.material.young * area,
        item.material.young * second,
        float(area * np.sqrt(item.material.young * item.material.density)),
    )


def deep_well(runs: Runs) -> list[Row]:
    """X01 (manual: verif-robust-deep-well): statics of 12 km, and a minute of rotation.

    The torque is evaluated over the last ten seconds, 1.3 round trips of a torsional wave.
    """
    run, statics = runs["x01-deep-well"], runs["x01-statics"].summary
    weight = sum(pipe_mass(item) * item.length * GRAVITY for item in run.case.string[:2])
    torque = run.after(50.0, "surface_torque")
    band = float(np.ptp(torque) / abs(torque.mean()))
    return [
        *common("X01", run),
        at_most("X01", "Newton iterations of the statics", statics["iterations"], 199),
        at_most("X01", "residual of the statics over the weight", statics["residual"] / weight, 1e-6),
        near(
            "X01",
            "hook load, soft string's [N]",
            statics["hook_load"],
            statics["soft_string"]["hook_load"],
            0.015,
        ),
        at_most("X01", "band of the surface torque over its mean, 50 to 60 s", band, 0.02),
    ]


def dropped_bit(runs: Runs) -> list[Row]:
    """X03 (manual: verif-robust-dropped-bit): weight on bit after the impact.

    Collars that hit the bottom with v load it with Z_a v until the wave returns from their upper end. At rest
    the weight is at most EA/L times the way of the top while it stops.
    """
    run = runs["x03-dropped-bit"]
    pipe, collar, _ = run.case.string
    t, h = run.history["time"], run.history
    speed = np.gradient(h["bit_depth"], t)
    reached = float(speed[t < 0.24].max())
    stretch = pipe.length / section(pipe)[0] + collar.length / section(collar)[0]
    static = 0.5 * 0.05 * reached / stretch
    return [
        *common("X03", run),
        at_most("X03", "rebound speed [m/s]", float(-speed.min()), reached),
        at_most(
            "X03",
            "peak weight on bit [N]",
            float(h["wob"].max()),
            1.3 * (section(collar)[2] * reached + static),
        ),
        near(
            "X03",
            "weight on bit before the wave is back, Z_a v [N]",
            float(np.interp(0.40, t, h["wob"])),
            section(collar)[2] * reached,
            0.01,
        ),
    ]


def tripping(runs: Runs) -> list[Row]:
    """X09 (manual: verif-robust-fast-tripping): hook load at most static + 1.1 Z_a dv + drag, where the drag is
    the difference of hoisting and rotating in the statics of the same well."""
    run, up, still = runs["x09-trip-fast"], runs["x09-hoist"].summary, runs["x09-rotate"].summary
    hook = run.history["hook_load"]
    limit = hook[0] + 1.1 * section(run.case.string[0])[2] * 2.0 + up["hook_load"] - still["hook_load"]
    t, data = run.frames
    curve = (data["md"][0] > 1000.0) & (data["md"][0] < 1360.0)
    summary = run.summary
    return [
        *common("X09", run),
        at_most("X09", "peak of the hook load [N]", float(hook.max()), float(limit)),
        at_most(
            "X09",
            "penetration in the curve [m]",
            float(run.penetration[:, curve].max()),
            allowed_penetration(run),
        ),
        at_most(
            "X09", "failed Newton solves (fewer than any burst of more than 5)", summary["failed_solves"], 5
        ),
    ]


def dogleg(runs: Runs) -> list[Row]:
    """X10 (manual: verif-robust-dogleg): bending stress, contact forces and projection in a dogleg.

    The stress of a pipe that follows the hole is E OD/2 kappa in the middle third of the dogleg (R = 57.3 m
    minus the clearance on the inner side). Contact forces are compared with those of elements of half the
    length, as sums over dogleg and kink, because single contact points of a stiff wall share them unevenly.
    The measured depths of the projected nodes increase, each by at most the length of its element.
    """
    run, fine = runs["x10-statics"], runs["x10-fine-statics"]
    item, s = run.case.string[1], run.statics
    middle = (s["md"] > 310.0) & (s["md"] < 320.0)
    radius = 30.0 / np.radians(30.0)
    clearance = 0.5 * (run.case.well.sections[0].diameter - item.od)
    expected = item.material.young * item.od / 2 / (radius - clearance)
    rows = [
        holds(
            "X10",
            "statics converged, negative pivots",
            run.summary["negative_pivots"],
            "0",
            run.summary["negative_pivots"] == 0,
        ),
        near(
            "X10",
            "bending stress in the dogleg's middle, E OD/2 kappa [Pa]",
            float(s["bending_stress"][middle].mean()),
            expected,
            0.05,
        ),
    ]
    for where, start, end in (("dogleg", 296.0, 334.0), ("kink", 396.0, 407.0)):
        coarse, half = _total(run.statics, start, end), _total(fine.statics, start, end)
        rows.append(
            near("X10", f"contact force of the {where}, of elements half as long [N]", coarse, half, 0.05)
        )
    rows.append(_projected_in_order(run))
    return rows + common("X10", runs["x10-dogleg"])


def _total(s: dict[str, FloatArray], start: float, end: float) -> float:
    here = (s["md"] >= start) & (s["md"] <= end)
    md, force = s["md"][here], s["contact_force"][here]
    return float(np.sum(0.5 * (force[1:] + force[:-1]) * np.diff(md)))


def _projected_in_order(run: Run) -> Row:
    from drillpetsc.model.hole import build_well

    well = build_well(run.case)
    assert well is not None
    foot = well.project(run.frames[1]["point"][-1])
    steps, pieces = np.diff(foot.md), np.diff(run.frames[1]["md"][0])
    odd = int(np.sum((steps <= 0) | (steps > 1.05 * pieces)))
    return at_most("X10", "nodes found out of order on the hole's axis", odd, 0)


def lock_up(runs: Runs) -> list[Row]:
    """X11 (manual: verif-robust-lock-up): load at the end of a helix that slides along the hole.

    The locked state is the creep after 3.4 s, in which the load must not fall.

    A helix of q radians per length has the contact force N = r (F q^2 - EI q^4) (bending of a helix of small
    slope, curvature r q^2), so that dF/ds = -mu N gives F_end = EI q^2 + (F - EI q^2) exp(-mu r q^2 L).
    F/(1 + mu r F L/4EI) is the same with the pitch of least energy, q^2 = F/2EI, which occurs without friction.
    Friction keeps the pitch and the changes of hand with which the helix formed: q is the mean of the run. The
    balance of load and computed contact force is independent of the shape.
    """
    run = runs["x11-lock-up"]
    item, h = run.case.string[0], run.history
    clearance, mu = 0.5 * (run.case.well.sections[0].diameter - item.od), run.case.well.sections[0].friction
    stiffness, w = section(item)[1], pipe_mass(item) * GRAVITY
    helical = 2 * np.sqrt(2 * stiffness * w / clearance)
    late = h["time"] > 3.5
    top, end = -h["hook_load"][late], h["wob"][late]
    load = float(top.mean())
    _, data = run.frames
    side = np.unwrap(np.arctan2(data["offset_y"][-1], data["offset_x"][-1]))
    turns = float(np.abs(np.diff(side)).sum() / (2 * np.pi))
    q2 = (2 * np.pi * turns / item.length) ** 2
    coiled = stiffness * q2 + (load - stiffness * q2) * np.exp(-mu * clearance * q2 * item.length)
    held = mu * float(trapezoid(data["contact_force"][-1], data["md"][0]))
    return [
        *common("X11", run),
        holds(
            "X11", "load at the top over the helical load", load / helical, ">= 2.95", load / helical >= 2.95
        ),
        near("X11", "load at the end, of a helix [N]", float(end.mean()), float(coiled), 0.10),
        near(
            "X11",
            "load lost on the way, friction times contact force [N]",
            load - float(end.mean()),
            held,
            0.05,
        ),
        holds(
            "X11", "helix: turns of either hand over the length", turns, "> 10 (pitch 7 to 9 m)", turns > 10
        ),
        at_most(
            "X11",
            "fall of the end's load while locked, over it",
            float(max(0.0, -(np.diff(end).min())) / end.mean()),
            0.01,
        ),
    ]


def pull_free(runs: Runs) -> list[Row]:
    """X12 (manual: verif-robust-pull-free): first speed F/Z_a; the kinetic energy decays below 5 % of the released
    energy F^2 L/2EA."""
    run = runs["x12-pull-free"]
    item, h = run.case.string[0], run.history
    t, force = h["time"], 4e5
    speed = -np.gradient(h["bit_depth"], t)
    ea, _, impedance = section(item)
    released = force**2 * item.length / (2 * ea)
    before, after = float(np.median(h["step"][(t > 0.02) & (t < 0.1)])), float(h["step"][t > 5.0].max())
    return [
        *common("X12", run),
        near(
            "X12",
            "first speed of the bit [m/s]",
            float(speed[(t > 0.104) & (t < 0.12)].mean()),
            force / impedance,
            0.05,
        ),
        at_most(
            "X12",
            "kinetic energy after 5 s, over the released energy",
            float(run.after(5.0, "kinetic_energy").max()) / released,
            0.05,
        ),
        holds(
            "X12",
            "longest step after the rest is back, over that before",
            after / before,
            ">= 0.5",
            after >= 0.5 * before,
        ),
    ]


def inextensible(runs: Runs) -> list[Row]:
    """X13 (manual: verif-robust-inextensible): torque, speed of the end and offsets over their largest value, for
    the true EA and a thousand times that."""
    one, other = runs["x13-coiled-tubing"], runs["x13-inextensible"]
    rows = [*common("X13", one), *common("X13", other)]
    pairs = [(c, one.history[c], other.history[c]) for c in ("surface_torque", "bit_speed")]
    pairs += [(c, one.probes[c], other.probes[c]) for c in ("x_100", "y_100", "x_190", "y_190")]
    for name, a, b in pairs:
        rows.append(
            at_most("X13", f"difference of {name}", float(np.abs(a - b).max() / np.abs(a).max()), 0.01)
        )
    return [
        *rows,
        at_most("X13", "steps over those with the true EA", other.summary["steps"] / one.summary["steps"], 3),
    ]


def few_elements(runs: Runs) -> list[Row]:
    """X14 (manual: verif-robust-few-elements): hook load w L, stretch w L^2/2EA, cantilever w L^4/8EI (small slopes:
    the second-order effect is 0.05 %).

    `check` and the statics warn of elements that are too long. In mud the hook load is the weight in air minus
    the force of the pressure on the lower end, W - p A_s.
    """
    short, long, bend = (
        runs[f"x14-{name}"] for name in ("one-element-10m", "one-element-1000m", "two-elements-bend")
    )
    rows = [row for run in (short, long, bend) for row in common("X14", run)]
    item, bar = long.case.string[0], short.case.string[0]
    ea, ei, _ = section(item)
    w = pipe_mass(item) * GRAVITY
    metal = np.pi / 4 * (bar.od**2 - bar.id**2)
    static = long.summary["statics"]
    tip = bend.frames[1]["point"][0, -1, 2]
    warnings = " ".join(static["warnings"])
    check = _described(long)
    return [
        *rows,
        near("X14", "1000 m: hook load, w L [N]", float(long.history["hook_load"][0]), w * 1000, 1e-6),
        near(
            "X14",
            "1000 m: stretch, w L^2/2EA [m]",
            float(long.history["bit_depth"][0]) - 1000,
            w * 1e6 / (2 * ea),
            1e-3,
        ),
        near(
            "X14",
            "10 m in mud: hook load, W - p A_s [N]",
            float(short.history["hook_load"][0]),
            w * 10 - float(short.history["bit_pressure"][0]) * metal,
            1e-3,
        ),
        near(
            "X14", "two elements: deflection of the tip, w L^4/8EI [m]", float(tip), w * 1e4 / (8 * ei), 2e-3
        ),
        holds(
            "X14",
            "1000 m: negative pivots, explained",
            f"{static['negative_pivots']}: {warnings[:60]}",
            "mesh too coarse",
            "mesh is too coarse" in warnings,
        ),
        holds("X14", "1000 m: check warns", "yes" if "WARNING" in check else "no", "yes", "WARNING" in check),
    ]


def _described(run: Run) -> str:
    from drillpetsc.analysis.commands.check import describe

    return describe(run.case)


def helix(runs: Runs) -> list[Row]:
    """X22 (manual: verif-robust-buckling-loads): up to ten times the first critical load 1.94 (EI w^2)^(1/3)
    (Lubinski, 1950), each load from the straight string."""
    case = runs["x22-helix"].case
    item = case.string[0]
    critical = 1.94 * (section(item)[1] * (pipe_mass(item) * GRAVITY) ** 2) ** (1 / 3)
    rows = common("X22", runs["x22-helix"])
    for name in sorted(n for n in runs if n.startswith("x22-wob")):
        run = runs[name]
        summary, data = run.summary, run.frames[1]
        load = summary["wob"] / critical
        rows += [
            holds(
                "X22",
                f"{load:.2f} critical loads: negative pivots",
                summary["negative_pivots"],
                "0",
                summary["negative_pivots"] == 0,
            ),
            at_most(
                "X22",
                f"{load:.2f} critical loads: penetration [m]",
                float(run.penetration.max()),
                allowed_penetration(run),
            ),
        ]
        if load > 5:
            side = float(np.hypot(data["offset_x"], data["offset_y"]).max())
            rows.append(
                holds(
                    "X22", f"{load:.2f} critical loads: on the wall, offset [m]", side, "> 0.04", side > 0.04
                )
            )
    return rows
