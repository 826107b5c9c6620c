"""The page "Measured wells" of the manual (docs/verification/measured-wells.md) and its pictures, from cases/measured.

No number of the page is typed.  Held-out halves of F-5 need the public record, and are left out with a word where it is missing
(../shared/data, or DRILLPETSC_DATA).
"""

from __future__ import annotations

import csv
import os
import shutil
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import measured_rig
import measured_torque
import numpy as np

import drillpetsc
from drillpetsc.case import load_case
from drillpetsc.errors import CaseError
from drillpetsc.output import read_table
from drillpetsc.plotting import style
from drillpetsc.units import to_si

ROOT = Path(__file__).parents[2]
WELLS = ROOT / "cases" / "measured"
PAGE = ROOT / "docs" / "verification" / "measured-wells.md"
PICTURES = PAGE.parent / "pictures"
NAMES = {"hook_load": "hook load", "surface_torque": "surface torque"}


@dataclass(frozen=True)
class Row:
    """A row of the table: what is compared, what was fitted, number of readings, bias, rms and largest error [-], what follows."""

    well: str
    what: str
    fitted: str
    count: int
    bias: float
    rms: float
    largest: float
    verdict: str = ""

    @property
    def line(self) -> str:
        """The row as Markdown."""
        errors = f"{100 * self.bias:+.1f} | {100 * self.rms:.1f} | {100 * self.largest:.1f}"
        return f"| {self.well} | {self.what} | {self.fitted} | {self.count} | {errors} | {self.verdict} |"


def _row(well: str, what: str, fitted: str, residual: np.ndarray, verdict: str = "") -> Row:
    largest = float(residual[np.abs(residual).argmax()])
    rms = float(np.sqrt((residual**2).mean()))
    return Row(well, what, fitted, len(residual), float(residual.mean()), rms, abs(largest), verdict)


def _record(name: str) -> Path | None:
    """A file of the public records, None where they are not at hand."""
    given = os.environ.get("DRILLPETSC_DATA")
    path = (Path(given) if given else ROOT.parent / "shared" / "data") / name
    return path if path.exists() else None


# ---------------------------------------------------------------------- hook load and torque
def _fit_words(fit: dict[str, Any]) -> str:
    scale = {"block_weight": (1e-3, " kN"), "running_drag": (1e-3, " kN per m/s")}
    words = []
    for name, found in fit.items():
        factor, unit = scale.get(name, (1.0, ""))
        value = found["value"]
        words.append(
            f"{name.replace('_', ' ')} "
            + ("not determined" if value is None else f"{value * factor:.3g}{unit}")
        )
    return ", ".join(words)


def _calibrated(well: str, name: str, fit: str, out: Path, **choices: Any) -> tuple[list[Row], Any]:
    """Rows of a calibration: the readings that were fitted, and those that were predicted."""
    result = drillpetsc.calibrate(WELLS / well / "case.yaml", out=out, fit=fit, **choices)
    table, rows = read_table(out / "calibration.csv"), []
    summary = result.summary
    drifts = bool(summary.get("drift") and summary["drift"]["drifts"])
    for part in ("fitted", "held_out"):
        for kind in ("hook_load", "surface_torque"):
            chosen = (table["part [-]"] == part) & (table["compared [-]"] == kind)
            if not chosen.any():
                continue
            relative = table["residual [N or N m]"][chosen] / table["measured [N or N m]"][chosen]
            held = (summary.get("hold_out") or {}).get(kind)
            if part == "fitted":
                verdict, fitted = ("friction drifts with depth" if drifts else ""), _fit_words(summary["fit"])
            else:
                verdict, fitted = f"predicted; {100 * held['in_band']:.0f} % in the 90 % band", "nothing more"
            rows.append(_row(name, NAMES[kind], fitted, relative, verdict))
    return rows, result


