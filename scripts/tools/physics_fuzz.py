"""Fuzz test of statics: random realistic wells, strings, muds and operations, with checks that need no reference.

Each case follows from --seed and its number alone.  A case ends as `right` (all checks hold), `refused` (with a
reason), `warned` (a check on the mesh or on the uniqueness of a buckled state fails, and the summary says of the same
case that its elements are too long, or that there are other states), or `wrong` (a check fails without a word, or there
is no reason).  The checks, from the written results and the case alone:

- axial balance: hook load = weight along the hole - friction - weight on bit, from the table's contact forces
- torque balance: surface torque = friction's + the bit's
- the string lies inside the hole, up to the wall's give
- the requested weight on bit is met
- a hole turned about the vertical, and its mirror image, give the same loads
- half the element length gives the same loads where nothing buckles
- where nothing buckles, hook load and torque lie near those of the soft string
"""

from __future__ import annotations

import argparse
import random
import tempfile
import traceback
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from drillpetsc import Case, statics
from drillpetsc.errors import DrillError
from drillpetsc.model.drilling_model import build_model
from drillpetsc.output import read_table

G = 9.81
PIPES = ((0.0889, 0.0702), (0.127, 0.1086), (0.1397, 0.1214), (0.1683, 0.1515))  # drill pipe, od and id [m]
COLLARS = ((0.1207, 0.0572), (0.1651, 0.0714), (0.2032, 0.0714), (0.2286, 0.0762))
BITS = (0.1524, 0.2159, 0.3111, 0.4445)
MOTIONS = ("hoist", "lower", "rotate", None)
OTHER_STATES = (
    0.1  # spread of the hook loads of a buckled string's states, as a share of its largest axial force
)


@dataclass
class Outcome:
    """How one case ended.  kind: right, refused, warned or wrong; problems: what was wrong, or the reason."""

    number: int
    kind: str
    title: str
    problems: list[str] = field(default_factory=list)


def well_path(rng: random.Random, length: float) -> tuple[str, dict[str, list[float]]]:
    """Survey of a random path [m, rad]: vertical, slant, build and hold, S-shaped, horizontal, or wandering."""
    kind = rng.choice(("vertical", "slant", "build", "s", "horizontal", "wandering"))
    md = np.append(np.arange(0.0, length, 30.0), length)
    rate = np.radians(rng.uniform(1.0, 6.0)) / 30.0
    kick = rng.uniform(0.05, 0.5) * length
    if kind == "vertical":
        inclination = np.zeros(len(md))
    elif kind == "slant":
        inclination = np.full(len(md), np.radians(rng.uniform(5, 60)))
    else:
        hold = np.radians(90.0 if kind == "horizontal" else rng.uniform(15, 80))
        inclination = np.clip((md - kick) * rate, 0.0, hold)
        if kind == "s":
            drop = kick + hold / rate + rng.uniform(0.1, 0.4) * length
            inclination -= np.clip((md - drop) * rate, 0.0, hold)
    azimuth = np.full(len(md), rng.uniform(0, 2 * np.pi))
    if kind == "wandering":
        azimuth += np.clip(md - kick, 0, None) * np.radians(rng.uniform(-2, 2)) / 30.0
        inclination += np.radians(0.3) * np.sin(md / 45.0) * (md > 60)
    return kind, {
        "md": md.tolist(),
        "inclination": np.abs(inclination).tolist(),
        "azimuth": np.mod(azimuth, 2 * np.pi).tolist(),
    }


