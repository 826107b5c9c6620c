"""A controller that begins after a restart, or from the state of another run."""

from __future__ import annotations

import pytest

from drillpetsc import load_case
from drillpetsc.analysis.motion.transient import run
from drillpetsc.output import read_table
from tests.parallel.rows.machines import TOP_DRIVE


@pytest.mark.parametrize("how", ["restart", "initial.from"])
def test_a_controller_that_the_run_before_did_not_have(tmp_path, how):
    """Steady rotation under `stiff`, then under `z_torque`: its filter of the torque begins at the torque, not at zero.

    From zero the set point falls by factor/zeta times the torque at once, and the motor brakes with 14 times the torque
    that turns the string.  The pipe takes 9 N m less than the motor gives when it changes (the string is not quite steady),
    which z_torque answers with p factor/zeta = 12.5 times as much, 18 % of the torque.
    """
    text = TOP_DRIVE.replace("60 ms, 1 s], value: [60 rpm, 80 rpm, 80 rpm]", "1 s], value: [60 rpm, 60 rpm]")
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