def _picture(out: Path, name: str) -> str:
    """Readings and computed values over depth, and the calibration's own picture; returns the lines of the page."""
    table = read_table(out / "calibration.csv")
    kinds = [kind for kind in NAMES if (table["compared [-]"] == kind).any()]
    with style.look():
        drawing = style.figure(5.2 * len(kinds), 6.0, dpi=110)
        for axes, kind in zip(
            drawing.subplots(1, len(kinds), squeeze=False, sharey=True)[0], kinds, strict=True
        ):
            size = 1e3
            for part, color, words in (
                ("fitted", "#1f5fa8", "computed, fitted"),
                ("held_out", "#c8501e", "computed, predicted"),
            ):
                chosen = (table["compared [-]"] == kind) & (table["part [-]"] == part)
                if not chosen.any():
                    continue
                depth, computed = table["bit_depth [m]"][chosen], table["computed [N or N m]"][chosen] / size
                band = np.nan_to_num(table["band [N or N m]"][chosen]) / size
                axes.errorbar(
                    computed,
                    depth,
                    xerr=band,
                    fmt="o",
                    markersize=3.5,
                    color=color,
                    linewidth=0.7,
                    label=words,
                )
                measured = table["measured [N or N m]"][chosen] / size
                axes.plot(measured, depth, "k+", markersize=5, label="measured" if part == "fitted" else None)
            axes.set_xlabel(f"{NAMES[kind]} [{'kN' if kind == 'hook_load' else 'kN m'}]")
        axes = drawing.axes[0]
        axes.invert_yaxis()
        axes.set_ylabel("bit depth [m]")
        axes.legend(fontsize=8)
        drawing.tight_layout()
        PICTURES.mkdir(exist_ok=True)
        drawing.savefig(PICTURES / f"{name}.png")
    return f"![readings and computed values over depth](pictures/{name}.png)\n"


# ---------------------------------------------------------------------- pump pressure
def _stages(well: str) -> np.ndarray:
    with (WELLS / well / "stages.csv").open(newline="") as lines:
        return np.array([[float(cell) for cell in row] for row in list(csv.reader(lines))[1:]])


def _pressures(well: str, flows: Sequence[str], out: Path, **choices: Any) -> np.ndarray:
    """Pressure of the pump above that at the outlet [Pa] at flow rates."""
    summary = drillpetsc.hydraulics(WELLS / well / "case.yaml", out=out, flow=list(flows), **choices).summary
    return np.array([flow["pump_pressure"] for flow in summary["flows"]]) - summary["outlet_pressure"]


def _pump_pressures(folder: Path) -> Iterator[Row]:
    rows = _stages("volve-f4")
    rows = rows[rows[:, 1] >= 886]
    found = _pressures("volve-f4", [f"{q} l/min" for q in rows[:, 1]], folder / "f4-flow", bit_depth="2616 m")
    yield _row("Volve F-4", "pump pressure, sea water", "nothing", found / (rows[:, 2] * 1e5) - 1)
    middle = (rows[:, 1] >= 1770) & (rows[:, 1] <= 2200)
    yield _row(
        "Volve F-4", "the same, 1770 to 2200 l/min", "nothing", (found / (rows[:, 2] * 1e5) - 1)[middle]
    )
    rows, psi = _stages("forge-16b"), to_si("1 psi", "Pa")
    found = _pressures("forge-16b", [f"{q} gpm" for q in rows[:, 1]], folder / "forge-flow")
    flow, read = rows[:, 1], rows[:, 2] * psi
    k = int(flow.argmax())
    tools = (read[k] - found[k]) * (flow / flow[k]) ** 2
    residual = np.delete((found + tools) / read - 1, k)
    yield _row(
        "FORGE 16B", "pump pressure, water", "loss of motor and MWD at the largest flow rate", residual
    )


# ---------------------------------------------------------------------- stick-slip
def _stick_slip(folder: Path) -> tuple[list[Row], str]:
    """Rows of the laboratory rig, and the table and picture of its section."""
    time, speed = measured_rig.computed(folder / "rig")
    found, read = measured_rig.figures(time, speed), measured_rig.read_windows()
    rows = []
    for name, fitted, starts in (
        ("UFRJ rig, 37 to 41 s", "10 parameters, to balances of torque", [measured_rig.FITTED]),
        ("UFRJ rig, 41 to 45 s", "nothing more", [measured_rig.FITTED + measured_rig.LENGTH]),
        ("UFRJ rig, all others", "nothing more", [q for q in read if not 37 <= q <= 41]),
    ):
        for key, words in (("frequency", "frequency of stick-slip"), ("peak", "peak of the bit speed")):
            residual = np.array([getattr(found, key) / getattr(read[start], key) - 1 for start in starts])
            stuck = 100 * max((found.stuck - read[start].stuck for start in starts), key=abs)
            verdict = f"stuck share {stuck:+.0f} points" if key == "peak" else ""
            rows.append(_row(name, words, fitted, residual, verdict))
    words = "\n".join(measured_rig.table_lines(found)) + "\n"
    record = _record(measured_rig.NAME)
    if record is not None:
        measured_rig.draw(time, speed, measured_rig.read_record(record), PICTURES / "measured-rig.png")
        words += "\n![computed and measured bit speed](pictures/measured-rig.png)\n"
    return rows, words


