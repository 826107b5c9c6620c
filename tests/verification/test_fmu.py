"""A case as an FMU gives what a session gives (manual: sec-fmu)."""

from __future__ import annotations

import builtins
import json
import zipfile

import numpy as np
import pytest

import drillpetsc
from drillpetsc import Case
from drillpetsc.errors import CaseError
from tests.helpers import top_drive_models as m

PIPE = {"kind": "pipe", "length": 10.0, "od": 0.127, "id": 0.1086, "element_length": 5.0}
CASE = {
    "title": "pipe under a drive",
    "string": [PIPE],
    "top": m.top("stiff", 5.0, max_torque=20e3),
    "gravity": 0.0,
    "initial": {"from": "rest"},
    "time": {"end": 1.0},
}
OUTPUTS = ["top_speed", "motor_torque", "bit_speed", "torque_limited"]


def test_without_pythonfmu_the_extra_is_named(tmp_path, monkeypatch):
    real = builtins.__import__

    def without(name, *more, **keywords):
        if name.split(".")[0] == "pythonfmu":
            raise ImportError(name)
        return real(name, *more, **keywords)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(CaseError, match=r"drillpetsc\[fmu\]"):
        drillpetsc.fmu(Case(**CASE), tmp_path / "well.fmu")
    assert not list(tmp_path.iterdir())


@pytest.fixture
def unit(tmp_path):
    """Path of the FMU with its chosen inputs and outputs."""
    pytest.importorskip("pythonfmu", reason="PythonFMU writes the FMU (extra fmu)")
    return drillpetsc.fmu(
        Case(**CASE), tmp_path / "well.fmu", inputs=["top.rotation"], outputs=OUTPUTS, name="my well"
    )


def test_the_file_holds_case_and_flags(unit, tmp_path):
    with zipfile.ZipFile(unit) as z:
        xml = z.read("modelDescription.xml").decode()
        assert json.loads(z.read("resources/fmu.json"))["inputs"][0]["start"] == 5.0
        assert b"pipe under a drive" in z.read("resources/case.yaml")
    for words in (
        'needsExecutionTool="true"',
        'canGetAndSetFMUstate="true"',
        'modelIdentifier="my_well"',
        "rad/s",
    ):
        assert words in xml
    case = Case(**CASE)
    for keywords, words in [
        ({"inputs": ["top.rotatoin"]}, "nearest: top.rotation"),
        ({"outputs": []}, "at least one of"),
        ({"outputs": ["bit_sped"]}, "nearest: bit_speed"),
    ]:
        with pytest.raises(CaseError, match=words):
            drillpetsc.fmu(case, tmp_path / "other.fmu", **keywords)
    with pytest.raises(CaseError, match="overwrite"):
        drillpetsc.fmu(case, unit)
    with pytest.raises(CaseError, match="ends with .fmu"):
        drillpetsc.fmu(case, tmp_path / "well.zip")
    everything = drillpetsc.fmu(case, unit, overwrite=True)
    with zipfile.ZipFile(everything) as z:
        assert len(json.loads(z.read("resources/fmu.json"))["outputs"]) > len(OUTPUTS)


def speed(t: float) -> float:
    """Set point over time: three levels."""
    return 5.0 if t < 0.2 else 5.1 if t < 0.5 else 12.0


def test_fmpy_gets_the_numbers_of_a_session(unit):
    """C31: simulate_fmu against the same calls of a session, 1e-9; the description is valid."""
    fmpy = pytest.importorskip("fmpy", reason="FMPy runs the FMU")
    from fmpy.validation import validate_fmu

    assert validate_fmu(str(unit)) == []
    step, n = 0.02, 40
    times = np.arange(n + 1) * step
    signals = np.array([(t, speed(t)) for t in times], dtype=[("time", float), ("top.rotation", float)])
    found = fmpy.simulate_fmu(
        str(unit), stop_time=n * step, step_size=step, output_interval=step, input=signals, output=OUTPUTS
    )
    rows = []
    with drillpetsc.Session(Case(**CASE)) as s:
        rows.append(s.get_many(OUTPUTS))
        present = 5.0
        for t in times[:-1]:
            if speed(t) != present:
                present = speed(t)
                s.set("top.rotation", present)
            s.step(step)
            rows.append(s.get_many(OUTPUTS))
    expected = np.array(rows)
    got = np.column_stack([found[name] for name in OUTPUTS])
    assert found["time"] == pytest.approx(times, abs=1e-12)
    size = np.abs(expected).max(axis=0)
    assert np.all(np.abs(got - expected) <= 1e-9 * np.maximum(size, 1.0))
    assert expected[-1, 0] > 6 and expected[:, 3].max() > 0.9  # the drive went to its limit


def test_a_saved_state_replays_in_the_fmu(unit):
    """fmi2GetFMUstate and fmi2SetFMUstate: the same steps again give the same bits; a step from elsewhere is refused."""
    fmpy = pytest.importorskip("fmpy", reason="FMPy runs the FMU")
    from fmpy.fmi1 import FMICallException
    from fmpy.fmi2 import FMU2Slave

    description = fmpy.read_model_description(str(unit))
    folder = fmpy.extract(str(unit))
    at = {v.name: v.valueReference for v in description.modelVariables}
    fmu = FMU2Slave(
        guid=description.guid,
        unzipDirectory=folder,
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName="one",
    )
    fmu.instantiate()
    fmu.setupExperiment(startTime=0.0)
    fmu.enterInitializationMode()
    fmu.exitInitializationMode()
    fmu.doStep(0.0, 0.1)
    state, found = fmu.getFMUState(), []
    for _ in range(2):
        fmu.setFMUState(state)
        fmu.setReal([at["top.rotation"]], [7.0])
        fmu.doStep(0.1, 0.1)
        found.append(fmu.getReal([at[name] for name in OUTPUTS]))
    assert found[0] == found[1] and found[0][0] > 0
    with pytest.raises(FMICallException):
        fmu.doStep(0.7, 0.1)
    fmu.freeFMUState(state)
    fmu.terminate()
    fmu.freeInstance()
