"""The model inside an FMU: a session behind the interface of PythonFMU.  ``fmu`` copies this file into the FMU.

Beside it in the FMU: case.yaml, and fmu.json with the names of inputs and outputs.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element, SubElement

from pythonfmu import DefaultExperiment, Fmi2Causality, Fmi2Slave, Fmi2Variability, Real
from pythonfmu.enums import Fmi2Status

NEAR = 1e-9  # difference of two times that is rounding, as a fraction of the step


class DrillpetscModel(Fmi2Slave):
    """A case as a co-simulation unit of FMI 2.0.

    An input that the host never changes follows the case.  The model is built, and its statics are solved, at the end of the
    initialisation.
    """

    def __init__(self, **keywords: Any) -> None:
        super().__init__(**keywords)
        self._folder = Path(keywords.get("resources") or ".")
        about = json.loads((self._folder / "fmu.json").read_text(encoding="utf-8"))
        self.modelName = about["name"]
        self.description = about["description"]
        self.version = about["version"]
        self.default_experiment = DefaultExperiment(
            start_time=0.0, stop_time=about["end"], step_size=about["step"]
        )
        self._interpolate = about["interpolate"]
        self._inputs = {q["name"]: float(q["start"]) for q in about["inputs"]}
        self._set = dict(self._inputs)
        self._outputs = dict.fromkeys((q["name"] for q in about["outputs"]), 0.0)
        self._session: Any = None
        self._start = 0.0
        for q in about["inputs"]:
            self._register(q, Fmi2Causality.input, self._inputs)
        for q in about["outputs"]:
            self._register(q, Fmi2Causality.output, self._outputs)

    def _register(self, q: dict[str, Any], causality: Fmi2Causality, values: dict[str, float]) -> None:
        name = q["name"]

        def getter() -> float:
            return values[name]

        def setter(value: float) -> None:
            values[name] = float(value)

        given = {"setter": setter} if causality == Fmi2Causality.input else {}
        self.register_variable(
            Real(
                name,
                causality=causality,
                variability=Fmi2Variability.continuous,
                description=f"{q['description']} [{q['unit']}]",
                getter=getter,
                **given,
            ),
            nested=False,
        )

    def to_xml(self, *arguments: Any, **keywords: Any) -> Element:
        """The description, with the outputs among the initial unknowns, which PythonFMU leaves out."""
        root = super().to_xml(*arguments, **keywords)
        structure = root.find("ModelStructure")
        unknowns = SubElement(structure, "InitialUnknowns")
        for unknown in structure.findall("Outputs/Unknown"):
            SubElement(unknowns, "Unknown", attrib={"index": unknown.get("index")})
        return root

    def setup_experiment(self, start_time: float, stop_time: float | None, tolerance: float | None) -> None:
        self._start = start_time

    def exit_initialization_mode(self) -> None:
        from drillpetsc.analysis.motion.session.session import Session

        self._session = Session(self._folder / "case.yaml", interpolate=self._interpolate)
        self._read()

    def do_step(self, current_time: float, step_size: float) -> bool:
        session = self._session
        if abs(current_time - self._start - session.time) > NEAR * max(step_size, abs(current_time)):
            return self._refuse(
                f"a step from {current_time:g} s: the model is at {self._start + session.time:g} s; "
                "set a saved state to go back"
            )
        try:
            for name, value in self._inputs.items():
                if value != self._set[name]:
                    session.set(name, value)
                    self._set[name] = value
            session.step(step_size)
            self._read()
        except Exception as error:  # the host has no other way to hear of it
            return self._refuse(" ".join(str(error).split()))
        return True

    def _refuse(self, text: str) -> bool:
        self.log(text, Fmi2Status.error)
        return False

    def _read(self) -> None:
        for name, value in zip(self._outputs, self._session.get_many(list(self._outputs)), strict=True):
            self._outputs[name] = value

    def terminate(self) -> None:
        if self._session is not None:
            self._session.close()
            self._session = None

    def _get_fmu_state(self) -> dict[str, Any]:
        session = None if self._session is None else self._session.state()
        return {
            "session": session,
            "inputs": dict(self._inputs),
            "set": dict(self._set),
            "outputs": dict(self._outputs),
        }

    def _set_fmu_state(self, state: dict[str, Any]) -> None:
        if state["session"] is not None:
            self._session.set_state(state["session"])
        self._inputs.update(state["inputs"])
        self._set.update(state["set"])
        self._outputs.update(state["outputs"])