# ---------------------------------------------------------------------- the page
def _source(well: str) -> str:
    """The paragraphs of SOURCE.md without its heading."""
    text = (WELLS / well / "SOURCE.md").read_text(encoding="utf-8")
    return text.split("\n", 1)[1].strip() + "\n"


def _dogleg() -> str:
    try:
        load_case(WELLS / "field-dogleg" / "case.yaml")
    except CaseError as error:
        return "```text\n" + str(error).replace(str(ROOT) + "/", "") + "\n```\n"
    raise SystemExit("the doubtful string of field-dogleg was taken without a word")


def main() -> None:
    """Compute all wells and write the page."""
    folder = Path(tempfile.mkdtemp())
    rows, parts = [], {}
    found, _ = _calibrated("volve-f5", "Volve F-5", "open_hole,block_weight", folder / "f5")
    rows += found
    parts["volve-f5"] = _picture(folder / "f5", "measured-f5")
    log = _record("volve-f5/measured-12in.csv")
    if log is not None:
        choices = {"log": str(log), "hold_out": "2150m"}
        found, _ = _calibrated(
            "volve-f5",
            "Volve F-5, record in 10 m points",
            "open_hole,block_weight",
            folder / "f5-half",
            **choices,
        )
        rows += found
        parts["volve-f5"] += _picture(folder / "f5-half", "measured-f5-half")
    parts["volve-f5"] += "\n" + measured_torque.section(folder, log)
    found, _ = _calibrated("volve-f4", "Volve F-4 trips", "cased,weight_factor,running_drag", folder / "f4")
    rows += found
    parts["volve-f4"] = _picture(folder / "f4", "measured-f4")
    found, _ = _calibrated(
        "volve-f4",
        "Volve F-4, deeper half predicted",
        "cased,weight_factor,running_drag",
        folder / "f4-half",
        hold_out="0.5",
    )
    rows += found
    rows += _pump_pressures(folder)
    found, parts["ufrj-rig"] = _stick_slip(folder)
    rows += found
    titles = {
        "volve-f5": "Volve F-5",
        "volve-f4": "Volve F-4",
        "forge-16b": "Utah FORGE 16B",
        "ufrj-rig": "Stick-slip of a laboratory rig",
        "field-dogleg": "A string that is doubtful",
    }
    lines = [
        "<!-- written by scripts/measured-wells -->",
        "(sec-verif-measured)=",
        "# Measured wells",
        "",
        "Computed and measured hook loads, torques and pump pressures of named public wells, and the stick-slip of a laboratory rig. Errors are computed less measured, over the reading, in per cent. Fitted numbers are named; a row",
        "with *predicted* contains readings that no number was fitted to. The cases, their sources and the bands that tests require are in `cases/measured`.",
        "",
        "| well | quantity | fitted | readings | bias | rms | largest | |",
        "| --- | --- | --- | --- | --- | --- | --- | --- |",
        *(row.line for row in rows),
        "",
        "What this does not show: dynamic loads of a well, and wells whose string or mud is not known. A fit with two numbers to the points that it is then compared with is no prediction. Torque drifts with depth in F-5,",
        "more than one friction factor for the open hole can follow: its prediction below the fitted depths is the weakest of this page. Predictions carry the drift on ({ref}`sec-calibrate-prediction`).",
        "",
    ]
    for well, title in titles.items():
        lines += [f"## {title}", "", _source(well), parts.get(well, "")]
        if well == "field-dogleg":
            lines += ["The case is refused:", "", _dogleg()]
    PAGE.write_text("\n".join(lines).replace("\n\n\n", "\n\n").rstrip() + "\n", encoding="utf-8")
    shutil.rmtree(folder)
    print("\n".join(row.line for row in rows))
    print(f"{PAGE.relative_to(ROOT)}")


if __name__ == "__main__":
    main()
