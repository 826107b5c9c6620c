"""Criteria of the scenes with mud: X07, X08 and what the coupled system adds, Y01 to Y06 (shared list of
extreme scenes)."""

from __future__ import annotations

import numpy as np
from scipy.integrate import trapezoid

from drillpetsc.fem.component import FloatArray
from tests.robustness.contact import SETTLED, pipe_mass, whirl_rate
from tests.robustness.criteria import Row, Run, Runs, at_least, at_most, common, holds, near
from tests.robustness.string import section

BALANCE = 1e-3  # mud that may be missing, over what went in or out


def thick_and_thin(runs: Runs) -> list[Row]:
    """X07.  In thick mud inertia m e Omega^2 turns against drag c v: M r'' + c r' = m e Omega^2 exp(i Omega
    t), M with the mud that moves along, so the axis circles forward at Omega with radius m e Omega/sqrt(c^2 +
    (M Omega)^2), about a centre that nothing holds.  The list asks for a forward whirl at reduced rate: that
    is a shaft which its drag holds back on the wall; free of the wall a linear drag leaves the rate as it is
    and reduces the radius, which is what is checked, at 30 m of 40 m.  M is that of steel, mud in the bore
    and at most three times the displaced mud, a tenth of c/Omega in all, and changes the radius by less than
    5 %."""
    thin, usual, thick = (runs[f"x07-mud-{name}"] for name in ("thin", "default", "thick"))
    rows = [row for run in (thin, usual, thick) for row in common("X07", run, penetration=run is thick)]
    rows += [_thrown(run) for run in (thin, usual)]
    item, mud = thick.case.string[0], thick.case.fluid
    omega = thick.case.top.rotation.value(2.0)
    p = thick.probes
    late = p["time"] > SETTLED
    t, x, y = p["time"][late], p["x_30"][late], p["y_30"][late]
    x, y = _without_drift(t, x), _without_drift(t, y)
    push = pipe_mass(item) * item.eccentricity * omega**2
    rows += [
        near("X07", "thick: whirl rate over rotation, forward", whirl_rate(x, y, t) / omega, 1.0, 0.02),
        near(
            "X07",
            "thick: radius of the whirl at 30 m [m]",
            float(np.hypot(x, y).mean()),
            push / (omega * float(mud.lateral_damping)),
            0.10,
        ),
        at_most(
            "X07",
            "thick: contact force over centrifugal force of an element",
            float(p["contact_40"][late].max()) / (push * 4.0),
            1.0,
        ),
        at_most(
            "X07", "thin: steps over those in default mud", thin.summary["steps"] / usual.summary["steps"], 5
        ),
    ]
    return rows


def _thrown(run: Run) -> Row:
    """The axis strikes the wall with e Omega at most as it leaves rest (see X05)."""
    item, contact = run.case.string[0], run.case.contact
    omega = run.case.top.rotation.value(2.0)
    m, component = pipe_mass(item), 0.5 * (run.case.well.sections[0].diameter - item.od)
    depth = (
        item.eccentricity * omega * np.sqrt(m / contact.stiffness)
        + m * (component + item.eccentricity) * omega**2 / contact.stiffness
    )
    return at_most(
        "X07", f"{run.name}: penetration at the frames [m]", float(run.penetration.max()), max(depth, 1.11e-3)
    )


def _without_drift(t: FloatArray, x: FloatArray) -> FloatArray:
    return x - np.polyval(np.polyfit(t, x, 2), t)


