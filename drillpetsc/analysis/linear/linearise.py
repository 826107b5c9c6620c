"""The `linearise` command: a model about its steady state as matrices, in full and with fewer states (manual: sec-linear)."""

from __future__ import annotations

import difflib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from drillpetsc.analysis.linear.doubts import Linear, Reduction
from drillpetsc.analysis.linear.linear_model import (
    USUAL,
    DisturbedInput,
    LinearModel,
    kind_of,
    linear_model,
    steady_state,
)
from drillpetsc.analysis.linear.linearised_model import mean_over_turn
from drillpetsc.analysis.linear.modal import (
    ZERO_FRACTION,
    reference_rate,
    unbalanced_force,
)
from drillpetsc.analysis.motion.run_options import options_of
from drillpetsc.analysis.motion.session.live_outputs import LiveOutputs
from drillpetsc.analysis.statics.placement import motion_text, prescribed_motion
from drillpetsc.arrays import FloatArray
from drillpetsc.case.case import Case
from drillpetsc.case.checks.limits import refuse_quaternion
from drillpetsc.case.options.case_inputs import describe, inputs_of, with_inputs
from drillpetsc.doubts import doubts_at
from drillpetsc.errors import CaseError
from drillpetsc.model.drilling_model import DrillingModel, build_model, is_quasi_static
from drillpetsc.model.top import continuous_control
from drillpetsc.output import RunFolder, write_summary
from drillpetsc.output.files.atomic import replace_file
from drillpetsc.output.job import Job
from drillpetsc.output.recorder import Recorder
from drillpetsc.parallel import first_rank_gives
from drillpetsc.solvers.linear.model_reduction import Reduced, not_decaying, reduce
from drillpetsc.solvers.linear.state_space import StateSpace

FREQUENCIES = 500  # at which a reduced model is compared with the whole one
ROUNDING = 1e-6  # part of an output that follows the rate of an input is rounding below this fraction of the response
PRINTED = 8  # Hankel values on the screen
NPZ, MAT = "linear.npz", "linear.mat"


@dataclass(frozen=True)
class LinearResult:
    """Result of ``linearise``, the same on all ranks.

    system: the whole model; reduced: the model with fewer states, None if it was not requested.
    inputs, outputs: names.
    folder, summary, lines: run folder, summary.json and the lines to show.
    """

    system: StateSpace
    reduced: Reduced | None
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    folder: Path
    summary: dict[str, Any]
    lines: list[str]

    def to_control(self, reduced: bool = False) -> Any:
        """The model as ``control.StateSpace`` of python-control, which has to be installed.

        Raises ImportError without it, and ValueError if an output follows the rate of an input.
        """
        try:
            import control
        except ImportError:
            raise ImportError("to_control needs python-control: pip install control") from None
        q = self.reduced.system if reduced and self.reduced is not None else self.system
        if q.F.any():
            raise ValueError(
                "an output depends on the rate of an input (F), which python-control does not support"
            )
        return control.ss(q.A, q.B, q.C, q.D, inputs=list(self.inputs), outputs=list(self.outputs))


def run_linearise(
    job: Job,
    inputs: Sequence[str],
    outputs: Sequence[str],
    method: str | None = None,
    order: int = 20,
) -> LinearResult:
    """Linearise a case about its steady state; collective.

    inputs: names as of ``Session.inputs``; outputs: columns of history.csv.
    method: ``balanced`` or ``modal`` reduction to ``order`` states; None: none.

    Raises CaseError for wrong arguments, SolveError if no equilibrium is found or no state space exists.
    """
    case, comm = job.case, job.comm
    refuse_quaternion(case, "linearise")
    case = continuous_control(case)
    if case.time is not None and is_quasi_static(case):
        raise CaseError(
            at="time.mode", got="quasi_static", want="dynamic: without inertia there is no linear model"
        )
    given = inputs_of(case)
    if case.top.autodriller is not None:  # which acts in a linear model from the start
        given.pop("top.lowering", None)
    refuse_unknown("--inputs", inputs, list(given))
    with options_of(case):
        disturbed = {key: DisturbedInput(given[key]) for key in inputs}
        model = build_model(with_inputs(mean_over_turn(case), disturbed), comm)
        model.case = case
        live = LiveOutputs(Recorder(model))
        units = {q.name: q.unit for q in live.described()}
        refuse_unknown("--outputs", outputs, list(units))
        folder = job.make_folder()
        state = steady_state(model)
        notes = [*state.warnings, *doubts_at(_moment(model, live))]
        linear = linear_model(model, disturbed, outputs)
        answer = first_rank_gives(
            comm.tompi4py(), partial(_reduced, model, linear, inputs, outputs, method, order)
        )
    system, reduced, found = answer
    described = [describe(case, key) for key in inputs]
    summary = {
        "title": case.title,
        "about": _about(model),
        "inputs": {q.name: q.unit for q in described},
        "outputs": {key: units[key] for key in outputs},
        **found,
        "warnings": notes + found["warnings"],
    }
    if comm.rank == 0:
        folder.write_case(case)
        _save(folder, system, reduced, summary)
        write_summary(folder.summary, {k: v for k, v in summary.items() if k != "response"})
    summary.pop("response")
    lines = _lines(case, folder, system, reduced, summary)
    return LinearResult(system, reduced, tuple(inputs), tuple(outputs), folder.path, summary, lines)


