"""welleng's torque and drag on the problems of the yardstick: python scripts/tools/yardstick_welleng.py welleng.json [PROBLEM ...]

Run it with a Python that has welleng and scipy. The program has a soft string and nothing else that a problem asks for.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.optimize import least_squares
from welleng.architecture import BHA, WellBore
from welleng.survey import Survey
from welleng.torque_drag import TorqueDrag
from yardstick_common import Found, answer, tube
from yardstick_score import Problem

Section = dict[str, Any]
STATIONS = 30.0  # of the hole [m]


def string_of(problem: Problem, bit: float) -> list[Section]:
    """Sections of string.csv from the bottom up; a length that is missing reaches to the rig."""
    table = problem.table("string.csv")
    sections = []
    for k in reversed(range(len(table["component"]))):
        cell = {key: float(column[k]) for key, column in table.items() if key != "component" and column[k]}
        left = bit - sum(one["length"] for one in sections)
        sections.append(
            {
                "length": min(cell.get("length [m]", left), left),
                "od": cell["outside diameter [m]"],
                "unit_weight": cell["weight in air [N/m]"],
                "tooljoint_od": cell.get("tool joint outside diameter [m]"),
            }  # fmt: skip
        )
    sections[-1]["length"] += bit - sum(one["length"] for one in sections)
    return sections


def loads(
    survey: Section, wells: list[Section], sections: list[Section], density: float, **at_bit: float
) -> TorqueDrag:
    """Torque and drag of a string: survey in m and rad, wells from the top down, sections from the bottom up, mud [kg/m3]."""
    bit = sum(one["length"] for one in sections)
    depth = np.unique(np.r_[np.arange(0.0, bit, STATIONS), bit])
    path = {key: np.interp(depth, survey["md"], survey[key]) for key in ("inc", "azi")}
    well = WellBore("well", 0.0, bit, method="top_down")
    for one in wells:
        end = min(one["to"], bit)
        if not well.complete:
            well.add_section(bottom=end, id=one["id"], coeff_friction_sliding=one["friction"])
    string = BHA("string", 0.0, bit)
    for one in sections[:-1]:
        string.add_section(density=7.85, **one)
    string.add_section(density=7.85, **{**sections[-1], "length": None})  # to the rig, whatever rounding left
    return TorqueDrag(
        Survey(md=depth, inc=path["inc"], azi=path["azi"], deg=False), well, string, density / 1000, **at_bit
    )


def survey_of(problem: Problem) -> Section:
    """Survey of survey.csv; the azimuth without jumps."""
    md, inclination, azimuth = (
        problem.column("survey.csv", name)
        for name in ("measured depth [m]", "inclination [rad]", "azimuth [rad]")
    )
    return {"md": md, "inc": inclination, "azi": np.unwrap(azimuth)}


def aarsnes_shor(problem: Problem) -> Found:
    """Torque of the rotating string."""
    g = problem.given
    parts = [g["assembly"], g["drill pipe"]]
    heavy = g["density [kg/m3]"] * g["gravity [m/s2]"]
    sections = [
        {"length": one["length [m]"], "od": one["outside diameter [m]"], "unit_weight": heavy * tube(one)[1]}
        for one in parts
    ]
    bit = sum(one["length"] for one in sections)
    survey = {"md": [0.0, bit], "inc": [g["inclination [rad]"]] * 2, "azi": [0.0, 0.0]}
    wells = [{"to": bit, "id": g["hole diameter [m]"], "friction": g["static friction [-]"]}]
    found = loads(survey, wells, sections, 0.0)
    return {
        "break-off torque": float(np.ravel(found.torque["rotating"][0])[-1]),
        "note": f"stations of {STATIONS:.0f} m; the program takes the radii in the reverse order, which costs 3 %; twist is not in it",
    }


def volve_f5(problem: Problem) -> Found:
    """Hook loads and torques; friction and block weight by least squares of the adapter."""
    g, column = problem.given, lambda name: problem.column("readings.csv", name)
    survey, depth = survey_of(problem), column("bit depth [m]")
    read = np.array([column("hook load [N]"), column("surface torque [N m]")])

    def computed(numbers: np.ndarray) -> np.ndarray:
        wells = [
            {"to": g["casing"]["to [m]"], "id": g["casing"]["diameter [m]"], "friction": g["casing"]["friction [-]"]},
            {"to": np.inf, "id": g["open hole"]["diameter [m]"], "friction": numbers[0]},
        ]  # fmt: skip
        rows = []
        for bit, wob, tob in zip(
            depth, column("weight on bit [N]"), column("torque on bit [N m]"), strict=True
        ):
            found = loads(survey, wells, string_of(problem, bit), g["mud density [kg/m3]"], wob=wob, tob=tob)
            rows.append((top(found.tension["drilling"]) + numbers[1] * 1e5, top(found.torque["drilling"])))
        return np.array(rows).T

    def misfit(numbers: np.ndarray) -> np.ndarray:
        return np.ravel((computed(numbers) - read) / np.abs(read))

    best = least_squares(misfit, [0.25, 6.0]).x
    hook, torque = computed(best)
    found: Found = {"hook load": hook.tolist(), "surface torque": torque.tolist()}
    none = [{"to": np.inf, "id": g["open hole"]["diameter [m]"], "friction": 0.0}]
    for bit in (1900, 2400):
        weighed = loads(survey, none, string_of(problem, float(bit)), g["mud density [kg/m3]"])
        found[f"hanging weight at {bit} m"] = top(weighed.tension["rotating"])
    return found | {
        "note": f"stations of {STATIONS:.0f} m; fitted by the adapter: open hole {best[0]:.4g}, block weight {best[1] * 1e5:.4g}"
    }


def volve_f4(problem: Problem) -> Found:
    """Hook loads; friction, factor and drag by least squares of the adapter."""
    g = problem.given
    survey, motions = survey_of(problem), problem.table("readings.csv")["motion"]
    depth, speed, read = (
        problem.column("readings.csv", name) for name in ("bit depth [m]", "speed [m/s]", "hook load [N]")
    )
    hole = {"to": np.inf, "id": g["open hole"]["diameter [m]"], "friction": g["open hole"]["friction [-]"]}

    def computed(numbers: np.ndarray) -> np.ndarray:
        wells = [{"to": q["to [m]"], "id": q["diameter [m]"], "friction": numbers[0]} for q in g["casing"]]
        rows = []
        for bit, motion, fast in zip(depth, motions, speed, strict=True):
            sections = string_of(problem, bit)
            for one in sections:
                one["unit_weight"] *= numbers[1]
            found = loads(survey, [*wells, hole], sections, g["mud density [kg/m3]"])
            sign = -1 if motion == "down" else 1
            along = top(found.tension["slackoff" if motion == "down" else "pickup"])
            rows.append(along + sign * numbers[2] * 1e5 * fast + g["block weight [N]"])
        return np.array(rows)

    best = least_squares(lambda q: (computed(q) - read) / read, [0.25, 0.95, 1.0]).x
    return {
        "hook load": computed(best).tolist(),
        "note": f"stations of {STATIONS:.0f} m; fitted by the adapter: casing {best[0]:.4g}, weight factor {best[1]:.4g}, drag {best[2] * 1e5:.4g}; "
        "pressure losses are not in the program",
    }


def top(along: Any) -> float:
    """Value at the rig of a result along the string, which begins there."""
    first = np.ravel(along[0])
    return float(first[-1])


if __name__ == "__main__":
    answer({"aarsnes-shor": aarsnes_shor, "volve-f5": volve_f5, "volve-f4": volve_f4})
