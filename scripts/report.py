"""Error against run time of every verification scene: studies, pictures and cases/verification/REPORT.md.

Studies lie in results/report/<scene>-<what> and are continued, so a report that was stopped goes on where it
was; --fresh begins anew. The scenes and what is varied stand in report_scenes.py.
"""

from __future__ import annotations

import argparse
import json
import math
import re
import shutil
import statistics
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from report_scenes import SCENES, DrillingModel

from drillpetsc.plotting.work_precision import draw_study
from drillpetsc.studies.convergence.study import study

ROOT = Path(__file__).parents[1]
CASES, RUNS = ROOT / "cases" / "verification", ROOT / "results" / "report"
PICTURES = CASES / "pictures"
SHORT_STEP_TIME_FACTOR = (
    10.0  # a run of the paper's integrator with short steps may take so many times longer than others
)
GOOD = 0.01  # error that most purposes ask for
DEFAULT, PAPER, PAPERS_RULE = "bdf2", "quaternion-bdf1-fixed", "bdf1-fixed"
DEFAULT_TOLERANCE = 1e-4
Told = dict[str, Any]


# ---------------------------------------------------------------------- studies
def studies_of(model: DrillingModel, quick: bool) -> dict[str, dict[str, Any]]:
    """What is run for a scene: name -> arguments of study()."""
    cut = (lambda values: values[1:4]) if quick else (lambda values: values)
    curves = {
        "curves": model.curves,
        "steps": cut(model.steps),
        "tolerances": cut(model.tolerances),
        "few": quick,
    }
    wanted: dict[str, dict[str, Any]] = {"curves": curves}
    if model.mesh:
        wanted["mesh"] = {"vary": "mesh", "values": cut(model.mesh)}
    if not quick:
        if model.solver:
            wanted["solver"] = {"vary": "solver", "tolerances": model.tolerances}
        if model.ranks:
            wanted["ranks"] = {"vary": "ranks"}
        if model.paper_steps:
            wanted["paper"] = {
                "curves": (PAPER,),
                "steps": model.paper_steps,
                "limit": SHORT_STEP_TIME_FACTOR * model.limit,
            }
    return wanted


def run_scene(name: str, model: DrillingModel, quick: bool, repeats: int, fresh: bool) -> dict[str, Told]:
    """Study.json of each study of a scene."""
    out: dict[str, Told] = {}
    for what, arguments in studies_of(model, quick).items():
        folder = RUNS / f"{name}-{what}{'-quick' if quick else ''}"
        if fresh:
            shutil.rmtree(folder, ignore_errors=True)
        print(f"{name}: {what}", flush=True)
        result = study(
            CASES / model.file,
            out=folder,
            restart=folder.exists(),
            repeats=1 if what == "paper" else repeats,
            outputs=() if what == "ranks" else model.outputs,
            **{"limit": model.limit, **arguments},
        )
        out[what] = json.loads((result.folder / "study.json").read_text(encoding="utf-8"))
    return out


def read_scene(name: str, quick: bool) -> dict[str, Told]:
    """The same of studies that are there already."""
    out = {}
    for file in sorted(RUNS.glob(f"{name}-*/study.json")):
        what = file.parent.name.removeprefix(f"{name}-")
        if what.endswith("-quick") == quick:
            out[what.removesuffix("-quick")] = json.loads(file.read_text(encoding="utf-8"))
    return out


# ---------------------------------------------------------------------- text
def number(value: float | None, digits: int = 2) -> str:
    return "-" if value is None or not math.isfinite(value) else f"{value:.{digits}g}"


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    return [
        "| " + " | ".join(head) + " |",
        "|" + " --- |" * len(head),
        *("| " + " | ".join(row) + " |" for row in rows),
        "",
    ]


def order_words(order: Mapping[str, float] | None) -> str:
    return "-" if not order else f"{order['order']:.2f} ({order['low']:.2f} to {order['high']:.2f})"


def cost_words(costs: Mapping[str, Any], target: str) -> str:
    cost = costs.get(target)
    return (
        "-"
        if cost is None
        else {"between": "", "below": "< ", "beyond": "~ "}[cost["how"]] + f"{cost['seconds']:.3g} s"
    )


def seconds_at(reported: Told, curve: str, output: str) -> float | None:
    """CPU seconds of a curve for an error of GOOD; where its cheapest point is better already, that
    point's."""
    cost = reported["cpu_seconds_at_rms_error"].get(curve, {}).get(output, {}).get(f"{GOOD:g}")
    return cost["seconds"] if cost else None