def random_case(seed: int, number: int) -> tuple[dict[str, Any], str | None, str]:
    """Data of case ``number``, its motion, and a title."""
    rng = random.Random(f"{seed}/{number}")
    length = round(rng.choice((250.0, 600.0, 1200.0, 2500.0)) * rng.uniform(0.8, 1.2), 1)
    kind, survey = well_path(rng, length)
    bit = rng.choice(BITS)
    size = BITS.index(bit)
    pipe, collar = PIPES[size if rng.random() < 0.7 else max(size - 1, 0)], COLLARS[size]
    friction = rng.choice((0.0, 0.1, 0.2, 0.3, 0.4))
    shoe = round(rng.uniform(0.2, 0.7) * length, 1)
    open_hole = bit * rng.choice((1.0, 1.02, 1.1))
    sections = [
        {"to": shoe, "kind": "casing", "diameter": max(1.05 * bit, open_hole), "friction": 0.7 * friction},
        {"to": length, "kind": "open_hole", "diameter": open_hole, "friction": friction},
    ]
    short = rng.choice((0.0, 0.0, round(rng.uniform(0.02, 0.3) * length, 1)))
    bha = min(rng.uniform(20, 200), 0.3 * length)
    string: list[dict[str, Any]] = [
        {"kind": "pipe", "name": "drill pipe", "length": 0.0, "od": pipe[0], "id": pipe[1]},
        {"kind": "pipe", "name": "drill collar", "length": round(bha, 1), "od": collar[0], "id": collar[1]},
    ]
    if rng.random() < 0.5:
        string.append(
            {
                "kind": "stabilizer",
                "length": 1.0,
                "od": round(0.98 * bit, 4),
                "mass": round(3000.0 * bit**2, 1),
            }
        )
        string.append({"kind": "pipe", "name": "near bit", "length": 3.0, "od": collar[0], "id": collar[1]})
    wet = rng.random() < 0.4
    if wet and len(string) > 2:  # the body of a bladed stabilizer, past which the mud flows
        string[2]["od"] = round(0.85 * bit, 4)
    string.append({"kind": "bit", "length": 0.4, "od": bit, "mass": 60.0})
    rest = sum(item["length"] for item in string)
    string[0]["length"] = round(length - short - rest, 4)
    element = max(5.0, round(length / 200, 1))
    for item in string:
        if item["kind"] == "pipe":
            item["element_length"] = min(element, item["length"])
    motion = rng.choice(MOTIONS)
    on_bottom = rng.random() < 0.6 and motion != "hoist"
    wob = round(rng.choice((10.0, 1e3, 3e4, 8e4, 1.5e5)) * rng.uniform(0.5, 1.0), 1)
    data: dict[str, Any] = {
        "title": f"{number}: {kind}, {length:g} m, friction {friction:g}",
        "well": {"survey": survey, "sections": sections},
        "string": string,
        "top": {"kind": "top_drive"},
        "bottom": {"kind": "bit"} if on_bottom else "free",
        "gravity": G,
        "initial": {"from": "statics", **({"wob": wob} if on_bottom else {})},
    }
    if wet:
        data["fluid"] = {
            "density": rng.uniform(1000, 1800),
            "rheology": {"model": "power_law", "consistency": 0.4, "index": 0.7},
            "bulk_modulus": 2e9,
            "flow_rate": rng.choice((0.0, 0.3, 1.0)) * (0.015, 0.03, 0.05, 0.06)[size],
        }
    title = f"{kind} {length:g} m, {motion}, wob {wob if on_bottom else 0:g} N, {'wet' if 'fluid' in data else 'dry'}, mu {friction:g}, short {short:g}"
    return data, motion, title


@dataclass
class Solved:
    """Results of one static solution."""

    summary: dict[str, Any]
    table: dict[str, np.ndarray]

    @property
    def buckled(self) -> bool:
        return any(self.summary["buckling"].values())


def solve(data: dict[str, Any], motion: str | None, folder: Path) -> Solved:
    """Solve one case; the results are read back from the files."""
    result = statics(Case(**data), folder, motion=motion, overwrite=True)
    return Solved(result.summary, read_table(folder / "statics.csv"))


def rigid(data: dict[str, Any], summary: dict[str, Any]) -> list[tuple[int, dict[str, Any]]]:
    """Rigid items of a summary with their numbers in the string."""
    numbers = [i for i, item in enumerate(data["string"]) if item["kind"] != "pipe"]
    return list(zip(numbers, summary["rigid_items"], strict=True))


