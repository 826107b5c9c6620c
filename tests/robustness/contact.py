"""Criteria of the scenes of wall contact and friction: X02, X05, X06, X15, X16, X19, X20 (shared list of
extreme scenes)."""

from __future__ import annotations

import numpy as np

from drillpetsc.fem.component import FloatArray
from tests.robustness.criteria import Row, Runs, allowed_penetration, at_least, at_most, common, holds, near
from tests.robustness.start_in_wall import DEPTH, SPEED

GRAVITY = 9.81  # of all extreme cases [m/s2]
SETTLED = 1.0  # [s] after which a string that was set in motion is looked at


def pipe_mass(item) -> float:
    """Mass per length of a pipe item [kg/m]."""
    return float(item.material.density * np.pi / 4 * (item.od**2 - item.id**2))


def whirl_rate(x: FloatArray, y: FloatArray, t: FloatArray) -> float:
    """Mean rate of turning of the place (x, y) about the hole's axis [rad/s], positive as the string
    turns."""
    return float(np.polyfit(t, np.unwrap(np.arctan2(y, x)), 1)[0])


def stiff_contact(runs: Runs) -> list[Row]:
    """X02: a shaft that lies and turns rests at the angle atan(mu) up the wall, so N = w cos(atan mu) (P10 of
    the verification list)."""
    run = runs["x02-stiff-contact"]
    item, mu = run.case.string[0], run.case.well.sections[0].friction
    t, data = run.frames
    md = data["md"][0]
    lies = (md > 20.0) & (md < 56.0)  # off the drive, which holds the top on the axis, and off the free end
    force = float(data["contact_force"][t > SETTLED][:, lies].mean())
    return [
        *common("X02", run),
        at_most("X02", "penetration [m]", float(run.penetration.max()), 1e-4),
        near(
            "X02", "mean contact force [N/m]", force, pipe_mass(item) * GRAVITY * np.cos(np.arctan(mu)), 0.01
        ),
        at_least("X02", "shortest step at the rows [s]", float(run.history["step"][1:].min()), 1e-9),
    ]


def unbalance(runs: Runs) -> list[Row]:
    """X05: an unrestrained pipe turns about its mass centre, so its axis moves at e Omega and may strike the
    wall with that; an undamped impact at v goes v sqrt(m/k) deep, which is more than the common millimetre at
    1e8 N/m2 and is added to the depth under the centrifugal load m (r + e) Omega^2 of the whirl along the
    wall."""
    rows: list[Row] = []
    for name in ("x05-unbalance-1e8", "x05-unbalance-1e10"):
        run = runs[name]
        item, contact = run.case.string[1], run.case.contact
        omega, e, m, k = (
            run.case.top.rotation.value(2.0),
            item.eccentricity,
            pipe_mass(item),
            contact.stiffness,
        )
        component = 0.5 * (run.case.well.sections[0].diameter - item.od)
        depth = e * omega * np.sqrt(m / k) + m * (component + e) * omega**2 / k
        p = run.probes
        late = p["time"] > SETTLED
        ratio = whirl_rate(p["x_55"][late], p["y_55"][late], p["time"][late]) / omega
        kind = "forward" if ratio > 0.1 else "backward" if ratio < -0.1 else "none"
        speed = np.gradient(np.column_stack([p["x_55"], p["y_55"]]), p["time"], axis=0)
        rough = float(np.abs(np.gradient(speed, p["time"], axis=0)).max())
        rows += common("X05", run, penetration=False)
        rows += [
            at_most("X05", f"{name}: penetration at the frames [m]", float(run.penetration.max()), depth),
            holds(
                "X05",
                f"{name}: whirl class and rate over rotation",
                f"{kind} {ratio:.4f}",
                "reported",
                np.isfinite(ratio),
            ),
            holds(
                "X05", f"{name}: largest acceleration of the axis [m/s2]", rough, "finite", np.isfinite(rough)
            ),
        ]
    return rows


def clearance(runs: Runs) -> list[Row]:
    """X06.  The stabilizer carries at most half of the collar above it and all that is below, by weight and
    by centrifugal force of the eccentric mass, and its own weight: F.  Without clearance its middle (mean of
    its ends) may then be 2 F/(k' l) off the axis.

    With clearance it may also whirl backward, driven by friction while its surface slips, so at most until it
    rolls on the wall: the middle then moves at Omega R, and goes into a wall of stiffness k' l by Omega R
    sqrt(m/(k' l)), m its own mass and that of the pipe it carries. At 0.1 mm it does (found alike with 3 to 9
    contact points; two inner points miss it).
    """
    rows: list[Row] = []
    for name in ("x06-clearance-1mm", "x06-clearance-100um", "x06-clearance-zero"):
        run = runs[name]
        above, body, below = run.case.string
        stiffness = run.case.contact.stiffness * body.length
        omega = run.case.top.rotation.value(2.0)
        m = pipe_mass(above)
        load = m * (GRAVITY + above.eccentricity * omega**2) * 0.5 * above.length + GRAVITY * (
            body.mass + pipe_mass(below) * below.length
        )
        carried = body.mass + 0.5 * m * above.length + pipe_mass(below) * below.length
        component = max(0.0, 0.5 * (run.case.well.sections[0].diameter - body.od))
        rolling = 0.5 * omega * body.od * np.sqrt(carried / stiffness) if component else 0.0
        p = run.probes
        middle = np.hypot(0.5 * (p["x_10"] + p["x_10.5"]), 0.5 * (p["y_10"] + p["y_10.5"]))
        limit = component + max(2 * load / stiffness, rolling)
        rows += [
            *common("X06", run),
            at_most("X06", f"{name}: offset of the stabilizer's middle [m]", float(middle.max()), limit),
            at_most("X06", f"{name}: failed Newton solves", run.summary["failed_solves"], 0),
        ]
    run = runs["x06-casing-in-hole"]
    return [
        *rows,
        *common("X06", run),
        at_most("X06", "x06-casing-in-hole: failed Newton solves", run.summary["failed_solves"], 0),
    ]


