"""Criteria of the cases with mud: X07, X08, and the cases of the coupled system, Y01 to Y06
(manual: sec-verif-robustness)."""

from __future__ import annotations

import numpy as np
from scipy.integrate import trapezoid

from drillpetsc.fem.component import FloatArray
from tests.robustness.contact import SETTLED, pipe_mass, whirl_rate
from tests.robustness.criteria import Row, Run, Runs, at_least, at_most, common, holds, near
from tests.robustness.string import section

LARGEST_IMBALANCE = 1e-3  # error of the mud mass balance over the mud that entered or left


def thick_and_thin(runs: Runs) -> list[Row]:
    """X07 (manual: verif-robust-thin-thick-mud): whirl in thick mud, steps in thin mud.

    In thick mud the unbalance acts against the drag c v: M r'' + c r' = m e Omega^2 exp(i Omega t), with the
    added mass in M. The axis circles forward with Omega and radius m e Omega/sqrt(c^2 + (M Omega)^2) about an
    unrestrained centre. A linear drag reduces the radius, not the rate; a whirl with reduced rate occurs only
    on the wall. Rate and radius are checked at 30 m of 40 m. M includes steel, mud in the bore and at most
    three times the displaced mud, in all a tenth of c/Omega, which changes the radius by less than 5 %.
    """
    thin, usual, thick = (runs[f"x07-mud-{name}"] for name in ("thin", "default", "thick"))
    rows = [row for run in (thin, usual, thick) for row in common("X07", run, penetration=run is thick)]
    rows += [_impact(run) for run in (thin, usual)]
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


def _impact(run: Run) -> Row:
    """The axis hits the wall at the start with at most e Omega (see X05)."""
    item, contact = run.case.string[0], run.case.contact
    omega = run.case.top.rotation.value(2.0)
    m, clearance = pipe_mass(item), 0.5 * (run.case.well.sections[0].diameter - item.od)
    depth = (
        item.eccentricity * omega * np.sqrt(m / contact.stiffness)
        + m * (clearance + item.eccentricity) * omega**2 / contact.stiffness
    )
    return at_most(
        "X07", f"{run.name}: penetration at the frames [m]", float(run.penetration.max()), max(depth, 1.11e-3)
    )


def _without_drift(t: FloatArray, x: FloatArray) -> FloatArray:
    return x - np.polyval(np.polyfit(t, x, 2), t)


def pump_trip(runs: Runs) -> list[Row]:
    """X08 (manual: verif-robust-pump-trip): pressure wave behind a stopped pump, dp = rho c dV.

    The wave speed c in a pipe that expands and shortens follows from rho c^2 [1/K + wall + 4 nu^2 A_i/(EA (1 -
    (c/c_t)^2))] = 1, with c_t the speed of axial waves in the steel (mass balance of the mud and momentum of the
    steel behind the wave front; Tijsseling, J. Fluids Struct. 10, 1996).

    The force on the top is dp A_i minus a part of the Poisson tension 2 nu A_i dp. The upper end is fixed, but
    the front runs along free pipe: of a step that moves with c in a rod with wave speed c_t the fixed end
    receives the fraction k/(1 + k), k = c/c_t.
    """
    run, viscous = runs["x08-pump-trip"], runs["x08-pump-trip-viscous"]
    item, mud = run.case.string[0], run.case.fluid
    bore = np.pi / 4 * item.id**2
    ea, nu = section(item)[0], item.material.poisson
    wall = 2 / item.material.young * (1 + nu + 2 * (1 - nu**2) * item.id**2 / (item.od**2 - item.id**2))
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


def _balance(case: str, run: Run, moved: float | None = None) -> Row:
    mass = run.summary["mass"]
    most = moved or max(abs(mass["pumped"]), abs(mass["returned"]), abs(mass["content_change"]))
    return at_most(
        case, f"{run.name}: mud missing over mud moved", abs(mass["error"]) / most, LARGEST_IMBALANCE
    )


def deep_mud(runs: Runs) -> list[Row]:
    """Y01 (manual: verif-robust-deep-well-mud): starts with steady flow and rotation, and keeps this state."""
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
    """Y02 (manual: verif-robust-near-sonic-surge): mud speed over the local speed of sound (K/rho)^(1/2) of an
    isothermal fluid of constant bulk modulus.

    The error of the mass balance is related to the mud that the casing displaces.
    """
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
    """Y03 (manual: verif-robust-stiff-mud): stiff mud leaves the hole at the rate of the pump."""
    run = runs["y03-incompressible-mud"]
    out, pumped = run.after(1.0, "outlet_flow").mean(), run.after(1.0, "pump_flow").mean()
    return [
        *common("Y03", run),
        _balance("Y03", run),
        near("Y03", "flow out of the hole, the pump's [m3/s]", float(out), float(pumped), 0.01),
    ]


def soft_mud(runs: Runs) -> list[Row]:
    """Y04 (manual: verif-robust-soft-mud): no soft mud leaves the hole before the pressure wave has passed the
    string and the annulus."""
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
    """Y05 (manual: verif-robust-tiny-elements): torque of a pipe that rotates in the hole, mu N R.

    Part of the weight hangs on the top drive, so the torque lies between half and all of that of the whole
    weight on the wall.
    """
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
    """Y06 (manual: verif-robust-hour): energy and mass balance, angles, and memory after 7200 turns.

    The difference between the twist (angle at the top minus that at the bit) and the integral of T/GJ changes
    by at most a ten-thousandth of a turn from the first to the last ten minutes. The angle of the bit is the
    integral of its speed (rows every 0.1 s) within a ten-thousandth.
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
            1 - memory["after_a_tenth"] / memory["end"],
            0.01,
        ),
    ]