def curve_rows(reported: Told, output: str) -> list[list[str]]:
    rows = []
    for curve in reported["orders"]:
        points = [p for p in reported["points"] if p["curve"] == curve]
        done = [p for p in points if p["status"] == "done"]
        errors = [p[f"error_{output}_rms"] for p in done if p[f"error_{output}_rms"] is not None]
        costs = reported["cpu_seconds_at_rms_error"].get(curve, {}).get(output, {})
        rows.append(
            [
                curve,
                f"{len(done)} of {len(points)}",
                number(max(errors, default=None)),
                number(min(errors, default=None)),
                order_words(reported["orders"][curve][output]["rms"]),
                *(cost_words(costs, t) for t in ("0.1", "0.01", "0.001")),
            ]
        )
    return rows


def failures(reported: Told) -> list[str]:
    """One line for each way in which points failed."""
    kinds: dict[tuple[str, str], list[str]] = {}
    for p in reported["points"]:
        if p["status"] != "done":
            message = p["message"].replace(str(ROOT) + "/", "").split("; where:")[0].split("; hint:")[0]
            kinds.setdefault(
                (p["curve"], re.sub(r" \d+ times in a row|, at last with.*", "", message)), []
            ).append(p["point"])
    return [f"- {curve} at {', '.join(points)}: {message}" for (curve, message), points in kinds.items()]


def scene_text(name: str, model: DrillingModel, reported: dict[str, Told]) -> list[str]:
    main = reported["curves"]
    about = main["reference"]
    lines = [
        f"## {main['title']}",
        "",
        f"`cases/verification/{model.file}`, {main['simulated']:g} s.  {model.note}",
        "",
    ]
    if about is None:
        return [*lines, "No reference came to its end.", ""]
    own = about["own_error"].get(model.main)
    lines += [
        f"Reference: {about['what']}"
        + (f"; its own error {own:.1g}" if own else "")
        + f".  Errors of `{model.main}`, rms over the "
        "rows as a share of its range.",
        "",
    ]
    lines += table(
        [
            "curve",
            "points",
            "largest error",
            "smallest",
            "order observed (95 %)",
            "CPU for 10 %",
            "1 %",
            "0.1 %",
        ],
        curve_rows(main, model.main),
    )
    lines += [*failures(main), ""] if failures(main) else []
    lines += [
        f"![error over CPU time](pictures/{name}-work_precision.png)",
        "",
        f"![error over step](pictures/{name}-orders.png)",
        "",
    ]
    return lines + more_text(name, model, reported)


def more_text(name: str, model: DrillingModel, reported: dict[str, Told]) -> list[str]:
    """Mesh, solvers, ranks."""
    lines: list[str] = []
    if "mesh" in reported and reported["mesh"]["reference"] is not None:
        mesh = reported["mesh"]
        rows = [
            [
                f"{p['abscissa']:.3g} m",
                str(p["elements"]),
                number(p[f"error_{model.main}_rms"]),
                f"{p['cpu']:.3g} s",
            ]
            for p in mesh["points"]
            if p["status"] == "done"
        ]
        order = order_words(mesh["orders"]["mesh"][model.main]["rms"])
        lines += [
            f"Mesh, against {mesh['reference']['what']}: order {order}.",
            "",
            *table(["element", "elements", "error", "CPU"], rows),
        ]
        lines += [f"![error over element length](pictures/{name}-mesh-orders.png)", ""]
    if "solver" in reported:
        rows = [
            [curve, number(seconds_at(reported["solver"], curve, model.main), 3) + " s"]
            for curve in reported["solver"]["orders"]
        ]
        lines += [f"Solvers, CPU time for an error of {100 * GOOD:g} %:", "", *table(["solver", "CPU"], rows)]
    if "ranks" in reported:
        points = [p for p in reported["ranks"]["points"] if p["status"] == "done"]
        largest = [
            [v for k, v in p.items() if k.startswith("error_") and k.endswith("_max") and v is not None]
            for p in points
        ]
        worst = [max(values, default=0.0) for values in largest]
        rows = [
            [
                str(p["ranks"]),
                f"{p['wall']:.3g} s",
                number(reported["ranks"]["speed_up"].get(str(p["ranks"]))),
                number(w),
            ]
            for p, w in zip(points, worst, strict=True)
        ]
        lines += [
            "Ranks, wall time, and the largest difference of any output to a separate run on one:",
            "",
            *table(["ranks", "wall", "speed-up", "difference / range"], rows),
        ]
    return lines


