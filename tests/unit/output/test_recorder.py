"""Samples of a run: who owns which part, what is evaluated, what the balances make of it."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from petsc4py import PETSc

from drillpetsc import Case
from drillpetsc.analysis.statics.placement import place_along_hole
from drillpetsc.fem.component import Powers
from drillpetsc.fem.quantity import Quantity, Sample
from drillpetsc.model.drilling_model import build_model
from drillpetsc.output.balances.energy_balance import EnergyBalance
from drillpetsc.output.balances.mass_balance import MassBalance
from drillpetsc.output.recorder import Recorder
from drillpetsc.output.table_rows import SampleLayout
from tests.helpers.wells import simple_well

PIPE = {"kind": "pipe", "length": 30, "od": 0.127, "id": 0.1086, "element_length": 5.0}
JOINTS = [{"at": 10.0, "kind": "universal"}, {"at": 20.0, "kind": "universal"}]


def hanging(**more) -> Recorder:
    model = build_model(Case(**{"string": [PIPE], "top": {"kind": "top_drive", "rotation": 1.0}, **more}))
    place_along_hole(model)
    return Recorder(model)


def test_quantities_with_one_value_share_its_place() -> None:
    def position(source, sample):
        return np.zeros((2, 3))

    x, y = (
        Quantity(name, "m", on="probe", label=name, value=position, size=3, interpolate="motion", index=i)
        for i, name in enumerate("xy")
    )
    load = Quantity("load", "N", on="scalar", label="load", value=lambda source, sample: 1.0)
    layout, source = SampleLayout({"scalar": 1, "probe": 2}), object()
    slots = [layout.add(source, q) for q in (x, load, y)]
    assert slots[0] is slots[2] and layout.width == 7
    assert [slot.span for slot in slots[:2]] == [slice(0, 6), slice(6, 7)]
    assert layout.motion().tolist() == [0, 1, 2, 3, 4, 5]
    assert layout.add(object(), load).start == 7  # of another source


def test_a_result_is_evaluated_once_a_sample() -> None:
    recorder, calls = hanging(joints=JOINTS), []
    joints = next(c for c in recorder.model.components if c.name == "joints")
    report = joints.element_results
    joints.element_results = lambda state: (calls.append(state), report(state))[1]
    joints.powers = joints.energies = lambda t, state: (0.0, 0.0)  # these evaluate it for themselves
    recorder.sample(0.0)
    assert len(calls) == 1  # twelve columns


def test_columns_of_joints_are_ordered_by_depth() -> None:
    names = [name for name, _ in hanging(joints=JOINTS).columns if name.startswith("joint")]
    assert len(names) == 12 and all(name.startswith("joint_10_") for name in names[:6])
    assert names[5:7] == ["joint_10_travel", "joint_20_force"]


def test_columns_of_probes_are_ordered_by_depth() -> None:
    recorder = hanging(output={"probes": [5.0, 7.5]})
    names = [name for name, _ in recorder.probe_columns]
    assert names == ["time", "x_5", "y_5", "spin_5", "x_7.5", "y_7.5", "spin_7.5"]


def test_a_quasi_static_run_evaluates_no_energies() -> None:
    well = simple_well(40, 0.2159, 0.3, kind="casing", friction=0.2)
    recorder = hanging(well=well, time={"end": 1.0, "mode": "quasi_static"})
    assert recorder.energy is None
    recorder.system.local_powers = recorder.system.energies = None  # type: ignore[method-assign,assignment]
    recorder.start(0.0)
    recorder.step(0.1, 0.1, 0.0)
    assert "energy_error" not in [name for name, _ in recorder.columns]
    assert set(recorder.get_state()) == {"samples"}


def test_between_steps_motion_is_a_parabola_and_everything_else_a_straight_line() -> None:
    recorder = hanging()
    names = {
        name: column.start for (name, _), column in zip(recorder.columns, recorder._history, strict=True)
    }
    for t in (0.0, 1.0, 3.0):
        recorder._samples.append((t, np.full(recorder.layout.width, t**2)))
    sample = recorder.at(2.0)
    assert sample[names["bit_speed"]] == pytest.approx(4.0)
    assert sample[names["surface_torque"]] == pytest.approx(5.0)


def test_a_continued_recorder_goes_on_with_the_same_numbers() -> None:
    mud = {"density": 1200, "rheology": {"model": "newtonian", "viscosity": 0.01}, "flow_rate": 0.01}
    first, second = (hanging(fluid=mud) for _ in range(2))
    first.start(0.0)
    first.step(0.1, 0.1, 0.0)
    second.set_state(first.get_state())
    for recorder in (first, second):
        recorder.step(0.2, 0.1, 0.0)
        assert recorder.energy is not None
        recorder.energy.update(0.2)
    assert first.history_row(0.15, 0.1, 2) == second.history_row(0.15, 0.1, 2)
    assert first.mass_balance() == second.mass_balance()


# ---------------------------------------------------------------------- balances
class Oscillator:
    """Stands for a system: unit mass and spring, x = cos t, with a damper's share of the power."""

    time = 0.0
    comm = PETSc.COMM_SELF
    assembly = SimpleNamespace(imposed=None)

    def energies(self, t: float) -> tuple[float, float, float]:
        return 0.5 * np.sin(t) ** 2, 0.5 * np.cos(t) ** 2, 0.0


