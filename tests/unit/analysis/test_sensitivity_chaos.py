"""Until when derivatives of a run are determined: planted series, and the sentence of the doubt."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc.analysis.sensitivities.doubts import Checked, Followed, Unchecked
from drillpetsc.analysis.sensitivities.motion.chaos import determined_until
from drillpetsc.case import Case
from drillpetsc.doubts import doubts_at

TIMES = np.linspace(0.0, 10.0, 2001)
SPEED = np.sin(20 * TIMES)  # its range is 2: a derivative of 20 moves it by a tenth of it for 1 %


@pytest.fixture
def case() -> Case:
    pipe = {"kind": "pipe", "length": 100.0, "od": 0.127, "id": 0.1086}
    return Case(string=[pipe], top={"kind": "top_drive"}, bottom="free")


def test_exponential_growth() -> None:
    """1e-3 e^(3t) reaches 20 at ln(2e4)/3 = 3.301 s; the oscillation of 0.16 s delays that by half a period at most."""
    until = determined_until(TIMES, SPEED, 1e-3 * np.exp(3 * TIMES) * np.cos(40 * TIMES))
    assert np.log(2e4) / 3 <= until < np.log(2e4) / 3 + 0.08


def test_growth_that_ends() -> None:
    """The motion calms down after 6 s, and the derivative stays as large as it was then."""
    slopes = 1e-3 * np.exp(3 * np.minimum(TIMES, 6.0)) * np.cos(40 * TIMES)
    assert determined_until(TIMES, SPEED, slopes) == pytest.approx(np.log(2e4) / 3, abs=0.08)


@pytest.mark.parametrize(
    "slopes",
    [
        40 * TIMES * np.cos(20 * TIMES),  # the phase of a limit cycle drifts
        4 * TIMES**2,
        400 * np.cos(20 * TIMES),
        1e-9 * np.exp(TIMES) * np.cos(40 * TIMES),  # grows, but not within the run
        np.zeros(len(TIMES)),
        400 * (1 - np.exp(-TIMES)),
    ],
)
def test_large_derivatives_without_exponential_growth(slopes) -> None:
    assert determined_until(TIMES, SPEED, slopes) == np.inf


def test_numbers_that_overflow() -> None:
    slopes = np.where(TIMES < 4.0, 1.0, np.nan)
    assert determined_until(TIMES, SPEED, slopes) == pytest.approx(4.0)


def test_sentence(case) -> None:
    (sentence,) = doubts_at(Followed(case, "bit_speed", {"top.lowering": 3.3, "gravity[2]": np.inf}))
    assert "bit_speed are not determined beyond 3.3 s by top.lowering:" in sentence
    assert doubts_at(Followed(case, "bit_speed", {"gravity[2]": np.inf})) == []


def test_a_derivative_that_is_missing_disagrees(case) -> None:
    assert len(doubts_at(Checked(case, "bit_speed.mean", "gravity[2]", np.nan, 1.0))) == 1


def test_a_check_without_the_same_steps(case) -> None:
    (sentence,) = doubts_at(Unchecked(case, ["top.lowering", "string[0].od"]))
    assert "top.lowering, string[0].od are not checked" in sentence
    assert doubts_at(Unchecked(case, [])) == []