def choices(all_told: Mapping[str, dict[str, Told]]) -> list[str]:
    """The table that says what to choose, from the studies alone."""
    rows = []
    for name, reported in all_told.items():
        model, main = SCENES[name], reported["curves"]
        if main["reference"] is None:
            continue
        costs = {curve: seconds_at(main, curve, model.main) for curve in main["orders"]}
        known = {curve: s for curve, s in costs.items() if s is not None}
        best = min(known, key=lambda curve: known[curve], default="-")
        default = next(
            (
                p
                for p in main["points"]
                if p["curve"] == DEFAULT
                and p["status"] == "done"
                and math.isclose(p["value"], DEFAULT_TOLERANCE)
            ),
            None,
        )
        error = default[f"error_{model.main}_rms"] if default else None
        words = {
            curve: cost_words(main["cpu_seconds_at_rms_error"][curve][model.main], f"{GOOD:g}")
            for curve in known
        }
        rows.append(
            [
                main["title"],
                element_words(costs),
                best + (f", {words[best]}" if known else ""),
                words.get(DEFAULT, "-"),
                loosest(main, model.main),
                mesh_choice(reported.get("mesh"), model.main),
                solver_choice(reported.get("solver"), model.main),
                number(error),
                cost_or_dash(default["cpu"] if default else None),
            ]
        )
    head = [
        "scene",
        "element",
        "cheapest curve for 1 %",
        f"{DEFAULT} for 1 %",
        "loosest tolerance for 1 %",
        "longest element for 1 %",
        "solver",
        f"error at the default tolerance {DEFAULT_TOLERANCE:g}",
        "its CPU",
    ]
    return table(head, rows)


def cost_or_dash(seconds: float | None) -> str:
    return "-" if seconds is None else f"{seconds:.2g} s"


def element_words(costs: Mapping[str, float | None]) -> str:
    """Gauge or quaternion, by the same rule in fixed steps."""
    ours, petsc_names = costs.get("bdf2-fixed"), costs.get("quaternion-bdf2-fixed")
    if ours is None or petsc_names is None:
        return "ancf (quaternion: no result)" if ours is not None else "-"
    return f"{'ancf' if ours <= petsc_names else 'quaternion'} ({max(ours, petsc_names) / min(ours, petsc_names):.2g} times cheaper)"


def loosest(reported: Told, output: str) -> str:
    points = [p for p in reported["points"] if p["curve"] == DEFAULT and p["status"] == "done"]
    return number(max((p["value"] for p in points if is_good(p, output)), default=None))


def is_good(point: Mapping[str, Any], output: str) -> bool:
    error = point[f"error_{output}_rms"]
    return error is not None and error <= GOOD


def mesh_choice(reported: Told | None, output: str) -> str:
    if reported is None or reported["reference"] is None:
        return "-"
    good = [p["abscissa"] for p in reported["points"] if p["status"] == "done" and is_good(p, output)]
    return f"{max(good):.3g} m" if good else "shorter"


def solver_choice(reported: Told | None, output: str) -> str:
    if reported is None or reported["reference"] is None:
        return "-"
    costs = {
        curve: s for curve in reported["orders"] if (s := seconds_at(reported, curve, output)) is not None
    }
    return min(costs, key=lambda curve: costs[curve], default="-")


def ratio_text(all_told: Mapping[str, dict[str, Told]]) -> list[str]:
    """How much faster the default is than the paper's element and rule on the hanging string."""
    reported = all_told.get("hanging-string", {}).get("curves")
    if reported is None or reported["reference"] is None:
        return []
    ours, papers, rule = (seconds_at(reported, curve, "bit_speed") for curve in (DEFAULT, PAPER, PAPERS_RULE))
    shorter = all_told["hanging-string"].get("paper")
    if not papers and shorter is not None:
        papers = seconds_at(shorter, PAPER, "bit_speed")
    lines = []
    if ours and papers:
        lines.append(
            f"At an error of 1 % in bit speed on the hanging string the default is {papers / ours:.2g} times faster than the "
            "paper's element and integrator (quaternion, BDF1, fixed steps)."
        )
    elif ours:
        lines.append(
            "The paper's element and integrator (quaternion, BDF1) gave no point with an error of 1 % in bit speed on the hanging "
            "string, so there is no ratio to them yet."
        )
    if ours and rule:
        lines.append(
            f"With the paper's integrator on this package's element it is {rule / ours:.2g} times faster."
        )
    return [*lines, ""]


HEAD = """# Error against run time

Written by `scripts/report`; do not edit.  Every scene is run by several integrators with several steps and tolerances, each run in a
process of its own; the CPU time is that of the time loop with its output, the median of {repeats} run(s) on {processor}.  Errors are taken
in the rows of `history.csv` and `probes.csv`, as shares of the output's range in the reference.  Fixed steps: Newton's tolerance follows
the step, so that it does not cover the order.  Names: `bdf2-fixed` fixed steps of BDF2, `bdf2` error control, `quaternion-...` the paper's
element.  `<`: the cheapest point is better already; `~`: beyond the last point.
"""