def refuse_unknown(option: str, names: Sequence[str], known: list[str]) -> None:
    """Refuse an empty list, a name given twice, and one that does not exist."""
    there = ", ".join(known) or "none in this case"
    if not names:
        raise CaseError(at=option, want=f"at least one of {there}")
    for i, key in enumerate(names):
        if key not in known:
            near = difflib.get_close_matches(key, known, 1, 0.4)
            raise CaseError(
                at=option, got=key, want=f"one of {there}", hint=f"nearest: {near[0]}" if near else ""
            )
        if key in names[:i]:
            raise CaseError(at=option, got=key, want="each name once")


def _about(model: DrillingModel) -> str:
    lowering, rotation = prescribed_motion(model)
    return motion_text(lowering, rotation, model.case.shown_units)


def _moment(model: DrillingModel, live: LiveOutputs) -> Linear:
    """What the linear model is made of: contacts, friction and bit as linearised, and the remaining imbalance; collective."""
    closed: int | None = None
    if model.contact is not None:
        cells, items = model.contact.element_results(model.system.assembly)
        own = int((cells[:, 0] > 0).sum() + (items[:, 0] > 0).sum())
        closed = model.system.comm.tompi4py().allreduce(own)
    on_bottom: bool | None = None
    if model.bit is not None and "wob" in [q.name for q in live.described()]:
        live.changed()
        on_bottom = bool(live.read(live.find(["wob"]), 0.0)[0] > 0)
    motion = prescribed_motion(model)
    return Linear(
        model=model,
        imbalance=unbalanced_force(model),
        varying=[(key, q.value(0.0)) for key, q in inputs_of(model.case).items() if q.breaks()],
        closed=closed,
        moves=motion != (0.0, 0.0),
        turns=bool(motion[1]),
        on_bottom=on_bottom,
    )


def _reduced(
    model: DrillingModel,
    linear: LinearModel | None,
    inputs: Sequence[str],
    outputs: Sequence[str],
    method: str | None,
    order: int,
) -> tuple[StateSpace, Reduced | None, dict[str, Any]]:
    """The whole model, the reduced one, and entries of the summary; on the first rank."""
    assert linear is not None
    system = linear.system
    zero = ZERO_FRACTION * reference_rate(model)
    kept = not_decaying(system, zero)
    s = np.linalg.eigvals(system.A) if system.order else np.zeros(0, dtype=complex)
    rigid, growing = [], []
    for root, vector in zip(kept.s, kept.vectors.T, strict=True):
        kind = kind_of(model, linear, vector)
        if abs(root) <= max(zero, np.sqrt(np.finfo(float).eps) * np.abs(s).max()):
            rigid.append(kind)
        else:
            growing.append({"kind": kind, "growth": root.real, "frequency": root.imag / (2 * np.pi)})
    rising = [
        g for g in growing if g["growth"] > 1e-6 * abs(complex(g["growth"], 2 * np.pi * g["frequency"]))
    ]
    frequency = _frequencies(s, zero)
    response = system.response(frequency)
    feed = np.abs(system.F) * 2 * np.pi * frequency[-1]
    system = replace(
        system, F=np.where(feed > ROUNDING * np.abs(response).max(axis=0, initial=0.0), system.F, 0.0)
    )
    follows = [(outputs[i], inputs[j]) for i, j in zip(*np.nonzero(system.F), strict=True)]
    found: dict[str, Any] = {
        "states": system.order,
        "rigid": rigid,
        "not_decaying": growing,
        "stable": not rising and not rigid,
        "largest_growth": float(s.real.max(initial=-np.inf)) if len(s) else None,
    }
    data: dict[str, Any] = {"frequency": frequency, "full": response}
    result = None
    if method is not None:
        sizes = np.array([USUAL[key] for key in inputs])
        result = reduce(system, method, order, zero, sizes)
        data["reduced"] = result.system.response(frequency)
        found["reduction"] = {
            "method": method,
            "states": result.system.order,
            "kept": result.kept,
            "bound": None if np.isnan(result.bound) else result.bound,
            "error": result.error(response, data["reduced"]),
            "frequencies": [frequency[0], frequency[-1]],
            "input_size": dict(zip(inputs, result.input_size, strict=True)),
            "output_size": dict(zip(outputs, result.output_size, strict=True)),
            "hankel": result.hankel[: 2 * order],
        }
    found["warnings"] = doubts_at(
        Reduction(
            model=model,
            rigid=rigid,
            rising=rising,
            constant=len(growing) - len(rising),
            apart=[outputs[i] for i in linear.constant],
            follows=follows,
            order=None if method is None else order,
            states=system.order,
        )
    )
    found["response"] = data
    return replace(system, motions=None), result, found