def pump_trip(runs: Runs) -> list[Row]:
    """X08.  The wave behind the stopped pump: dp = rho c dV, with the speed of a pressure wave in a pipe that
    gives way sideways and, as it grows thinner, along: rho c^2 [1/K + wall + 4 nu^2 A_i/(EA (1 - (c/c_t)^2))]
    = 1, c_t the axial wave of the steel (from the mass of the mud and the momentum of the steel behind a wave
    front; Tijsseling, J. Fluids Struct. 10, 1996).  The top takes dp A_i less what the wall loses of the
    tension 2 nu A_i dp that the bulging pipe would have if it were held: its end is held, but the front runs
    on free pipe, and of a step that moves with c in a rod with waves c_t the fixed end feels k/(1 + k), k =
    c/c_t."""
    run, viscous = runs["x08-pump-trip"], runs["x08-pump-trip-viscous"]
    item, mud = run.case.string[0], run.case.fluid
    bore = np.pi / 4 * item.id**2
    ea, nu = section(item)[0], item.material.poisson
    wall = 2 / item.material.young * ((item.od**2 + item.id**2) / (item.od**2 - item.id**2) + nu)
    steel = np.sqrt(item.material.young / item.material.density)
    c = 1000.0
    for _ in range(50):
        c = (
            mud.density * (1 / mud.bulk_modulus + wall + 4 * nu**2 * bore / (ea * (1 - (c / steel) ** 2)))
        ) ** -0.5
    h = run.history
    t, p = h["time"], h["pump_pressure"]
    stop = int(np.searchsorted(t, 2.0 - 1e-9))
    jump = mud.density * c * float(h["pump_flow"][stop - 1]) / bore
    dp = p[stop - 1] - p[(t > 2.05) & (t < 3.5)].mean()
    share = c / steel / (1 + c / steel)
    pull = h["hook_load"][(t > 2.05) & (t < 2.35)].mean() - h["hook_load"][stop - 1]
    v = viscous.history
    before = float(np.median(v["step"][(v["time"] > 1.0) & (v["time"] < 1.8)]))
    after = float(v["step"][(v["time"] > 2.5) & (v["time"] < 7.0)].max())
    first = float(h["step"][stop + 1])
    return [
        *common("X08", run),
        *common("X08", viscous),
        near("X08", "level of the pressure wave, rho c dV [Pa]", float(dp), jump, 0.01),
        near(
            "X08",
            "jump of the hook load, dp A_i (1 - 2 nu k/(1 + k)) [N]",
            float(pull),
            float(dp) * bore * (1 - 2 * nu * share),
            0.02,
        ),
        holds(
            "X08",
            "first step after the trip over the one before (formula restarted)",
            first / float(h["step"][stop - 5]),
            "< 0.5",
            first < 0.5 * float(h["step"][stop - 5]),
        ),
        at_least("X08", "viscous: longest step within 5 s after over the one before", after / before, 0.5),
    ]


def _balance(model: str, run: Run, moved: float | None = None) -> Row:
    reported = run.summary["mass"]
    most = moved or max(abs(reported["pumped"]), abs(reported["returned"]), abs(reported["content_change"]))
    return at_most(model, f"{run.name}: mud missing over mud moved", abs(reported["error"]) / most, BALANCE)


def deep_mud(runs: Runs) -> list[Row]:
    """Y01: starts in steady flow and steady rotation, and stays there."""
    run = runs["y01-deep-well-mud"]
    h = run.history
    rows = [*common("Y01", run), _balance("Y01", run)]
    return rows + [
        at_most(
            "Y01", f"change of {name} in 2 s, over it", float(np.ptp(h[name]) / abs(h[name].mean())), 0.02
        )
        for name in ("hook_load", "surface_torque", "pump_pressure")
    ]


def surge(runs: Runs) -> list[Row]:
    """Y02: speed of sound (K/rho)^(1/2) at the pressure of the place, of an isothermal fluid of constant
    modulus; the mud that is looked after is what the casing displaces on its way."""
    run = runs["y02-surge-near-sonic"]
    t, data = run.frames
    mud, item = run.case.fluid, run.case.string[0]
    sound = np.sqrt(mud.bulk_modulus / (mud.density * np.exp(data["annulus_pressure"] / mud.bulk_modulus)))
    mach = float((np.abs(data["annulus_speed"]) / sound).max())
    way = float(run.history["bit_depth"][-1] - run.history["bit_depth"][0])
    return [
        *common("Y02", run),
        holds("Y02", "fastest mud over its speed of sound", mach, "> 0.7", mach > 0.7),
        _balance("Y02", run, np.pi / 4 * item.od**2 * way),
        holds(
            "Y02",
            "pressure at the bottom rises while it falls",
            float(np.diff(run.after(0.05, "bit_pressure")).min()),
            "> 0",
            bool((np.diff(run.after(0.05, "bit_pressure")) > 0).all()),
        ),
    ]


