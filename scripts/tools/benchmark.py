"""Benchmark cases: errors, simulated seconds per CPU second (median of several runs), and fractions of the time
by phase.

Each run is a separate process on one core. CPU seconds are those of the time integration with its output; for
the pendulum without output, like its target. The reference solutions are in benchmark_reference.py: the exact
torsional wave for the hanging string and the deep well, an explicit integrator of order 8 on a finer mesh for the pendulum, and
a run with a tenth of the tolerance for the cases with contact. The first use takes some minutes in all; later
ones find the references in the user's cache folder.
"""

from __future__ import annotations

import argparse
import itertools
import json
import os
import platform
import statistics
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import benchmark_reference as reference
import numpy as np

from drillpetsc.output import read_frame, read_series, read_table

CASES = Path(__file__).parents[2] / "cases" / "benchmark"
# simulated seconds per CPU second
TARGETS = {
    "pendulum": 5.0,
    "hanging-string": 5.0,
    "hanging-string-contact": 2.0,
    "buckled-collar": 3.0,
    "coupled-2000m": 1.0,
    "deep-spin-up": 1.5,
}
PHASES = ("Residual", "Jacobian", "ChainFactor", "ChainSolve", "Output")
SETTLED = 2.0  # start of the interval of means [s]
Errors = dict[str, float]


# ---------------------------------------------------------------------- errors of a run: name -> value
def pendulum_errors(folder: Path, fresh: bool) -> Errors:
    times, path = reference.pendulum_path(CASES / "pendulum.yaml", fresh)
    history, probes = read_table(folder / "history.csv"), read_table(folder / "probes.csv")
    if not np.allclose(history["time [s]"], times):
        raise ValueError("the rows of the run and of the reference are at different times")
    up = probes[next(name for name in probes if name.startswith("x_"))]
    off = np.column_stack([history["bit_depth [m]"], up]) - path
    return {"rms tip path / L": float(np.sqrt(np.mean(np.sum(off**2, axis=1))) / 0.5)}


def hanging_errors(folder: Path, fresh: bool) -> Errors:
    history = read_table(folder / "history.csv")
    t, speed = history["time [s]"], history["bit_speed [rad/s]"]
    off = (speed - reference.exact_bit_speed(t, t[-1])) / reference.SPEED
    return {
        "rms bit speed / 80 rpm": float(np.sqrt(np.mean(off**2))),
        "hook load": float(np.max(np.abs(history["hook_load [N]"] / reference.HANGING_WEIGHT - 1))),
    }


def contact_errors(folder: Path, fresh: bool) -> Errors:
    columns = {"mean hook load": "hook_load [N]", "mean torque": "surface_torque [N m]"}
    return _against_finer(folder, "hanging-string-contact", columns, fresh)


def collar_errors(folder: Path, fresh: bool) -> Errors:
    frames = [read_frame(path) for t, path in read_series(folder) if t > 0]
    top = np.array([frame.point_data["axial_force [N]"][0] for frame in frames])
    out = {"axial load": float(np.max(np.abs(top / -reference.AXIAL_LOAD - 1)))}
    return out | _against_finer(folder, "buckled-collar", {"mean torque": "surface_torque [N m]"}, fresh)


def coupled_errors(folder: Path, fresh: bool) -> Errors:
    columns = {
        "mean hook load": "hook_load [N]",
        "mean torque": "surface_torque [N m]",
        "mean pump pressure": "pump_pressure [Pa]",
    }
    balance = json.loads((folder / "summary.json").read_text())["mass"]
    return _against_finer(folder, "coupled-2000m", columns, fresh) | {
        "mud balance / pumped": abs(balance["error_share"])
    }


def spin_up_errors(folder: Path, fresh: bool) -> Errors:
    """The lower end stands still until the torsional wave of the pipe reaches it, after 3.7 s."""
    speed = read_table(folder / "history.csv")["bit_speed [rad/s]"]
    return {"bit speed before the wave / 100 rpm": float(np.max(np.abs(speed)) / (100 * np.pi / 30))}


def _against_finer(folder: Path, name: str, columns: dict[str, str], fresh: bool) -> Errors:
    history = read_table(folder / "history.csv")
    finer = reference.finer_means(CASES / f"{name}.yaml", tuple(columns.values()), SETTLED, fresh)
    return {name: abs(reference.mean_of(history, c, SETTLED) / finer[c] - 1) for name, c in columns.items()}