def balance(data: dict[str, Any], motion: str | None, solved: Solved) -> list[str]:
    """Problems with the balance of axial force and torque along the string, from the written results."""
    model = build_model(Case(**data))
    mesh, well = model.mesh, model.well
    assert well is not None
    s, t = solved.summary, solved.table
    contact = t["contact_force [N/m]"]
    inside = 0.5 * (contact[1:] + contact[:-1]) * mesh.length
    items = [(item["contact_force_sum [N]"], 0.5 * data["string"][i]["od"]) for i, item in rigid(data, s)]
    shift = float(data["well"]["sections"][-1]["to"]) - mesh.total_length if "wob" in data["initial"] else 0.0
    mu = np.asarray(well.friction(0.5 * (mesh.upper + mesh.lower) + shift))
    # the last item is the bit, whose drag is part of the axial force at the lowest node
    drag = float((mu * inside).sum()) + float(mu[-1]) * sum(force for force, _ in items[:-1])
    direction = {"hoist": 1.0, "lower": -1.0}.get(motion or "", 0.0)
    problems = []
    force = t.get("effective_tension [N]", t["axial_force [N]"])
    # buoyed weight along the hole between the nodes, from the vertical depths of the string itself
    cosine = np.cos(np.radians(t["inclination [deg]"]))
    weight = model.effective_mass * G * mesh.length * 0.5 * (cosine[1:] + cosine[:-1])
    change = float(force[0] - force[-1])
    own_weight = sum(b.mass for b in mesh.bodies if b.node < mesh.nodes - 1) * G
    expected = float(weight.sum()) + direction * drag
    scale = max(float(np.abs(weight).sum()) + drag, 1e3)
    # flowing mud drags the pipe, which the table does not list
    if (
        not data.get("fluid", {}).get("flow_rate")
        and abs(change - expected) > 0.03 * scale + 1.5 * own_weight + 500.0
    ):
        problems.append(
            f"axial balance: {change:.5g} N along the string, {expected:.5g} N from weight and friction"
        )
    if motion == "rotate":
        radius = 0.5 * mesh.outer_diameter
        torque = float((mu * inside * radius).sum()) + float(s["bit_torque"])
        torque += float(mu[-1]) * sum(force * lever for force, lever in items)
        if abs(s["surface_torque"] - torque) > 0.05 * max(torque, 1.0) + 50.0:
            problems.append(
                f"torque balance: {s['surface_torque']:.5g} N m at the top, {torque:.5g} N m from friction"
            )
    elif abs(s["surface_torque"]) > 0.02 * scale * 0.1 + 20.0:
        problems.append(f"torque of {s['surface_torque']:.4g} N m without rotation")
    wob = data["initial"].get("wob")
    if wob and abs(s["wob"] - wob) > 1e-3 * wob:
        problems.append(f"weight on bit {s['wob']:.6g} N instead of {wob:.6g} N")
    return problems


def inside_hole(data: dict[str, Any], solved: Solved) -> list[str]:
    """Problems with nodes beyond the wall."""
    model = build_model(Case(**data))
    mesh, well, t = model.mesh, model.well, solved.table
    assert well is not None
    outer = np.maximum(np.append(mesh.outer_diameter, 0), np.append(0, mesh.outer_diameter))
    gap = np.asarray(well.radius(mesh.node_depth)) - 0.5 * outer
    offset = np.hypot(t["offset_x [m]"], t["offset_y [m]"])
    contact = np.abs(t["contact_force [N/m]"]).max(initial=0.0)
    # contact acts at points inside the elements: a node between them reaches beyond the wall by millimetres, most
    # where a clamped end bends the string
    allowed = np.maximum(gap, 0.0) + 5e-3 + 3 * contact / 1e8
    allowed[:5] += 5e-3
    element = data["string"][0]["element_length"]
    curvature = np.linalg.norm(np.asarray(well.at(np.linspace(0.0, float(well.depth), 500))[2]), axis=1).max()
    allowed += 0.1 * element**2 * curvature / 8
    beyond = offset - allowed
    # nodes have the depth of the unstrained string, so which side of a shoe they are on is not known
    margin = solved.summary["stretch"] + data["string"][0]["element_length"]
    shift = float(data["well"]["sections"][-1]["to"]) - model.mesh.total_length
    shoe = float(data["well"]["sections"][0]["to"])
    beyond[(mesh.node_depth > shoe - shift - margin) & (mesh.node_depth < shoe + margin)] -= 0.05
    worst = int(np.argmax(beyond))
    if beyond[worst] > 0:
        return [f"beyond the wall by {beyond[worst] * 1e3:.3g} mm at {mesh.node_depth[worst]:.0f} m"]
    return []


def warned(solved: Solved, problems: list[str]) -> bool:
    """Whether the summary says why checks of the mesh, or of the uniqueness of a buckled state, fail.

    ``OTHER_STATES`` of the largest force along the string is the spread of states between the thresholds of the helix
    that the note on other states covers; published bands are wider (25 % of what friction takes).
    """
    said = solved.summary["warnings"]
    if any("element_length of" in w for w in said):
        return True
    force = np.abs(solved.table.get("effective_tension [N]", solved.table["axial_force [N]"])).max()
    return (
        any("other stable states" in w for w in said)
        and all(p.startswith("hook_load") for p in problems)
        and all(abs(a - b) < OTHER_STATES * force for a, b in map(two_numbers, problems))
    )


def two_numbers(problem: str) -> tuple[float, float]:
    """The values that a problem of ``symmetry`` compares."""
    words = problem.replace(",", " ").split()
    return float(words[1]), float(words[-1])


