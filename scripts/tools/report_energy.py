"""Energy and mean torque against run time for BDF2 and generalised-alpha: buckled collar, tumbling rod, axial ring.

Their motion is chaotic, or what matters is an energy, so that no error of a history can be drawn.  Writes
cases/verification/ENERGY.md and its pictures; runs are kept in results/report/energy and are not repeated.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT))  # for the models of the tests
PICTURES = ROOT / "cases" / "verification" / "pictures"
KEPT = ROOT / "results" / "report" / "energy"
SETTLED = 2.0  # start of the mean of the torque [s]
#: name of a curve -> PETSc options
CURVES: dict[str, dict[str, Any]] = {
    "bdf2": {"ts_type": "bdf", "ts_bdf_order": 2},
    "alpha2, radius 0.9": {"ts_type": "alpha2", "ts_alpha_radius": 0.9},
    "alpha2, radius 0.8": {"ts_type": "alpha2", "ts_alpha_radius": 0.8},
    "alpha2, radius 0.5": {"ts_type": "alpha2", "ts_alpha_radius": 0.5},
}
TOLERANCES = (3e-3, 1.1e-3, 1e-3, 9e-4, 3e-4, 1e-4)
REFERENCE = {**CURVES["alpha2, radius 0.8"], "ts_adapt_type": "none", "ts_dt": 2e-4, "q_snes_stol": 1e-9}
STEPS_A_TURN, TURNS = (50, 100, 200, 400), 10
PHASES, PERIODS = (0.4, 0.2, 0.1, 0.05), 1000
TORQUE, SCATTER = "error of the mean torque", 0.015  # of equally good runs of the collar
TARGETS = {"energy": 50.0, "torque": 0.05, "rod": 2e-3, "ring": 2e-3}


def kept(name: str, compute: Callable[[], dict[str, Any]], write_only: bool) -> dict[str, Any] | None:
    """Result of an earlier call of this name, else of ``compute``; None where nothing is to be computed."""
    file = KEPT / f"{name}.json"
    if file.is_file():
        return dict(json.loads(file.read_text(encoding="utf-8")))
    if write_only:
        return None
    found = compute()
    KEPT.mkdir(parents=True, exist_ok=True)
    file.write_text(json.dumps(found), encoding="utf-8")
    print(name, found, flush=True)
    return found


# ---------------------------------------------------------------------- computations
def collar(options: Mapping[str, Any]) -> dict[str, Any]:
    """Energy error [J], energy exchanged [J], mean torque [N m], steps and CPU time [s] of the buckled collar."""
    from drillpetsc import load_case, run
    from drillpetsc.output import read_table

    case = load_case(ROOT / "cases" / "benchmark" / "buckled-collar.yaml")
    result = run(
        case.model_copy(update={"petsc": dict(options)}), KEPT / "run", progress="silent", overwrite=True
    )
    history, summary = read_table(KEPT / "run" / "history.csv"), result.summary
    late = history["time [s]"] >= SETTLED
    return {
        "energy": summary["energy"]["error"],
        "share": summary["energy"]["error_share"],
        "gain": summary["energy"]["gained"],
        "torque": float(np.mean(history["surface_torque [N m]"][late])),
        "steps": summary["steps"],
        "cpu": summary["cpu_seconds"],
    }


def rod(options: Mapping[str, Any], steps: int) -> dict[str, Any]:
    """Energy lost and largest gain over the energy, of a free rod that tumbles TURNS times."""
    from tests.helpers.motion import fixed, integrate
    from tests.verification.test_generalized_alpha import tumbling

    system = tumbling()
    before, energies, began = sum(system.energies(0.0)), [], time.process_time()
    integrate(
        system,
        float(TURNS),
        fixed(1 / steps, **options),
        lambda t, dt: energies.append(sum(system.energies(t))),
    )
    change = np.array(energies) / before - 1
    return {"change": change[-1], "gain": max(0.0, change.max()), "cpu": time.process_time() - began}


def ring(options: Mapping[str, Any], phase: float, periods: int) -> dict[str, Any]:
    """Energy lost over the energy by mode 1 of 200 elements at ``phase`` = angular frequency times step."""
    from tests.helpers.motion import beam, fixed, integrate, straight

    model = straight(string=[beam(10.0, 200, 1e4, 1e3, 1e3, 1.0, 0.01)], top="clamped", gravity=0.0)
    system = model.system
    s, w = system.field("string.position")[:, 2].copy(), 0.5 * np.pi / 10.0 * 100.0
    for name, shape in (
        ("position", np.sin(0.05 * np.pi * s)),
        ("tangent", 0.05 * np.pi * np.cos(0.05 * np.pi * s)),
    ):
        rates = np.zeros((len(s), 3))
        rates[:, 2] = 1e-3 * w * shape
        system.set_field(f"string.{name}", rates, "y")
    before, began = sum(system.energies(0.0)), time.process_time()
    steps = round(periods * 2 * np.pi / phase)
    integrate(
        system,
        steps * phase / w,
        fixed(phase / w, drillpetsc_newton_work=0, q_snes_stol=1e-9, **options),
    )
    return {
        "change": sum(system.energies(0.0)) / before - 1,
        "periods": periods,
        "cpu": time.process_time() - began,
    }


def compute(write_only: bool, parts: set[str]) -> dict[str, Any]:
    """All results by part and curve."""
    found: dict[str, Any] = {"collar": {}, "rod": {}, "ring": {}, "reference": None}
    wanted = lambda part: write_only or part not in parts  # noqa: E731
    found["reference"] = kept("collar-reference", lambda: collar(REFERENCE), wanted("reference"))
    for (
        tolerance
    ) in TOLERANCES:  # one tolerance after another, so that times that are compared are neighbours
        for curve, options in CURVES.items():
            point = kept(
                f"collar-{curve}-{tolerance:g}",
                lambda o=options, r=tolerance: collar({**o, "ts_rtol": r}),  # type: ignore[misc]
                wanted("collar"),
            )
            if point is not None:
                found["collar"].setdefault(curve, {})[tolerance] = point
    for curve, options in CURVES.items():
        for steps in STEPS_A_TURN:
            point = kept(f"rod-{curve}-{steps}", lambda o=options, n=steps: rod(o, n), wanted("rod"))  # type: ignore[misc]
            if point is not None:
                found["rod"].setdefault(curve, {})[steps] = point
        for phase in PHASES:
            periods = PERIODS if phase == PHASES[-1] and curve == "alpha2, radius 0.8" else 50
            point = kept(
                f"ring-{curve}-{phase:g}",
                lambda o=options, p=phase, n=periods: ring(o, p, n),  # type: ignore[misc]
                wanted("ring"),
            )
            if point is not None:
                found["ring"].setdefault(curve, {})[phase] = point
    return found


# ---------------------------------------------------------------------- text and pictures
def table(head: list[str], rows: list[list[str]]) -> list[str]:
    return [
        "| " + " | ".join(head) + " |",
        "|" + " --- |" * len(head),
        *("| " + " | ".join(row) + " |" for row in rows),
        "",
    ]


def torque_error(point: Mapping[str, Any], reference: Mapping[str, Any]) -> float:
    return float(point["torque"] / reference["torque"] - 1)


def write(found: Mapping[str, Any]) -> Path:
    """ENERGY.md and its pictures."""
    reference = found["reference"]
    lines = [
        "# Energy against run time",
        "",
        "Written by `scripts/report-energy`; do not edit.  Scenes whose motion is chaotic, or whose energy is what matters, beside those of [REPORT.md](REPORT.md).",
        "",
        "## Buckled collar",
        "",
        "`cases/benchmark/buckled-collar.yaml`, 10 s.  Reference of the mean torque after 2 s: generalised-alpha, radius 0.8, fixed steps of 0.2 ms, "
        f"Newton at 1e-9: {reference['torque']:.1f} N m, its own energy error {reference['energy']:.1f} J.  The motion is chaotic: equally good runs scatter by some 1.5 % in the torque.",
        "",
        *table(
            ["curve", "tolerance", "energy error", "largest gain", "mean torque", "steps", "CPU"],
            [
                [
                    curve,
                    f"{tolerance:g}",
                    f"{p['energy']:.0f} J ({100 * p['share']:.2f} %)",
                    f"{p['gain']:.1f} J",
                    f"{100 * torque_error(p, reference):+.1f} %",
                    str(p["steps"]),
                    f"{p['cpu']:.1f} s",
                ]
                for curve, points in found["collar"].items()
                for tolerance, p in points.items()
            ],
        ),
        "![error over CPU time](pictures/buckled-collar-energy.png)",
        "",
        "## Tumbling rod and axial ring",
        "",
        f"Energy lost with fixed steps: a free stiff rod after {TURNS} revolutions, and mode 1 of an undamped axial ring of 200 elements after 50 periods "
        f"(radius 0.8 at the shortest step: {PERIODS}).",
        "",
        *table(
            [
                "curve",
                *(f"rod, {n} steps a turn" for n in STEPS_A_TURN),
                *(f"ring, wh = {p:g}" for p in PHASES),
            ],
            [
                [
                    curve,
                    *(share(found["rod"].get(curve, {}).get(n)) for n in STEPS_A_TURN),
                    *(share(found["ring"].get(curve, {}).get(p)) for p in PHASES),
                ]
                for curve in CURVES
            ],
        ),
        "![energy lost over steps](pictures/energy-of-free-motion.png)",
    ]
    draw(found)
    file = ROOT / "cases" / "verification" / "ENERGY.md"
    file.write_text("\n".join(lines).rstrip() + "\n", encoding="utf-8")
    return file


def share(point: Mapping[str, Any] | None) -> str:
    if point is None or not math.isfinite(point["change"]):
        return "-"
    gain = f" (gain {point['gain']:.1e})" if point.get("gain", 0.0) > 1e-6 else ""
    return f"{point['change']:.1e}{gain}"


def draw(found: Mapping[str, Any]) -> None:
    """Two pictures: errors of the collar over CPU time; energy lost in free motion over the steps."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    from drillpetsc.plotting import style
    from drillpetsc.plotting.command.work_precision import COLORS, MARKERS

    PICTURES.mkdir(parents=True, exist_ok=True)
    reference = found["reference"]
    panels: list[tuple[str, str, str, float, Callable[[Any], float]]] = [
        ("collar", "CPU time [s]", "energy error [J]", TARGETS["energy"], lambda p: abs(p["energy"])),
        (
            "collar",
            "CPU time [s]",
            TORQUE,
            TARGETS["torque"],
            lambda p: abs(torque_error(p, reference)),
        ),
        (
            "rod",
            "steps a turn",
            "energy lost by the rod, 10 turns",
            TARGETS["rod"],
            lambda p: abs(p["change"]),
        ),
        (
            "ring",
            "steps a period",
            "energy lost by the ring, a period",
            TARGETS["ring"] / PERIODS,
            lambda p: -math.log(1 + p["change"]) / p["periods"],
        ),
    ]
    across_of: dict[str, Callable[[Any, Any], float]] = {
        "collar": lambda key, p: p["cpu"],
        "rod": lambda key, p: key,
        "ring": lambda key, p: 2 * math.pi / key,
    }
    dashed = "Dashed: the target."
    for name, chosen, title, note in (
        (
            "buckled-collar-energy",
            panels[:2],
            "Buckled collar: error over CPU time, a point for each tolerance",
            dashed + " Dotted: the scatter of equally good runs.",
        ),
        ("energy-of-free-motion", panels[2:], "Free motion: energy lost over steps", dashed),
    ):
        with style.look():
            drawing = style.figure(11.5, 4.4, dpi=80)
            axes = drawing.subplots(1, 2)
            drawing.suptitle(title, x=0.02, ha="left", fontweight="bold", fontsize=12)
            for ax, (part, across, up, target, value) in zip(axes, chosen, strict=True):
                for k, curve in enumerate(CURVES):
                    points = found[part].get(curve, {})
                    xy = [(across_of[part](key, p), value(p)) for key, p in points.items()]
                    ax.plot(
                        *zip(*xy, strict=True) if xy else ((), ()),
                        color=COLORS[k],
                        marker=MARKERS[k],
                        markersize=5,
                        linewidth=1.3,
                        label=curve,
                    )
                ax.axhline(target, color="0.45", linewidth=0.9, linestyle=(0, (5, 3)))
                ax.set(xscale="log", yscale="log", xlabel=across, ylabel=up)
                if up == TORQUE:
                    ax.axhline(SCATTER, color="0.45", linewidth=0.9, linestyle=":")
                    ax.set_ylim(bottom=1e-3)
                ax.grid(True, which="both", alpha=0.18, linewidth=0.5)
                ax.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 3.0, 5.0)))
                ax.xaxis.set_minor_formatter(NullFormatter())
                ax.xaxis.set_major_formatter(FuncFormatter(lambda x, place: f"{x:g}"))
            drawing.legend(
                *axes[0].get_legend_handles_labels(), loc="center right", frameon=False, fontsize=8.5
            )
            drawing.text(0.02, 0.01, note, fontsize=7.5, color="0.3")
            drawing.tight_layout(rect=(0, 0.03, 0.84, 0.98))
            drawing.savefig(PICTURES / f"{name}.png")


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parts = ("reference", "collar", "rod", "ring")
    parser.add_argument("parts", nargs="*", metavar="PART", help=f"of {', '.join(parts)} (default: all)")
    parser.add_argument("--write-only", action="store_true", help="write the report from existing results")
    given = parser.parse_args()
    unknown = set(given.parts) - set(parts)
    if unknown:
        parser.error(f"unknown part {', '.join(sorted(unknown))}: allowed are {', '.join(parts)}")
    found = compute(given.write_only, set(given.parts or parts))
    if found["reference"] is None:
        parser.error("there is no reference yet: run the part reference first")
    print(write(found))


if __name__ == "__main__":
    main()
