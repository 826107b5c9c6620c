"""Pictures of long runs: fewer points, the same picture."""

import numpy as np

from drillpetsc.plotting.thinning import CELLS, INTERVALS, envelope, last_passages


def test_envelope_keeps_every_peak_and_short_lines_whole():
    rng = np.random.default_rng(1)
    n = 25 * INTERVALS + 7
    time, values = np.arange(n) * 0.01, rng.standard_normal(n)
    values[[12_345, n - 3]], values[777] = [50.0, 60.0], -50.0
    values[40:60] = np.nan
    at, kept = envelope(time, values)
    assert len(at) < 2.1 * INTERVALS
    assert {50.0, 60.0, -50.0} <= set(kept)
    assert (np.diff(at) > 0).all() and at[0] == time[0] and at[-1] == time[-1]
    # of every interval the line reaches as high and as low as that of all points
    for part in (slice(0, 25), slice(25 * 100, 25 * 101)):
        inside = (at >= time[part][0]) & (at <= time[part][-1])
        assert np.nanmax(kept[inside]) == np.nanmax(values[part])
        assert np.nanmin(kept[inside]) == np.nanmin(values[part])
    for whole, same in zip(envelope(time[:100], values[:100]), (time[:100], values[:100]), strict=True):
        np.testing.assert_array_equal(whole, same)


def test_an_orbit_keeps_the_last_passage_through_every_cell():
    rng = np.random.default_rng(2)
    angle = np.cumsum(rng.uniform(0.0, 0.1, 200_000))
    points = 0.9 * np.column_stack((np.cos(angle), np.sin(angle)))
    points[1000] = 0.0  # an excursion
    kept = last_passages(points, 1.0)
    cells = np.floor((points[:-1] + 1.0) * (CELLS / 2)).astype(int)
    assert {tuple(c) for c in cells[kept]} == {tuple(c) for c in cells}
    assert len(kept) == len({tuple(c) for c in cells}) < 5000
    assert (np.diff(kept) > 0).all() and kept[-1] == len(points) - 2
    assert 1000 in kept
    np.testing.assert_array_equal(last_passages(points[:50], 1.0), np.arange(49))