def symmetry(data: dict[str, Any], motion: str | None, solved: Solved, folder: Path) -> list[str]:
    """Problems with the same hole turned about the vertical."""
    turned = {**data, "well": {**data["well"], "survey": dict(data["well"]["survey"])}}
    turned["well"]["survey"]["azimuth"] = [(a + 1.1) % (2 * np.pi) for a in data["well"]["survey"]["azimuth"]]
    other = solve(turned, motion, folder)
    problems = []
    for name in ("hook_load", "surface_torque", "wob"):
        a, b = solved.summary[name], other.summary[name]
        if abs(a - b) > (1e-4 if not solved.buckled else 2e-2) * max(abs(a), 1e4):
            problems.append(f"{name} {a:.8g}, in a hole turned by 63 deg {b:.8g}")
    return problems


def finer(data: dict[str, Any], motion: str | None, solved: Solved, folder: Path) -> list[str]:
    """Problems with half the element length."""
    if solved.buckled:
        return []
    string = [
        {**item, "element_length": 0.5 * item["element_length"]} if "element_length" in item else item
        for item in data["string"]
    ]
    other = solve({**data, "string": string}, motion, folder)
    problems = []
    for name, least in (("hook_load", 2e3), ("surface_torque", 100.0)):
        a, b = solved.summary[name], other.summary[name]
        if abs(a - b) > 0.01 * abs(a) + least:
            problems.append(f"{name} {a:.6g}, with half the element length {b:.6g}")
    return problems


def soft(solved: Solved, friction: float) -> list[str]:
    """Problems beside the soft string where nothing buckles."""
    bound = solved.summary.get("soft_string")
    if solved.buckled or bound is None:
        return []
    # in mud the force above which only mud stands: the hook load of a top inside the hole leaves that mud's push out
    force = solved.table.get("effective_tension [N]")
    a, b = solved.summary["hook_load"] if force is None else float(force[0]), bound["hook_load"]
    if abs(a - b) > (0.03 + 0.2 * friction) * abs(b) + 2e3:
        return [f"force at the top {a:.6g} N, soft string {b:.6g} N"]
    return []


def judged(seed: int, number: int, folder: Path, turned: bool = True, halved: bool = True) -> Outcome:
    """Solve and check one case.  turned: also in a hole that is turned about the vertical; halved: with half the element length."""
    data, motion, title = random_case(seed, number)
    friction = data["well"]["sections"][1]["friction"]
    try:
        solved = solve(data, motion, folder / "a")
        if not solved.summary["stable"]:
            said = [w for w in solved.summary["warnings"] if "unstable" in w or "stab" in w or "pivot" in w]
            return Outcome(
                number, "refused" if said else "wrong", title, said or ["unstable, without a word"]
            )
        problems = balance(data, motion, solved)
        # a flow drags the pipe, which the soft string leaves out
        problems += soft(solved, friction) if not data.get("fluid", {}).get("flow_rate") else []
        doubts = inside_hole(data, solved)
        doubts += symmetry(data, motion, solved, folder / "b") if turned else []
        doubts += finer(data, motion, solved, folder / "c") if halved else []
        if doubts and not problems and warned(solved, doubts):
            return Outcome(number, "warned", title, doubts)
        problems += doubts
    except DrillError as error:
        text = str(error)
        return Outcome(number, "refused" if len(text) > 20 else "wrong", title, [text.splitlines()[0]])
    except Exception:
        return Outcome(number, "wrong", title, [traceback.format_exc()])
    return Outcome(number, "wrong" if problems else "right", title, problems)


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("count", type=int, nargs="?", default=100, help="number of cases")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--first", type=int, default=0, help="number of the first case")
    parser.add_argument("--write", metavar="FILE", help="write case --first as YAML and stop")
    arguments = parser.parse_args()
    if arguments.write:
        data, motion, title = random_case(arguments.seed, arguments.first)
        Case(**data).dump(Path(arguments.write))
        print(f"{title}; motion {motion}")
        return 0
    counts: Counter[str] = Counter()
    with tempfile.TemporaryDirectory() as folder:
        for number in range(arguments.first, arguments.first + arguments.count):
            outcome = judged(arguments.seed, number, Path(folder))
            counts[outcome.kind] += 1
            if outcome.kind != "right":
                print(
                    f"{outcome.kind} {number} ({outcome.title})", *outcome.problems, sep="\n    ", flush=True
                )
    print(f"{sum(counts.values())} cases:", ", ".join(f"{n} {kind}" for kind, n in sorted(counts.items())))
    return 1 if counts["wrong"] else 0


if __name__ == "__main__":
    raise SystemExit(main())
