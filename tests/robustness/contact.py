"""Criteria of the cases of wall contact and friction: X02, X05, X06, X15, X16, X19, X20
(manual: sec-verif-robustness)."""

from __future__ import annotations

import numpy as np

from drillpetsc.fem.component import FloatArray
from tests.robustness.criteria import (
    Row,
    Run,
    Runs,
    allowed_penetration,
    at_least,
    at_most,
    common,
    holds,
    near,
)
from tests.robustness.run import PRESSED_DEPTH, PRESSED_SPEED

GRAVITY = 9.81  # in all cases of the suite [m/s2]
SETTLED = 1.0  # time after which a started string is evaluated [s]


def pipe_mass(item) -> float:
    """Mass per length of a pipe item [kg/m]."""
    return float(item.material.density * np.pi / 4 * (item.od**2 - item.id**2))


def whirl_rate(x: FloatArray, y: FloatArray, t: FloatArray) -> float:
    """Mean angular rate of the position (x, y) about the hole's axis [rad/s], positive in the direction of
    rotation."""
    return float(np.polyfit(t, np.unwrap(np.arctan2(y, x)), 1)[0])


def stiff_contact(runs: Runs) -> list[Row]:
    """X02 (manual: verif-robust-stiff-contact): a rotating shaft on the low side rests at the angle atan(mu), so
    N = w cos(atan mu) (manual: verif-rotating-shaft-on-wall)."""
    run = runs["x02-stiff-contact"]
    item, mu = run.case.string[0], run.case.well.sections[0].friction
    t, data = run.frames
    md = data["md"][0]
    lies = (md > 20.0) & (md < 56.0)  # away from the top, which is held on the axis, and from the free end
    force = float(data["contact_force"][t > SETTLED][:, lies].mean())
    return [
        *common("X02", run),
        at_most("X02", "penetration [m]", float(run.penetration.max()), 1e-4),
        near(
            "X02", "mean contact force [N/m]", force, pipe_mass(item) * GRAVITY * np.cos(np.arctan(mu)), 0.01
        ),
        at_least("X02", "shortest step at the rows [s]", float(run.history["step"][1:].min()), 1e-9),
    ]


def bulge(run: Run) -> FloatArray:
    """Offset (f, n) of the nodes from the chord between the two contact points beside them [m], that of bending."""
    _, data = run.frames
    stiffness = np.full(data["outer_radius"].shape[1], np.inf)
    for item in run.case.string:
        at = np.isclose(data["outer_radius"][0], 0.5 * item.od)
        stiffness[at] = item.material.young * np.pi / 64 * (item.od**4 - item.id**4)
        length = item.element_length
    reach = 0.5 * (1 - 1 / np.sqrt(3)) * length
    return np.asarray(0.5 * reach**2 * data["bending_moment"] / stiffness)


