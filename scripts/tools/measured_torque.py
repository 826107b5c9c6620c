"""Why torque drifts with depth in Volve F-5: one change of the case or of the readings at a time, for the page "Measured wells".

The drift is the mean error of the torque of the lower ten of the 20 points, computed with the factors fitted to the upper ten.
"""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

import drillpetsc
from drillpetsc.analysis.commands.import_log import points_of_log
from drillpetsc.analysis.loads.torque_drag.operations import plan_of
from drillpetsc.analysis.loads.torque_drag.readings.calibration import Calibration
from drillpetsc.case import load_case
from drillpetsc.case.blocks.roadmap import MeasuredPoint
from drillpetsc.case.case import Case
from drillpetsc.output import read_table

ROOT = Path(__file__).parents[2]
WELL = ROOT / "cases" / "measured" / "volve-f5" / "case.yaml"
CUT = 2150.0  # bit depth below which torque is predicted [m]
FITTED = ("open_hole", "block_weight")
SHOE, STEP = 1405.0, 5.0  # of the casing; stations of a survey that is made tortuous [m]
RPM = np.pi / 30
LIGHT = 0.6  # weight on the bit that cuts next to nothing [t]
USUAL, SLOW = (147 * RPM, 153 * RPM), (50 * RPM, 140 * RPM)

