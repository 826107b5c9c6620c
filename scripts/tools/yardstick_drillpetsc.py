"""drillpetsc on the problems of the yardstick: a case is built from the neutral numbers, and its commands answer."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from scipy.optimize import brentq
from yardstick_score import Problem

import drillpetsc
from drillpetsc import Case
from drillpetsc.analysis.statics.answer import static_summary
from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
from drillpetsc.analysis.statics.placement import place_along_hole
from drillpetsc.analysis.statics.relaxation import relax
from drillpetsc.model.drilling_model import build_model
from drillpetsc.output import read_table
from drillpetsc.solvers.static.static_newton import Equilibrium, StaticNewton

sys.path.insert(0, str(Path(__file__).parents[2]))
from tests.helpers.buckling import buckling_load  # noqa: E402

Found = dict[str, Any]
GRAVITY = 9.81  # where a problem gives weights in mud [m/s2]


def pipe(given: Found, element: float, weight: float | None = None, **keys: Any) -> Found:
    """A pipe of the neutral sizes; weight in mud per length [N/m], else of steel."""
    od, bore = given["outside diameter [m]"], given["inside diameter [m]"]
    material = {"young": given["Young's modulus [Pa]"], "poisson": given["Poisson's ratio [-]"]}
    if weight is not None:
        material["density"] = weight / GRAVITY / (np.pi / 4 * (od**2 - bore**2))
    keys = {"length": given.get("length [m]"), **keys}
    return {"kind": "pipe", "od": od, "id": bore, "material": material, "element_length": element, **keys}


def straight(length: float, inclination: float, diameter: float, friction: float = 0.0) -> Found:
    """A straight hole: length [m], inclination [rad], diameter [m]."""
    survey = {"md": [0.0, length], "inclination": [inclination] * 2, "azimuth": [0.0, 0.0]}
    return {"survey": survey, "sections": [{"to": length, "kind": "open_hole", "diameter": diameter, "friction": friction}]}


def summary_of(command: Callable[..., Any], case: Case, **choices: Any) -> Found:
    """Summary of a command on a case, in a folder that is removed."""
    with TemporaryDirectory() as folder:
        return dict(command(case, Path(folder) / "run", **choices).summary)


def equilibrium(case: Case, motion: tuple[float, float] = (0.0, 0.0)) -> tuple[Any, Found]:
    """Model in equilibrium while it slides (m/s down, rad/s), and its summary."""
    model = build_model(case)
    return model, static_summary(model, find_equilibrium(model, motion))


def period(time: np.ndarray, signal: np.ndarray) -> float:
    """Mean time [s] between rises of a signal (n,) through its mean."""
    high = signal >= signal.mean()
    k = np.flatnonzero(~high[:-1] & high[1:])
    return float((time[k[-1]] - time[k[0]]) / (len(k) - 1))


def threshold(unstable: Callable[[float], bool], low: float, high: float, tolerance: float = 1e-4) -> float:
    """The load between low and high at which a straight string becomes unstable, by bisection."""
    while high - low > tolerance * high:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if unstable(middle) else (middle, high)
    return 0.5 * (low + high)


# ---------------------------------------------------------------------- buckling
def lubinski(problem: Problem) -> Found:
    """Weights on bit at which the straight string has one, and two, unstable shapes; side force of the hinge at the bit."""
    given = problem.given["buckling"]
    weight, length = given["weight in mud [N/m]"], given["length [m]"]
    bending = given["Young's modulus [Pa]"] * np.pi / 64
    bending *= given["outside diameter [m]"] ** 4 - given["inside diameter [m]"] ** 4
    unit = (bending * weight**2) ** (1 / 3)

    def shapes(wob: float) -> float:
        top = {"kind": "top_drive", "force": weight * length - wob}
        case = Case(
            string=[pipe(given, length / 100, weight)], top=top, bottom="pinned", gravity=GRAVITY,
            initial={"imperfection": 0.0},
        )  # fmt: skip
        return summary_of(drillpetsc.modes, case, count=8, kind="lateral")["diverging"] / 2

    found = {
        "first buckling": threshold(lambda wob: shapes(wob) >= 1, unit, 3 * unit),
        "second buckling": threshold(lambda wob: shapes(wob) >= 2, 3 * unit, 5 * unit),
        "note": "100 elements of 3 m",
    }
    given = problem.given["side force"]
    # a level hole and the weight across the inclined one: no axial force, as the problem asks
    collar = pipe(given, 1.0, given["weight in mud [N/m]"] * np.sin(given["inclination [rad]"]), length=40.0)
    case = Case(
        well=straight(40.0, np.pi / 2, given["hole diameter [m]"]), string=[collar],
        top={"kind": "top_drive", "force": 0.0}, bottom="pinned", gravity=GRAVITY,
    )  # fmt: skip
    model, _ = equilibrium(case)
    return found | {"side force at bit": abs(model.system.reaction("bottom.side_reaction_1"))}


def mitchell(problem: Problem) -> Found:
    """Relaxation from a helix on the wall; means over the middle half."""
    given = problem.given
    force, length, elements = given["compression [N]"], given["length [m]"], 160
    young, od = given["Young's modulus [Pa]"], given["outside diameter [m]"]
    bending = young * np.pi / 64 * (od**4 - given["inside diameter [m]"] ** 4)
    clearance, wave = 0.5 * (given["hole diameter [m]"] - od), 2 * np.pi / np.sqrt(8 * np.pi**2 * bending / force)
    case = Case(
        well=straight(length, 0.0, given["hole diameter [m]"]), string=[pipe(given, length / elements)],
        top={"kind": "top_drive", "force": -force}, bottom="pinned", gravity=0.0,
    )  # fmt: skip
    model = build_model(case)
    place_along_hole(model)
    system, depth = model.system, model.mesh.node_depth
    turn = wave * depth
    around = clearance * np.column_stack([np.cos(turn), np.sin(turn), np.zeros_like(turn)])
    slope = clearance * wave * np.column_stack([-np.sin(turn), np.cos(turn), np.zeros_like(turn)])
    system.set_field("string.position", model.position + around)
    system.set_field("string.tangent", model.tangent + slope)
    held = next(component for component in model.components if component.name == "held_end")
    for end, offset in ((model.top, around[0]), (held, around[-1])):
        end.anchor += end.prescribed()[0].directions[:, :3] @ offset
    model.contact.impose_sliding_direction(0.0, 0.0)
    relax(model, StaticNewton(system, clearance=clearance), Equilibrium())
    middle = slice(elements // 4, 3 * elements // 4)
    cells, _ = model.contact.element_results(system.assembly)
    position = system.field("string.position")
    angle = np.unwrap(np.arctan2(position[:, 1], position[:, 0]))
    turns = abs(angle[middle.stop] - angle[middle.start]) / (2 * np.pi)
    beam = model.beam.element_results(system.layout, system.assembly.x, system.assembly.y)
    return {
        "contact force": float((cells[middle, 0] / model.mesh.length[middle]).mean()),
        "pitch": float((depth[middle.stop] - depth[middle.start]) / turns),
        "bending moment": float(beam[middle, 7].mean()),
        "note": "160 elements; starts from a helix of the theory's pitch",
    }


def dawson_paslay(problem: Problem) -> Found:
    """Force at which the tangent stiffness loses its first positive pivot."""
    found: Found = {"note": "elements of 4 m"}
    for part, quantity in (("first", "buckling of 200 m"), ("second", "buckling of a long pipe")):
        given = problem.given[part]
        od, weight = given["outside diameter [m]"], given["weight in mud [N/m]"]
        clearance = 0.5 * (given["hole diameter [m]"] - od)
        bending = given["Young's modulus [Pa]"] * np.pi / 64 * (od**4 - given["inside diameter [m]"] ** 4)
        case = Case(
            well=straight(given["length [m]"], np.pi / 2, given["hole diameter [m]"]), string=[pipe(given, 4.0, weight)],
            top={"kind": "top_drive"}, bottom="free", gravity=GRAVITY,
        )  # fmt: skip
        near = 2 * np.sqrt(bending * weight / clearance)  # the search begins 10 % on both sides of it
        found[quantity] = buckling_load(build_model(case), clearance, near)
    return found


def aarsnes_shor(problem: Problem) -> Found:
    """Statics of the turning string for torque and twist; a run with the drive for the period."""
    g = problem.given
    items = []
    for part, elements in (("drill pipe", 100), ("assembly", 10)):
        one, nu = g[part], g["Poisson's ratio [-]"]
        material = {"young": 2 * (1 + nu) * one["shear modulus [Pa]"], "poisson": nu, "density": g["density [kg/m3]"]}
        sizes = {"length": one["length [m]"], "od": one["outside diameter [m]"], "id": one["inside diameter [m]"]}
        items.append({"kind": "pipe", **sizes, "element_length": one["length [m]"] / elements, "material": material})
    length, static = sum(item["length"] for item in items), g["static friction [-]"]
    keys = {"string": items, "bottom": "free", "gravity": g["gravity [m/s2]"]}
    well = straight(length + 10, g["inclination [rad]"], g["hole diameter [m]"], static)
    case = Case(well=well, top={"kind": "top_drive"}, **keys)
    model, figures = equilibrium(case, (0.0, 1.0))
    spin = model.system.field("string.spin").ravel() if "string.spin" in model.system.layout.dofs else None
    found = {"break-off torque": figures["surface_torque"]}
    if spin is not None:
        found["break-off twist"] = abs(float(spin[0] - spin[-1]))
    drive = g["drive"]
    t = np.linspace(0.0, 8.0, 33)
    dynamic = g["dynamic over static friction [-]"] * static
    radius = 0.5 * g["drill pipe"]["outside diameter [m]"]
    run = Case(
        well=straight(length + 10, g["inclination [rad]"], g["hole diameter [m]"], dynamic),
        contact={"stribeck": {"static": static, "speed": 0.5 * radius}},
        top={
            "kind": "top_drive", "motor": {"inertia": drive["inertia [kg m2]"]},
            "rotation": {"time": t.tolist(), "value": (drive["set point [rad/s]"] * (1 - np.exp(-t / drive["lag [s]"]))).tolist()},
            "control": {"kind": "pi", "p": drive["p [N m s/rad]"], "i": drive["i [N m/rad]"]},
        },
        time={"end": 60.0}, output={"history_every": 0.05, "field_every": 30.0}, **keys,
    )  # fmt: skip
    with TemporaryDirectory() as folder:
        drillpetsc.run(run, Path(folder) / "run", progress="silent")
        table = read_table(Path(folder) / "run" / "history.csv")
    late = table["time [s]"] >= 30
    return found | {"period": period(table["time [s]"][late], table["surface_torque [N m]"][late])}
