"""Loads as inputs of a session (manual: sec-session)."""

from __future__ import annotations

import pytest

from drillpetsc import Session
from drillpetsc.case.case import Case

CASE = {
    "string": [{"kind": "pipe", "length": 10.0, "od": 0.127, "id": 0.1086, "element_length": 5.0}],
    "top": "free",
    "gravity": 0.0,
    "initial": {"from": "rest", "inclination": 0.0},
    "loads": [{"at": 10.0, "force": [0.0, 0.0, 1e3], "value_over": 0.0}],
    "time": {"end": 1.0},
}


def test_a_load_that_a_session_sets_pushes_a_free_pipe():
    """x = F t^2/2m + F t t'/m of a free pipe that is pushed for t = 0.2 s, and then goes on for t' = 0.2 s."""
    with Session(Case(**CASE)) as s:
        (load,) = (q for q in s.inputs if q.name.startswith("loads"))
        assert load.name == "loads[0].value_over" and load.unit == ""
        s.step(0.1)
        s.set("loads[0].value_over", 2.0)
        s.step(0.2)
        state = s.state()
        s.set("loads[0].value_over", 0.0)
        s.step(0.2)
        first = s.get("bit_depth")
        s.set_state(state)
        s.set("loads[0].value_over", 0.0)
        s.step(0.2)
        assert s.get("bit_depth") == first
    mass = 7850 * 3.141592653589793 / 4 * (0.127**2 - 0.1086**2) * 10.0
    # the waves of the pipe, 4 ms, leave micrometres
    assert first - 10.0 == pytest.approx(2e3 / mass * (0.5 * 0.2**2 + 0.2 * 0.2), rel=1e-3)
