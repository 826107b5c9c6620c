"""Time of a step by phase over the number of elements, and speed-up on several ranks, of the 12 km spin-up with mud.

``measure FILE`` appends measurements to a JSON file, ``draw FILE FOLDER`` draws two pictures from it.
Times of a phase are those of the shortest of several calls, and the CPU time of a step is that of a run of 0.3 s with its
output, on one core.  Speed-ups are ratios of wall times of the motion; a run whose ranks did not have a core each (CPU time below
0.92 of wall time) is dropped, up to five times.
"""

from __future__ import annotations

import argparse
import json
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import benchmark
import benchmark_reference as reference

CASE = Path(__file__).parents[2] / "cases" / "benchmark" / "deep-spin-up.yaml"
LENGTH, ELEMENTS = 12000.0, (600, 1200, 2400, 4800, 9600, 20000)
PHASES = {"residual": "residual", "Jacobian": "Jacobian", "factor": "factorisation", "solve": "solve"}
PHASES |= {"sample and audit": "sample and energy audit"}
OWN_CORE, TRIES = 0.92, 5


def case_file(folder: Path, elements: int, end: float) -> Path:
    """The case with about so many elements, to ``end`` [s], in a folder."""
    text = CASE.read_text(encoding="utf-8")
    text = text.replace("element_length: 10 m", f"element_length: {LENGTH / elements:g} m")
    text = text.replace("time: {end: 0.5 s}", f"time: {{end: {end:g} s}}")
    file = folder / f"spin-up-{elements}.yaml"
    file.write_text(text, encoding="utf-8")
    return file


def phases(elements: int) -> dict[str, Any]:
    """Shortest calls of the phases [s], and CPU time of a step [s], on one rank."""
    with tempfile.TemporaryDirectory() as scratch:
        file = case_file(Path(scratch), elements, 0.3)
        summary = reference.run_case(file, Path(scratch) / "run")
        calls = benchmark.call_times(file, Path(scratch) / "run", 15)
    step = summary["cpu_seconds"] / summary["steps"]
    counts = {name: summary[name] / summary["steps"] for name in ("newton_iterations", "jacobians")}
    return {"elements": summary["elements"], "calls": calls, "step": step, "counts": counts}


def speed_up(elements: int, ranks: int, end: float) -> dict[str, Any] | None:
    """Wall time of a step [s] on so many ranks, None where no run had a core for each."""
    mpirun = shutil.which("mpirun")
    if mpirun is None:
        raise SystemExit("scaling: mpirun is not installed; allowed: --ranks 1")
    with tempfile.TemporaryDirectory() as scratch:
        file, folder = case_file(Path(scratch), elements, end), Path(scratch) / "run"
        line = [
            sys.executable,
            "-m",
            "drillpetsc",
            "run",
            str(file),
            "--out",
            str(folder),
            "--progress",
            "silent",
            "--overwrite",
        ]
        if ranks > 1:
            line = [mpirun, "-n", str(ranks), *line]
        for _ in range(TRIES):
            subprocess.run(line, check=True, stdout=subprocess.DEVNULL)
            summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
            if summary["cpu_seconds"] >= OWN_CORE * ranks * summary["wall_seconds"]:
                return {
                    "elements": summary["elements"],
                    "ranks": ranks,
                    "step": summary["wall_seconds"] / summary["steps"],
                }
    return None


