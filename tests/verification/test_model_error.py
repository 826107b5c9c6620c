"""Predictions of `calibrate --hold-out`: errors that are alike along depth are carried on, and their band holds."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from drillpetsc.analysis.calibration.estimator import UNIT_STEP
from drillpetsc.analysis.loads.torque_drag.readings.along_depth import correlation_sum, small_sample
from drillpetsc.analysis.loads.torque_drag.readings.calibration import Calibration
from drillpetsc.analysis.loads.torque_drag.readings.held_out import BAND, BAND_SIGMAS, predict
from drillpetsc.analysis.loads.torque_drag.readings.model_error import SECTION, ModelError, Relative, relative
from tests.verification.test_calibrate_command import TRUTH, _drilling, case

FREE = np.zeros(1)  # no prior of the friction factor


@pytest.fixture(scope="module")
def well() -> Relative:
    """50 torques from 1900 to 2400 m without errors."""
    work = Calibration(case(), _drilling(0)[::5])
    work.own[0] = TRUTH["cased"]
    clean = relative(work, {"open_hole": TRUTH["open_hole"]}, ("open_hole",), "open_hole")
    return replace(clean, error=np.zeros(50), noise=np.ones(50))


def some(of: Relative, rows: np.ndarray, error: np.ndarray) -> Relative:
    """Some of the readings, with errors."""
    at = {name: value[rows] for name, value in vars(of).items() if name in Relative.__dataclass_fields__}
    return Relative(**at | {"error": error[rows]})


def process(rng: np.random.Generator, depth: np.ndarray, over: float) -> np.ndarray:
    """A first-order Markov process of size 1."""
    covariance = np.exp(-np.abs(depth[:, None] - depth) / over)
    return np.asarray(
        np.linalg.cholesky(covariance + 1e-12 * np.eye(len(depth))) @ rng.standard_normal(len(depth))
    )


def walk(rng: np.random.Generator, depth: np.ndarray, rate: float) -> np.ndarray:
    return np.asarray(
        np.cumsum(rate * np.sqrt(np.diff(depth, prepend=depth[0])) * rng.standard_normal(len(depth)))
    )


def matern(apart: np.ndarray) -> np.ndarray:
    x = np.sqrt(3.0) * apart / SECTION
    return np.asarray((1 + x) * np.exp(-x))


ERRORS = {
    "alike over 60 m": lambda rng, at: (0.03 * process(rng, at, 60.0), 0.0),
    "friction walks": lambda rng, at: (0.0, walk(rng, at, 0.002)),
    "alike, and friction drifts": lambda rng, at: (
        0.03 * process(rng, at, 60.0),
        rng.choice([-1, 1]) * 2e-4 * (at - at[0]),
    ),
    "alike, and friction walks": lambda rng, at: (0.03 * process(rng, at, 60.0), walk(rng, at, 0.002)),
}


@pytest.mark.slow
@pytest.mark.parametrize("kind", ERRORS)
def test_band_holds_on_twins(well: Relative, kind: str) -> None:
    """The upper half fitted, 20 seeds: the 90 % band of the lower half holds 85 to 97 % of its readings.

    Torques have 1.5 % of noise of their own.  Friction walks by 0.002 per root metre, or drifts by 0.02 per 100 m."""
    upper, hits = well.depth < 2150, []
    for seed in range(20):
        rng = np.random.default_rng(seed)
        reading, friction = ERRORS[kind](rng, well.depth)
        error = 0.015 * rng.standard_normal(50) + reading + well.source[:, 0] * friction
        slope = well.slope[upper, 0]
        error = error - well.slope[:, 0] * (slope @ error[upper]) / (slope @ slope)  # about the fitted factor
        mean, sigma = ModelError(some(well, upper, error), FREE, FREE).predict(some(well, ~upper, error))
        hits.append(np.mean(np.abs(error[~upper] - mean) <= 1.645 * sigma))
    assert 0.85 <= np.mean(hits) <= 0.97, np.mean(hits)


def test_what_is_alike_is_carried_on(well: Relative) -> None:
    """One exact reading shows a friction that is 0.02 off; the rest follows Matern's correlation c = (1 + x) exp(-x), x = sqrt(3) d/1000 m.

    The error below is c times that, its variance s^2 (1 - c^2)."""
    one, far = np.arange(1), np.arange(1, 50)
    error = 0.02 * well.source[:, 0]
    fitted = some(well, one, error)
    certain = np.array([1e12])  # the friction factor itself is known
    model = ModelError(fitted, certain, FREE)
    sizes = np.log([0.1, 1e-9, 1e-9, 1e-9, 30.0])
    mean, variance = model._given(sizes, some(well, far, error))
    apart = well.depth[far] - well.depth[0]
    friction = well.source[far, 0]
    c = matern(apart)
    assert mean == pytest.approx(0.02 * friction * c, rel=1e-5)
    assert variance == pytest.approx((0.1 * friction) ** 2 * (1 - c**2), rel=1e-5)


def test_pulling_out_says_nothing_of_friction_running_in(well: Relative) -> None:
    """Another operation has the same weight and another friction."""
    model = ModelError(some(well, np.arange(25), well.error), FREE, FREE)
    other = replace(well, operation=np.full(50, "trip_in"))
    sizes = np.log([0.1, 0.01, 0.01, 0.01, 30.0])
    apart = np.abs(well.depth[:, None] - well.depth[:25])
    weight = 0.01**2 * np.outer(well.source[:, 1], well.source[:25, 1]) * matern(apart)
    assert model._alike(sizes, other) == pytest.approx(weight, abs=1e-15)


def test_neighbours_are_averaged_beyond_a_hundred() -> None:
    """500 readings of one series become 100 with a fifth of the variance."""
    many = Relative(
        *(
            np.arange(500.0),
            np.full(500, "drilling"),
            np.ones(500, dtype=bool),
            np.arange(500.0),
            np.ones(500),
        ),
        *(np.ones((500, 1)), np.ones((500, 2)), np.ones(500)),
    )
    found = many.condensed()
    assert found.depth == pytest.approx(np.arange(2.0, 500.0, 5.0)) and found.error == pytest.approx(
        found.depth
    )
    assert found.noise == pytest.approx(np.full(100, 0.2))


def test_prior_of_a_fitted_factor_bounds_the_band() -> None:
    """A prior narrows the band of predicted readings, and adds to it if it replaces the fit."""
    points = _drilling(2)[::5]
    work, rest = (Calibration(case(), part) for part in (points[:12], points[12:]))
    free = predict(work, work.fit(("open_hole",)), rest)
    priors = {"open_hole": (TRUTH["open_hole"], 1e-4)}
    known = predict(work, work.fit(("open_hole",), priors=priors), rest)
    assert known.band.max() < free.band.max()


def test_draws_are_normal_with_the_curvature_of_the_likelihood(well: Relative) -> None:
    """Of 0.5 x'Hx: x'Hx of a draw is the squared length of its standard normal numbers."""
    model = ModelError(well, FREE, FREE)
    skew = np.random.default_rng(1).uniform(-0.3, 0.3, (5, 5))
    curvature = np.diag([3.0, 4.0, 5.0, 6.0, 7.0]) + skew + skew.T
    model.best = np.arange(5.0)
    model._unlikely = lambda x: 0.5 * (x - model.best) @ curvature @ (x - model.best)  # type: ignore[method-assign]
    off = model._draws() - model.best
    normal = np.random.default_rng(0).standard_normal(off.shape)
    assert np.einsum("ni,ij,nj->n", off, curvature, off) == pytest.approx((normal**2).sum(axis=1), rel=1e-5)


def test_noise_of_readings_stands_on_the_diagonal(well: Relative) -> None:
    """Variance s^2 n of a reading with noise factor n."""
    model = ModelError(replace(well, noise=np.arange(1.0, 51.0)), FREE, FREE)
    sizes = np.log([1e-9, 1e-9, 0.03, 1e-9, 30.0])
    assert model._covariance(sizes) == pytest.approx(np.diag(0.03**2 * np.arange(1.0, 51.0)), abs=1e-12)


def test_correlation_length_of_a_step() -> None:
    """31 readings of -1 and 31 of 1: rho_k = 1 - 3k/62 is above 0.05 up to k = 19."""
    step = np.repeat([-1.0, 1.0], 31)
    assert correlation_sum(step) == pytest.approx(1 + 2 * (19 - 3 * 190 / 62), rel=1e-12)
    assert correlation_sum(np.ones(4)) == 1.0


def test_the_parameter_that_no_reading_determines_is_named() -> None:
    """Of three factors the third changes nothing but with the second, a thousandth as much as it."""
    names = ("cased", "open_hole", "weight_factor")
    work = Calibration(case(), _drilling(0)[::5])
    unit = np.array([work.parameter(name).step / UNIT_STEP for name in names])
    jacobian = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 1e-3], [0.0, 1e-9, 0.0]])
    assert work._unclear(names, jacobian / unit) == "weight_factor"
    assert work._unclear(names, np.eye(3) / unit) is None


def test_intervals_of_few_blocks_and_bands_have_the_quantiles_of_tables():
    """Student's 2.776 of five blocks over the normal 1.960, for a spread about their own mean; 90 % of a normal lie within 1.645."""
    assert small_sample(500.0, 100.0) == pytest.approx(2.776 / 1.960 * np.sqrt(5 / 4), rel=5e-4)
    assert (BAND, BAND_SIGMAS) == (0.90, pytest.approx(1.645, rel=5e-4))
