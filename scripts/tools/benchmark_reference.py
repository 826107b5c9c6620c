"""Reference solutions of the benchmark: exact waves, another integrator on a finer mesh, runs with a smaller
tolerance.

Expensive references are kept in the user's cache folder under a hash of the case file and of this file.
"""

from __future__ import annotations

import hashlib
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np

REFERENCE_TOLERANCE_RATIO = 10.0  # -ts_rtol of the case over that of its reference run
SHEAR_SPEED = float(np.sqrt(206e9 / 2.6 / 7850.0))  # sqrt(G/density) of the hanging string, nu = 0.3 [m/s]
SPEED = 80 * 2 * np.pi / 60  # top speed of all rotating cases [rad/s]
HANGING_WEIGHT = 792.684e3  # hook load of the hanging string [N]
AXIAL_LOAD = 100e3  # on top of the buckled collar [N]


# ---------------------------------------------------------------------- cache
def cache_folder() -> Path:
    default = Path(os.environ.get("XDG_CACHE_HOME", str(Path.home() / ".cache"))) / "drillpetsc"
    return Path(os.environ.get("DRILLPETSC_CACHE", str(default))) / "references"


def cached(case: Path, kind: str, compute: Callable[[], dict], fresh: bool = False) -> dict:
    """The reference ``kind`` of a case (plain numbers and lists) from the cache; computed if missing or
    ``fresh``."""
    key = hashlib.sha256(
        b"\0".join([kind.encode(), case.read_bytes(), Path(__file__).read_bytes()])
    ).hexdigest()[:16]
    file = cache_folder() / f"{case.stem}-{kind}-{key}.json"
    if file.exists() and not fresh:
        return json.loads(file.read_text())
    print(f"computing the reference of {case.stem} ({kind}), kept in {file}", file=sys.stderr, flush=True)
    value = compute()
    file.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.NamedTemporaryFile("w", dir=file.parent, delete=False) as scratch:
        json.dump(value, scratch)
    os.replace(scratch.name, file)
    return value


# ---------------------------------------------------------------------- hanging string
def exact_bit_speed(times: np.ndarray, end: float) -> np.ndarray:
    """Bit speed (k,) [rad/s] at ``times`` (k,) [s] <= ``end``: torsional wave in 1800 m of pipe above 200 m
    of collar, free bit.

    Method of characteristics with cells of equal travel time, exact at the times of the grid. Both sections
    have the same shear wave speed; the impedances are in the ratio of their polar moments. The top speed rises
    as half a cosine to 80 rpm in 2 s.
    """

    def inertia(od: float, bore: float) -> float:
        return np.pi / 32 * (od**4 - bore**4)

    cell, n, junction = 1.0, 2000, 1800
    dt = cell / SHEAR_SPEED
    z = np.where(np.arange(n) < junction, inertia(0.127, 0.1086), inertia(0.1778, 0.0714))
    up, down = np.zeros(n), np.zeros(n)  # speed waves leaving each cell upward and downward
    out = np.zeros(int(end / dt) + 2)
    for k in range(len(out)):
        t = k * dt
        top = SPEED * (0.5 * (1 - np.cos(np.pi * min(t, 2.0) / 2)))
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