ERRORS: dict[str, Callable[[Path, bool], Errors]] = {
    "pendulum": pendulum_errors,
    "hanging-string": hanging_errors,
    "hanging-string-contact": contact_errors,
    "buckled-collar": collar_errors,
    "coupled-2000m": coupled_errors,
    "deep-spin-up": spin_up_errors,
}


# ---------------------------------------------------------------------- measuring
def call_times(case: Path, folder: Path | None = None, calls: int = 40) -> dict[str, float]:
    """Shortest time [s] of one call of each phase, in the static state of a case, or at the end of its run in ``folder``.

    The shortest of many calls depends little on what else the machine does.
    """
    from drillpetsc.analysis.motion import checkpoint
    from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
    from drillpetsc.analysis.statics.placement import move_rigidly, release
    from drillpetsc.case import load_case
    from drillpetsc.model.drilling_model import build_model
    from drillpetsc.output.files.tables import rows_as_text
    from drillpetsc.output.measured.field_output import FieldOutput
    from drillpetsc.output.recorder import STEPS_AT_ONCE, Recorder
    from drillpetsc.solvers.time.newton import chain_factor

    model = build_model(load_case(case))
    if folder is None:
        find_equilibrium(model)
        release(model)
        move_rigidly(model)
    else:
        checkpoint.restore(model, checkpoint.read(folder / "checkpoint.h5"))
    system, shift = model.system, 1e3
    asm, factor = system.assembly, chain_factor(system)
    x, rows = np.zeros(system.layout.size), system.new_condensed()
    recorder, fields = Recorder(model), FieldOutput(model)
    recorder.start(0.0)
    recorder.step(0.01, 0.01, 0.0)
    recorder.catch_up()
    steps = itertools.count(2)

    def record() -> None:
        t = 0.01 * next(steps)
        recorder.step(t, 0.01, 0.0)
        recorder.rows_due([t - 0.005], t, 1, 0.01, True)

    phases: dict[str, Callable[[], object]] = {
        "residual": lambda: system.sum_residual(0.0, rows),
        "Jacobian": lambda: asm.jacobian(0.0, (1.0, shift, shift**2), True),
        "factor": lambda: factor.factor(asm.values),
        "solve": lambda: factor.solve(x, x),
        "sample and audit": record,
        "fields": lambda: fields.fields(0.0),
    }
    out = {}
    for name, call in phases.items():
        times = []
        for _ in range(calls):
            begun = time.perf_counter()
            call()
            times.append(time.perf_counter() - begun)
        out[name] = min(times)
    # what is computed of all recorded steps together, and their rows as text: for one of them
    for _ in range(STEPS_AT_ONCE - 1 - recorder.recorded):
        record()
    count, begun = max(recorder.recorded, 1), time.perf_counter()
    recorder.catch_up()
    out["outputs of a step"] = (time.perf_counter() - begun) / count
    begun = time.perf_counter()
    for rows in recorder.kept_rows():
        rows_as_text(rows)
    out["row"] = (time.perf_counter() - begun) / count
    return out


def fluid_cost(case: Path) -> Errors:
    """Time of residual, Jacobian, factor and solve with mud over that without, in one process (shortest of many
    calls)."""
    text = case.read_text(encoding="utf-8")
    dry = text[: text.index("fluid:")] + text[text.index("gravity:") :]
    with tempfile.TemporaryDirectory() as scratch:
        file = Path(scratch) / "dry.yaml"
        file.write_text(dry, encoding="utf-8")
        wet_times, dry_times = call_times(case), call_times(file)
    return {f"{name}, wet / dry": wet_times[name] / dry_times[name] for name in wet_times}


