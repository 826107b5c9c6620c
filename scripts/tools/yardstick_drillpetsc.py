"""drillpetsc on the problems of the yardstick: a case is built from the neutral numbers, and its commands answer."""

from __future__ import annotations

import sys
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import measured_rig
import numpy as np
from yardstick_common import GRAVITY, Found, threshold
from yardstick_score import Problem

import drillpetsc
from drillpetsc import Case
from drillpetsc.analysis.loads.torque_drag.readings.calibration import Calibration
from drillpetsc.analysis.loads.torque_drag.string_rows import rows_at
from drillpetsc.analysis.statics.answer import static_summary
from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
from drillpetsc.analysis.statics.placement import place_along_hole
from drillpetsc.analysis.statics.relaxation import come_to_rest
from drillpetsc.case.blocks.roadmap import MeasuredPoint
from drillpetsc.case.files.mud_report import api_annulus, by_rules
from drillpetsc.model.drilling_model import build_model
from drillpetsc.model.hole import build_well
from drillpetsc.output import read_table
from drillpetsc.solvers.static.static_newton import Equilibrium, StaticNewton

sys.path.insert(0, str(Path(__file__).parents[2]))
from tests.helpers.buckling import buckling_load  # noqa: E402


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
    return {
        "survey": survey,
        "sections": [{"to": length, "kind": "open_hole", "diameter": diameter, "friction": friction}],
    }


def summary_of(command: Callable[..., Any], case: Case, **choices: Any) -> Found:
    """Summary of a command on a case, in a folder that is removed."""
    with TemporaryDirectory() as folder:
        return dict(command(case, Path(folder) / "run", **choices).summary)


