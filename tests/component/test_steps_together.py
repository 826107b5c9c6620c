"""What is computed of many recorded steps at once is what one step after the other gives."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from drillpetsc.analysis.motion.initial_state import initial_state
from drillpetsc.analysis.motion.integrator_choice import make_integrator
from drillpetsc.analysis.motion.transient import run
from drillpetsc.case import load_case
from drillpetsc.fem.step_record import StepRecord
from drillpetsc.model.drilling_model import build_model
from drillpetsc.output import recorder as recorders
from drillpetsc.output.recorder import Recorder

STEPS = 12
CASES = Path(__file__).parents[2] / "cases"
SCENES = {
    "coupled": (
        "benchmark/coupled-2000m.yaml",
        ["string[0].element_length=45 m", "string[1].element_length=33 m"],
    ),
    "contact": ("benchmark/hanging-string-contact.yaml", ["string[0].element_length=60 m"]),
    "quaternion": (
        "benchmark/coupled-2000m.yaml",
        ["beam.formulation=quaternion", "string[0].element_length=90 m", "string[1].element_length=33 m"],
    ),
    "deviated, mud": ("benchmark/deep-spin-up.yaml", ["string[0].element_length=240 m"]),
    "mud by volumes": (
        "benchmark/coupled-2000m.yaml",
        ["fluid.formulation=hermite", "string[0].element_length=45 m", "string[1].element_length=33 m"],
    ),
    "mud by volumes, quaternion": (
        "benchmark/coupled-2000m.yaml",
        [
            "fluid.formulation=hermite",
            "beam.formulation=quaternion",
            "string[0].element_length=90 m",
            "string[1].element_length=33 m",
        ],
    ),
    "motor": ("motor-slide.yaml", []),
    "jar": ("jar-stuck.yaml", []),
    "drive": ("top-drive-stick-slip.yaml", ["string[0].element_length=100 m"]),
}


@pytest.mark.parametrize("scene", SCENES)
def test_outputs_of_steps_together_are_those_of_each_step(scene: str) -> None:
    """Samples, powers and energies of every recorded step, to rounding."""
    file, changes = SCENES[scene]
    model = build_model(load_case(CASES / file, [*changes, "output.probes=[310 m, 520 m]"]))
    recorder, integrator, system = Recorder(model), make_integrator(model), model.system
    initial_state(model, model.case, None, None)
    recorder._record = StepRecord(system, 2 * STEPS)
    recorder.start(0.0)
    alone: list[np.ndarray] = []

    def after_step(t: float, dt: float) -> None:
        seen = integrator.input_time(t)
        alone.append(np.concatenate([recorder.sample(seen), system.energies(seen)]))
        recorder.step(t, dt, t + dt, seen, integrator.fresh)  # no row is due, the step is sampled
        if len(alone) == STEPS:
            integrator.stop()

    integrator.after_step.append(after_step)
    integrator.run(0.0, 10.0)
    assert len(alone) == STEPS
    together = recorder._evaluated()
    expected = np.array(alone)
    assert together.shape == expected.shape
    # a power is a sum of terms that cancel in part: relative to the largest of its kind
    scale = np.maximum(np.abs(expected).max(axis=0), 1e-12)
    powers = recorder._powers
    scale[powers] = scale[powers].max()
    scale[-3:] = scale[-3:].max()
    worst = np.max(np.abs(together - expected) / scale, axis=0)
    assert worst.max() < 1e-11, worst


def test_files_do_not_depend_on_how_many_steps_are_evaluated_together(tmp_path: Path, monkeypatch) -> None:
    """One, seven and all at once: the same bytes."""
    file, changes = SCENES["coupled"]  # with rows between the first steps
    changes = [*changes, "output.probes=[600 m, 1900 m]", "time.end=0.01 s", "output.history_every=0.02 ms"]
    case, found = load_case(CASES / file, changes), []
    for count in (1, 7, 256):
        monkeypatch.setattr(recorders, "STEPS_AT_ONCE", count)
        result = run(case, tmp_path / f"{count}", progress="silent")
        tables = [(tmp_path / f"{count}" / f"{name}.csv").read_bytes() for name in ("history", "probes")]
        found.append((*tables, result.summary["energy"], result.summary["mass"]))
    assert found[0][0].count(b"\n") == 502
    assert found[0] == found[1] == found[2]