def over_all(all_told: Mapping[str, dict[str, Told]]) -> list[str]:
    """What speaks for the defaults: each curve over all scenes, and which the figures choose."""
    seen: dict[str, list[tuple[float | None, float | None, int, int]]] = {}
    for name, reported in all_told.items():
        main = reported["curves"]
        if main["reference"] is None:
            continue
        ours = seconds_at(main, DEFAULT, SCENES[name].main)
        for curve in main["orders"]:
            points = [p for p in main["points"] if p["curve"] == curve]
            failed = sum(p["status"] != "done" for p in points)
            seen.setdefault(curve, []).append(
                (seconds_at(main, curve, SCENES[name].main), ours, failed, len(points))
            )
    if not seen:
        return []
    rows, rank = [], {}
    for curve, found in seen.items():
        reached = sum(cost is not None for cost, *_ in found)
        failed, points = sum(f for *_, f, _ in found), sum(n for *_, n in found)
        ratios = [cost / ours for cost, ours, *_ in found if cost and ours]
        ratio = statistics.median(ratios) if ratios else None
        rows.append([curve, f"{reached} of {len(found)}", f"{failed} of {points}", number(ratio, 3)])
        if not curve.endswith("-fixed") and len(found) == len(all_told):  # others could not be run everywhere
            rank[curve] = (reached / len(found), -failed / max(points, 1), -(ratio or math.inf))
    head = [
        "curve",
        f"scenes with an error of {100 * GOOD:g} %",
        "points failed",
        f"median CPU for it over that of `{DEFAULT}`",
    ]
    if not rank:
        return table(head, rows)
    best = max(rank, key=lambda curve: rank[curve])
    words = "which is the default" if best == DEFAULT else f"which is NOT the default, {DEFAULT}"
    text = (
        f"Of the curves whose steps follow an error and that every scene can take, `{best}` reaches {100 * GOOD:g} % in the "
        f"largest share of its scenes (of equals the one that fails least): {words}.  {DEFAULTS}"
    )
    return [*table(head, rows), text, ""]


DEFAULTS = """The default settings of the package are those of this report's `bdf2`: the ANCF element, BDF of order 2 with error
control (`-ts_type bdf -ts_bdf_order 2 -ts_adapt_type basic -ts_rtol 1e-4`), the condensed Newton solver with the direct solver for chains.
BDF3 is not stable where nothing damps; ARKIMEX, of order 4, pays at small errors in smooth scenes of few elements, and assembles the whole
system, which takes long strings too long."""


def write_report(all_told: Mapping[str, dict[str, Told]], repeats: int) -> Path:
    """REPORT.md and its pictures."""
    PICTURES.mkdir(parents=True, exist_ok=True)
    lines: list[str] = []
    for name, reported in all_told.items():
        draw_study(reported["curves"], PICTURES, name=f"{name}-", dpi=72)
        if "mesh" in reported:
            draw_study(reported["mesh"], PICTURES, name=f"{name}-mesh-", dpi=72)
            (PICTURES / f"{name}-mesh-work_precision.png").unlink(missing_ok=True)
        lines += scene_text(name, SCENES[name], reported)
    processor = next(iter(all_told.values()))["curves"]["machine"]["processor"] if all_told else "?"
    missing = [name for name in SCENES if name not in all_told]
    end = [f"Not run yet: {', '.join(missing)}.", ""] if missing else []
    text = [
        HEAD.format(repeats=repeats, processor=processor),
        "## What to choose",
        "",
        *choices(all_told),
        *ratio_text(all_told),
        *over_all(all_told),
        *end,
        *lines,
    ]
    file = CASES / "REPORT.md"
    file.write_text("\n".join(text).rstrip() + "\n", encoding="utf-8")
    return file


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help=f"of {', '.join(SCENES)} (default: all)")
    parser.add_argument(
        "--quick",
        action="store_true",
        help="three points a curve, one run of each, no study of solvers and ranks",
    )
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--fresh", action="store_true", help="run everything anew")
    parser.add_argument(
        "--write-only", action="store_true", help="write the report from the studies that are there"
    )
    given = parser.parse_args()
    unknown = set(given.scenes) - set(SCENES)
    if unknown:
        parser.error(f"unknown scene {', '.join(sorted(unknown))}: allowed are {', '.join(SCENES)}")
    repeats = 1 if given.quick else given.repeats
    all_told = {}
    for name, model in SCENES.items():
        on_rank = not given.write_only and (not given.scenes or name in given.scenes)
        reported = (
            run_scene(name, model, given.quick, repeats, given.fresh)
            if on_rank
            else read_scene(name, given.quick)
        )
        if "curves" in reported:  # scenes that were not asked for stay in the report as they are
            all_told[name] = reported
    print(write_report(all_told, repeats))


if __name__ == "__main__":
    main()
