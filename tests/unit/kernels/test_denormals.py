"""Denormal numbers are zero while a run computes, and numbers again outside it."""

import numpy as np
import pytest

from drillpetsc.kernels.denormals import flushed_denormals
from tests.helpers.motion import integrate, straight

TINY = 1e-310
NAMES = ("bdf", "alpha2")


def are_flushed() -> bool:
    """Whether products of denormal numbers are zero in this thread, by the library's and by numpy's arithmetic."""
    by_array = float((np.array([TINY]) * np.array([1.0]))[0])
    assert (by_array == 0.0) == (TINY * 0.5 == 0.0)
    return by_array == 0.0


def test_only_within_the_block():
    assert not are_flushed()
    with flushed_denormals():
        assert are_flushed()
        with flushed_denormals():
            assert are_flushed()
        assert are_flushed()
    assert not are_flushed()


def test_restored_after_an_exception():
    with pytest.raises(RuntimeError), flushed_denormals():
        raise RuntimeError
    assert not are_flushed()


def test_normal_numbers_keep_their_bits():
    numbers = np.array([1.0, -0.0, 2.3e-308, 1e300, np.inf])
    with flushed_denormals():
        assert (numbers * 1.0).tobytes() == numbers.tobytes()


@pytest.mark.parametrize("name", NAMES)
def test_while_a_run_computes(name):
    model = straight(
        string=[{"kind": "pipe", "length": 100.0, "od": 0.127, "id": 0.1086, "element_length": 10.0}],
        top={"kind": "top_drive", "rotation": {"ramp": 1.0, "value": 10.0}},
        contact="none",
        time={"end": 0.01},
    )
    seen: list[bool] = []
    integrate(model.system, 0.01, {"ts_type": name}, lambda t, dt: seen.append(are_flushed()))
    assert seen
    assert all(seen)
    assert not are_flushed()
