"""The Python functions that are made from the classes of the commands, and what all classes have in common."""

from __future__ import annotations

import inspect
from typing import Any

import pytest

import drillpetsc
from drillpetsc.errors import CaseError
from drillpetsc.operations import OPERATIONS
from drillpetsc.operations.operation import Mark

PIPE = {"kind": "pipe", "length": 30.0, "od": 0.127, "id": 0.1086}
#: what users wrote before there was a class, beside `case`, `out`, `overwrite`, `name` and `comm`
KEYWORDS = {
    "statics": "bit_depth motion operation path",
    "hydraulics": "bit_depth flow spp units",
    "surge": "speeds operation pipe bit_depth window flow dynamic units",
    "roadmap": "measured model units block",
    "calibrate": "measured log every fit hold_out errors prior units model",
    "limits": "bit_depth operation helical design_factor tension_fraction corrosive sn units",
    "modes": "count shift kind about without_control",
    "campbell": "speeds count kind lines without_control frequency stiffness",
    "stability": "speeds wob count kind without_control method duration",
    "response": "excite speeds amplitude order stress without_control",
    "linearise": "inputs outputs reduce order",
    "top_drive": "",
}


@pytest.mark.parametrize("name", KEYWORDS)
def test_a_function_keeps_its_keywords(name: str) -> None:
    function = getattr(drillpetsc, name)
    parameters = inspect.signature(function).parameters
    expected = {"case", "out", "overwrite", "name", "comm", "units", *KEYWORDS[name].split()}
    assert set(parameters) == expected and function.__name__ == name
    documented = [line.partition(":")[0] for line in inspect.getdoc(function).splitlines()]
    assert expected <= set(documented)
    positional = [q for q, p in parameters.items() if p.kind is p.POSITIONAL_OR_KEYWORD]
    assert positional == (["case", "inputs", "outputs", "out"] if name == "linearise" else ["case", "out"])


def test_an_old_keyword_is_answered_with_the_new_one() -> None:
    case = drillpetsc.Case(string=[PIPE], top="clamped")
    with pytest.raises(TypeError, match="surge: speed is now called speeds"):
        drillpetsc.surge(case, speed="1 m/s")
    with pytest.raises(TypeError, match="stability: rpm is now called speeds"):
        drillpetsc.stability(case, rpm="60 rpm", wob="1 kN")
    with pytest.raises(TypeError, match="missing a required .*argument: 'speeds'"):
        drillpetsc.campbell(case)
    with pytest.raises(TypeError, match="unexpected keyword argument 'kin'"):
        drillpetsc.modes(case, kin="axial")


@pytest.mark.parametrize(
    ("name", "options", "at", "want"),
    [
        ("modes", {"kind": "sideways"}, "--kind", "lateral or axial or torsional or fluid"),
        ("modes", {"count": 0}, "--count", "a number of modes, at least 1"),
        ("statics", {"motion": "sideways"}, "--motion", "hoist or lower or rotate"),
        ("limits", {"design_factor": 11}, "--design-factor", "a number from 1 to 10"),
        (
            "linearise",
            {"inputs": ["x"], "outputs": ["y"], "order": 3},
            "--order",
            "only together with --reduce",
        ),
        ("fmu", {"out": "case.zip"}, "--out", "a file name that ends with .fmu"),
    ],
)
def test_python_gets_the_refusals_of_the_command(
    name: str, options: dict[str, Any], at: str, want: str
) -> None:
    with pytest.raises(CaseError) as refused:
        getattr(drillpetsc, name)(drillpetsc.Case(string=[PIPE], top="clamped"), **options)
    assert refused.value.at == at and want in refused.value.want


def test_every_field_has_a_help_and_every_default_is_allowed() -> None:
    found = []
    for operation in OPERATIONS:
        for option in operation.options():
            if not option.help or (Mark.ARGUMENT in option.marks and not option.metavar):
                found.append((operation.command(), option.name))
            if option.choices and option.default is not None and option.default not in option.choices:
                found.append((operation.command(), option.name))
            if not option.required and option.readers and not isinstance(option.default, int | float):
                option.read(option.default, "SI")
    assert found == []