def test_energy_balance_of_given_powers() -> None:
    """The trapezoidal rule is exact for powers linear in time; the error is what the powers do not explain."""
    balance = EnergyBalance(Oscillator())  # type: ignore[arg-type]
    balance.start(0.0, (0.0, 1.0))
    for k in range(4):
        balance.step(0.0, 0.25, (0.5 * (k + 1), 1.0))
    assert (balance.dissipated, balance.supplied) == pytest.approx((1.0, 1.0))
    balance.update(1.0)
    assert balance.error == pytest.approx(0.0, abs=1e-15)
    assert balance.exchanged == pytest.approx(max(1.0, np.sin(1.0) ** 2))
    balance.step(0.0, 1.0, (3.0, 1.0))
    assert balance.error == pytest.approx(0.5 * (2.0 + 3.0) - 1.0)
    assert balance.summary()["error"] == balance.last_error != balance.error  # of the last update


def test_work_that_was_given_back_counts_as_exchanged() -> None:
    """2 J in, 2 J out: the scale of the error is 2 J, not the rounding of what was supplied in all."""
    balance = EnergyBalance(Oscillator())  # type: ignore[arg-type]
    balance.start(0.0, (0.0, 2.0))
    balance.step(0.0, 1.0, (0.0, 2.0))
    for power in (-2.0, -2.0):
        balance.step(0.0, 0.5, (0.0, power))
    balance.step(0.0, 0.5, (0.0, -2.0))
    assert balance.supplied == pytest.approx(0.0)
    assert balance.exchanged == pytest.approx(2.0)


def test_energy_that_a_change_of_law_releases_is_heat() -> None:
    """A latch lets go of 0.3 J of the 0.5 J that are stored: turned into heat, and the balance stays closed."""
    balance = EnergyBalance(Oscillator())  # type: ignore[arg-type]
    balance.start(0.0, (0.0, 0.0))
    balance.before_event(1.0)
    balance.system.energies = lambda t: (0.2, 0.0, 0.0)  # type: ignore[method-assign,assignment]
    balance.system.powers = lambda t: Powers()  # type: ignore[attr-defined,method-assign]
    balance.after_event(1.0)
    assert balance.dissipated == pytest.approx(0.3) and balance.error == pytest.approx(0.0)


def test_work_of_an_impulse_closes_the_balance() -> None:
    balance = EnergyBalance(Oscillator())  # type: ignore[arg-type]
    balance.start(0.0, (0.0, 0.0))
    balance.at_jump(1.0)
    balance.system.energies = lambda t: (5.0, 0.0, 0.0)  # type: ignore[method-assign,assignment]
    balance.add_impulse_work(1.1)
    assert balance.supplied == pytest.approx(4.5) and balance.error == pytest.approx(0.0)


@pytest.mark.parametrize("steps", [(0.1, 0.1, 0.1), (0.1, 0.2, 0.3)])
def test_volumes_of_steady_flow_are_exact(steps: tuple[float, ...]) -> None:
    """0.02 m3/s in, 0.015 out, 0.001 of cuttings over the steps: the content changes by the difference."""
    mass, t = MassBalance(), 0.0
    mass.start(3.0)
    for k, dt in enumerate(steps):
        mass.step(np.array([0.02, 0.015, 0.001]), dt, fresh=k == 0)
        t += dt
    mass.content = 3.0 + 0.006 * t
    found = mass.balance()
    assert [found[name] for name in ("pumped", "returned", "cuttings", "content_change")] == pytest.approx(
        [0.02 * t, 0.015 * t, 0.001 * t, 0.006 * t]
    )
    assert found["error"] == pytest.approx(0.0, abs=1e-15)


def test_a_sample_keeps_results_by_function_and_arguments() -> None:
    calls = []

    class System:
        assembly = "state"

    def work(*arguments):
        calls.append(arguments)
        return len(calls)

    sample = Sample(System(), 0.0)
    assert [sample.once(work), sample.once(work), sample.once(work, 2.0)] == [1, 1, 2]
    assert calls == [("state",), (2.0, "state")]