def stiff_mud(runs: Runs) -> list[Row]:
    """Y03: stiff mud comes out as it is pumped in, less what the moving string stirs."""
    run = runs["y03-incompressible-mud"]
    out, pumped = run.after(1.0, "outlet_flow").mean(), run.after(1.0, "pump_flow").mean()
    return [
        *common("Y03", run),
        _balance("Y03", run),
        near("Y03", "flow out of the hole, the pump's [m3/s]", float(out), float(pumped), 0.01),
    ]


def soft_mud(runs: Runs) -> list[Row]:
    """Y04: soft mud is squeezed first: nothing comes out before the wave has gone down the string and up the
    annulus."""
    run = runs["y04-gas-like-mud"]
    mud, time = run.case.fluid, run.case.time
    front = np.sqrt(mud.bulk_modulus / mud.density) * time.end
    share = float(np.abs(run.history["outlet_flow"]).max() / run.history["pump_flow"].max())
    return [
        *common("Y04", run),
        _balance("Y04", run),
        at_most(
            "Y04", f"flow out over the pump's, while the wave has gone {front:.0f} m of 960 m", share, 1e-3
        ),
    ]


def tiny_elements(runs: Runs) -> list[Row]:
    """Y05: weight over the wall and the drive, and the torque of a pipe that turns in the hole, mu N R once
    the drive has come up: less than that of the whole weight on the wall, more than half of it (some of it
    hangs on the drive)."""
    run = runs["y05-3000-elements-on-30m"]
    item, hole = run.case.string[0], run.case.well.sections[0]
    side = pipe_mass(item) * 9.81 * item.length * np.sin(np.radians(80.0))
    most = hole.friction * side * item.od / 2
    torque = float(run.after(0.25, "surface_torque").mean())
    return [
        *common("Y05", run),
        holds(
            "Y05",
            "torque over that of the whole weight on the wall",
            torque / most,
            "0.5 to 1",
            0.5 <= torque / most <= 1.0,
        ),
    ]


def hour(runs: Runs) -> list[Row]:
    """Y06: after 7200 turns the books still balance, angles are what speeds and torques make of them, and no
    memory was taken.

    Orientation: angle turned at the top less that at the bit, and the integral of T/GJ, stay as far apart as
    in the first ten minutes, by a ten-thousandth of a turn; the bit's angle is the integral of its speed
    (rows every 0.1 s) to a ten-thousandth.
    """
    run = runs["y06-hour"]
    times, data = run.frames
    md, spun, torque = data["md"][0], data["spin_angle"], data["torque"]
    memory, energy, h = run.summary["memory"], run.summary["energy"], run.history
    item = np.searchsorted(np.cumsum([q.length for q in run.case.string]), 0.5 * (md[1:] + md[:-1]))
    pipes = [run.case.string[k] for k in item]
    stiffness = np.array(
        [np.pi / 64 * (q.od**4 - q.id**4) * q.material.young / (1 + q.material.poisson) for q in pipes]
    )
    off = spun[:, 0] - spun[:, -1] - (0.5 * (torque[:, 1:] + torque[:, :-1]) / stiffness) @ np.diff(md)
    drift = off[times >= times[-1] - 600.0].mean() - off[times <= 600.0].mean()
    by_bit = float(trapezoid(h["bit_speed"], h["time"]))
    return [
        *common("Y06", run),
        _balance("Y06", run),
        at_most("Y06", "error of the energy balance over energy exchanged", abs(energy["error_share"]), 0.01),
        near(
            "Y06",
            "turns of the top drive, 2 a second",
            float(spun[-1, 0]) / (2 * np.pi),
            2.0 * float(times[-1]),
            1e-9,
        ),
        near(
            "Y06",
            "turns of the bit, those of its speed",
            float(spun[-1, -1] - spun[0, -1]) / (2 * np.pi),
            by_bit / (2 * np.pi),
            1e-4,
        ),
        at_most(
            "Y06",
            "drift of the twist beside that of the torque, turns",
            float(abs(drift)) / (2 * np.pi),
            1e-4,
        ),
        at_most(
            "Y06",
            "memory taken after the first tenth, share of the peak",
            1 - memory["after_a_tenth"] / memory["peak"],
            0.01,
        ),
    ]
