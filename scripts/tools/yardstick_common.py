"""What the adapters of the yardstick share. Needs numpy and scipy only, so that it runs beside any program."""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import yardstick_score as yard
from scipy.signal import butter, filtfilt

Found = dict[str, Any]
GRAVITY = 9.81  # where a problem gives weights in mud [m/s2]
STUCK = 1.0472  # a bit below this speed is stuck, by the question of laboratory-rig [rad/s]


def tube(given: Found) -> tuple[float, float, float]:
    """Young's modulus [Pa], area [m2] and second moment of area [m4] of a pipe."""
    od, bore = given["outside diameter [m]"], given["inside diameter [m]"]
    return (
        given.get("Young's modulus [Pa]", np.nan),
        np.pi / 4 * (od**2 - bore**2),
        np.pi / 64 * (od**4 - bore**4),
    )


def threshold(unstable: Callable[[float], bool], low: float, high: float, tolerance: float = 1e-4) -> float:
    """The load between low and high at which a straight string becomes unstable, by bisection."""
    while high - low > tolerance * high:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if unstable(middle) else (middle, high)
    return 0.5 * (low + high)


def buckling(negative: Callable[[float], int], unit: float) -> Found:
    """Answers of lubinski from the number of negative eigenvalues at a weight on bit; unit: weight of a dimensionless length [N]."""
    return {
        "first buckling": threshold(lambda wob: negative(wob) >= 1, unit, 3 * unit),
        "second buckling": threshold(lambda wob: negative(wob) >= 2, 3 * unit, 5 * unit),
    }


def friction_torques(given: Found, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Torsional stiffness [N m/rad] and friction torque [N m] of the pieces (count per part) of aarsnes-shor, from the bottom up."""
    stiffness, torque = [], []
    for part in ("assembly", "drill pipe"):
        one = given[part]
        _, area, second = tube(one)
        piece = one["length [m]"] / count
        weight = given["density [kg/m3]"] * given["gravity [m/s2]"] * area * piece
        arm = given["static friction [-]"] * 0.5 * one["outside diameter [m]"]
        stiffness += [one["shear modulus [Pa]"] * 2 * second / piece] * count
        torque += [weight * np.sin(given["inclination [rad]"]) * arm] * count
    return np.array(stiffness), np.array(torque)


def rig_figures(time: np.ndarray, speed: np.ndarray) -> Found:
    """Figures of laboratory-rig from 8 s of bit speed (8001,) [rad/s] at 1 ms."""
    speed = filtfilt(*butter(4, 10 * 2e-3), speed)
    late = time >= 4.0
    time, speed = time[late], speed[late]
    mean = speed.mean()
    rise = np.flatnonzero((speed[:-1] < mean) & (speed[1:] >= mean))
    found = {
        "mean": float(mean),
        "frequency": (len(rise) - 1) / float(time[rise[-1]] - time[rise[0]]),
        "peak": float(np.mean([speed[a:b].max() for a, b in zip(rise[:-1], rise[1:], strict=True)])),
        "stuck share": float((speed < STUCK).mean()),
    }
    return found | {f"{key}, predicted": value for key, value in found.items()}


def answer_with(solvers: dict[str, Any], names: list[str]) -> dict[str, Found]:
    """Answers of a program: a function a problem; one that fails is told in a note and leaves its quantities open."""
    answers: dict[str, Found] = {}
    for name in names:
        start = time.perf_counter()
        try:
            found = dict(solvers[name](yard.load(name)))
        except Exception as error:
            found = {"note": f"failed: {type(error).__name__}: {error}"}
        answers[name] = {**found, "seconds": round(time.perf_counter() - start, 3)}
        print(f"{name}: {answers[name]['seconds']} s", file=sys.stderr)
    return answers


def write(answers: dict[str, Found], out: Path) -> None:
    """Write an answer file."""
    out.write_text(json.dumps(answers, indent=1) + "\n", encoding="utf-8")


def answer(solvers: dict[str, Callable[[yard.Problem], Found]]) -> None:
    """Write the answers to the file of the command line; a string instead of a function says why there is none."""
    chosen = sys.argv[2:] or [name for name in yard.ORDER if name in solvers]
    write(answer_with(solvers, chosen), Path(sys.argv[1]))
