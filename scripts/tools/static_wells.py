"""Statics of wells of 12 km: hook load, factorisations and seconds over the number of elements, as a table.

An S-well, a J-well and a vertical well, dry and with mud, each turning with a weight on bit of 80 kN.  Each solve is a
process of its own on each number of ranks.  Seconds are wall time of the model's set-up and of the solve; factorisations
are those of the direct solver.
"""

from __future__ import annotations

import argparse
import json
import shutil
import subprocess
import sys
import time
from typing import Any

import numpy as np

LENGTH = 12000.0
ELEMENTS = (600, 2400, 4800, 9600, 20000)


def _arc(start: float, rate: float, begin: float, end: float) -> tuple[list[float], list[float]]:
    """Stations each 30 m of a build or drop at ``rate`` [deg/30 m]: depths [m] and inclinations [deg], without the first."""
    count = round(abs(end - begin) / rate)
    return [start + 30.0 * k for k in range(1, count + 1)], list(np.linspace(begin, end, count + 1)[1:])


def _survey(well: str) -> dict[str, list[float]]:
    md, inclination = [0.0], [0.0]
    if well != "vertical":
        a, b = _arc(1000.0, 3.0, 0.0, 60.0)
        md, inclination = [*md, 1000.0, *a], [*inclination, 0.0, *b]
    if well == "S":
        a, b = _arc(7000.0, 2.0, 60.0, 20.0)
        md, inclination = [*md, 7000.0, *a], [*inclination, 60.0, *b]
    md, inclination = [*md, LENGTH], [*inclination, inclination[-1]]
    return {"md": md, "inclination": list(np.radians(inclination)), "azimuth": [0.0] * len(md)}


def case_data(well: str, mud: bool, elements: int) -> dict[str, Any]:
    """Keys of the case."""
    length = (LENGTH - 0.5) / elements
    pipe = {"kind": "pipe", "element_length": length}
    data: dict[str, Any] = {
        "well": {
            "survey": _survey(well),
            "sections": [
                {"to": 7000.0, "kind": "casing", "diameter": 0.2244, "friction": 0.2},
                {"to": LENGTH, "kind": "open_hole", "diameter": 0.2159, "friction": 0.25},
            ],
        },
        "string": [
            {**pipe, "length": 11800.0, "od": 0.127, "id": 0.1086},
            {**pipe, "length": 199.5, "od": 0.1715, "id": 0.0714},
            {"kind": "bit", "length": 0.5, "od": 0.2159, "mass": 60.0},
        ],
        "top": {"kind": "top_drive", "rotation": 10.0},
        "bottom": {"kind": "bit"},
        "contact": {"stiffness": 1e8},
        "initial": {"from": "statics", "wob": 80e3},
        "time": {"end": 1.0},
    }
    if mud:
        rheology = {"model": "power_law", "consistency": 0.5, "index": 0.7}
        data["fluid"] = {"density": 1200.0, "rheology": rheology, "bulk_modulus": 2e9, "flow_rate": 0.03}
    return data


def solve(well: str, mud: bool, elements: int) -> dict[str, float] | None:
    """Solve on all ranks of this process; the figures on rank 0."""
    from petsc4py import PETSc

    from drillpetsc import Case
    from drillpetsc.analysis.statics.answer import static_summary
    from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
    from drillpetsc.model.drilling_model import build_model
    from drillpetsc.solvers.chain.chain_lu import ChainFactor

    count, factor = [0], ChainFactor.factor

    def counted(self, values):
        count[0] += 1
        return factor(self, values)

    ChainFactor.factor = counted  # type: ignore[method-assign]
    begin = time.perf_counter()
    model = build_model(Case(**case_data(well, mud, elements)))
    built = time.perf_counter()
    state = find_equilibrium(model)
    end = time.perf_counter()
    figures = static_summary(model, state)
    if PETSc.COMM_WORLD.rank:
        return None
    return {
        "elements": len(model.mesh.length),
        "hook_load": figures["hook_load"],
        "stable": figures["stable"],
        "factorisations": count[0],
        "set_up": built - begin,
        "solve": end - built,
    }


def measured(well: str, mud: bool, elements: int, ranks: int) -> dict[str, float]:
    """Solve in a new process on ``ranks`` ranks."""
    own = [sys.executable, __file__, "--one", well, str(int(mud)), str(elements)]
    launch = ["mpirun", "-n", str(ranks)] if ranks > 1 else []
    if ranks > 1 and shutil.which("mpirun") is None:
        raise SystemExit("static-wells: mpirun is not installed; allowed: --ranks 1")
    done = subprocess.run([*launch, *own], capture_output=True, text=True)
    if done.returncode:
        return {"failed": 1.0, "why": (done.stderr.strip().splitlines() or ["no message"])[-1]}  # type: ignore[dict-item]
    return json.loads(done.stdout.strip().splitlines()[-1])


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--elements", type=int, nargs="+", default=list(ELEMENTS))
    parser.add_argument("--ranks", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--wells", nargs="+", choices=["S", "J", "vertical"], default=["S", "J", "vertical"])
    parser.add_argument("--one", nargs=3, metavar=("WELL", "MUD", "ELEMENTS"), help=argparse.SUPPRESS)
    args = parser.parse_args()
    if args.one:
        out = solve(args.one[0], args.one[1] == "1", int(args.one[2]))
        if out is not None:
            print(json.dumps(out))
        return
    print("| well | elements | ranks | hook load [kN] | factorisations | set-up [s] | solve [s] |")
    print("| --- | --- | --- | --- | --- | --- | --- |", flush=True)
    for well in args.wells:
        for mud in (False, True):
            for elements in args.elements:
                for ranks in args.ranks:
                    q = measured(well, mud, elements, ranks)
                    head = f"| {well}, {'mud' if mud else 'dry'} | {elements} | {ranks} |"
                    if "failed" in q:
                        print(f"{head} {q['why']} | | | |", flush=True)
                        continue
                    load = f"{q['hook_load'] / 1e3:.3f}" + ("" if q["stable"] else ", not stable")
                    print(
                        f"{head} {load} | {q['factorisations']:g} | {q['set_up']:.2f} | {q['solve']:.2f} |",
                        flush=True,
                    )


if __name__ == "__main__":
    main()
