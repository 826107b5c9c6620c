"""The `fmu` command: a case as a co-simulation unit of FMI 2.0, for Simulink, OpenModelica, FMPy and others.

Manual: sec-fmu.
"""

from __future__ import annotations

import json
import re
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from petsc4py import PETSc

from drillpetsc.analysis.linear.linearise import refuse_unknown
from drillpetsc.analysis.motion.run_options import options_of
from drillpetsc.analysis.motion.session.live_outputs import LiveOutputs
from drillpetsc.case.case import Case
from drillpetsc.case.options.case_inputs import describe, inputs_of
from drillpetsc.errors import CaseError
from drillpetsc.model.drilling_model import build_model, is_quasi_static
from drillpetsc.output.recorder import Recorder
from drillpetsc.version import __version__

INSTALL = "pip install 'drillpetsc[fmu]'"
SLAVE = "drillpetsc_fmu"  # name of the script in the FMU
DEFAULT_STEP = 0.01  # communication step that is proposed to the host [s]


def build_fmu(
    case: Case,
    out: str | Path,
    inputs: Sequence[str] | None = None,
    outputs: Sequence[str] | None = None,
    overwrite: bool = False,
    interpolate: str = "held",
    name: str = "case",
) -> Path:
    """Write a case as an FMU; returns its path.

    case: the user's case, which goes into the file with all its data.
    out: path of the file, ending with ``.fmu``; overwrite: replace an existing one.
    inputs, outputs: names as of a session; None: all.
    interpolate: as of a session; name: of the model.

    Raises CaseError for wrong arguments, on several ranks, and where PythonFMU is not installed.
    """
    if PETSc.COMM_WORLD.size > 1:
        raise CaseError(
            at="fmu", got=f"{PETSc.COMM_WORLD.size} ranks", want="one rank: an FMU is written, and runs, in one process"
        )  # fmt: skip
    try:
        from pythonfmu import FmuBuilder
    except ImportError:
        raise CaseError(at="fmu", want="the package pythonfmu", hint=INSTALL) from None
    path = Path(out)
    if path.exists() and not overwrite:
        raise CaseError(at="--out", got=str(path), want="a new file", hint="--overwrite replaces it")
    if case.time is not None and is_quasi_static(case):
        raise CaseError(at="time.mode", got="quasi_static", want="dynamic in an FMU")
    if case.initial.from_ not in ("statics", "rest", "straight"):
        raise CaseError(
            at="initial.from",
            got=case.initial.from_,
            want="statics, rest or straight: a run folder is not in the FMU",
        )
    about = _described(case, inputs, outputs) | {
        "name": re.sub(r"\W", "_", name) if name[:1].isalpha() else "well_" + re.sub(r"\W", "_", name),
        "description": case.title or name,
        "version": __version__,
        "interpolate": interpolate,
        "end": 1.0 if case.time is None else case.time.end,
        "step": DEFAULT_STEP,
    }
    before = list(sys.path)
    with tempfile.TemporaryDirectory(prefix="drillpetsc_fmu_") as folder:
        script = Path(folder) / f"{SLAVE}.py"
        script.write_text(
            (Path(__file__).parent / "fmu_slave.py").read_text(encoding="utf-8"), encoding="utf-8"
        )
        files = [Path(folder) / "case.yaml", Path(folder) / "fmu.json"]
        case.dump(files[0])
        files[1].write_text(json.dumps(about, indent=1), encoding="utf-8")
        path.parent.mkdir(parents=True, exist_ok=True)
        new = Path(folder) / "new.fmu"
        try:
            FmuBuilder.build_FMU(
                script, new, files, needsExecutionTool=True, canHandleVariableCommunicationStepSize=True,
                canGetAndSetFMUstate=True,
            )  # fmt: skip
        finally:
            sys.path[:] = before
            sys.modules.pop(SLAVE, None)
        path.write_bytes(new.read_bytes())
    return path


def _described(case: Case, inputs: Sequence[str] | None, outputs: Sequence[str] | None) -> dict[str, Any]:
    """Names, units, descriptions and starts of inputs and outputs."""
    given = inputs_of(case)
    with options_of(case):
        live = LiveOutputs(Recorder(build_model(case, PETSc.COMM_SELF)))
    known = {q.name: q for q in live.described()}
    chosen = list(given) if inputs is None else list(inputs)
    shown = list(known) if outputs is None else list(outputs)
    if inputs is not None:
        refuse_unknown("--inputs", chosen, list(given))
    refuse_unknown("--outputs", shown, list(known))
    about = [describe(case, key) for key in chosen]
    return {
        "inputs": [
            {"name": q.name, "unit": q.unit, "description": q.description, "start": given[q.name].value(0.0)}
            for q in about
        ],
        "outputs": [
            {"name": key, "unit": known[key].unit, "description": known[key].description} for key in shown
        ],
    }