# ---------------------------------------------------------------------- pendulum
def free_motion(case, elements: int, times: np.ndarray, tolerance: float) -> np.ndarray:
    """Lower end (k, 2) [m], north and down, at ``times`` (k,) [s] of a straight string released in the plane of
    north and down.

    DOP853 for M a = -R(x, y, a = 0). The residual R and the constant mass matrix M of the string with
    ``elements`` elements are those of the package; the time integration (explicit, order 8, error control of
    positions and velocities) is independent. Spin and east offset remain zero, since all forces lie in the
    plane.
    """
    from scipy.integrate import solve_ivp

    from drillpetsc.analysis.statics.placement import move_rigidly, place_along_hole, release
    from drillpetsc.model.drilling_model import build_model

    item = case.string[0]
    refined = item.model_copy(update={"element_length": item.length / elements})
    model = build_model(case.model_copy(update={"string": type(case.string)([refined])}))
    place_along_hole(model)
    release(model)
    move_rigidly(model)
    asm, layout = model.system.assembly, model.system.layout
    held = np.concatenate([f.rows[np.any(f.D != 0, axis=0)] for f in asm.row_replacements])
    plane = np.concatenate(
        [layout.dofs[f"string.{name}"][:, [0, 2]].ravel() for name in ("position", "tangent")]
    )
    free = np.setdiff1d(plane, held)
    inverse, n = np.linalg.inv(_mass(asm, layout.size)[np.ix_(free, free)]), len(free)

    def rate(t: float, z: np.ndarray) -> np.ndarray:
        asm.x[free], asm.y[free], asm.a[:] = z[:n], z[n:], 0.0
        return np.concatenate([z[n:], -inverse @ asm.residual(t)[free]])

    start = np.concatenate([asm.x[free], asm.y[free]])
    found = solve_ivp(
        rate,
        (0.0, float(times[-1])),
        start,
        method="DOP853",
        rtol=tolerance,
        atol=1e-2 * tolerance,
        t_eval=times,
    )
    if found.status != 0:
        raise RuntimeError(f"the reference integration stopped: {found.message}")
    end = layout.dofs["string.position"][-1, [0, 2]]
    return found.y[np.searchsorted(free, end)].T


def _mass(asm, size: int) -> np.ndarray:
    """Mass matrix (n, n) of the assembled rows, dense."""
    asm.jacobian(0.0, (0.0, 0.0, 1.0), condensed=False)
    rows, columns = asm.places()
    keep = (rows >= 0) & (columns >= 0)
    M = np.zeros((size, size))
    np.add.at(M, (rows[keep], columns[keep]), asm.values[keep])
    return M


def pendulum_path(case_file: Path, fresh: bool) -> tuple[np.ndarray, np.ndarray]:
    """Times (k,) [s] and path (k, 2) [m] of the tip, north and up, on a mesh with twice the elements of the
    case."""

    def compute() -> dict:
        from drillpetsc.case import load_case

        case = load_case(case_file)
        item = case.string[0]
        elements = 2 * round(item.length / item.element_length)
        times = np.arange(0.0, case.time.end + 1e-9, case.output.history_every)
        return {"times": times.tolist(), "path": free_motion(case, elements, times, 1e-6).tolist()}

    value = cached(case_file, "dop853", compute, fresh)
    return np.array(value["times"]), np.array(value["path"]) * [1.0, -1.0]


# ---------------------------------------------------------------------- finer runs
def run_case(case_file: Path, folder: Path, *options: str) -> dict:
    """Run a case in a separate process; returns its summary."""
    command = [
        sys.executable,
        "-m",
        "drillpetsc",
        "run",
        str(case_file),
        "--out",
        str(folder),
        "--progress",
        "silent",
        *options,
    ]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return json.loads((folder / "summary.json").read_text())


def mean_of(history: dict[str, np.ndarray], column: str, after: float) -> float:
    """Mean over time of a column of history.csv from ``after`` [s] on (rows are equally spaced)."""
    return float(np.mean(history[column][history["time [s]"] >= after]))


def finer_means(case_file: Path, columns: tuple[str, ...], after: float, fresh: bool) -> dict[str, float]:
    """Means of history columns in a run of the case with a tolerance REFERENCE_TOLERANCE_RATIO times smaller."""

    def compute() -> dict:
        from drillpetsc.case import load_case
        from drillpetsc.output import read_table

        tolerance = float(load_case(case_file).petsc.get("ts_rtol", 1e-4)) / REFERENCE_TOLERANCE_RATIO
        with tempfile.TemporaryDirectory() as scratch:
            run_case(case_file, Path(scratch) / "run", "-ts_rtol", repr(tolerance))
            history = read_table(Path(scratch) / "run" / "history.csv")
        return {c: mean_of(history, c, after) for c in columns}

    return cached(case_file, "finer", compute, fresh)
