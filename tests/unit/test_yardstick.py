"""The yardstick: planted good and bad answers, and quick problems through drillpetsc."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
import pytest
from numpy.polynomial import Polynomial
from numpy.polynomial.legendre import Legendre, leggauss

sys.path.insert(0, str(Path(__file__).parents[2] / "scripts" / "tools"))
import yardstick_common as common  # noqa: E402
import yardstick_score as yard  # noqa: E402

WORDS_OF_OUR_CASES = ("drillpetsc", "element_length", "od:", "yaml", "kind")


def answers(tmp_path: Path, content: dict) -> Path:
    path = tmp_path / "mine.json"
    path.write_text(json.dumps(content))
    return path


def verdicts(path: Path) -> dict[tuple[str, str], str]:
    return {(row[0], row[1]): row[3] for row in yard.rows([path])[1]}


@pytest.mark.parametrize("name", yard.ORDER)
def test_problems_are_complete_and_neutral(name: str) -> None:
    problem = yard.load(name)
    text = (problem.folder / "problem.json").read_text()
    assert not [word for word in WORDS_OF_OUR_CASES if word in text]
    for quantity, about in problem.data["expected"].items():
        assert about["source"] and about["meaning"] and about["band"], quantity
        value = problem.expected(quantity)
        assert yard.score(problem, quantity, value.tolist() if value.size > 1 else float(value[0])).inside


def test_all_problems_are_in_the_order() -> None:
    assert sorted(p.name for p in yard.PROBLEMS.iterdir()) == sorted(yard.ORDER)


def test_planted_answers(tmp_path: Path) -> None:
    read = yard.load("volve-f5").expected("hook load")
    found = verdicts(
        answers(
            tmp_path,
            {
                "mitchell": {
                    "contact force": 817.076 * 1.019,
                    "pitch": 17.9486 * 1.06,
                    "bending moment": None,
                    "seconds": 2.5,
                },
                "volve-f5": {"hook load": (read * 1.005).tolist(), "surface torque": [1.0, 2.0]},
                "fritz": {"added mass, wide": float("nan"), "added mass, narrow": "no"},
                "laboratory-rig": {"stuck share": 0.158 + 0.2},
            },
        )
    )
    assert found["mitchell", "contact force"] == "+1.9 %, in"
    assert found["mitchell", "pitch"] == "+6 %, OUT"
    assert found["mitchell", "bending moment"] == found["lubinski", "first buckling"] == "not answered"
    assert found["mitchell", "seconds"] == "2.5"
    assert found["volve-f5", "hook load"].endswith(", in")
    assert found["volve-f5", "surface torque"] == "2 values instead of 20, OUT"
    assert found["fritz", "added mass, wide"] == "not finite, OUT"
    assert found["fritz", "added mass, narrow"] == "no number, OUT"
    assert found["laboratory-rig", "stuck share"].endswith("OUT")
    assert found["all", "in the band"] == "2"


def test_lubinski_by_an_independent_integration() -> None:
    """Energy of y''^2 + (x - W) y'^2 over Legendre polynomials that meet y(0) = y(L) = y'(L) = 0, in dimensionless lengths."""
    given = yard.load("lubinski").given["buckling"]
    sizes = given["outside diameter [m]"] ** 4 - given["inside diameter [m]"] ** 4
    weight, bending = given["weight in mud [N/m]"], given["Young's modulus [Pa]"] * np.pi / 64 * sizes
    unit = (bending / weight) ** (1 / 3)
    length = given["length [m]"] / unit
    s, dose = leggauss(60)
    x = 0.5 * length * (1 + s)
    slope, curve = [], []
    for k in range(32):
        shape = Polynomial([1, 1]) * Polynomial([1, -1]) ** 2
        high = Legendre.basis(k)
        first, second = shape.deriv(), shape.deriv(2)
        slope.append(first(s) * high(s) + shape(s) * high.deriv()(s))
        curve.append(second(s) * high(s) + 2 * first(s) * high.deriv()(s) + shape(s) * high.deriv(2)(s))
    slope, curve = np.array(slope) * 2 / length, np.array(curve) * 4 / length**2
    stiffness = (curve * dose) @ curve.T + (slope * dose * x) @ slope.T
    found = np.sort(np.linalg.eigvals(np.linalg.solve((slope * dose) @ slope.T, stiffness)).real)[:2]
    assert found == pytest.approx([1.7647, 3.9313], abs=1e-4)
    expected = yard.load("lubinski").data["expected"]
    for value, quantity in zip(found, ("first buckling", "second buckling"), strict=True):
        assert expected[quantity]["value"] == pytest.approx(value * weight * unit, rel=1e-4)


def test_one_bad_reading_is_seen() -> None:
    problem = yard.load("volve-f5")
    read = problem.expected("hook load")
    read[3] *= 1.02
    assert yard.score(problem, "hook load", read.tolist()).inside is False


@pytest.mark.parametrize("content", [{"mitchel": {}}, {"mitchell": {"pitch of the helix": 1.0}}])
def test_misspelt_names_are_refused(tmp_path: Path, content: dict) -> None:
    with pytest.raises(ValueError, match="there are: lubinski|it asks for: contact force"):
        yard.rows([answers(tmp_path, content)])


def test_tables() -> None:
    head, table = ["problem", "band"], [["a", "1 %"]]
    assert yard.markdown(head, table) == "| problem | band |\n| --- | --- |\n| a | 1 % |"
    assert yard.plain(head, table) == "problem  band\na        1 %"


def test_a_failure_is_a_note() -> None:
    def fails(problem: yard.Problem) -> dict:
        raise RuntimeError("diverged")

    found = common.answer_with({"fritz": fails}, ["fritz"])["fritz"]
    assert found["note"] == "failed: RuntimeError: diverged" and "seconds" in found


@pytest.mark.parametrize("name", ["mitchell", "dawson-paslay", "fritz"])
def test_quick_problems_of_ours(name: str) -> None:
    import yardstick_drillpetsc as ours

    problem = yard.load(name)
    found = ours.SOLVERS[name](problem)
    for quantity in problem.data["expected"]:
        assert yard.score(problem, quantity, found[quantity]).inside, quantity


def test_the_adapter_follows_the_numbers() -> None:
    """Twice the weight: buckling loads grow by the square root of two (Dawson and Paslay, long pipe)."""
    import yardstick_drillpetsc as ours

    problem = yard.load("dawson-paslay")
    before = ours.SOLVERS["dawson-paslay"](problem)["buckling of a long pipe"]
    problem.data["given"]["second"]["weight in mud [N/m]"] *= 2
    after = ours.SOLVERS["dawson-paslay"](problem)["buckling of a long pipe"]
    assert after / before == pytest.approx(2**0.5, rel=5e-3)


def test_the_friction_that_adapters_share() -> None:
    """Its sum is the published torque; half of a piece's own torque twists the piece."""
    problem = yard.load("aarsnes-shor")
    stiffness, torque = common.friction_torques(problem.given, 100)
    below = np.cumsum(torque) - 0.5 * torque
    assert yard.score(problem, "break-off torque", torque.sum()).inside
    assert (below / stiffness).sum() == pytest.approx(problem.expected("break-off twist")[0], rel=1e-4)


def test_the_figures_of_the_rig() -> None:
    """A sine of 2 Hz, far below the low pass, whose lowest part counts as stuck."""
    time = np.arange(8001) * 1e-3
    speed = 10 + 9.5 * np.sin(2 * np.pi * 2 * time)
    found = common.rig_figures(time, speed)
    assert found["mean"] == pytest.approx(10, rel=1e-2)
    assert found["frequency"] == pytest.approx(2, rel=1e-3)
    assert found["peak"] == pytest.approx(19.5, rel=1e-2)
    assert found["stuck share"] == pytest.approx(np.arccos((10 - common.STUCK) / 9.5) / np.pi, abs=0.01)


def test_a_threshold_is_bracketed() -> None:
    assert common.threshold(lambda load: load > 1.7, 1.0, 3.0) == pytest.approx(1.7, rel=1e-4)