def _frequencies(s: np.ndarray, zero: float) -> FloatArray:
    """Frequencies (k,) [Hz] from a tenth of the slowest root to the fastest oscillation."""
    size = np.abs(s[np.abs(s) > max(zero, 1e-8 * np.abs(s).max(initial=0.0))])
    if not len(size):
        return np.geomspace(1e-2, 1e2, FREQUENCIES)
    high = max(float(np.abs(s.imag).max()), 10 * float(size.min()))
    return np.geomspace(size.min() / 10, high, FREQUENCIES) / (2 * np.pi)


def _save(folder: RunFolder, system: StateSpace, reduced: Reduced | None, summary: dict[str, Any]) -> None:
    """Write linear.npz and linear.mat; names in both are lists of words."""
    words = {
        "inputs": list(summary["inputs"]),
        "input_units": list(summary["inputs"].values()),
        "outputs": list(summary["outputs"]),
        "output_units": list(summary["outputs"].values()),
        "states": list(system.names),
    }
    response = summary["response"]
    arrays = {key: getattr(system, key) for key in "ABCDF"}
    arrays |= {"frequency": response["frequency"], "response": response["full"]}
    if reduced is not None:
        arrays |= {f"{key}_reduced": getattr(reduced.system, key) for key in "ABCDF"}
        arrays |= {
            "response_reduced": response["reduced"],
            "hankel": reduced.hankel,
            "bound": np.array(reduced.bound),
        }

    def npz(file: Path) -> None:
        with open(file, "wb") as f:
            np.savez_compressed(f, **arrays, **{k: np.array(v, dtype=str) for k, v in words.items()})

    def mat(file: Path) -> None:
        from scipy.io import savemat

        cells = {k: np.array(v, dtype=object).reshape(-1, 1) for k, v in words.items()}
        with open(file, "wb") as f:
            savemat(f, {**arrays, **cells})

    replace_file(folder.path / NPZ, npz)
    replace_file(folder.path / MAT, mat)


def _lines(
    case: Case, folder: RunFolder, system: StateSpace, reduced: Reduced | None, summary: dict[str, Any]
) -> list[str]:
    lines = [f"{case.title or 'case'}: linear model about {summary['about']}, {system.order} states"]
    lines.append("  inputs:  " + ", ".join(f"{k} [{u}]" for k, u in summary["inputs"].items()))
    lines.append("  outputs: " + ", ".join(f"{k} [{u}]" for k, u in summary["outputs"].items()))
    if reduced is not None:
        r = summary["reduction"]
        lines.append(
            f"  {r['method']} reduction: {r['states']} states, {r['kept']} of them of motions that do not decay"
        )
        if len(reduced.hankel):
            shown = ", ".join(f"{q:.4g}" for q in reduced.hankel[:PRINTED])
            lines.append(f"    Hankel values: {shown}{', ...' if len(reduced.hankel) > PRINTED else ''}")
        sizes = ", ".join(f"{k} {v:.4g}" for k, v in {**r["input_size"], **r["output_size"]}.items())
        lines.append(f"    in units of: {sizes}")
        bound = "" if r["bound"] is None else f", bound {r['bound']:.4g}"
        low, high = r["frequencies"]
        lines.append(
            f"    largest error at {FREQUENCIES} frequencies, {low:.3g} to {high:.3g} Hz: {r['error']:.4g}{bound}"
        )
    lines += [f"  note: {text}" for text in summary["warnings"]]
    lines.append(f"  results: {folder.path}")
    return lines
