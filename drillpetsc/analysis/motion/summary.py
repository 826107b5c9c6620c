"""summary.json and the last lines of a run."""

from __future__ import annotations

import math
import shlex
import time as clock
from dataclasses import dataclass
from typing import Any

from petsc4py import PETSc

from drillpetsc.analysis.motion.machine_report import control_summary, hoist_summary
from drillpetsc.analysis.motion.provenance import digest, versions
from drillpetsc.analysis.statics.equilibrium import StaticState
from drillpetsc.analysis.statics.placement import top_depth
from drillpetsc.errors import Interrupted
from drillpetsc.fem.discrete_system import DiscreteSystem
from drillpetsc.geometry.trajectory import as_dict, new_hole
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.output.balances.time_error import time_error_lines
from drillpetsc.output.recorder import Recorder
from drillpetsc.physics.top.hoist import Hoist
from drillpetsc.physics.top.top_drive import MotorDrive
from drillpetsc.solvers.time.time_integrator import TimeIntegrator
from drillpetsc.unit_systems import System, display_unit, plain, shown

FOR_RATES = 5.0  # length of new hole [m] below which its waviness, tenths of a degree, hides its build rate
DAMPING_SHOWN = 1e-3  # share of energy lost above which the report names the damping of the time formula
DAMPING_MATTERS = 0.01  # share of energy lost above which the report names which vibrations are damped
PHASES = ("Residual", "Jacobian", "ChainFactor", "ChainSolve", "Output")


@dataclass(frozen=True)
class Clocks:
    """Wall and processor clock [s] at the start of the program, and at the start of the motion."""

    program: tuple[float, float]
    motion: tuple[float, float]


def run_summary(
    model: DrillingModel, integrator: TimeIntegrator, error: BaseException | None
) -> dict[str, Any]:
    """Facts of the computation: title, status, versions, options, sizes."""
    system = model.system
    interrupted = isinstance(error, Interrupted | KeyboardInterrupt)
    return {
        "title": model.case.title,
        "status": "done"
        if error is None
        else str(error) or "interrupted"
        if interrupted
        else f"failed: {error}",
        "interrupted": interrupted,
        "case_digest": digest(model.case),
        "versions": versions(),
        "petsc_options": integrator.options,
        "ranks": system.comm.size,
        "elements": system.chain.size - 1 - len(system.mesh.joints),
        "unknowns": sum(f.size * count for f, count in field_counts(system)),
    }


def timing(
    integrator: TimeIntegrator, clocks: Clocks, start: float, reached: float, error: BaseException | None
) -> dict[str, Any]:
    """Simulated time, counts and times of the computation; collective unless there is an error.

    start, reached: simulated time at the start of this run and at its end [s].
    """
    comm = integrator.system.comm
    wall, cpu = clock.perf_counter() - clocks.motion[0], clock.process_time() - clocks.motion[1]
    if comm.size > 1 and error is None:
        cpu = comm.tompi4py().allreduce(cpu)
    return {
        "simulated": reached - start,
        "time": reached,
        **counts(integrator),
        "wall_seconds": wall,
        "cpu_seconds": cpu,
        "start_seconds": clocks.motion[0] - clocks.program[0],
        "real_time_factor": (reached - start) / wall if wall > 0 else None,
        "wall_by_phase": phases(integrator),
    }


def outcome(
    model: DrillingModel,
    recorder: Recorder,
    notes: dict[str, Any],
    reached: float,
    error: BaseException | None,
    newton_work: float | None = None,
) -> dict[str, Any]:
    """Warnings, balances, the new hole and the last values of the history.

    newton_work: work of the residuals that Newton left [J], None if unknown.
    """
    result: dict[str, Any] = {"warnings": list(notes.get("warnings", ()))}
    if "accepted_changes" in notes:
        result["accepted_changes"] = list(notes["accepted_changes"])
    if "statics" in notes:
        result["statics"] = notes["statics"]
    for drive in model.parts(MotorDrive):
        result["top_drive"] = control_summary(drive.described, drive.motor, drive.impedance)
    for hoist in model.parts(Hoist):
        result["hoist"] = hoist_summary(model, hoist)
    if recorder.energy is not None:
        result["energy"] = recorder.energy.summary(newton_work)
    if recorder.mass is not None:
        result["mass"] = recorder.mass_balance()
    if model.contact is not None:
        result["rigid_items"] = recorder.rigid_items(top_depth(model))
    if model.bit is not None and model.bit.hole is not None:
        well = model.bit.drilled_hole()
        drilled = new_hole(well, model.bit.hole.start, model.bit.hole.original) if well is not None else None
        if drilled is not None:
            result["new_hole"] = as_dict(drilled)
    if error is None or isinstance(error, Interrupted):
        row = recorder.history_row(reached, 0.0, 0.0)
        result["final"] = {
            f"{name} [{unit}]": value
            for (name, unit), value in zip(recorder.columns, row, strict=True)
            if name not in ("step", "newton")
        }
    return result