def fixed_steps(runs: Runs) -> list[Row]:
    """X15: kinetic energy after the spin-up never above that of the turning string by more than a tenth; a
    step whose Newton fails is cut (so there are as many rejected steps as failed solves), and the run still
    ends where it must."""
    rows: list[Row] = []
    for name in ("x15-bdf1-50ms", "x15-bdf1-500ms", "x15-bdf2-50ms", "x15-bdf2-500ms"):
        run = runs[name]
        energy, reported = run.after(SETTLED + 0.5, "kinetic_energy"), run.summary
        steady = float(np.median(energy))
        rows += [
            *common("X15", run),
            at_most(
                "X15", f"{name}: kinetic energy after the spin-up [J]", float(energy.max()), 1.1 * steady
            ),
            holds(
                "X15",
                f"{name}: failed solves, rejected steps",
                f"{reported['failed_solves']}, {reported['rejected_steps']}",
                "every failed solve rejected",
                reported["failed_solves"] <= reported["rejected_steps"],
            ),
            near("X15", f"{name}: end of the run [s]", reported["time"], 20.0, 1e-9),
        ]
    return rows


def in_the_wall(runs: Runs) -> list[Row]:
    """X16: the wall gives back no more than it has stored and what came in, v_out <= sqrt(v^2 + k' d^2/m');
    looked at where the string is straight.  In the end it lies: penetration as everywhere.  From statics
    there is none to begin with."""
    run, lying = runs["x16-pressed"], runs["x16-start-in-the-wall"]
    contact, m = run.case.contact, pipe_mass(run.case.string[0])
    t, data = run.frames
    middle = data["md"][0] > 20.0
    out = float(-data["velocity"][:, middle, 2].min())
    last = run.penetration[t > 0.9 * t[-1]].max()
    rows = common("X16", run, penetration=False)
    rows += [
        near("X16", "penetration at the start [m]", float(run.penetration[0][middle].max()), DEPTH, 1e-6),
        at_most(
            "X16", "ejection speed [m/s]", out, float(np.sqrt(SPEED**2 + contact.stiffness * DEPTH**2 / m))
        ),
        at_most("X16", "penetration in the end [m]", float(last), allowed_penetration(run)),
    ]
    return [
        *rows,
        *common("X16", lying, gain=False),
        at_most(
            "X16",
            "started from statics: speed of any node [m/s]",
            float(np.abs(lying.frames[1]["velocity"]).max()),
            1e-3,
        ),
    ]


def friction(runs: Runs) -> list[Row]:
    """X19: slip velocity 1e-5 m/s; storms are more than 50 rejected steps in a second, counted over the whole
    run."""
    rows: list[Row] = []
    for name in ("x19-friction-zero", "x19-friction-one", "x19-friction-jump"):
        run = runs[name]
        per_second = run.summary["rejected_steps"] / run.summary["simulated"]
        rows += [
            *common("X19", run),
            at_most("X19", f"{name}: rejected steps per second", per_second, 50),
            at_most("X19", f"{name}: Newton iterations of a step", float(run.history["newton"].max()), 25),
        ]
    return rows


def washout(runs: Runs) -> list[Row]:
    """X20: of the axial force while the joint climbs out the wall can cause mu N + N dR/ds, N the joint's own
    contact force and dR/ds the steepest slope of the smooth step, 3/2 dR/l with l = max(0.5 m, 10 dR)
    (Well.transitions)."""
    run, section = runs["x20-washout"], runs["x20-washout"].case.well.sections
    rise = 0.5 * (section[1].diameter - section[2].diameter)
    slope = 1.5 * rise / max(0.5, 10 * rise)
    h, force = run.history, run.probes["contact_56.25"]
    t, hook = h["time"], h["hook_load"]
    climbs, before = (t > 6.6) & (t < 7.6), (t > 5.6) & (t < 6.2)
    spike = float(np.abs(hook[climbs] - hook[before].mean()).max())
    most = float(force[climbs].max())
    lands = np.diff(force[climbs])
    moved = np.interp(8.5, t, h["bit_depth"]) - np.interp(2.0, t, h["bit_depth"])
    limit = 1.2 * most * (section[2].friction + slope)
    return [
        *common("X20", run),
        at_most("X20", "axial spike while the joint climbs out [N]", spike, limit),
        at_most(
            "X20",
            "largest change of its contact force in a millisecond, over its peak",
            float(np.abs(lands).max()) / most,
            0.5,
        ),
        near("X20", "way of the lower end in 6.5 s at 1 m/s [m]", float(moved), 6.5, 0.01),
    ]
