"""A motor with a controller, its limits, filters and a change of the law: restarts bit for bit, and several ranks."""

from __future__ import annotations

from pathlib import Path

import pytest

from drillpetsc import load_case
from drillpetsc.analysis.transient import run
from drillpetsc.output import read_table
from tests.helpers.ranks import FIXED, runs_on_ranks, same_histories
from tests.parallel.test_restart import files, run_with_copies

#: the controller changes at 40 ms, the torque meets its limit before; the set point bends at 60 ms
CASE = """
well:
  survey: {md: [0 m, 60 m], inclination: [40 deg, 70 deg], azimuth: [0 deg, 10 deg]}
  sections: [{to: 60 m, kind: casing, diameter: 215.9 mm, friction: 0.2}]
string:
  - {kind: pipe, length: 30 m, od: 127 mm, id: 108.6 mm, element_length: 10 m}
  - {kind: pipe, length: 20 m, od: 171.5 mm, id: 71.4 mm, element_length: 10 m, eccentricity: 3 mm}
top:
  kind: top_drive
  rotation: {time: [0 s, 60 ms, 1 s], value: [60 rpm, 80 rpm, 80 rpm]}
  motor: {inertia: 300 kg m2, max_torque: 2 kN m, power: 30 kW, time_constant: 2 ms, torque_rate: 200 kN m/s}
  control:
    - {kind: z_torque, high_pass: 1 s}
    - {kind: soft_torque, damping: 4, frequency: 2 Hz, inertia_compensation: 0.5, delay: 4 ms, from: 40 ms}
bottom: free
time: {end: 0.1 s}
petsc: {q_snes_stol: 1.0e-10}
output: {history_every: 5 ms, field_every: 50 ms, checkpoint_every: 7 ms}
"""


@pytest.fixture(scope="module")
def case(tmp_path_factory) -> Path:
    path: Path = tmp_path_factory.mktemp("case") / "case.yaml"
    path.write_text(CASE)
    return path


def test_restarts_reproduce_the_run(case, tmp_path, monkeypatch):
    copies = run_with_copies(case, tmp_path / "run", monkeypatch)
    whole = files(tmp_path / "run")
    for copy in copies[:: max(1, len(copies) // 6)]:
        run(load_case(case), copy, restart=True, progress="silent")
        assert files(copy) == whole


@pytest.mark.parametrize("how", ["restart", "initial.from"])
def test_a_controller_that_the_run_before_did_not_have(tmp_path, how):
    """Steady rotation under `stiff`, then under `z_torque`: its filter of the torque begins at the torque, not at zero.

    From zero the set point falls by factor/zeta times the torque at once, and the motor brakes with 14 times the torque
    that turns the string.  The pipe takes 9 N m less than the motor gives when it changes (the string is not quite steady),
    which z_torque answers with p factor/zeta = 12.5 times as much, 18 % of the torque.
    """
    text = CASE.replace("60 ms, 1 s], value: [60 rpm, 80 rpm, 80 rpm]", "1 s], value: [60 rpm, 60 rpm]")
    head, tail = text.split("  motor:")
    motor = "  motor: {inertia: 300 kg m2, max_torque: 60 kN m}\n"
    rest = tail[tail.index("bottom:") :].replace("end: 0.1 s", "end: {end}")
    rest += "initial: {initial}\n"

    def case(control: str, end: str, initial: str) -> str:
        return (
            head
            + motor
            + f"  control: {{kind: {control}}}\n"
            + rest.replace("{end}", end).replace("{initial}", initial)
        )

    first = tmp_path / "first"
    (tmp_path / "a.yaml").write_text(case("stiff", "50 ms", "{from: statics}"))
    run(load_case(tmp_path / "a.yaml"), first, progress="silent")
    steady = read_table(first / "history.csv")["motor_torque [N m]"]
    start = "{from: statics}" if how == "restart" else f"{{from: {first}}}"
    (tmp_path / "b.yaml").write_text(case("z_torque", "0.1 s", start))
    if how == "restart":
        run(load_case(tmp_path / "b.yaml"), first, restart=True, accept_changes=True, progress="silent")
        found = read_table(first / "history.csv")["motor_torque [N m]"][len(steady) :]
    else:
        run(load_case(tmp_path / "b.yaml"), tmp_path / "second", progress="silent")
        found = read_table(tmp_path / "second" / "history.csv")["motor_torque [N m]"][1:]
    assert found == pytest.approx(steady[-1], rel=0.25)


@pytest.mark.parallel
def test_ranks_agree(case, tmp_path):
    """Fixed steps on two and three ranks, against one."""
    one = same_histories(runs_on_ranks(case, tmp_path, FIXED))
    assert 0 < one["torque_limited [-]"].sum() < len(one["time [s]"])
    assert set(one["control_mode [-]"]) == {4.0, 3.0}