def static_notes(state: StaticState | None) -> dict[str, Any]:
    """Notes of the static start for the summary; checkpoints keep them."""
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


def field_counts(system: DiscreteSystem) -> list[tuple[Any, int]]:
    """Each field with the number of vertices that have it (whole string)."""
    return [(f, int(system.regions[f.region].sum())) for f in system.layout.fields]


def counts(integrator: TimeIntegrator) -> dict[str, int]:
    """Steps, iterations and factorisations."""
    c = integrator.counters
    return {
        "steps": c.steps,
        "rejected_steps": c.rejected,
        "newton_iterations": integrator.newton_iterations(),
        "jacobians": integrator.jacobian_count(),
        "failed_solves": integrator.failure_count(),
        "linear_iterations": integrator.linear_iterations(),
    }


def phases(integrator: TimeIntegrator) -> dict[str, float]:
    """Wall seconds of this rank by phase, from PETSc's log and from the compiled iteration."""
    out, compiled = {}, integrator.compiled_seconds()
    for name in PHASES:
        try:
            out[name] = float(PETSc.Log.Event(name).getPerfInfo()["time"]) + compiled.get(name, 0.0)
        except (PETSc.Error, KeyError):
            continue
    return out


def closing_lines(
    result: dict[str, Any], folder, units: System | None = None, checked: bool = False
) -> list[str]:
    """Report of a run for the screen, in a system of units.  checked: its time error is also measured."""
    system = units or "metric"
    if result.get("nothing_left"):
        return [
            f"{result['title'] or 'case'}: the run had already reached its end at {result['time']:.6g} s",
            f"  results: {folder}",
        ]
    e = result.get("energy", {})
    lines = [
        f"{result['title'] or 'case'}: {result['elements']} elements, {result['unknowns']} unknowns, {result['ranks']} rank(s)",
        f"  simulated {result['simulated']:.6g} s in {plain(result['wall_seconds'], 3)} s (real-time factor {plain(result['real_time_factor'], 3)}), "
        f"{result['steps']} steps, {result['rejected_steps']} rejected, {result['newton_iterations']} Newton iterations, "
        f"{result['jacobians']} Jacobians",
    ]
    if e:
        damped = ", removed by numerical damping" if e.get("damped_share", 0.0) > DAMPING_SHOWN else ""
        lines.append(
            f"  energy error {shown(e['error'], 'energy', system, 3)} ({plain(100 * e['error_share'], 2)} % of the energy exchanged{damped})"
        )
    lines += _time_lines(result, checked, system)
    if "mass" in result:
        m = result["mass"]
        lines.append(
            f"  mud: {shown(m['pumped'], 'volume', system, 6)} pumped, {shown(m['returned'], 'volume', system, 6)} returned, balance off by {shown(m['error'], 'volume', system, 2)}"
        )
    if "new_hole" in result:
        q = result["new_hole"]
        rate, _, per = display_unit("dogleg", system)
        build, turn = (math.radians(q[f"{name}_rate [deg/30m]"]) / 30 / rate for name in ("build", "turn"))
        rates = (
            f", build rate {build:.3g}, turn rate {turn:.3g} {per.replace('30m', '30 m')}"
            if q["drilled [m]"] >= FOR_RATES
            else " (too short for rates)"
        )
        lines.append(
            f"  drilled {shown(q['drilled [m]'], 'length', system)}: inclination {q['inclination_start [deg]']:.4g} to "
            f"{q['inclination_end [deg]']:.4g} deg{rates}"
        )
    for warning in (*result.get("statics", {}).get("warnings", ()), *result.get("warnings", ())):
        lines.append(f"  note: {warning}")
    lines.append(f"  results: {folder}")
    lines.append(
        f"  look at them: scripts/drillpetsc plot {shlex.quote(str(folder))}   scripts/drillpetsc view {shlex.quote(str(folder))}   "
        "(string.pvd opens in ParaView)"
    )
    return lines


def _time_lines(result: dict[str, Any], checked: bool, system: System) -> list[str]:
    """Lines on the error of the time steps: estimated error of the outputs, and what numerical damping has removed."""
    estimate, energy = result.get("error_estimate") or {}, result.get("energy", {})
    lines = time_error_lines(estimate["outputs"], checked) if "outputs" in estimate else []
    frequency, share = estimate.get("damped_above"), energy.get("damped_share", 0.0)
    if frequency is not None and share > DAMPING_MATTERS:
        lines.append(
            f"  numerical damping removed {shown(energy['damped'], 'energy', system, 3)}, {plain(100 * share, 2)} % of the energy exchanged: at these steps "
            f"vibrations above {frequency:.2g} Hz lose more than 1 % of their amplitude per period"
        )
    return lines
