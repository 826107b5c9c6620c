"""Values that begin with a minus sign: they are values of the option before them, and answered with its name."""

from __future__ import annotations

import pytest

from drillpetsc.cli import main
from drillpetsc.cli.parser import split_words

CASE = "cases/vertical-2000m.yaml"


@pytest.mark.parametrize(
    ("words", "own", "petsc"),
    [
        (["run", "c.yaml", "--set", "x=-1"], ["run", "c.yaml", "--set", "x=-1"], []),
        (["run", "c.yaml", "--set", "-x=-1 m"], ["run", "c.yaml", "--set=-x=-1 m"], []),
        (["surge", "c.yaml", "--speeds", "-5m/s"], ["surge", "c.yaml", "--speeds=-5m/s"], []),
        (["surge", "c.yaml", "--speeds", "-.5 m/s"], ["surge", "c.yaml", "--speeds=-.5 m/s"], []),
        (["plot", "run", "--range", "-5", "10"], ["plot", "run", "--range", "-5", "10"], []),
        (
            ["run", "c.yaml", "-ts_dt", "-1e-3", "-ts_monitor"],
            ["run", "c.yaml"],
            ["-ts_dt", "-1e-3", "-ts_monitor"],
        ),
        (["run", "--overwrite", "-ts_dt", "1", "c.yaml"], ["run", "--overwrite", "c.yaml"], ["-ts_dt", "1"]),
        (["run", "--out=a", "-5kN", "c.yaml"], ["run", "--out=a", "-5kN", "c.yaml"], []),
    ],
)
def test_words_that_begin_with_a_dash(words: list[str], own: list[str], petsc: list[str]) -> None:
    assert split_words(words) == (own, petsc)


@pytest.mark.parametrize(
    ("words", "first", "given"),
    [
        (["surge", CASE, "--speeds", "-0.5 m/s"], "--speeds", "-0.5 m/s"),
        (["hydraulics", CASE, "--flow", "-30l/s"], "--flow", "-30l/s"),
        (
            ["response", CASE, "--excite", "bit", "--amplitude", "-5kN", "--speeds", "60rpm"],
            "--amplitude",
            "-5kN",
        ),
        (["statics", CASE, "--set", "initial.wob=-5 kN"], "initial.wob", "-5 kN"),
        (["statics", CASE, "--set", "-initial.wob=5 kN"], "-initial", "initial"),
    ],
)
def test_a_value_below_zero_is_answered(
    words: list[str], first: str, given: str, capsys: pytest.CaptureFixture
) -> None:
    """The name of the option or key, the value, and what is allowed; no list of options."""
    assert main(words) == 2
    said = capsys.readouterr().err
    assert f"{first}\n" in said and given in said and "allowed:" in said and "usage" not in said
