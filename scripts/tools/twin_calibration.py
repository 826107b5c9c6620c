"""Twin experiments of `calibrate`: readings of known parameters with noise, and how often the 95 % intervals hold the truth.

The tables of the manual come from:  scripts/twin-calibration soft 100;  scripts/twin-calibration stiff 100 (verif-twin-calibration);
scripts/twin-calibration runs 20;  scripts/twin-calibration runs 100 1000 (verif-twin-runs)
"""

from __future__ import annotations

import sys
from functools import partial
from pathlib import Path

import numpy as np
from petsc4py import PETSc

from drillpetsc.analysis.calibration.estimator import Fit
from drillpetsc.analysis.loads.torque_drag.readings.calibration import Calibration
from drillpetsc.analysis.loads.torque_drag.readings.forward_stiff import StiffForward
from drillpetsc.case import load_case
from drillpetsc.case.blocks.roadmap import MeasuredPoint
from drillpetsc.case.case import Case
from drillpetsc.parallel import initialise_petsc

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT))
from tests.verification import test_calibrate_runs as runs  # noqa: E402

#: parameters of the readings [SI]; the case has 0.2, 0.3, no block, 1260 kg/m3 and 6.8 kN m
TRUTH = {
    "cased": 0.22,
    "open_hole": 0.28,
    "block_weight": 180e3,
    "fluid.density": 1290.0,
    "roadmap.drilling.tob": 7500.0,
}
DEPTHS = (500.0, 1200.0, 1800.0, 2390.0)  # bit depths of the readings [m]
SIGMA = 2e3  # standard error of a hook load [N]; that of a torque is the one that `calibrate` assumes


def twin_case() -> Case:
    """The build-and-hold well J-1 with elements of 20 m and a torque on bit, the pumps off."""
    case = load_case(ROOT / "cases" / "field" / "metric.yaml")
    lengths = {f"string[{i}].element_length": size for i, size in enumerate(("20 m", "20 m", "12 m"))}
    return case.replace(
        {**lengths, "fluid.flow_rate": "0 l/min", "roadmap.drilling": {"wob": "50 kN", "tob": "6.8 kN m"}}
    )


class Twin:
    """Readings of a string whose parameters are known.

    model: soft or stiff, which computes the readings and is fitted to them; depths: of the bit [m].
    """

    def __init__(self, model: str, depths: tuple[float, ...] = DEPTHS) -> None:
        forward = None if model == "soft" else partial(StiffForward, comm=PETSc.COMM_SELF)
        turning = {"trip_in": None, "trip_out": None, "rotate_off_bottom": 1.0, "drilling": 1.0}
        blank = tuple(
            MeasuredPoint(bit_depth=depth, operation=word, hook_load=1.0, torque=torque, sigma=SIGMA)
            for depth in depths
            for word, torque in turning.items()
        )
        self.work = Calibration(twin_case(), blank, forward=forward)
        self.clean = self._points(self.work.computed([TRUTH])[0])
        self.work.read(self.clean)

    def _points(self, values: np.ndarray) -> tuple[MeasuredPoint, ...]:
        """The points with readings (n,) [N, N m]."""
        d, points = self.work.data, list(self.work.points)
        for i, hook, value in zip(d.point, d.hook, values, strict=True):
            points[i] = points[i].model_copy(update={"hook_load" if hook else "torque": float(value)})
        return tuple(points)

    def fit(self, seed: int) -> Fit:
        """The fit to readings with the noise of a seed."""
        self.work.read(self.clean)
        d = self.work.data
        noise = d.sigma * np.random.default_rng(seed).standard_normal(len(d.value))
        self.work.read(self._points(d.value + noise))
        return self.work.fit(tuple(TRUTH))

    def errors(self, seeds: range) -> np.ndarray:
        """(seeds, parameters) error over the half width of the interval; infinite for a parameter that was not determined."""
        out = []
        for seed in seeds:
            found = self.fit(seed)
            row = (found.value - np.array(list(TRUTH.values()))) / found.interval
            out.append(np.where(np.isnan(row), np.inf, row))
        return np.array(out)


def print_runs(seeds: range) -> None:
    """Print how often the intervals of logs in time hold each number."""
    for what, case, truth in (("pendulum", runs.pendulum, runs.FREE), ("bit law", runs.rock_bit, runs.LAW)):
        pair = runs.twin(case("bdf"), truth)
        for memory in (0.0, 0.8):
            fits = pair.fits(runs.WHOLE, seeds, 0.02, memory)
            missing = {seed: fit.reasons for seed, fit in zip(seeds, fits, strict=True) if fit.reasons}
            print(
                f"| {what}, memory {memory:g} | {pair.held(fits)} | {pair.held(fits, True)} | of {len(seeds)} |",
                missing or "",
                flush=True,
            )


def main(model: str, count: str, first: str = "0") -> None:
    """Print the table of a model, soft, stiff or runs, for ``count`` seeds from the ``first`` on."""
    seeds = range(int(first), int(first) + int(count))
    if model == "runs":
        initialise_petsc()
        print_runs(seeds)
        return
    twin = Twin(model)
    widths, errors = [], []
    for seed in seeds:
        found = twin.fit(seed)
        widths.append(found.interval)
        errors.append(found.value - np.array(list(TRUTH.values())))
        held = (np.abs(errors) <= np.array(widths)).sum(axis=0)
        print(seed, dict(zip(TRUTH, held.tolist(), strict=True)), found.reasons or "", flush=True)
    for k, name in enumerate(TRUTH):
        width, error = np.array(widths)[:, k], np.array(errors)[:, k]
        print(
            f"| `{name}` | {TRUTH[name]:g} | {np.nanmean(width):.3g} | {np.sqrt(np.nanmean(error**2)):.3g} "
            f"| {int(held[k])} of {len(error)} |"
        )


if __name__ == "__main__":
    main(*sys.argv[1:])