def unbalance(runs: Runs) -> list[Row]:
    """X05 (manual: verif-robust-unbalance): allowed depth of the impacts and of the whirl along the wall.

    An unrestrained pipe rotates about its mass centre, so its axis moves with e Omega and may hit the wall with
    this speed. An undamped impact with speed v has the depth v sqrt(m/k), which at 1e8 N/m2 exceeds the common
    1 mm. It is added to the depth under the centrifugal load m (r + e) Omega^2 of the whirl along the wall.

    Both hold where the wall acts: at two Gauss points of each element of 4 m, 0.85 m from the node between them. There a
    bent pipe bulges by M/EI times half the square of that distance, up to 3 mm where the drill pipe bends above the
    collars. In the chaotic whirl some frame may have a node in such a bulge.
    """
    rows: list[Row] = []
    for name in ("x05-unbalance-1e8", "x05-unbalance-1e10"):
        run = runs[name]
        item, contact = run.case.string[1], run.case.contact
        omega, e, m, k = (
            run.case.top.rotation.value(2.0), item.eccentricity, pipe_mass(item), contact.stiffness,
        )  # fmt: skip
        clearance = 0.5 * (run.case.well.sections[0].diameter - item.od)
        depth = e * omega * np.sqrt(m / k) + m * (clearance + e) * omega**2 / k
        p = run.probes
        late = p["time"] > SETTLED
        ratio = whirl_rate(p["x_55"][late], p["y_55"][late], p["time"][late]) / omega
        kind = "forward" if ratio > 0.1 else "backward" if ratio < -0.1 else "none"
        speed = np.gradient(np.column_stack([p["x_55"], p["y_55"]]), p["time"], axis=0)
        rough = float(np.abs(np.gradient(speed, p["time"], axis=0)).max())
        rows += common("X05", run, penetration=False)
        rows += [
            at_most(
                "X05",
                f"{name}: penetration at the frames less the bulge [m]",
                float((run.penetration - bulge(run)).max()),
                depth,
            ),
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


def tight_clearance(runs: Runs) -> list[Row]:
    """X06 (manual: verif-robust-clearance): allowed offset of the stabilizer.

    The stabilizer carries the load F: its own weight, at most half of the weight and centrifugal force of the
    eccentric collar above, and all of those below. Without clearance the offset of its middle (mean of its
    ends) is at most 2 F/(k' l).

    With clearance friction may also drive a backward whirl as long as the surface slips, so at most until the
    stabilizer rolls on the wall. Its middle then moves with Omega R and enters a wall of stiffness k' l by
    Omega R sqrt(m/(k' l)), where m includes the pipe that it carries. This occurs at 0.1 mm, with 3 to 9 contact
    points; two inner points miss it.
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
        clearance = max(0.0, 0.5 * (run.case.well.sections[0].diameter - body.od))
        rolling = 0.5 * omega * body.od * np.sqrt(carried / stiffness) if clearance else 0.0
        p = run.probes
        middle = np.hypot(0.5 * (p["x_10"] + p["x_10.5"]), 0.5 * (p["y_10"] + p["y_10.5"]))
        limit = clearance + max(2 * load / stiffness, rolling)
        rows += [
            *common("X06", run),
            at_most("X06", f"{name}: offset of the stabilizer's middle [m]", float(middle.max()), limit),
            at_most("X06", f"{name}: failed Newton solves", run.summary["failed_solves"], 0),
        ]
    run = runs["x06-casing-in-hole"]
    return [
        *rows,
        *common("X06", run),
        # of 19000 steps: while the whole casing begins to roll along the wall, within 3 ms; they are repeated with shorter ones
        at_most("X06", "x06-casing-in-hole: failed Newton solves", run.summary["failed_solves"], 10),
    ]


def fixed_steps(runs: Runs) -> list[Row]:
    """X15 (manual: verif-robust-long-steps): kinetic energy after the spin-up at most a tenth above that of the
    rotating string.

    A step with a failed Newton solve is reduced, so every failed solve is a rejected step, and the run reaches
    its end.
    """
    rows: list[Row] = []
    for name in ("x15-bdf1-50ms", "x15-bdf1-500ms", "x15-bdf2-50ms", "x15-bdf2-500ms"):
        run = runs[name]
        energy, summary = run.after(SETTLED + 0.5, "kinetic_energy"), run.summary
        steady = float(np.median(energy))
        rows += [
            *common("X15", run),
            at_most(
                "X15", f"{name}: kinetic energy after the spin-up [J]", float(energy.max()), 1.1 * steady
            ),
            holds(
                "X15",
                f"{name}: failed solves, rejected steps",
                f"{summary['failed_solves']}, {summary['rejected_steps']}",
                "every failed solve rejected",
                summary["failed_solves"] <= summary["rejected_steps"],
            ),
            near("X15", f"{name}: end of the run [s]", summary["time"], 20.0, 1e-9),
        ]
    return rows


def in_the_wall(runs: Runs) -> list[Row]:
    """X16 (manual: verif-robust-start-in-wall): the wall returns at most the stored and the kinetic energy,
    v_out <= sqrt(v^2 + k' d^2/m').

    This is evaluated where the string is straight. At the end the string lies on the wall, with the common
    limit of penetration. A run from statics does not move.
    """
    run, lying = runs["x16-pressed"], runs["x16-start-in-the-wall"]
    contact, m = run.case.contact, pipe_mass(run.case.string[0])
    t, data = run.frames
    middle = data["md"][0] > 20.0
    out = float(-data["velocity"][:, middle, 2].min())
    last = run.penetration[t > 0.9 * t[-1]].max()
    rows = common("X16", run, penetration=False)
    rows += [
        near(
            "X16",
            "penetration at the start [m]",
            float(run.penetration[0][middle].max()),
            PRESSED_DEPTH,
            1e-6,
        ),
        at_most(
            "X16",
            "ejection speed [m/s]",
            out,
            float(np.sqrt(PRESSED_SPEED**2 + contact.stiffness * PRESSED_DEPTH**2 / m)),
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
    """X19 (manual: verif-robust-friction-extremes): slip velocity 1e-5 m/s; at most 50 rejected steps per
    second, over the whole run."""
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
    """X20 (manual: verif-robust-washout): axial force while the joint moves out of the washout.

    The wall causes at most mu N + N dR/ds, with N the contact force of the joint and dR/ds the steepest slope
    of the smooth step, 3/2 dR/l with l = max(0.5 m, 10 dR) (Well.transitions).
    """
    run, section = runs["x20-washout"], runs["x20-washout"].case.well.sections
    rise = 0.5 * (section[1].diameter - section[2].diameter)
    slope = 1.5 * rise / max(0.5, 10 * rise)
    h, force = run.history, run.probes["contact_56.25"]
    t, hook = h["time"], h["hook_load"]
    moves_out, before = (t > 6.6) & (t < 7.6), (t > 5.6) & (t < 6.2)
    spike = float(np.abs(hook[moves_out] - hook[before].mean()).max())
    most = float(force[moves_out].max())
    lands = np.diff(force[moves_out])
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
