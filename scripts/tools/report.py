"""Error against run time of every verification case: studies, pictures and cases/verification/REPORT.md.

Studies are in results/report/<case>-<study> and are continued, so a report that was stopped resumes where it
stopped; --fresh starts again. The cases and their studies are listed in report_cases.py.
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

from report_cases import CASES, ReportCase

from drillpetsc.plotting.command.work_precision import draw_study
from drillpetsc.studies.convergence.study import study

ROOT = Path(__file__).parents[2]
CASE_FILES, RUNS = ROOT / "cases" / "verification", ROOT / "results" / "report"
PICTURES = CASE_FILES / "pictures"
SHORT_STEP_TIME_FACTOR = 10.0  # time limit of runs with ``paper_steps`` over that of other runs
TARGET_ERROR = 0.01  # error for which curves are compared
DEFAULT, PAPER, PAPER_INTEGRATOR = "bdf2", "quaternion-bdf1-fixed", "bdf1-fixed"
ALTERNATIVE = "alpha2"
DEFAULT_TOLERANCE = 1e-4
Content = dict[str, Any]  # of study.json


# ---------------------------------------------------------------------- studies
def studies_of(case: ReportCase, quick: bool) -> dict[str, dict[str, Any]]:
    """Studies of a case: name -> arguments of study()."""
    cut = (lambda values: values[1:4]) if quick else (lambda values: values)
    curves = {
        "curves": case.curves,
        "steps": cut(case.steps),
        "tolerances": cut(case.tolerances),
        "few": quick,
    }
    wanted: dict[str, dict[str, Any]] = {"curves": curves}
    if case.mesh:
        wanted["mesh"] = {"vary": "mesh", "values": cut(case.mesh)}
    if not quick:
        if case.solver:
            wanted["solver"] = {"vary": "solver", "tolerances": case.tolerances}
        if case.ranks:
            wanted["ranks"] = {"vary": "ranks"}
        if case.paper_steps:
            wanted["paper"] = {
                "curves": (PAPER,),
                "steps": case.paper_steps,
                "limit": SHORT_STEP_TIME_FACTOR * case.limit,
            }
    return wanted


def run_case(name: str, case: ReportCase, quick: bool, repeats: int, fresh: bool) -> dict[str, Content]:
    """Run the studies of a case; returns the content of study.json of each study."""
    out: dict[str, Content] = {}
    for what, arguments in studies_of(case, quick).items():
        folder = RUNS / f"{name}-{what}{'-quick' if quick else ''}"
        if fresh:
            shutil.rmtree(folder, ignore_errors=True)
        print(f"{name}: {what}", flush=True)
        result = study(
            CASE_FILES / case.file,
            out=folder,
            restart=folder.exists(),
            repeats=1 if what == "paper" else repeats,
            outputs=() if what == "ranks" else case.outputs,
            changes=case.changes,
            **{"limit": case.limit, **arguments},
        )
        out[what] = json.loads((result.folder / "study.json").read_text(encoding="utf-8"))
    return out


def read_case(name: str, quick: bool) -> dict[str, Content]:
    """Content of study.json of the studies of a case that exist."""
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


def seconds_at(content: Content, curve: str, output: str) -> float | None:
    """CPU seconds of a curve for an error of TARGET_ERROR, or of its cheapest point if that is more accurate."""
    cost = content["cpu_seconds_at_rms_error"].get(curve, {}).get(output, {}).get(f"{TARGET_ERROR:g}")
    return cost["seconds"] if cost else None


def curve_rows(content: Content, output: str) -> list[list[str]]:
    rows = []
    for curve in content["orders"]:
        points = [p for p in content["points"] if p["curve"] == curve]
        done = [p for p in points if p["status"] == "done"]
        errors = [p[f"error_{output}_rms"] for p in done if p[f"error_{output}_rms"] is not None]
        costs = content["cpu_seconds_at_rms_error"].get(curve, {}).get(output, {})
        rows.append(
            [
                curve,
                f"{len(done)} of {len(points)}",
                number(max(errors, default=None)),
                number(min(errors, default=None)),
                order_words(content["orders"][curve][output]["rms"]),
                *(cost_words(costs, t) for t in ("0.1", "0.01", "0.001")),
            ]
        )
    return rows


def failures(content: Content) -> list[str]:
    """One line for each kind of failure."""
    kinds: dict[tuple[str, str], list[str]] = {}
    for p in content["points"]:
        if p["status"] != "done":
            message = p["message"].replace(str(ROOT) + "/", "").split("; where:")[0].split("; hint:")[0]
            kinds.setdefault(
                (p["curve"], re.sub(r" \d+ times in a row|, at last with.*", "", message)), []
            ).append(p["point"])
    return [f"- {curve} at {', '.join(points)}: {message}" for (curve, message), points in kinds.items()]


def case_text(name: str, case: ReportCase, content: dict[str, Content]) -> list[str]:
    main = content["curves"]
    about = main["reference"]
    changed = f" with `{'`, `'.join(case.changes)}`" if case.changes else ""
    lines = [
        f"## {main['title']}",
        "",
        f"`{(CASE_FILES / case.file).resolve().relative_to(ROOT)}`{changed}, {main['simulated']:g} s.  {case.note}",
        "",
    ]
    if about is None:
        return [*lines, "No reference was completed.", ""]
    own = about["own_error"].get(case.main)
    lines += [
        f"Reference: {about['what']}"
        + (f"; its own error {own:.1g}" if own else "")
        + f".  Errors of `{case.main}`, rms over the "
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
        curve_rows(main, case.main),
    )
    lines += [*failures(main), ""] if failures(main) else []
    lines += [
        f"![error over CPU time](pictures/{name}-work_precision.png)",
        "",
        f"![error over step](pictures/{name}-orders.png)",
        "",
    ]
    return lines + more_text(name, case, content)


def more_text(name: str, case: ReportCase, content: dict[str, Content]) -> list[str]:
    """Text about mesh, solvers and ranks."""
    lines: list[str] = []
    if "mesh" in content and content["mesh"]["reference"] is not None:
        mesh = content["mesh"]
        rows = [
            [
                f"{p['abscissa']:.3g} m",
                str(p["elements"]),
                number(p[f"error_{case.main}_rms"]),
                f"{p['cpu']:.3g} s",
            ]
            for p in mesh["points"]
            if p["status"] == "done"
        ]
        order = order_words(mesh["orders"]["mesh"][case.main]["rms"])
        lines += [
            f"Mesh, against {mesh['reference']['what']}: order {order}.",
            "",
            *table(["element", "elements", "error", "CPU"], rows),
        ]
        lines += [f"![error over element length](pictures/{name}-mesh-orders.png)", ""]
    if "solver" in content:
        rows = [
            [curve, number(seconds_at(content["solver"], curve, case.main), 3) + " s"]
            for curve in content["solver"]["orders"]
        ]
        lines += [
            f"Solvers, CPU time for an error of {100 * TARGET_ERROR:g} %:",
            "",
            *table(["solver", "CPU"], rows),
        ]
    if "ranks" in content:
        points = [p for p in content["ranks"]["points"] if p["status"] == "done"]
        largest = [
            [v for k, v in p.items() if k.startswith("error_") and k.endswith("_max") and v is not None]
            for p in points
        ]
        worst = [max(values, default=0.0) for values in largest]
        rows = [
            [
                str(p["ranks"]),
                f"{p['wall']:.3g} s",
                number(content["ranks"]["speed_up"].get(str(p["ranks"]))),
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


def choices(all_content: Mapping[str, dict[str, Content]]) -> list[str]:
    """Table of recommended choices, from the studies alone."""
    rows = []
    for name, content in all_content.items():
        case, main = CASES[name], content["curves"]
        if main["reference"] is None:
            continue
        costs = {curve: seconds_at(main, curve, case.main) for curve in main["orders"]}
        known = {curve: s for curve, s in costs.items() if s is not None}
        best = min(known, key=lambda curve: known[curve], default="-")
        default = default_point(main, DEFAULT)
        error = default[f"error_{case.main}_rms"] if default else None
        words = {
            curve: cost_words(main["cpu_seconds_at_rms_error"][curve][case.main], f"{TARGET_ERROR:g}")
            for curve in known
        }
        rows.append(
            [
                main["title"],
                element_words(costs),
                best + (f", {words[best]}" if known else ""),
                words.get(DEFAULT, "-"),
                words.get(ALTERNATIVE, "-"),
                loosest(main, case.main),
                mesh_choice(content.get("mesh"), case.main),
                solver_choice(content.get("solver"), case.main),
                number(error),
                cost_or_dash(default["cpu"] if default else None),
            ]
        )
    head = [
        "case",
        "element",
        "cheapest curve for 1 %",
        f"{DEFAULT} for 1 %",
        f"{ALTERNATIVE} for 1 %",
        "loosest tolerance for 1 %",
        "longest element for 1 %",
        "solver",
        f"error at the default tolerance {DEFAULT_TOLERANCE:g}",
        "its CPU",
    ]
    return table(head, rows)


def default_errors(all_content: Mapping[str, dict[str, Content]]) -> list[str]:
    """Table of the errors of all drawn outputs at the default tolerance, with both integrators that control their steps."""
    rows = []
    for name, content in all_content.items():
        main = content["curves"]
        if main["reference"] is None:
            continue
        for output in CASES[name].outputs:
            row = [main["title"], f"`{output}`" + (" (compared)" if output == CASES[name].main else "")]
            for curve in (DEFAULT, ALTERNATIVE):
                point = default_point(main, curve)
                error = point.get(f"error_{output}_rms") if point else None
                row += [
                    "-" if error is None else f"{100 * error:.2g} %",
                    str(point["steps"]) if point else "-",
                    cost_or_dash(point["cpu"] if point else None),
                ]
            rows.append(row)
    head = ["case", "output"]
    for curve in (DEFAULT, ALTERNATIVE):
        head += [f"`{curve}`: error", "steps", "CPU"]
    return [
        "## Errors at the default tolerance",
        "",
        f"Of `{DEFAULT}`, and of `{ALTERNATIVE}`, the default where the string may turn in a hole, at a tolerance of {DEFAULT_TOLERANCE:g}.",
        "",
        *table(head, rows),
    ]


def default_point(main: Content, curve: str) -> Content | None:
    """The finished point of a curve at the default tolerance."""
    for p in main["points"]:
        if p["curve"] == curve and p["status"] == "done" and math.isclose(p["value"], DEFAULT_TOLERANCE):
            return dict(p)
    return None


def cost_or_dash(seconds: float | None) -> str:
    return "-" if seconds is None else f"{seconds:.2g} s"


def element_words(costs: Mapping[str, float | None]) -> str:
    """Cheaper of the ANCF and the quaternion element, with the same integrator and fixed steps."""
    default, quaternion = costs.get("bdf2-fixed"), costs.get("quaternion-bdf2-fixed")
    if "quaternion-bdf2-fixed" not in costs:
        return "-"
    if default is None or quaternion is None:
        return "ancf (quaternion: no result)" if default is not None else "-"
    return f"{'ancf' if default <= quaternion else 'quaternion'} ({max(default, quaternion) / min(default, quaternion):.2g} times cheaper)"


def loosest(content: Content, output: str) -> str:
    points = [p for p in content["points"] if p["curve"] == DEFAULT and p["status"] == "done"]
    return number(max((p["value"] for p in points if is_good(p, output)), default=None))


def is_good(point: Mapping[str, Any], output: str) -> bool:
    error = point[f"error_{output}_rms"]
    return error is not None and error <= TARGET_ERROR


def mesh_choice(content: Content | None, output: str) -> str:
    if content is None or content["reference"] is None:
        return "-"
    good = [p["abscissa"] for p in content["points"] if p["status"] == "done" and is_good(p, output)]
    return f"{max(good):.3g} m" if good else "shorter"


def solver_choice(content: Content | None, output: str) -> str:
    if content is None or content["reference"] is None:
        return "-"
    costs = {curve: s for curve in content["orders"] if (s := seconds_at(content, curve, output)) is not None}
    return min(costs, key=lambda curve: costs[curve], default="-")


def ratio_text(all_content: Mapping[str, dict[str, Content]]) -> list[str]:
    """Speed of the default relative to the element and integrator of the reference paper, on the hanging string."""
    content = all_content.get("hanging-string", {}).get("curves")
    if content is None or content["reference"] is None:
        return []
    default, paper, rule = (
        seconds_at(content, curve, "bit_speed") for curve in (DEFAULT, PAPER, PAPER_INTEGRATOR)
    )
    shorter = all_content["hanging-string"].get("paper")
    if not paper and shorter is not None:
        paper = seconds_at(shorter, PAPER, "bit_speed")
    lines = []
    if default and paper:
        lines.append(
            f"At an error of 1 % in bit speed on the hanging string the default is {paper / default:.2g} times faster than the "
            "reference paper's element and integrator (quaternion, BDF1, fixed steps)."
        )
    elif default:
        lines.append(
            "The reference paper's element and integrator (quaternion, BDF1) gave no point with an error of 1 % in bit speed on the hanging "
            "string, so there is no ratio to them yet."
        )
    if default and rule:
        lines.append(
            f"With the reference paper's integrator on this package's element it is {rule / default:.2g} times faster."
        )
    return [*lines, ""]


HEAD = """# Error against run time

