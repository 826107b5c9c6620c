"""Rows of a roadmap from the beam: the static equilibrium of the string at a bit depth in an operation.

The string is that of the soft one: its lowest metres, with its weight less that of the mud that it displaces, so that the
force of the beam is the effective tension (manual: sec-roadmap-stiff).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from petsc4py import PETSc

from drillpetsc.analysis.hydraulics.flow_model import string_at
from drillpetsc.analysis.loads.limits.along_string import State, Surroundings, static_state
from drillpetsc.analysis.loads.limits.side_force import largest_on_joint
from drillpetsc.analysis.loads.limits.table import Choices, Strength, element_values
from drillpetsc.analysis.loads.torque_drag.circulation import Circulation
from drillpetsc.analysis.loads.torque_drag.operations import Load, Pair
from drillpetsc.analysis.loads.torque_drag.string_rows import (
    JOINT,
    SHORTEST,
    StringRows,
    gravity_of,
    partly_filled,
)
from drillpetsc.analysis.loads.torque_drag.table import OK, STATES, failed, neutral_point, said_of
from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
from drillpetsc.arrays import FloatArray
from drillpetsc.case.blocks.ends import ForcedBottom, HeldBottom, LineLoad, TopDrive
from drillpetsc.case.blocks.items.string import Beam, Item, Rigid, Tube
from drillpetsc.case.blocks.items.tubulars import Tubular
from drillpetsc.case.case import Case
from drillpetsc.case.pipe.section import ring
from drillpetsc.errors import CaseError, SolveError
from drillpetsc.geometry.well import Well
from drillpetsc.model.drilling_model import DrillingModel, build_model
from drillpetsc.model.mesh import MeshOf
from drillpetsc.output.progress import counted
from drillpetsc.output.watches.buckling import ELEMENTS_PER_PITCH
from drillpetsc.output.watches.coarse_mesh import TOLERANCE

BY_PATH = "one of several states: buckled with friction, at the end of a path of steady sliding"
LIFTED = 10.0  # length of the pieces on which the forces of flowing mud are uniform [m]


@dataclass(frozen=True)
class Job:
    """One row: a string, a friction pair and a load.

    block: weight of the block [N]; densities: of the mud in and around the string [kg/m3].
    flow: forces of flowing mud; the error where there is no steady flow.
    """

    rows: StringRows
    pair: Pair
    load: Load
    block: float = 0.0
    densities: tuple[float, float] = (0.0, 0.0)
    flow: Circulation | SolveError | None = None


def need_beam(case: Case) -> None:
    """Raise CaseError for a case of which the beam has no roadmap."""
    if case.beam.formulation != "ancf":
        raise CaseError(
            at="--model", got="stiff", want="beam: {formulation: ancf}, whose static equilibrium is sought"
        )
    key = partly_filled(case)
    if key is not None:
        raise CaseError(at="--model", got="stiff", want=f"--model soft with fluid.{key}")
    if case.contact is None:
        raise CaseError(
            at="--model", got="stiff", want="a case with contact: without it the wall drags nothing"
        )
    if case.all_joints:
        raise CaseError(at="--model", got="stiff", want="a string without joints, or --model soft")


def stiff_case(case: Case, well: Well, job: Job) -> Case:
    """The case of a row: the string in the hole at its bit depth, hung at the top, with the buoyed weights.

    Raises CaseError if an item floats.
    """
    rows, g = job.rows, gravity_of(case, "roadmap")
    items = string_at(case, rows.depth).items
    edges = iter(zip(rows.weight, np.diff(rows.edges), strict=True))
    hung: list[Item] = []
    for item in items:
        if item.length < SHORTEST:  # its weight hangs on the next item, or at the lower end
            last = item is items[-1]
            weight, length = (rows.end_weight, 1.0) if last else (0.0, 1.0)
        else:
            weight, length = next(edges)
        hung.append(_weighing(item, float(weight) / g, float(length), job.pair.item_factor))
    sections = tuple(
        s.model_copy(update={"friction": float(mu)})
        for s, mu in zip(case.given_well.sections, job.pair.friction, strict=True)
    )
    tangent = np.asarray(well.at(np.array([rows.depth]))[1])[0]
    thrust = job.flow.thrust if isinstance(job.flow, Circulation) else 0.0
    north, east, down = (float(v) for v in -(job.load.wob + thrust) * tangent)
    free = HeldBottom(kind="free")
    pushed = ForcedBottom(kind="force", force=(north, east, down))
    return case.model_copy(
        update={
            "string": tuple(hung),
            "well": case.given_well.model_copy(update={"sections": sections}),
            "top": TopDrive(kind="top_drive"),
            "bottom": pushed if job.load.wob + thrust else free,
            "initial": case.initial.model_copy(update={"wob": None, "from_": "statics"}),
            "formation": None,
            "hold_string": False,
            "fluid": None,
            "roadmap": None,
            "loads": _lifting(well, job.flow) if isinstance(job.flow, Circulation) else (),
        }
    )


def _lifting(well: Well, flow: Circulation) -> tuple[LineLoad, ...]:
    """Line loads of the flow, along the hole, on pieces of the string."""
    last = float(flow.md[-1])
    marks = np.unique(np.append(np.arange(0.0, last, LIFTED), last))
    tangent = np.asarray(well.at(0.5 * (marks[:-1] + marks[1:]))[1])
    force = -flow.lift(marks)[:, None] * tangent
    return tuple(
        LineLoad.model_validate({"from": upper, "to": lower, "force": tuple(piece)})
        for upper, lower, piece in zip(marks.tolist(), marks[1:].tolist(), force.tolist(), strict=False)
    )


def _weighing(item: Item, mass: float, length: float, factor: float) -> Item:
    """The item with a mass per length [kg/m] and its own friction times ``factor``; CaseError where it floats."""
    update: dict[str, Any] = {} if item.friction is None else {"friction": item.friction * factor}
    if isinstance(item, Rigid):
        if mass < 0:
            raise CaseError(at="string", got=item.name, want="an item that does not float in the mud")
        return item.model_copy(update={**update, "mass": mass * length})
    if not mass > 0:
        raise CaseError(at="string", got=item.name, want="an item that does not float in the mud")
    if isinstance(item, Tubular):
        update["adjusted_weight"] = mass
    elif isinstance(item, Tube):
        density = mass / ring(item.od, item.id)[0]
        update["material"] = item.material.model_copy(update={"density": density})
    else:
        assert isinstance(item, Beam)
        update["mass"] = mass
    return item.model_copy(update=update)


def motion_of(job: Job) -> tuple[float, float]:
    """Axial velocity [m/s, down positive] and rotation [rad/s] of a row, which friction opposes."""
    return -job.load.axial_velocity, job.load.rotation


def model_of(case: Case, well: Well, job: Job, like: MeshOf | None = None) -> DrillingModel:
    """The model of a row; like: as for ``build_model``."""
    return build_model(stiff_case(case, well, job), PETSc.COMM_SELF, motion_of(job), like=like)


def stiff_row(case: Case, well: Well, job: Job) -> dict[str, Any]:
    """One row [SI]; nan for every number, and the reason as its status, where there is no trustworthy state."""
    load = job.load
    row: dict[str, Any] = {"wob": load.wob}
    if job.rows.misfit:
        return row | failed(job.rows.misfit)
    if isinstance(job.flow, SolveError):
        return row | failed(f"the flow: {job.flow}")
    motion = motion_of(job)
    try:
        model = model_of(case, well, job)
        state = find_equilibrium(model, motion, False)
    except (SolveError, CaseError) as error:
        return row | failed(str(error))
    if not state.stable and state.path is None:
        pivots = state.equilibrium.negative_pivots
        return row | failed(f"the state is not stable ({pivots} negative pivots)")
    row |= values_of(model, job)
    if state.path is not None:
        row["status"] = "; ".join([*([row["status"]] if row["status"] != OK else []), BY_PATH])
    return row


def values_of(model: DrillingModel, job: Job) -> dict[str, Any]:
    """What a state gives, with the torque on bit, which twists the string alike from end to end."""
    found = static_state(model)
    assert found is not None
    mesh, load, system = model.mesh, job.load, model.system
    hole, pipe = Surroundings(model), Strength(model, Choices())
    found = _in_mud(model, replace(found, torque=found.torque + load.torque), hole, job)
    with np.errstate(divide="ignore", invalid="ignore"):
        values = element_values(model, found, hole, pipe, Choices())
        push = -found.effective
        sinusoidal, helical = (
            float(np.max(np.where(np.isfinite(q) & (push > 0), push / q, 0.0)))
            for q in (values["sinusoidal_limit"], values["helical_limit"])
        )
    md = np.append(hole.md[:, 0], hole.md[-1, 1])
    tension = np.append(found.effective[:, 0], found.effective[-1, 1])
    lowest = int(np.argmin(tension))
    length = mesh.length
    row = {
        "hook_load": -system.reaction("top.axial_reaction"),
        "surface_torque": system.reaction("top.torque_reaction") + load.torque,
        "stretch": float(np.sum(found.effective.mean(axis=1) * length / mesh.axial_stiffness)),
        "twist": float(np.sum(found.torque.mean(axis=1) * length / mesh.torsional_stiffness)),
        "min_effective_tension": float(tension[lowest]),
        "md_of_min": float(md[lowest]),
        "neutral_point": neutral_point(md, tension),
        "sinusoidal_ratio": sinusoidal,
        "helical_ratio": helical,
        "buckling_state": STATES[2 if helical > 1 else int(sinusoidal > 1)],
        "max_side_force_per_joint": _side_force(model, found, hole),
        "min_safety_factor": _least(values["safety_factor"]),
        "overpull_margin": _least(values["tension_limit"] - values["axial_force"]),
    }
    pitch = 2 * np.pi * np.sqrt(2 * hole.stiffness / np.maximum(push.max(axis=1), 1.0))
    coils = (push > np.where(np.isfinite(values["helical_limit"]), values["helical_limit"], np.inf)).any(
        axis=1
    )
    said = [said_of(row, job.block)]
    if (coils & (length > TOLERANCE * pitch / ELEMENTS_PER_PITCH)).any():
        said.append("elements are too long for the helix")
    return row | {"status": "; ".join(filter(None, said)) or OK}


def _side_force(model: DrillingModel, found: State, hole: Surroundings) -> float:
    """Largest side force on a joint [N]; items without joints count over the length of a joint, as in the soft string."""
    known = np.isfinite(found.side_force_of_elements)
    if not known.any():
        return float("nan")
    own = np.nan_to_num(found.side_force_of_elements) * model.mesh.length
    joint = np.where(np.isfinite(model.mesh.joint_length), model.mesh.joint_length, JOINT)
    return float(largest_on_joint(hole.md, own, joint).max())


def _least(values: FloatArray) -> float:
    known = values[np.isfinite(values)]
    return float(known.min()) if len(known) else float("nan")


def _in_mud(model: DrillingModel, found: State, hole: Surroundings, job: Job) -> State:
    """The state with the pressures of the mud inside and outside, and the tension of the wall."""
    mesh = model.mesh
    if isinstance(job.flow, Circulation):
        inside, outside = (np.interp(hole.md, job.flow.md, p) for p in (job.flow.inside, job.flow.outside))
        momentum = np.interp(hole.md, job.flow.md, job.flow.momentum)
    else:
        gravity = float(np.linalg.norm(np.array(model.case.gravity, dtype=float)))
        depth = np.maximum(hole.tvd, 0.0)
        (inside, outside), momentum = (
            (density * gravity * depth for density in job.densities),
            np.zeros_like(depth),
        )
    bore, whole = mesh.tube_bore_area, mesh.tube_outer_area
    axial = found.axial + inside * bore[:, None] - outside * whole[:, None]
    axial += np.divide(momentum, bore[:, None], out=np.zeros_like(momentum), where=bore[:, None] > 0)
    return replace(found, axial=axial, inside=inside, outside=outside)


def solve_jobs(case: Case, well: Well, jobs: list[Job], comm: PETSc.Comm) -> list[dict[str, Any]]:
    """Rows of the jobs; collective.

    Each rank solves whole strings, so that the rows are the same for any number of ranks.
    """
    own = counted(range(comm.rank, len(jobs), comm.size), "rows", comm.rank)
    mine = {i: stiff_row(case, well, jobs[i]) for i in own}
    every: dict[int, dict[str, Any]] = {}
    for part in [mine] if comm.size == 1 else comm.tompi4py().allgather(mine):
        every |= part
    return [every[i] for i in range(len(jobs))]