Angles = Callable[[np.ndarray, np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]
Points = tuple[MeasuredPoint, ...]


def drift(case: Case, points: Points) -> tuple[float, float]:
    """(mean relative error of the predicted torques, open-hole friction that was fitted)."""
    upper, lower = (tuple(p for p in points if (p.bit_depth > CUT) == below) for below in (False, True))
    fit, rest = Calibration(case, upper).fit(FITTED), Calibration(case, lower)
    error = rest.computed([fit.best])[0] / rest.data.value - 1
    return float(error[~rest.data.hook].mean()), float(fit.value[0])


def surveyed(case: Case, change: Angles) -> Case:
    """A case with inclination and azimuth changed along the hole, both in radians."""
    survey = case.given_well.survey
    md = np.append(np.arange(0.0, survey.md[-1], STEP), survey.md[-1])
    azimuth = np.interp(md, survey.md, np.unwrap(survey.azimuth))
    inclination, azimuth = change(md, np.interp(md, survey.md, survey.inclination), azimuth)
    angles = {"inclination": np.abs(inclination), "azimuth": azimuth % (2 * np.pi)}
    given = {key: [f"{np.degrees(q)} deg" for q in values] for key, values in angles.items()}
    return case.replace({"well.survey": {"md": [f"{q} m" for q in md], **given}})


def tortuous(above: float) -> Angles:
    """Angles that swing by 0.5 degrees over 60 m below a depth [m]."""

    def change(md: np.ndarray, inclination: np.ndarray, azimuth: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        size = np.radians(0.5) * ((md > above) & (inclination > 0.1))
        swing = 2 * np.pi * md / 60
        across = size * np.cos(swing) / np.maximum(np.sin(inclination), 0.1)
        return inclination + size * np.sin(swing), azimuth + across

    return change


def stiffness(folder: Path) -> tuple[float, float]:
    """Torque of the stiff string over the torque of the soft one, less 1, at the upper and the lower end of the points."""
    torque = {}
    for model in ("soft", "stiff"):
        factors = {"cased": [0.18], "open_hole": [0.25]}
        depths = [f"{depth} m" for depth in (1910, 2385)]
        keys: dict[str, Any] = {"operations": ["drilling"], "bit_depth": depths, "friction_factor": factors}
        drillpetsc.roadmap(WELL, out=folder / model, model=model, **keys)
        torque[model] = read_table(folder / model / "roadmap.csv")["surface_torque [N m]"]
    first, last = torque["stiff"] / torque["soft"] - 1
    return float(first), float(last)


def by_speed(case: Case, record: Path) -> tuple[float, float, int]:
    """Mean relative errors of the torques read at the usual speed and at lower ones, and number of the latter.

    The factors are fitted to all points of 10 m."""
    points = points_of_log(str(record), case, None)
    work = Calibration(case, points)
    fit = work.fit(FITTED)
    d = work.data
    speed = np.array([points[i].rpm or 0.0 for i in d.point])
    error = fit.computed / d.value - 1
    usual, slow = (~d.hook & (a <= speed) & (speed <= b) for a, b in (USUAL, SLOW))
    return float(error[usual].mean()), float(error[slow].mean()), int(slow.sum())


def _zero_of_downhole_torque(record: Path) -> str:
    """Words on the downhole torque that is read with next to no weight on the bit, by 50 m."""
    with record.open(newline="") as lines:
        rows = list(csv.DictReader(lines))
    depth, weight, torque = (
        np.array([float(row[name] or "nan") for row in rows])
        for name in ("bit_md_m", "wob_downhole_t", "torque_downhole_kNm")
    )
    light, part = weight < LIGHT, depth // 50
    read = [float(np.nanmedian(torque[light & (part == q)])) for q in np.unique(part[light])]
    return f". With less than {LIGHT:g} t on the bit it reads {min(read):.1f} to {max(read):.1f} kN m, so its zero is in doubt"


def _changes(case: Case, points: Points, record: Path | None) -> Iterator[tuple[str, Case, Points, str]]:
    """Mechanism, case, points and words for each row."""
    mean = float(np.mean([p.tob for p in points if p.bit_depth <= CUT and p.tob is not None]))
    yield "nothing changed", case, points, ""
    yield (
        "torque on bit stays at its mean above 2150 m",
        case,
        tuple(p.model_copy(update={"tob": mean}) for p in points),
        "in part: the downhole torque grows and the surface torque does not follow"
        + ("" if record is None else _zero_of_downhole_torque(record)),
    )
    for value in (0.22, 0.26):
        yield (
            f"friction of the cased hole {value:.2f} instead of 0.18",
            case.replace({"well.sections[0].friction": value}),
            points,
            "not determined: the points do not tell it from the open hole",
        )
    yield (
        "tortuosity of 0.5° over 60 m, open hole",
        surveyed(case, tortuous(SHOE)),
        points,
        "no: the drift grows",
    )
    yield "the same, all along", surveyed(case, tortuous(0.0)), points, "no"
    yield (
        "hole that does not turn: side force of inclination alone",
        surveyed(case, lambda md, i, a: (i, np.full_like(a, np.radians(110.0)))),
        points,
        "no: the program adds both as vectors, and has to",
    )
    for density in (1450, 1530):
        yield (
            f"mud of {density} kg/m3 instead of 1490",
            case.replace({"fluid.density": f"{density} kg/m3"}),
            points,
            "no",
        )


def section(folder: Path, record: Path | None) -> str:
    """Lines of the page: the table, and what follows from it."""
    case = load_case(WELL)
    points = plan_of(case).measured
    assert points is not None
    lines = [
        "### Why torque drifts",
        "",
        "The factors are fitted to the ten points above 2150 m; the table shows the mean error of the ten torques below, computed with the same factors. One thing is changed at a time.",
        "",
        "| change | open hole | torque below [%] | supported |",
        "| --- | --- | --- | --- |",
    ]
    for name, changed, read, words in _changes(case, points, record):
        error, factor = drift(changed, read)
        found = "0, its bound" if np.isnan(factor) else f"{factor:.3f}"
        lines.append(f"| {name} | {found} | {100 * error:+.1f} | {words} |")
    first, last = stiffness(folder)
    lines.append(
        f"| stiffness of the pipe | | {100 * (last - first):+.1f} more | no: the stiff string takes {-100 * first:.1f} % off the torque at 1910 m and {-100 * last:.1f} % at 2385 m |"
    )
    if record is not None:
        usual, slow, count = by_speed(case, record)
        lines.append(
            f"| friction by rotary speed | | none | at one depth, not for the drift: all 20 points are at 150 rpm. {count} points of the record below 140 rpm have torques {100 * (slow - usual):.0f} % lower than those at 150 rpm with the same factors |"
        )
    lines += [
        "| cuttings, temperature, lubricity | | | not in the record |",
        "",
        "No mechanism that can be computed without a fit takes the drift away. The largest part goes with the reading of the downhole torque. The rest is friction that falls with depth, for a reason that the record does not contain.",
        "It is therefore carried on as a process along depth, with its band ({ref}`sec-calibrate-prediction`).",
        "",
    ]
    return "\n".join(lines)