def equilibrium(case: Case, motion: tuple[float, float] = (0.0, 0.0)) -> tuple[Any, Found]:
    """Model in equilibrium while it slides (m/s down, rad/s), and its summary."""
    model = build_model(case)
    return model, static_summary(model, find_equilibrium(model, motion, False))


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
    clearance, wave = (
        0.5 * (given["hole diameter [m]"] - od),
        2 * np.pi / np.sqrt(8 * np.pi**2 * bending / force),
    )
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
    come_to_rest(model, StaticNewton(system, clearance=clearance), Equilibrium())
    middle = slice(elements // 4, 3 * elements // 4)
    cells, _ = model.contact.element_results(system.assembly)
    position = system.field("string.position")
    angle = np.unwrap(np.arctan2(position[:, 1], position[:, 0]))
    turns = abs(angle[middle.stop] - angle[middle.start]) / (2 * np.pi)
    beam = model.beam.element_results(system.assembly)
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
    """Statics of the turning string."""
    g = problem.given
    items = []
    for part, elements in (("drill pipe", 100), ("assembly", 10)):
        one, nu = g[part], g["Poisson's ratio [-]"]
        material = {
            "young": 2 * (1 + nu) * one["shear modulus [Pa]"],
            "poisson": nu,
            "density": g["density [kg/m3]"],
        }
        sizes = {
            "length": one["length [m]"],
            "od": one["outside diameter [m]"],
            "id": one["inside diameter [m]"],
        }
        items.append(
            {"kind": "pipe", **sizes, "element_length": one["length [m]"] / elements, "material": material}
        )
    length, static = sum(item["length"] for item in items), g["static friction [-]"]
    keys = {"string": items, "bottom": "free", "gravity": g["gravity [m/s2]"]}
    well = straight(length + 10, g["inclination [rad]"], g["hole diameter [m]"], static)
    case = Case(well=well, top={"kind": "top_drive"}, **keys)
    model, figures = equilibrium(case, (0.0, 1.0))
    spin = model.system.field("string.spin").ravel() if "string.spin" in model.system.layout.dofs else None
    found = {"break-off torque": figures["surface_torque"]}
    if spin is not None:
        found["break-off twist"] = abs(float(spin[0] - spin[-1]))
    return found


# ---------------------------------------------------------------------- fluids
def conveying(given: Found, mass: float, fluid: Found, **keys: Any) -> Case:
    """A vertical beam of 16 elements with a stiff, inviscid fluid."""
    item = {
        "kind": "beam", "length": given["length [m]"], "axial_stiffness": 1e10, "torsional_stiffness": 1e4,
        "bending_stiffness": given["bending stiffness [N m2]"], "mass": mass, "polar_inertia": 1.0,
        "od": given["outside diameter [m]"], "id": given.get("inside diameter [m]", 0.8 * given["outside diameter [m]"]),
        "element_length": given["length [m]"] / 16,
    }  # fmt: skip
    still = {"density": given["fluid density [kg/m3]"], "bulk_modulus": 1e14, "elastic_walls": False}
    inviscid = {"rheology": {"model": "newtonian", "viscosity": 0.0}}
    keys = {"gravity": 0.0, "initial": {"imperfection": 0.0}, **keys}
    return Case(string=[item], fluid={**still, **inviscid, **fluid}, **keys)


def paidoussis(problem: Problem) -> Found:
    """Flow rates at which the first mode of `modes` begins to grow."""
    g = problem.given
    length, bending, density = g["length [m]"], g["bending stiffness [N m2]"], g["fluid density [kg/m3]"]
    bore = np.pi / 4 * g["inside diameter [m]"] ** 2

    def made(u: float, beta: float, gamma: float, **ends: str) -> Case:
        mass = density * bore * (1 - beta) / beta
        gravity = gamma * bending / ((mass + density * bore) * length**3)
        flow = u / length * np.sqrt(bending / (density * bore)) * bore
        return conveying(g, mass, {"flow_rate": flow}, gravity=gravity, **ends)

    def found(u: float, *which: Any, **ends: str) -> Found:
        return summary_of(drillpetsc.modes, made(u, *which, **ends), count=6, kind="lateral")

    beta = g["hinged"]["beta [-]"]
    out: Found = {
        "divergence": threshold(
            lambda u: found(u, beta, 0.0, top="pinned", bottom="pinned")["unstable"] > 0, 2.0, 5.0
        ),
        "note": "16 elements",
    }
    for name, words in (("cantilever", "flutter"), ("hanging cantilever", "hanging flutter")):
        which = g[name]["beta [-]"], g[name].get("gamma [-]", 0.0)
        ends = {"top": "clamped", "bottom": "free"}
        u = threshold(lambda u, which=which, ends=ends: found(u, *which, **ends)["unstable"] > 0, 3.0, 8.0)
        at = found(u, *which, **ends)
        mass = density * bore / which[0]
        fastest = int(np.argmax(at["growth"]))
        out[f"{words} speed"] = u
        out[f"{words} frequency"] = (
            2 * np.pi * float(at["frequency"][fastest]) * length**2 * np.sqrt(mass / bending)
        )
    return out


def fritz(problem: Problem) -> Found:
    """Added mass and damping from frequency and growth of the first lateral mode."""
    g = problem.given
    length, bending, od = g["length [m]"], g["bending stiffness [N m2]"], g["outside diameter [m]"]
    displaced, speed = g["fluid density [kg/m3]"] * np.pi / 4 * od**2, g["reference angular speed [rad/s]"]
    viscosity = g["fluid density [kg/m3]"] * speed * od**2 / 4 / g["Stokes number [-]"]
    viscous = {
        "rheology": {"model": "newtonian", "viscosity": viscosity},
        "lateral_damping": "stokes", "lateral_damping_speed": speed,
    }  # fmt: skip
    out: Found = {"note": "16 elements"}
    for width in ("narrow", "wide"):
        well = straight(length + 2, 0.0, g[f"{width} ratio [-]"] * od)
        ends = {
            "top": "pinned",
            "bottom": {"kind": "pinned", "plugged": True},
            "contact": "none",
            "well": well,
        }
        mass = g["mass of pipe [kg/m]"]
        still = summary_of(
            drillpetsc.modes, conveying(g, mass, {"lateral_damping": "none"}, **ends), count=2, kind="lateral"
        )
        total = np.pi**4 * bending / length**4 / (2 * np.pi * float(still["frequency"][0])) ** 2
        out[f"added mass, {width}"] = (total - mass) / displaced
        model = build_model(conveying(g, mass, viscous, **ends))
        out[f"viscous damping, {width}"] = float(np.mean(model.fluid.annulus.lateral.damping)) / (
            displaced * speed
        )
    return out


def power_law(channel: str, dial: list[float]) -> Found:
    """Index and consistency [Pa s^n] of a channel by the rules of API RP 13D, from dial readings at 600, 300, 100 and 3 rpm."""
    readings = dict(zip(("600", "300", "100", "3"), dial, strict=True))
    found = by_rules("power_law", readings) if channel == "bore" else api_annulus(readings)
    assert found is not None
    return {"model": "power_law", "law": "api", "index": found[1], "consistency": found[0]}


def api_13d(problem: Problem) -> Found:
    """`hydraulics` with the constants of each channel, and with the second mud for the bit."""
    g, losses = problem.given, {}
    items = [
        {"kind": "pipe", "length": g[part]["length [m]"], "od": g[part]["outside diameter [m]"],
         "id": g[part]["inside diameter [m]"], "element_length": step}
        for part, step in (("pipe", 30.0), ("collars", 10.0))
    ]  # fmt: skip
    survey = {"md": [0.0, g["open hole"]["to [m]"]], "inclination": [0.0, 0.0], "azimuth": [0.0, 0.0]}
    sections = [
        {"kind": kind.replace(" ", "_"), "to": g[kind]["to [m]"], "diameter": g[kind]["diameter [m]"]}
        for kind in ("casing", "open hole")
    ]
    well, stiff = {"survey": survey, "sections": sections}, {"bulk_modulus": 1e14, "elastic_walls": False}
    names = {
        ("pipe", "bore", ""): "loss in pipe", ("collars", "bore", ""): "loss in collars",
        ("pipe", "annulus", "casing"): "loss around pipe in casing",
        ("pipe", "annulus", "open hole"): "loss around pipe in open hole",
        ("collars", "annulus", "open hole"): "loss around collars",
    }  # fmt: skip
    mud = g["first mud"]
    for channel, law in (("bore", "pipe"), ("annulus", "annulus")):
        fluid = {"density": mud["density [kg/m3]"], "flow_rate": mud["flow rate [m3/s]"], **stiff}
        case = Case(
            string=items,
            top="clamped",
            well=well,
            fluid={**fluid, "rheology": power_law(law, mud["dial readings [deg]"])},
        )
        with TemporaryDirectory() as folder:
            drillpetsc.hydraulics(case, Path(folder) / "run")
            table = read_table(Path(folder) / "run" / "hydraulics.csv")
        for k in np.flatnonzero(table["channel [-]"] == channel):
            for (part, where, around), name in names.items():
                side, size = ("inside", "od [m]") if channel == "bore" else ("outside", "id [m]")
                fits = (
                    where == channel and abs(float(table[size][k]) - g[part][f"{side} diameter [m]"]) < 1e-6
                )
                if around:
                    fits = fits and abs(float(table["od [m]"][k]) - g[around]["diameter [m]"]) < 1e-6
                if fits:
                    losses[name] = losses.get(name, 0.0) + float(table["pressure_loss [Pa]"][k])
    mud = g["second mud"]
    area = mud["nozzles"] * np.pi / 4 * mud["nozzle diameter [m]"] ** 2
    bit = {"kind": "bit", "length": 0.0, "od": 0.2159, "mass": 50.0, "nozzle_area": area}
    fluid = {"density": mud["density [kg/m3]"], "flow_rate": mud["flow rate [m3/s]"], **stiff}
    fluid["rheology"] = {"model": "newtonian", "viscosity": 1e-3}
    case = Case(string=[items[0], bit], top="clamped", well=well, fluid=fluid)
    return losses | {"loss in bit": summary_of(drillpetsc.hydraulics, case)["flows"][0]["bit_loss"]}


# ---------------------------------------------------------------------- measured wells
def items_of(problem: Problem, kind: Callable[[str], str] = lambda name: "tool") -> list[Found]:
    """Items of string.csv from the top down; a length that is missing reaches to the rig."""
    table, items = problem.table("string.csv"), []
    for k, name in enumerate(table["component"]):
        cell = {key: column[k] for key, column in table.items()}
        joint = {
            key: float(cell[f"tool joint {words} [m]"])
            for key, words in (("od", "outside diameter"), ("id", "inside diameter"), ("length", "length"))
            if cell[f"tool joint {words} [m]"]
        }
        one: Found = {
            "kind": "drill_pipe" if joint else "pipe" if name == "tubing" else kind(name), "name": f"{name} {k}",
            "length": float(cell["length [m]"]) if cell["length [m]"] else "fill",
            "od": float(cell["outside diameter [m]"]), "id": float(cell["inside diameter [m]"]),
        }  # fmt: skip
        if cell["weight in air [N/m]"]:
            one["weight"] = f"{cell['weight in air [N/m]']} N/m"
        items.append({**one, **({"tool_joint": joint} if joint else {})})
    return items


def survey_of(problem: Problem) -> Found:
    """Survey of survey.csv."""
    names = {"md": "measured depth [m]", "inclination": "inclination [rad]", "azimuth": "azimuth [rad]"}
    return {key: problem.column("survey.csv", name).tolist() for key, name in names.items()}


def fitted(case: Case, points: tuple[MeasuredPoint, ...], numbers: tuple[str, ...]) -> tuple[Any, Found]:
    """`calibrate` on readings: the work, and the fitted numbers."""
    work = Calibration(case, points)
    return work, dict(zip(numbers, work.fit(numbers).value, strict=True))


def volve_f5(problem: Problem) -> Found:
    """`calibrate` with the friction of the open hole and the block weight."""
    g, column = problem.given, lambda name: problem.column("readings.csv", name)
    well = {
        "survey": survey_of(problem),
        "sections": [
            {"to": g["casing"]["to [m]"], "kind": "casing", "diameter": g["casing"]["diameter [m]"], "friction": g["casing"]["friction [-]"]},
            {"to": "end", "kind": "open_hole", "diameter": g["open hole"]["diameter [m]"], "friction": 0.25},
        ],
    }  # fmt: skip
    mud = {"plastic_viscosity": g["plastic viscosity [Pa s]"], "yield_point": g["yield point [Pa]"]}
    case = Case(
        well=well, bit_depth=2400.0, string=items_of(problem), top={"kind": "top_drive", "rotation": 15.7}, bottom="free",
        gravity=g["gravity [m/s2]"], fluid={"density": g["mud density [kg/m3]"], "rheology": mud}, rig={"block_weight": 600e3},
        roadmap={"operations": ["drilling"]},
    )  # fmt: skip
    names = {
        "bit_depth": "bit depth [m]", "wob": "weight on bit [N]", "tob": "torque on bit [N m]", "rpm": "rotary speed [rad/s]",
        "flow_rate": "flow rate [m3/s]", "hook_load": "hook load [N]", "torque": "surface torque [N m]",
    }  # fmt: skip
    columns = {key: column(name) for key, name in names.items()}
    count = len(columns["wob"])
    points = tuple(
        MeasuredPoint(operation="drilling", **{key: float(values[k]) for key, values in columns.items()})
        for k in range(count)
    )
    work, numbers = fitted(case, points, ("open_hole", "block_weight"))
    computed, hook = work.computed([numbers])[0], work.data.hook
    out: Found = {"hook load": computed[hook].tolist(), "surface torque": computed[~hook].tolist()}
    hole = build_well(case)
    for depth in (1900, 2400):
        rows = rows_at(case, float(depth))
        down = np.asarray(hole.at(rows.edges)[0])[:, 2]
        out[f"hanging weight at {depth} m"] = float(rows.weight @ np.diff(down)) + float(rows.end_weight)
    words = ", ".join(f"{key.replace('_', ' ')} {value:.4g}" for key, value in numbers.items())
    return out | {"note": f"soft string; fitted {words}"}


def volve_f4(problem: Problem) -> Found:
    """`calibrate` with friction, weight factor and running drag; `hydraulics` for the stages."""
    g = problem.given
    casing = [
        {"kind": "casing", "to": q["to [m]"], "diameter": q["diameter [m]"], "friction": 0.25}
        for q in g["casing"]
    ]
    hole = {
        "kind": "open_hole",
        "to": "end",
        "diameter": g["open hole"]["diameter [m]"],
        "friction": g["open hole"]["friction [-]"],
    }
    items = items_of(problem)
    items[0]["joint_length"] = g["joint length of the drill pipe [m]"]
    fluid = {"density": g["mud density [kg/m3]"], "flow_rate": 0.0}
    fluid["rheology"] = {"model": "newtonian", "viscosity": g["viscosity [Pa s]"]}
    case = Case(
        well={"survey": survey_of(problem), "sections": [*casing, hole]}, string=items, top={"kind": "top_drive", "rotation": 0.0},
        fluid=fluid, rig={"block_weight": g["block weight [N]"]}, gravity=g["gravity [m/s2]"],
        roadmap={"operations": ["trip_in", "trip_out"]},
    )  # fmt: skip
    depth, speed, hook = (
        problem.column("readings.csv", name) for name in ("bit depth [m]", "speed [m/s]", "hook load [N]")
    )
    words = {"down": "trip_in", "up": "trip_out"}
    motions = problem.table("readings.csv")["motion"]
    points = tuple(
        MeasuredPoint(operation=words[m], bit_depth=float(d), speed=float(v), hook_load=float(h))
        for m, d, v, h in zip(motions, depth, speed, hook, strict=True)
    )
    work, numbers = fitted(case, points, ("cased", "weight_factor", "running_drag"))
    stages = case.replace({"bit_depth": g["bit depth of the stages [m]"]})
    pumped = pump_pressures(stages, problem.column("stages.csv", "flow rate [m3/s]"))
    said = ", ".join(f"{key.replace('_', ' ')} {value:.4g}" for key, value in numbers.items())
    return {
        "hook load": work.computed([numbers])[0].tolist(),
        "pump pressure": pumped.tolist(),
        "note": f"soft string; fitted {said}",
    }


def pump_pressures(case: Case, flows: np.ndarray) -> np.ndarray:
    """Pressure of the pump above the outlet [Pa] at flow rates (n,) [m3/s]."""
    summary = summary_of(drillpetsc.hydraulics, case, flow=[f"{q} m3/s" for q in flows])
    return np.array([flow["pump_pressure"] for flow in summary["flows"]]) - summary["outlet_pressure"]


def forge_16b(problem: Problem) -> Found:
    """`hydraulics`; the tools' coefficient from the largest flow rate."""
    g = problem.given
    casing = [
        {"kind": "casing", "to": q["to [m]"], "diameter": q["diameter [m]"], "friction": 0.2}
        for q in g["casing"]
    ]
    hole = {"kind": "open_hole", "to": "end", "diameter": g["open hole"]["diameter [m]"], "friction": 0.3}
    *items, bit = items_of(problem)
    area = g["nozzles"] * np.pi / 4 * g["nozzle diameter [m]"] ** 2
    items.append({"kind": "bit", "length": bit["length"], "od": bit["od"], "mass": 50.0, "nozzle_area": area})
    fluid = {"density": g["mud density [kg/m3]"], "flow_rate": 0.04, "surface_line": {"case": 4}}
    fluid["rheology"] = {"model": "newtonian", "viscosity": g["viscosity [Pa s]"]}
    case = Case(
        well={"survey": survey_of(problem), "sections": [*casing, hole]}, string=items, top={"kind": "top_drive"},
        bottom="bit", fluid=fluid, bit_depth=g["measured depth of the bit [m]"],
    )  # fmt: skip
    flow = problem.column("stages.csv", "flow rate [m3/s]")
    largest, read = (
        float(problem.column("largest.csv", name)[0]) for name in ("flow rate [m3/s]", "pump pressure [Pa]")
    )
    computed = pump_pressures(case, np.append(flow, largest))
    tools = (read - computed[-1]) * (flow / largest) ** 2
    rate = [f"{g['flow rate of the bit loss [m3/s]']} m3/s"]
    return {
        "pump pressure": (computed[:-1] + tools).tolist(),
        "loss in bit": summary_of(drillpetsc.hydraulics, case, flow=rate)["flows"][0]["bit_loss"],
        "note": "surface line of case 4",
    }


def laboratory_rig(problem: Problem) -> Found:
    """A run of 8 s with one torsional element and the bit as a rigid body."""
    g = problem.given
    shaft, bit, motor = g["shaft"], g["bit"], g["motor"]
    stiffness, slope = shaft["stiffness [N m/rad]"], motor["loss of speed [N m s/rad]"]
    string = [
        {"kind": "beam", "length": 1.0, "element_length": 1.0, "od": 0.02, "mass": 1.0, "polar_inertia": 1e-6,
         "axial_stiffness": 1e6, "bending_stiffness": 1e3, "torsional_stiffness": stiffness,
         "damping": {"stiffness": shaft["damping [N m s/rad]"] / stiffness}},
        {"kind": "bit", "length": 0.1, "od": 0.1, "mass": 10.0, "inertia": {"axial": bit["inertia [kg m2]"], "transverse": 1.0}},
    ]  # fmt: skip
    law = {"kind": "velocity_weakening", "static": g["torque on bit"]["static [N m]"], "dynamic": 0.0}
    law["speed"] = g["torque on bit"]["speed w0 [rad/s]"]
    case = Case(
        well=straight(1.1, 0.0, 0.1), string=string, contact={"slip_velocity": 5e-4}, bottom={"kind": "bit"}, gravity=9.81,
        top={
            "kind": "top_drive", "rotation": motor["stall torque [N m]"] / slope,
            "motor": {"inertia": motor["inertia [kg m2]"], "time_constant": motor["lag [s]"]},
            "control": {"kind": "pi", "p": slope, "i": 0.0},
        },
        formation={"drillability": 0.0, "bit_law": law},
        initial={"from": "statics", "wob": g["weight on bit [N]"], "imperfection": 0.0},
        time={"end": 8.0}, output={"history_every": 1e-3, "field_every": 4.0},
    )  # fmt: skip
    with TemporaryDirectory() as folder:
        drillpetsc.run(case, Path(folder) / "run", progress="silent")
        table = read_table(Path(folder) / "run" / "history.csv")
    late = table["time [s]"] >= table["time [s]"][-1] - measured_rig.LENGTH
    found = measured_rig.figures(
        table["time [s]"][late], measured_rig.low_pass(table["bit_speed [rad/s]"])[late]
    )
    figures = {
        "mean": found.mean,
        "frequency": found.frequency,
        "peak": found.peak,
        "stuck share": found.stuck,
    }
    return figures | {f"{key}, predicted": value for key, value in figures.items()}


def madsim(problem: Problem) -> Found:
    """Statics of the assembly: its bend in a short piece, bit and blades of 1 cm on a wall of the given stiffness."""
    g, table = problem.given, problem.table("components.csv")
    part = {name: np.array(cells, dtype=float) for name, cells in table.items()}
    short, at, wall = (
        0.01,
        g["distance of the bend from the bit [m]"],
        g["stiffness of the wall at a contact [N/m]"],
    )
    touches = {q["distance from bit [m]"]: q["diameter [m]"] for q in g["contact diameters"]}
    bends = [at - short, at + short]
    blades = [z + side * short / 2 for z in touches if z > 0 for side in (-1, 1)]
    cuts = np.unique(np.round([0.0, short, *part["to [m]"], *blades, *bends], 6))
    items: list[Found] = []
    for a, b in pairwise(cuts):
        middle = 0.5 * (a + b)
        cell = {name: float(column[np.searchsorted(part["to [m]"], middle)]) for name, column in part.items()}
        mass = cell["weight in air [N/m]"] / 9.80665
        touch = next((od for z, od in touches.items() if abs(z - middle) < short), None)
        if touch:
            kind = "stabilizer" if a else "bit"
            items.append({"kind": kind, "length": float(b - a), "od": touch, "mass": mass * float(b - a)})
            continue
        items.append(beam_of(cell, float(b - a), mass))
        if bends[0] - 1e-5 < a and b < bends[1] + 1e-5:
            items[-1]["bend"] = {"angle": g["bend [rad]"] * float(b - a) / (2 * short), "tool_face": 0.0}
    length, depth = float(cuts[-1]), g["measured depth of the bit [m]"]  # the case begins at the string's top
    azimuth = np.interp(
        np.linspace(depth - length, depth, 12), [0, depth], [g["azimuth at the start [rad]"], g["azimuth at the bit [rad]"]]
    )  # fmt: skip
    survey = {
        "md": np.linspace(0, length, 12).tolist(),
        "inclination": [g["inclination [rad]"]] * 12,
        "azimuth": azimuth.tolist(),
    }
    hole = {"to": length, "kind": "open_hole", "diameter": g["hole diameter [m]"], "friction": 0.0}
    mud = {
        "density": g["mud density [kg/m3]"],
        "flow_rate": 0.0,
        "rheology": {"model": "newtonian", "viscosity": 1e-3},
    }
    case = Case(
        well={"survey": survey, "sections": [hole]}, string=items[::-1], top={"kind": "top_drive"}, bottom="bit",
        initial={"wob": g["weight on bit [N]"]}, contact={"stiffness": wall / short}, fluid=mud,
    )  # fmt: skip
    with TemporaryDirectory() as folder:
        summary = drillpetsc.statics(case, Path(folder) / "run").summary
        table = read_table(Path(folder) / "run" / "statics.csv")
    rigid = {round(length - q["md [m]"], 2): q["side_force [N]"] for q in summary["rigid_items"]}
    stabilizer = min(z for z in touches if z > 0)
    near = min(rigid, key=lambda z: abs(z - stabilizer))
    return {
        "side force at bit": rigid[min(rigid)], "stabilizer force": rigid[near],
        "bending moment": float(np.interp(length - stabilizer, table["md [m]"], table["bending_moment [N m]"])),
        "note": "elements of 0.1 m; bit and blades of 1 cm; the torque on bit is left out",
    }  # fmt: skip


def beam_of(cell: Found, length: float, mass: float) -> Found:
    """A beam of a row of components.csv: length [m], mass per length [kg/m]."""
    od, bore, young = cell["outside diameter [m]"], cell["inside diameter [m]"], cell["Young's modulus [Pa]"]
    second = cell["area moment of inertia [m4]"]
    return {
        "kind": "beam", "length": length, "od": od, "id": bore, "element_length": 0.1,
        "axial_stiffness": young * np.pi / 4 * (od**2 - bore**2), "bending_stiffness": young * second,
        "torsional_stiffness": young / (1 + cell["Poisson's ratio [-]"]) * second, "mass": mass,
        "polar_inertia": 2 * 7850 * second,
    }  # fmt: skip


SOLVERS: dict[str, Callable[[Problem], Found]] = {
    "lubinski": lubinski, "mitchell": mitchell, "dawson-paslay": dawson_paslay, "madsim": madsim,
    "aarsnes-shor": aarsnes_shor, "api-13d": api_13d, "paidoussis": paidoussis, "fritz": fritz,
    "volve-f5": volve_f5, "volve-f4": volve_f4, "forge-16b": forge_16b, "laboratory-rig": laboratory_rig,
}  # fmt: skip