def measure(name: str, repeat: int, fresh: bool = False) -> dict:
    """Results of ``repeat`` runs of a case: those of the middle run, with the median of simulated seconds per CPU
    second."""
    runs, calls = [], dict[str, float]()
    for k in range(repeat):
        with tempfile.TemporaryDirectory() as scratch:
            folder = Path(scratch) / "run"
            summary = reference.run_case(CASES / f"{name}.yaml", folder)
            errors = ERRORS[name](folder, fresh and k == 0)
            now = call_times(CASES / f"{name}.yaml", folder)
            calls = {phase: min(calls.get(phase, np.inf), seconds) for phase, seconds in now.items()}
        errors["energy lost / exchanged"] = abs(summary["energy"]["error_share"])
        if "coupled" in name:
            errors |= fluid_cost(CASES / f"{name}.yaml")
        seconds = {p: summary["wall_by_phase"].get(p, 0.0) for p in PHASES}
        cpu = summary["cpu_seconds"] - (seconds["Output"] if name == "pendulum" else 0.0)
        runs.append(
            {
                "factor": summary["simulated"] / cpu,
                "cpu": cpu,
                "errors": errors,
                "steps": summary["steps"],
                "newton": summary["newton_iterations"],
                "jacobians": summary["jacobians"],
                "phases": {p: s / summary["wall_seconds"] for p, s in seconds.items()},
                "seconds": {"motion (CPU)": cpu, "start": summary["start_seconds"], **seconds},
            }
        )
    middle = sorted(runs, key=lambda r: r["factor"])[len(runs) // 2]
    return {
        **middle,
        "factor": statistics.median(r["factor"] for r in runs),
        "seconds": {p: statistics.median(r["seconds"][p] for r in runs) for p in runs[0]["seconds"]},
        "calls": calls,
        "case": name,
        "target": TARGETS[name],
    }


# ---------------------------------------------------------------------- comparing
SLOWER = 1.1  # a ratio above this is marked


def machine() -> str:
    """Processor and number of cores: times of different machines are not compared."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
        name = next(line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        name = platform.processor() or platform.machine()
    return f"{name}, {os.cpu_count()} cores"


def comparison(before: list[dict], now: list[dict]) -> list[tuple[str, str, float, float, float]]:
    """Rows (scene, phase, seconds before, seconds now, ratio now / before) of the scenes and phases that both have."""
    stored, rows = {r["case"]: r for r in before}, []
    for r in now:
        old = stored.get(r["case"], {})
        for kind in ("seconds", "calls"):
            for phase, seconds in r[kind].items():
                was = old.get(kind, {}).get(phase, 0.0)
                if was > 0.0:
                    name = phase if kind == "seconds" else f"one {phase}"
                    rows.append((r["case"], name, was, seconds, seconds / was))
    return rows


def read_stored(path: Path, of_machine: str) -> list[dict]:
    """Results of an earlier --json; SystemExit with the reason where they cannot be compared with this machine's."""
    try:
        stored = json.loads(path.read_text(encoding="utf-8"))
        kept, cases = str(stored["machine"]), list(stored["cases"])
    except (OSError, ValueError, TypeError, KeyError) as error:
        raise SystemExit(f"{path}: no results of scripts/benchmark --json ({error})") from None
    if kept != of_machine:
        raise SystemExit(f"{path}: measured on {kept}, this machine is {of_machine}: times do not compare")
    return cases


def print_comparison(rows: list[tuple[str, str, float, float, float]]) -> None:
    """Print the table; phases that take longer than ``SLOWER`` times as long are marked."""
    print(f"\n{'scene':24} {'phase':22} {'before':>11} {'now':>11} {'ratio':>6}")
    for scene, phase, was, seconds, ratio in rows:
        mark = "  slower" if ratio > SLOWER else ""
        print(f"{scene:24} {phase:22} {was:9.4g} s {seconds:9.4g} s {ratio:6.2f}{mark}")


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("cases", nargs="*", metavar="CASE", help=f"of {', '.join(TARGETS)} (default: all)")
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--fresh", action="store_true", help="compute the references again")
    parser.add_argument("--json", metavar="FILE", help="also write the results to this file")
    parser.add_argument(
        "--compare",
        metavar="FILE",
        type=Path,
        help="print the ratio to the times in FILE, written with --json on this machine, by scene and phase",
    )
    arguments = parser.parse_args()
    stored = read_stored(arguments.compare, machine()) if arguments.compare else []
    unknown = set(arguments.cases) - set(TARGETS)
    if unknown:
        parser.error(f"unknown case {', '.join(sorted(unknown))}: allowed are {', '.join(TARGETS)}")
    rows = []
    print(
        f"{'case':24} {'simulated/CPU':>13} {'target':>6}  {'steps':>6} {'Newton':>6} {'Jac.':>5}  fractions of the time"
    )
    for name in arguments.cases or TARGETS:
        r = measure(name, arguments.repeat, arguments.fresh)
        rows.append(r)
        shares = " ".join(f"{p} {100 * v:.0f}%" for p, v in r["phases"].items())
        print(
            f"{name:24} {r['factor']:13.2f} {r['target']:6.1f}  {r['steps']:6d} {r['newton']:6d} {r['jacobians']:5d}  {shares}"
        )
        print(
            " " * 26 + ", ".join(f"{error} {value:.2e}" for error, value in r["errors"].items()), flush=True
        )
    if arguments.json:
        Path(arguments.json).write_text(json.dumps({"machine": machine(), "cases": rows}, indent=2))
    if arguments.compare:
        print_comparison(comparison(stored, rows))


if __name__ == "__main__":
    main()
