"""Samples of uncertain numbers and their statistics against closed forms."""

from __future__ import annotations

from statistics import NormalDist

import numpy as np
import pytest

from drillpetsc.analysis.uncertain.draws import correlation_of, draw
from drillpetsc.analysis.uncertain.spread import spreads_of
from drillpetsc.case.blocks.uncertain import Spread

LEVELS = (0.1, 0.5, 0.9)
SPREADS = [
    Spread(normal=(2.0, 0.3)),
    Spread(normal=(-1.0, 0.4), correlated={"a": 0.6}),
    Spread(uniform=(5.0, 7.0)),
]
NAMES = ["a", "b", "c"]


def drawn(samples, seed=1, spreads=SPREADS):
    """Samples of the spreads."""
    return draw(spreads, correlation_of(NAMES, spreads), samples, seed)


def test_each_number_lies_once_in_each_interval():
    """Of equal probability, however the numbers are correlated."""
    draws = drawn(200)
    shares = np.stack(
        [
            [NormalDist(2.0, 0.3).cdf(q) for q in draws[:, 0]],
            [NormalDist(-1.0, 0.4).cdf(q) for q in draws[:, 1]],
            (draws[:, 2] - 5.0) / 2.0,
        ]
    )
    for share in shares:
        assert sorted(np.floor(share * 200).astype(int)) == list(range(200))


def test_each_form_lies_once_in_each_interval():
    """Lognormal and triangular numbers by their closed distribution functions; mean and deviation of the lognormal are those given."""
    mean, deviation, (low, mode, high) = 0.25, 0.1, (0.1, 0.2, 0.45)
    draws = draw(
        [Spread(lognormal=(mean, deviation)), Spread(triangular=(low, mode, high))], np.eye(2), 2000, 3
    )
    width = np.sqrt(np.log1p((deviation / mean) ** 2))
    normal = NormalDist(np.log(mean) - 0.5 * width**2, width)
    x = draws[:, 1]
    rise = (x - low) ** 2 / ((high - low) * (mode - low))
    fall = 1 - (high - x) ** 2 / ((high - low) * (high - mode))
    shares = [normal.cdf(q) for q in np.log(draws[:, 0])], np.where(x < mode, rise, fall)
    for share in shares:
        assert sorted(np.floor(np.asarray(share) * 2000).astype(int)) == list(range(2000))
    assert draws[:, 0].mean() == pytest.approx(mean, rel=2e-3)
    assert draws[:, 0].std() == pytest.approx(deviation, rel=2e-2)
    assert x.mean() == pytest.approx((low + mode + high) / 3, rel=1e-3)


def test_same_seed_same_numbers():
    """Another seed gives others."""
    assert np.array_equal(drawn(50), drawn(50))
    assert not np.array_equal(drawn(50), drawn(50, seed=2))


@pytest.mark.parametrize("seed", (1, 2, 3))
def test_correlation(seed):
    """Of the samples: 0.6 between a and b, none elsewhere; the ordering leaves less than 0.03 at 500 samples."""
    found = np.corrcoef(drawn(500, seed), rowvar=False)
    assert found[0, 1] == pytest.approx(0.6, abs=0.03)
    assert np.abs(found[2, :2]).max() < 0.03


@pytest.mark.parametrize("seed", (1, 2, 3, 4, 5))
def test_sum_of_correlated_normals(seed):
    """3 a + 2 b is normal: mean 4, variance 0.81 + 0.64 + 2 * 0.6 * 0.9 * 0.8; quantiles within three standard errors of simple sampling."""
    n, exact = 500, NormalDist(4.0, np.sqrt(0.81 + 0.64 + 2 * 0.6 * 0.9 * 0.8))
    draws = drawn(n, seed)
    found = spreads_of("monte-carlo", draws, draws @ np.array([[3.0], [2.0], [0.0]]), LEVELS)
    assert found.mean[0] == pytest.approx(4.0, abs=3 * exact.stdev / np.sqrt(n))
    assert found.deviation[0] == pytest.approx(exact.stdev, rel=3 / np.sqrt(2 * n))
    for level, quantile in zip(LEVELS, found.quantiles[0], strict=True):
        wanted = exact.inv_cdf(level)
        assert quantile == pytest.approx(wanted, abs=3 * np.sqrt(level * (1 - level) / n) / exact.pdf(wanted))


def test_shares_of_independent_numbers():
    """Of 3 a + 4 b with equal deviations: 9/25 and 16/25; by least squares as by given slopes."""
    spreads = [Spread(normal=(0.0, 1.0)), Spread(normal=(5.0, 1.0)), Spread(uniform=(0.0, 1.0))]
    draws = drawn(2000, spreads=spreads)
    slopes = np.array([[3.0, 4.0, 0.0]])
    for given in (None, slopes):
        found = spreads_of("linear", draws, draws @ slopes.T, LEVELS, given)
        assert found.shares[0] == pytest.approx([0.36, 0.64, 0.0], abs=0.02)
        assert found.shares[0].sum() == pytest.approx(1.0, abs=1e-12)


def test_failed_samples_are_counted():
    """And the others give the statistics; an output that never varies has no shares."""
    draws = drawn(100)
    values = np.stack([draws[:, 0], np.full(100, 3.0)], axis=1)
    values[:7, 0] = np.nan
    found = spreads_of("monte-carlo", draws, values, LEVELS)
    assert found.failed.tolist() == [7, 0]
    assert found.mean[0] == pytest.approx(draws[7:, 0].mean())
    assert np.isnan(found.shares[1]).all()


def test_impossible_correlations():
    """A pair that contradicts itself, and three that cannot hold together."""
    pair = [Spread(normal=(0, 1), correlated={"b": 0.5}), Spread(normal=(0, 1), correlated={"a": 0.4})]
    with pytest.raises(ValueError, match=r"0\.5 and 0\.4"):
        correlation_of(["a", "b"], pair)
    three = [
        Spread(normal=(0, 1), correlated={"b": 0.9, "c": 0.9}),
        Spread(normal=(0, 1), correlated={"c": -0.9}),
        Spread(normal=(0, 1)),
    ]
    with pytest.raises(ValueError, match="hold together"):
        correlation_of(NAMES, three)
