"""The benchmark scenes: error beside real-time factor, median of several runs, shares of the time by phase.

Each run is a process of its own on one core.  The error of the hanging string is against the exact torsional wave; that of the
others is the energy that the time integration lost, as a share of the energy exchanged (reference runs come with the study command).
"""

from __future__ import annotations

import argparse
import json
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from drillpetsc.output import read_table

ROOT = Path(__file__).parents[1]
TARGETS = {"pendulum": 5.0, "hanging-string": 5.0, "hanging-string-contact": 2.0, "buckled-collar": 3.0}  # real-time factors
PHASES = ("Residual", "Jacobian", "ChainFactor", "ChainSolve", "Output")


def exact_bit_speed(times: np.ndarray, end: float) -> np.ndarray:
    """Torsional wave in pipe above collar by characteristics, cells of one travel time each (exact at the grid's times).

    Same shear wave speed c in both sections; impedances GJ/c; top speed half a cosine to 80 rpm in 2 s; free bit.
    """
    c = np.sqrt(206e9 / 2.6 / 7850.0)

    def inertia(od: float, bore: float) -> float:
        return np.pi / 32 * (od**4 - bore**4)

    cell = 1.0
    dt, n, junction = cell / c, 2000, 1800
    z = np.where(np.arange(n) < junction, inertia(0.127, 0.1086), inertia(0.1778, 0.0714))
    up, down = np.zeros(n), np.zeros(n)  # speed waves leaving each cell upward and downward
    out = np.zeros(int(end / dt) + 2)
    for k in range(len(out)):
        t = k * dt
        top = 80 * 2 * np.pi / 60 * (0.5 * (1 - np.cos(np.pi * min(t, 2.0) / 2)))
        new_down, new_up = np.empty(n), np.empty(n)
        # at each inner joint: transmitted and reflected speed waves by impedances
        za, zb = z[:-1], z[1:]
        speed = 2 * (za * down[:-1] + zb * up[1:]) / (za + zb)
        new_down[1:], new_up[:-1] = speed - up[1:], speed - down[:-1]
        new_down[0] = top - up[0]
        new_up[-1] = down[-1]
        out[k] = 2 * down[-1]
        down, up = new_down, new_up
    return np.interp(times, np.arange(len(out)) * dt, out)


def error_of(scene: str, folder: Path, summary: dict) -> tuple[str, float]:
    """What the error is, and its size."""
    if scene == "hanging-string":
        history = read_table(folder / "history.csv")
        t, speed = history["time [s]"], history["bit_speed [rad/s]"]
        return "rms bit speed / 80 rpm", float(np.sqrt(np.mean((speed - exact_bit_speed(t, t[-1])) ** 2)) / (80 * 2 * np.pi / 60))
    return "energy lost / exchanged", abs(summary["energy"]["error_share"])


def measure(scene: str, repeat: int) -> dict:
    """Median figures of ``repeat`` runs of a scene."""
    runs = []
    for _ in range(repeat):
        with tempfile.TemporaryDirectory() as scratch:
            folder = Path(scratch) / "run"
            case = ROOT / "cases" / "benchmark" / f"{scene}.yaml"
            subprocess.run([sys.executable, "-m", "drillpetsc", "run", str(case), "--out", str(folder), "--progress", "silent"], check=True,
                           stdout=subprocess.DEVNULL)
            summary = json.loads((folder / "summary.json").read_text())
            what, error = error_of(scene, folder, summary)
        cpu = summary["cpu_seconds"]
        phases = {p: summary["wall_by_phase"].get(p, 0.0) / summary["wall_seconds"] for p in PHASES}
        runs.append({"factor": summary["simulated"] / cpu, "cpu": cpu, "error": error, "what": what, "steps": summary["steps"],
                     "newton": summary["newton_iterations"], "jacobians": summary["jacobians"], "phases": phases})
    middle = sorted(runs, key=lambda r: r["factor"])[len(runs) // 2]
    return {**middle, "factor": statistics.median(r["factor"] for r in runs), "scene": scene, "target": TARGETS[scene]}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help=f"of {', '.join(TARGETS)} (default: all)")
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--json", metavar="FILE", help="write the figures here, too")
    arguments = parser.parse_args()
    unknown = set(arguments.scenes) - set(TARGETS)
    if unknown:
        parser.error(f"unknown scene {', '.join(sorted(unknown))}: allowed are {', '.join(TARGETS)}")
    rows = []
    print(f"{'scene':24} {'simulated/CPU':>13} {'target':>6} {'error':>9}  {'steps':>6} {'Newton':>6} {'Jac.':>5}  shares of the time")
    for scene in arguments.scenes or TARGETS:
        r = measure(scene, arguments.repeat)
        rows.append(r)
        shares = " ".join(f"{p} {100 * v:.0f}%" for p, v in r["phases"].items())
        counts = f"{r['steps']:6d} {r['newton']:6d} {r['jacobians']:5d}"
        print(f"{scene:24} {r['factor']:13.2f} {r['target']:6.1f} {r['error']:9.2e}  {counts}  {shares}  ({r['what']})", flush=True)
    if arguments.json:
        Path(arguments.json).write_text(json.dumps(rows, indent=2))


if __name__ == "__main__":
    main()
