"""Built-in speed controllers that sample and hold their torque (manual: verif-sampled-law)."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from drillpetsc import Case, modes, run, top_drive
from drillpetsc.errors import CaseError
from drillpetsc.output import read_table
from tests.helpers import top_drive_models as m

PIPE = {"kind": "pipe", "length": 10.0, "od": 0.127, "id": 0.1086, "element_length": 5.0}
PI = {"kind": "pi", "p": 8e3, "i": 12e3}
SOFT = {"kind": "soft_torque", "damping": 20, "frequency": 0.5, "inertia_compensation": 0.5}
Z_TORQUE = {"kind": "z_torque", "p": 20, "i": 3}


def case(control: Any, **more: Any) -> Case:
    """Ten metres of pipe under a drive whose set point rises to 10 rad/s in 50 ms."""
    speed, motor = {"ramp": 0.05, "value": 10.0}, more.pop("motor", {})
    whole = {
        "string": [PIPE],
        "top": m.top(control, speed, **motor),
        "gravity": 0.0,
        "initial": {"from": "rest"},
        "time": {"end": 0.5},
        "output": {"history_every": 0.01},
    }
    return Case(**(whole | more))


def history(folder, control: Any, **more: Any) -> dict[str, np.ndarray]:
    return read_table(run(case(control, **more), folder, progress="silent").folder / "history.csv")


LIMITED = {"max_torque": 2e4, "min_torque": 0.0}


@pytest.mark.parametrize(
    ("law", "motor"), [(PI, {}), (SOFT, LIMITED), (Z_TORQUE, LIMITED)], ids=["pi", "soft_torque", "z_torque"]
)
def test_it_is_the_continuous_law_with_half_a_sample_of_delay(tmp_path, law, motor):
    """A held torque is late by half a sample on average: the difference falls with the first power of the sample."""
    differences = []
    for k, sample in enumerate((4e-3, 1e-3)):
        smooth = history(tmp_path / f"smooth{k}", law | {"delay": sample / 2}, motor=motor)
        held = history(tmp_path / f"held{k}", law | {"sample": sample}, motor=motor)
        assert np.all(held["control_mode [-]"] == smooth["control_mode [-]"])
        differences.append(np.abs(smooth["top_speed [rad/s]"] - held["top_speed [rad/s]"]).max())
    assert smooth["top_speed [rad/s]"].max() > 3.0
    assert differences[1] < 0.03 and differences[1] < 0.5 * differences[0]


@pytest.mark.parametrize(("kind", "tolerance"), [("bdf", 0.02), ("alpha2", 1e-5)])
def test_a_delay_of_whole_samples(kind, tolerance, tmp_path):
    """The motion of a rigid drive by the difference equation w' = w + h M/J with M of four samples ago.

    With BDF a jump of the torque acts late by a part of a step, since the formula of time goes on: p times 10 rad/s times 1 ms over
    the inertia is 0.02 rad/s.  With generalised-alpha the accelerations jump with the torque; what is left is the twist of the pipe."""
    h, late, end = 0.02, 4, 0.5
    petsc = {"ts_rtol": 1e-6, "ts_type": kind}
    table = history(tmp_path / "run", PI | {"sample": h, "delay": late * h}, petsc=petsc)
    inertia = m.INERTIA + 7850 * m.POLAR * 10.0
    speed, integral, queue, speeds = 0.0, 0.0, [0.0] * late, [0.0]
    for k in range(round(end / h)):
        error = 5.0 * (1 - np.cos(np.pi * min(k * h / 0.05, 1.0))) - speed
        integral += PI["i"] * error * h
        queue.append(PI["p"] * error + integral)
        speed += h * queue.pop(0) / inertia
        speeds.append(speed)
    assert table["top_speed [rad/s]"][::2] == pytest.approx(np.array(speeds), abs=tolerance)
    assert max(speeds) > 5.0


def test_generalised_alpha_keeps_order_two_and_energy(tmp_path):
    """300 m of pipe whose torque jumps at every sample: the speed of the lower end against steps of a 64th of a sample."""
    string, sample = [{**PIPE, "length": 300.0, "element_length": 100.0}], 0.02

    def speed(parts: int) -> np.ndarray:
        petsc = {"ts_type": "alpha2", "ts_adapt_type": "none", "ts_dt": sample / parts}
        made = case(PI | {"sample": sample}, string=string, petsc=petsc, output={"history_every": sample})
        done = run(made, tmp_path / str(parts), progress="silent")
        assert abs(done.summary["energy"]["error_share"]) < 20 / parts**2 * 1e-2
        return read_table(done.folder / "history.csv")["bit_speed [rad/s]"]

    fine = speed(64)
    errors = [np.sqrt(np.mean((speed(parts) - fine) ** 2)) for parts in (4, 8, 16)]
    assert np.ptp(fine) > 5.0 and errors[0] < 0.05 * np.ptp(fine)
    # against 64 instead of infinitely many: log2((1/16 - 1/256)/(1/64 - 1/256)) of 4 and 8 steps of an order-two method
    wanted = [np.log2((a**-2 - 64**-2) / ((2 * a) ** -2 - 64**-2)) for a in (4, 8)]
    assert np.log2(np.array(errors[:-1]) / errors[1:]) == pytest.approx(wanted, abs=0.15)


def test_a_change_of_the_law_without_a_jump(tmp_path):
    """From stiff to soft at 0.3 s: the torque changes by less than in any sample before."""
    laws = [{"kind": "stiff", "sample": 5e-3}, SOFT | {"from": 0.3, "sample": 5e-3}]
    table = history(tmp_path / "run", laws, output={"history_every": 0.005})
    change = np.abs(np.diff(table["motor_torque [N m]"]))
    at = int(np.argmax(table["control_mode [-]"] == 3))
    assert table["time [s]"][at] == pytest.approx(0.3, abs=0.006)
    assert change[at - 2 : at + 2].max() < 0.1 * change.max()


def test_modes_have_its_mean_delay(tmp_path):
    """Sample 40 ms and delay 40 ms: the modes of a continuous law with 60 ms."""
    tables = [
        read_table(modes(Case(**m.twisting(control)), tmp_path / name, count=4).folder / "modes.csv")
        for name, control in (
            ("sampled", m.SOFT | {"sample": 0.04, "delay": 0.04}),
            ("delayed", m.SOFT | {"delay": 0.06}),
        )
    ]
    for column in ("frequency [Hz]", "damping_ratio [-]"):
        assert tables[0][column] == pytest.approx(tables[1][column], rel=1e-9)


@pytest.mark.parametrize("control, key", [
    (PI | {"sample": 0.01, "delay": 0.015}, "top.control[0].delay"),
    ([{"kind": "stiff", "sample": 0.01}, SOFT | {"from": 1.0, "sample": 0.02}], "top.control[1].sample"),
    ([{"kind": "stiff"}, SOFT | {"from": 1.0, "sample": 0.02}], "top.control[1].sample"),
])  # fmt: skip
def test_refused(control, key):
    with pytest.raises(CaseError) as refused:
        case(control)
    assert refused.value.at == key


def test_a_coarse_sample_is_warned_of(tmp_path):
    """A tenth of the tuned period of 2 s is 0.2 s."""
    for sample, warned in ((0.25, 1), (0.15, 0)):
        found = top_drive(case(SOFT | {"sample": sample}), tmp_path / str(sample)).summary["warnings"]
        assert len([text for text in found if "a tenth of the tuned period, 2 s" in text]) == warned
