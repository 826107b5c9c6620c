"""summary.json and the last lines of a run."""

from __future__ import annotations

import platform
import time as clock
from typing import Any

import numpy as np
from petsc4py import PETSc

from drillpetsc.errors import Interrupted
from drillpetsc.geometry.trajectory import as_dict, new_hole
from drillpetsc.version import __version__

FOR_RATES = 5.0  # [m] of new hole below which its waviness, tenths of a degree, says more than its build rate
PHASES = ("Residual", "Jacobian", "ChainFactor", "ChainSolve", "Output")


def of_run(
    model, recorder, integrator, notes, reached: float, start: float, began, marks, error
) -> dict[str, Any]:
    """Everything that summary.json tells; collective unless there is an error."""
    system = model.system
    now = clock.perf_counter(), clock.process_time()
    wall, cpu = now[0] - marks[0], now[1] - marks[1]
    if system.comm.size > 1 and error is None:
        cpu = system.comm.tompi4py().allreduce(cpu)
    interrupted = isinstance(error, (Interrupted, KeyboardInterrupt))
    unknowns = sum(f.size * count for f, count in field_counts(system))
    result: dict[str, Any] = {
        "title": model.case.title,
        "status": "done" if error is None else str(error) if interrupted else f"failed: {error}",
        "interrupted": interrupted,
        "versions": {
            "drillpetsc": __version__,
            "petsc": ".".join(map(str, PETSc.Sys.getVersion())),
            "numpy": np.__version__,
            "python": platform.python_version(),
        },
        "petsc_options": integrator.options,
        "ranks": system.comm.size,
        "elements": system.chain.size - 1 - len(system.mesh.joints),
        "unknowns": unknowns,
        "simulated": reached - start,
        "time": reached,
        **counts(integrator),
        "wall_seconds": wall,
        "cpu_seconds": cpu,
        "start_seconds": marks[0] - began[0],
        "real_time_factor": (reached - start) / wall if wall > 0 else None,
        "wall_by_phase": phases(),
    }
    result["warnings"] = list(notes.get("warnings", ()))
    if "statics" in notes:
        result["statics"] = notes["statics"]
    if recorder.has_energies:
        result["energy"] = energy(recorder)
    if recorder.flow is not None:
        result["mass"] = recorder.mass_balance()
    if model.drilling is not None:
        drilled = new_hole(model.drilling.drilled_hole(), model.drilling.hole.start)
        if drilled is not None:
            result["new_hole"] = as_dict(drilled)
    if error is None or isinstance(error, Interrupted):
        row = recorder.history_row(reached, 0.0, 0.0)
        result["final"] = {
            f"{n} [{u}]": value
            for (n, u), value in zip(recorder.columns, row, strict=True)
            if n not in ("step", "newton")
        }
    return result


def notes_of(state) -> dict[str, Any]:
    """What the summary tells of the static start, kept in checkpoints."""
    if state is None:
        return {}
    e = state.equilibrium
    return {
        "statics": {
            "iterations": e.iterations,
            "negative_pivots": e.negative_pivots,
            "residual": float(e.residual),
            "imperfection": float(e.imperfection),
            "warnings": list(state.warnings),
        }
    }


def field_counts(system) -> list[tuple[Any, int]]:
    """Each field with the number of vertices that have it (whole string)."""
    return [(f, int(system.regions[f.region].sum())) for f in system.layout.fields]


def counts(integrator) -> dict[str, int]:
    c = integrator.counters
    return {
        "steps": c.steps,
        "rejected_steps": c.rejected,
        "newton_iterations": integrator.newton_iterations(),
        "jacobians": integrator.jacobian_count(),
        "failed_solves": integrator.failure_count(),
        "linear_iterations": integrator.linear_iterations(),
    }


def energy(recorder) -> dict[str, float]:
    """Energy balance since the start [J], at the last audit (a run that failed has no later one); the share
    is relative to the larger of work supplied and peak change of stored energy."""
    kinetic, strain, potential = map(float, recorder.energies)
    error = recorder.audited_error
    return {
        "kinetic": kinetic,
        "strain": strain,
        "potential": potential,
        "dissipated": recorder.dissipated,
        "supplied": recorder.supplied,
        "error": error,
        "error_share": error / recorder.exchanged,
    }


def phases() -> dict[str, float]:
    """Wall seconds of this rank by phase, from PETSc's log."""
    out = {}
    for name in PHASES:
        try:
            out[name] = float(PETSc.Log.Event(name).getPerfInfo()["time"])
        except (PETSc.Error, KeyError):
            continue
    return out


def closing_lines(result: dict[str, Any], folder) -> list[str]:
    """The few lines that end a run on the screen."""
    e = result.get("energy", {})
    lines = [
        f"{result['title'] or 'case'}: {result['elements']} elements, {result['unknowns']} unknowns, {result['ranks']} rank(s)",
        f"  simulated {result['simulated']:.6g} s in {result['wall_seconds']:.3g} s (real-time factor {result['real_time_factor']:.3g}), "
        f"{result['steps']} steps, {result['rejected_steps']} rejected, {result['newton_iterations']} Newton iterations, "
        f"{result['jacobians']} Jacobians",
    ]
    if e:
        lines.append(
            f"  energy error {e['error']:.3g} J ({100 * e['error_share']:.2g} % of the energy exchanged)"
        )
    if "mass" in result:
        m = result["mass"]
        lines.append(
            f"  mud: {m['pumped']:.6g} m3 pumped, {m['returned']:.6g} m3 returned, balance off by {m['error']:.2g} m3"
        )
    if "new_hole" in result:
        q = result["new_hole"]
        rates = (
            f", build rate {q['build_rate [deg/30m]']:.3g}, turn rate {q['turn_rate [deg/30m]']:.3g} deg/30 m"
            if q["drilled [m]"] >= FOR_RATES
            else " (too short for rates)"
        )
        lines.append(
            f"  drilled {q['drilled [m]']:.4g} m: inclination {q['inclination_start [deg]']:.4g} to "
            f"{q['inclination_end [deg]']:.4g} deg{rates}"
        )
    for warning in (*result.get("statics", {}).get("warnings", ()), *result.get("warnings", ())):
        lines.append(f"  note: {warning}")
    lines.append(f"  results: {folder}")
    lines.append(
        f"  look at them: scripts/drillpetsc plot {folder}   scripts/drillpetsc view {folder}   (string.pvd opens in ParaView)"
    )
    return lines