def draw(stored: dict[str, Any], folder: Path) -> list[Path]:
    """Draw time by phase over elements, and speed-up over ranks; returns the files."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    from drillpetsc.analysis.commands.rank_model import RANKS, StepCounts
    from drillpetsc.plotting.style import LINE_COLORS

    folder.mkdir(parents=True, exist_ok=True)
    rows = sorted(stored["phases"], key=lambda r: r["elements"])
    figure, axes = plt.subplots(figsize=(7.2, 4.2), layout="constrained")
    n = [r["elements"] for r in rows]
    for (key, label), color in zip(PHASES.items(), LINE_COLORS, strict=False):
        axes.plot(
            n, [1e6 * r["calls"][key] / r["elements"] for r in rows], "o-", color=color, label=f"one {label}"
        )
    axes.plot(n, [1e6 * r["step"] / r["elements"] for r in rows], "ks--", label="step with output (CPU time)")
    axes.set(xscale="log", yscale="log", xlabel="elements", ylabel="time for each element [µs]")
    axes.set_xticks(n, [f"{k}" for k in n])
    axes.minorticks_off()
    ticks = (0.1, 0.2, 0.5, 1, 2, 5, 10)
    axes.set_yticks(ticks, [f"{k:g}" for k in ticks])
    axes.set_title("12 km, mud, spin-up: one core")
    axes.grid(alpha=0.3)
    axes.legend(fontsize=8, ncols=2, loc="upper center", bbox_to_anchor=(0.5, -0.16))
    files = [folder / "time-per-phase.png", folder / "speed-up.png"]
    figure.savefig(files[0], dpi=130)
    figure, axes = plt.subplots(figsize=(7.2, 4.2), layout="constrained")
    ranks = [1, *RANKS]
    for elements, color in zip((600, 2400, 4800, 20000), LINE_COLORS, strict=False):
        counts = StepCounts(elements, 1016.0, 11)
        axes.plot(
            ranks, [counts.speed_up(p) for p in ranks], "-", color=color, label=f"{elements} elements, model"
        )
        one = [
            r["step"] for r in stored["ranks"] if r["ranks"] == 1 and abs(r["elements"] / elements - 1) < 0.02
        ]
        for r in stored["ranks"]:
            if one and r["ranks"] > 1 and abs(r["elements"] / elements - 1) < 0.02:
                mean = sum(one) / len(one)
                axes.plot(r["ranks"], mean / r["step"], "o", color=color, mec="k", ms=7)
    axes.plot([], [], "o", color="w", mec="k", label="measured")
    axes.plot(ranks, ranks, ":", color="0.5", label="ideal")
    axes.set(xscale="log", yscale="log", xlabel="ranks, a core each", ylabel="speed-up", ylim=(0.9, 70))
    axes.set_xticks(ranks, [str(p) for p in ranks])
    axes.set_yticks((1, 2, 4, 8, 16, 32, 64), ["1", "2", "4", "8", "16", "32", "64"])
    axes.minorticks_off()
    axes.grid(alpha=0.3)
    axes.legend(fontsize=8)
    axes.set_title("Speed-up of a step: modelled, and measured on two ranks")
    figure.savefig(files[1], dpi=130)
    return files


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("action", choices=("measure", "draw"))
    parser.add_argument("file", type=Path, metavar="FILE", help="measurements, JSON")
    parser.add_argument("folder", type=Path, nargs="?", metavar="FOLDER", help="of the pictures")
    parser.add_argument("--elements", type=int, nargs="+", default=list(ELEMENTS), metavar="N")
    parser.add_argument(
        "--ranks", type=int, nargs="+", default=[], metavar="N", help="also speed-ups, 1 among them"
    )
    parser.add_argument(
        "--end", type=float, default=2.0, metavar="S", help="simulated time of the speed-ups [s]"
    )
    arguments = parser.parse_args()
    stored: dict[str, Any] = {"machine": benchmark.machine(), "phases": [], "ranks": []}
    if arguments.file.exists():
        stored = json.loads(arguments.file.read_text(encoding="utf-8"))
        if arguments.action == "measure" and stored["machine"] != benchmark.machine():
            parser.error(
                f"{arguments.file}: measured on {stored['machine']}, this machine is {benchmark.machine()}"
            )
    elif arguments.action == "draw":
        parser.error(f"{arguments.file}: no such file")
    if arguments.action == "draw":
        if arguments.folder is None:
            parser.error("draw needs FOLDER")
        print(*draw(stored, arguments.folder), sep="\n")
        return
    for elements in arguments.elements:
        if arguments.ranks:
            for ranks in arguments.ranks:
                found = speed_up(elements, ranks, arguments.end)
                print(elements, ranks, found or "no run with a core for each rank", flush=True)
                stored["ranks"] += [found] if found else []
        else:
            stored["phases"].append(phases(elements))
            print(stored["phases"][-1], flush=True)
        arguments.file.write_text(json.dumps(stored, indent=1), encoding="utf-8")


if __name__ == "__main__":
    main()
