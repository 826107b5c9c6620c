"""Fuzz test of motion: random wells, strings with a tool, muds and operations; the energy of each run must be balanced.

The wells, strings and muds are those of scripts/physics-fuzz of at most 800 m, with one more tool: the string starts from
statics and is hoisted, lowered, turned or held while the pump changes. A force that the model leaves out of string or mud
does work that no other part takes up, so the balance shows it whatever the motion is.

Each case follows from --seed and its number alone. A case ends as `balanced`, `wrong` (energy error above 0.3 % of the
energy exchanged, or mud of 20 ml that comes from nowhere and is more than 1e-4 of the mud exchanged), `stopped` (more than --steps time steps), or `refused` with a reason.
"""

from __future__ import annotations

import argparse
import random
import tempfile
from collections import Counter
from math import pi
from pathlib import Path
from typing import Any

from physics_fuzz import random_case

from drillpetsc import Case, run
from drillpetsc.errors import DrillError

LONGEST = 800.0  # well [m]
LARGEST = 3e-3  # energy error as a share of the energy exchanged; a hole's step within an element leaves up to 0.25 %
LARGEST_MASS, LEAST_MASS = (
    1e-4,
    2e-5,
)  # mass error as a share of the mud exchanged, and as a volume [m3], below which it is none
STEEL = 7850.0 * 0.999  # density of rigid tools [kg/m3], just below that of a tube of their size
TOOLS: tuple[dict[str, Any] | None, ...] = (
    None,
    {"kind": "pipe", "length": 9.0, "element_length": 3.0},
    {"kind": "body", "length": 9.0},
    {"kind": "shock_sub", "length": 6.0, "stiffness": 5e6},
    {"kind": "jar", "length": 8.0, "jar": {"stroke": 0.2, "trigger": "900 kN", "action": "mechanical"}},
    {"kind": "pdm", "length": 8.0, "pdm": {"rev_per_volume": "0.29 rev/gal", "stall_torque": 14e3}},
)
OPERATIONS = ("hoist", "lower", "rotate", "rotate and lower", "hold")
SPEED, ON_BOTTOM, ROTATION = 0.3, 0.01, 6.0  # of the top [m/s], [m/s] and [rad/s]


def moving_case(seed: int, number: int, formulation: str = "mixed") -> tuple[dict[str, Any], str] | None:
    """Data of case ``number`` and a title; None where the well is too long, or has no mud for the ``formulation`` hermite."""
    data, _, title = random_case(seed, number)
    if data["well"]["survey"]["md"][-1] > LONGEST:
        return None
    rng = random.Random(f"energy {seed}/{number}")
    wet = "fluid" in data
    if not wet and formulation != "mixed":
        return None
    tool = rng.choice(TOOLS)
    if tool is not None and (wet or tool["kind"] != "pdm"):
        collar, bit = data["string"][1], data["string"][-1]["od"]
        od = round(rng.choice((collar["od"], 0.9 * bit)), 4)
        item = {**tool, "name": "tool", "od": od, "id": collar["id"]}
        if tool["kind"] in ("body", "shock_sub"):
            item["mass"] = round(STEEL * pi / 4 * (od**2 - collar["id"] ** 2) * tool["length"], 3)
        data["string"].insert(1, item)
        data["string"][0]["length"] = round(data["string"][0]["length"] - tool["length"], 4)
        title += f", {tool['kind']} of {od:g} m"
    operation = rng.choice(OPERATIONS)
    top: dict[str, Any] = {"kind": "top_drive"}
    if operation == "hoist":
        top["lowering"] = {"time": [0.1, 0.6], "value": [0.0, -SPEED]}
    elif "lower" in operation:
        speed = SPEED if data["bottom"] == "free" else ON_BOTTOM
        top["lowering"] = {"time": [0.1, 0.6], "value": [0.0, speed]}
    if "rotate" in operation:
        top["rotation"] = {"time": [0.1, 0.8], "value": [0.0, ROTATION]}
    data["top"] = top
    if wet:
        data["fluid"]["formulation"] = formulation
        flow = data["fluid"]["flow_rate"]
        data["fluid"]["flow_rate"] = {"time": [0.1, 0.7], "value": [flow, rng.choice((0.5, 1.0, 1.0)) * flow]}
    data["time"], data["output"] = {"end": 1.5}, {"history_every": 0.05}
    return data, f"{title}; {operation}"


def judged(data: dict[str, Any], folder: Path, steps: int) -> tuple[str, str]:
    """Run a case: (kind, what was found)."""
    data = {**data, "petsc": {"ts_rtol": 1e-5, "ts_max_steps": steps}}
    try:
        summary = run(Case(**data), folder, progress="silent", overwrite=True).summary
    except DrillError as error:
        text = str(error).splitlines()[0]
        return ("stopped" if "-ts_max_steps" in text else "refused"), text
    energy, mass = summary["energy"], summary.get("mass", {"error": 0.0, "error_share": 0.0})
    found = f"energy {energy['error']:.3g} J, {energy['error_share']:.2g}; mass {mass['error_share']:.2g}"
    lost = abs(mass["error"]) > LEAST_MASS and abs(mass["error_share"]) > LARGEST_MASS
    wrong = lost or abs(energy["error_share"]) > LARGEST
    return ("wrong" if wrong else "balanced"), found


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "count", type=int, nargs="?", default=100, help="numbers to try; long wells are left out"
    )
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--first", type=int, default=0, help="first number")
    parser.add_argument("--steps", type=int, default=6000, help="most time steps of a run")
    parser.add_argument(
        "--formulation", choices=("mixed", "hermite"), default="mixed", help="of the mud that flows"
    )
    parser.add_argument("--write", metavar="FILE", help="write case --first as YAML and stop")
    arguments = parser.parse_args()
    if arguments.write:
        made = moving_case(arguments.seed, arguments.first, arguments.formulation)
        if made is None:
            parser.error(f"case {arguments.first} has a well of more than {LONGEST:g} m, or no mud")
        Case(**made[0]).dump(Path(arguments.write))
        print(made[1])
        return 0
    counts: Counter[str] = Counter()
    with tempfile.TemporaryDirectory() as folder:
        for number in range(arguments.first, arguments.first + arguments.count):
            made = moving_case(arguments.seed, number, arguments.formulation)
            if made is None:
                continue
            kind, found = judged(made[0], Path(folder) / "run", arguments.steps)
            counts[kind] += 1
            if kind != "balanced":
                print(f"{kind} {number} ({made[1]})\n    {found}", flush=True)
    print(f"{sum(counts.values())} cases:", ", ".join(f"{n} {kind}" for kind, n in sorted(counts.items())))
    return 1 if counts["wrong"] else 0


if __name__ == "__main__":
    raise SystemExit(main())