Written by `scripts/report`; do not edit.  Every case is run by several integrators with several steps and tolerances, each run in a
process of its own; the CPU time is that of the time loop with its output, the median of {repeats} run(s) on {processor}.  Errors are taken
in the rows of `history.csv` and `probes.csv`, as shares of the output's range in the reference.  Fixed steps: Newton's tolerance follows
the step, so that it does not cover the order.  Names: `bdf2-fixed` fixed steps of BDF2, `bdf2` error control, `alpha2` generalised-alpha with
spectral radius 0.8, `quaternion-...` the reference paper's element.  Energies of chaotic and free motions: [ENERGY.md](ENERGY.md).  `<`: the cheapest point is more accurate; `~`: beyond the last point.
"""


def over_all(all_content: Mapping[str, dict[str, Content]]) -> list[str]:
    """Text about the defaults: each curve over all cases, and the best of them."""
    seen: dict[str, list[tuple[float | None, float | None, int, int]]] = {}
    for name, content in all_content.items():
        main = content["curves"]
        if main["reference"] is None:
            continue
        default = seconds_at(main, DEFAULT, CASES[name].main)
        for curve in main["orders"]:
            points = [p for p in main["points"] if p["curve"] == curve]
            failed = sum(p["status"] != "done" for p in points)
            seen.setdefault(curve, []).append(
                (seconds_at(main, curve, CASES[name].main), default, failed, len(points))
            )
    if not seen:
        return []
    rows, rank = [], {}
    for curve, found in seen.items():
        reached = sum(cost is not None for cost, *_ in found)
        failed, points = sum(f for *_, f, _ in found), sum(n for *_, n in found)
        ratios = [cost / default for cost, default, *_ in found if cost and default]
        ratio = statistics.median(ratios) if ratios else None
        rows.append([curve, f"{reached} of {len(found)}", f"{failed} of {points}", number(ratio, 3)])
        if not curve.endswith("-fixed") and len(found) == len(all_content):  # curves that all cases have
            rank[curve] = (reached / len(found), -failed / max(points, 1), -(ratio or math.inf))
    head = [
        "curve",
        f"cases with an error of {100 * TARGET_ERROR:g} %",
        "points failed",
        f"median CPU for it over that of `{DEFAULT}`",
    ]
    if not rank:
        return table(head, rows)
    best = max(rank, key=lambda curve: rank[curve])
    text = (
        f"Of the curves whose steps follow an error and that every case can use, `{best}` reaches {100 * TARGET_ERROR:g} % in the "
        f"largest share of its cases (of equals the one that fails least, then the cheapest).  {DEFAULTS}"
    )
    return [*table(head, rows), text, ""]


DEFAULTS = """The default settings of the package are the ANCF element, the condensed Newton solver with the direct solver for chains,
and `time.integrator: auto`: this report's `alpha2` where the string may turn in a hole, with steps that keep the energy of what touches the
wall and may whirl, and its `bdf2` (`-ts_type bdf -ts_bdf_order 2 -ts_adapt_type basic -ts_rtol 1e-4`) elsewhere.
BDF3 is not stable where nothing damps; ARKIMEX, of order 4, pays at small errors in smooth cases of few elements, and assembles the whole
system, which takes long strings too long.  Generalised-alpha has a quarter to a third of the error of BDF2 at the same tolerance and a similar
cost, where the motion is smooth or has impacts.  In the coupled string it resolves a flutter of the near-bit stabiliser that BDF2 damps away at
tolerances down to 1e-4, in 14 times the steps."""


def write_report(all_content: Mapping[str, dict[str, Content]], repeats: int) -> Path:
    """REPORT.md and its pictures."""
    PICTURES.mkdir(parents=True, exist_ok=True)
    lines: list[str] = []
    for name, content in all_content.items():
        draw_study(content["curves"], PICTURES, name=f"{name}-", dpi=72)
        if "mesh" in content:
            draw_study(content["mesh"], PICTURES, name=f"{name}-mesh-", dpi=72)
            (PICTURES / f"{name}-mesh-work_precision.png").unlink(missing_ok=True)
        lines += case_text(name, CASES[name], content)
    processor = next(iter(all_content.values()))["curves"]["machine"]["processor"] if all_content else "?"
    missing = [name for name in CASES if name not in all_content]
    end = [f"Not run yet: {', '.join(missing)}.", ""] if missing else []
    text = [
        HEAD.format(repeats=repeats, processor=processor),
        "## What to choose",
        "",
        *choices(all_content),
        *ratio_text(all_content),
        *over_all(all_content),
        *end,
        *default_errors(all_content),
        *lines,
    ]
    file = CASE_FILES / "REPORT.md"
    file.write_text("\n".join(text).rstrip() + "\n", encoding="utf-8")
    return file


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("cases", nargs="*", metavar="CASE", help=f"of {', '.join(CASES)} (default: all)")
    parser.add_argument(
        "--quick",
        action="store_true",
        help="three points a curve, one run of each, no study of solvers and ranks",
    )
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--fresh", action="store_true", help="run all studies again")
    parser.add_argument("--write-only", action="store_true", help="write the report from existing studies")
    given = parser.parse_args()
    unknown = set(given.cases) - set(CASES)
    if unknown:
        parser.error(f"unknown case {', '.join(sorted(unknown))}: allowed are {', '.join(CASES)}")
    repeats = 1 if given.quick else given.repeats
    all_content = {}
    for name, case in CASES.items():
        to_run = not given.write_only and (not given.cases or name in given.cases)
        content = (
            run_case(name, case, given.quick, repeats, given.fresh)
            if to_run
            else read_case(name, given.quick)
        )
        if "curves" in content:  # cases that were not named keep their place in the report
            all_content[name] = content
    print(write_report(all_content, repeats))


if __name__ == "__main__":
    main()
