"""Elements that are too long for what a state shows, or for what a case lets expect, with the length that would do.

Manual: sec-mesh-coarse.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.model.element_length import (
    HELIX,
    LARGEST_STRESS_FREE_TURN,
    LARGEST_TURN,
    LEAST_STEP,
    STEP_STRESS,
    VERTICAL,
    free_length,
    step_moment,
)
from drillpetsc.model.hole import top_of_string
from drillpetsc.model.mesh import string_forces
from drillpetsc.output.files.tables import Column
from drillpetsc.output.static_table import at_nodes, static_table
from drillpetsc.output.watches.buckling import ELEMENTS_PER_PITCH, buckling
from drillpetsc.unit_systems import display

TOLERANCE = 1.25  # of a turn in one element over that which suffices
MOMENT_ERROR = 0.03  # of a bending moment beside a support, from which it is reported
#: moments at the nodes follow from equilibrium (manual: sec-beam-nodal): lengths that leave about 1 % of them, over the
#: bending layer and over the free length
LAYER_SHARE, SPAN_SHARE = 1.5, 0.6
LEAST_STRESS = 10e6  # bending stress of which the error is reported [Pa]
SHARP_BEND = 50e6  # bending stress of a jump of the hole's curvature beside which elements are judged [Pa]
MOST_PLACES = 6  # of one kind


@dataclass(frozen=True)
class _Loads:
    """What elements are judged by, at the nodes (n,).

    tension: effective axial force [N]; side: load across the string [N/m]; clearance: radial [m], infinite without a
    wall; stress: bending stress [Pa], None where it is not known.
    """

    tension: FloatArray
    side: FloatArray
    clearance: FloatArray
    stress: FloatArray | None


Found = dict[str, Any]
"""Values of the sentence on elements that are too long: length and the length that would do [m], and their place."""


@dataclass(frozen=True)
class LongElements:
    """Elements that are too long: ranges of them (``_ranged``), those beside a support (``_beside``), and those of buckles."""

    ranges: tuple[Found, ...] = ()
    supports: tuple[Found, ...] = ()
    buckles: tuple[Found, ...] = ()


def of_state(
    model: DrillingModel, columns: list[Column] | None = None, values: FloatArray | None = None
) -> LongElements:
    """Elements that are too long for the model's present state; collective, and the same on all ranks.

    columns, values: of ``static_table``, computed here where ``columns`` is None.
    """
    if not model.beam.moves or model.beam.needs_ancf_equilibrium:
        return LongElements()
    if columns is None:
        columns, values = static_table(model)
    found = LongElements()
    if values is not None:
        buckles = tuple(buckling(model, columns, values).coarse)
        found = replace(_of_loads(model, _of_state(model, columns, values)), buckles=buckles)
    comm = model.system.comm
    return found if comm.size == 1 else comm.tompi4py().bcast(found)


def expected(model: DrillingModel) -> LongElements:
    """Elements that are too long for the forces estimated before any solve (manual: sec-mesh-forces)."""
    case, mesh = model.case, model.mesh
    if case.hold_string:
        return LongElements()
    forces = string_forces(case, model.well)
    middle = 0.5 * (forces.md[1:] + forces.md[:-1])
    at = np.clip(np.searchsorted(forces.md, 0.5 * (mesh.upper + mesh.lower)) - 1, 0, len(middle) - 1)
    extreme = np.where(forces.push > forces.pull, -forces.push, forces.pull)
    load = _Loads(
        at_nodes(extreme[at], extreme[at]),
        at_nodes(forces.side[at], forces.side[at]),
        at_nodes(forces.clearance[at], forces.clearance[at]),
        None,
    )
    push, bending = forces.push[at], mesh.bending_stiffness
    walled = np.isfinite(forces.clearance[at])
    clearance = np.where(walled, forces.clearance[at], 1.0)
    level = np.maximum(
        2 * np.sqrt(bending * forces.side[at] / clearance),
        VERTICAL * np.cbrt(bending * forces.weight[at] ** 2),
    )
    pitch = 2 * np.pi * np.sqrt(2 * bending / np.maximum(push, 1e-9))
    long = (
        walled
        & ~mesh.is_joint
        & (push > HELIX * level)
        & (mesh.length > pitch / ELEMENTS_PER_PITCH * TOLERANCE)
    )
    helix = _ranged(model, long, pitch / ELEMENTS_PER_PITCH, lambda k: "the expected helix")
    found = _of_loads(model, load)
    return replace(found, ranges=(*helix, *found.ranges))


def _of_state(model: DrillingModel, columns: list[Column], values: FloatArray) -> _Loads:
    table = dict(zip([c[0] for c in columns], values.T, strict=True))
    mesh, contact = model.mesh, model.contact
    clearance = np.full(mesh.nodes, np.inf)
    if contact is not None:
        radius = at_nodes(0.5 * mesh.contact_diameter, 0.5 * mesh.contact_diameter)
        place = mesh.node_depth + top_of_string(model.case, mesh.total_length)
        clearance = np.maximum(np.asarray(contact.well.radius(place)) - radius, 1e-3)
    stiffness = at_nodes(mesh.bending_stiffness, mesh.bending_stiffness)
    load = np.nan_to_num(table["buckling_load"]) if "buckling_load" in table else np.zeros(mesh.nodes)
    side = (
        (0.5 * load) ** 2 * np.where(np.isfinite(clearance), clearance, 0.0) / stiffness
    )  # of Dawson and Paslay
    tension = table.get("effective_tension", table["axial_force"])
    return _Loads(tension, side, clearance, table["bending_stress"])


def _of_loads(model: DrillingModel, load: _Loads) -> LongElements:
    supports = (*_supports(model, load), *_jumps(model, load), *_steps(model, load))
    return LongElements((*_residual(model), *_turns(model)), supports)


# ---------------------------------------------------------------------- kinds
def _residual(model: DrillingModel) -> list[Found]:
    """Elements in which the stress-free shape turns by too much."""
    own = np.array([getattr(item, "curvature", 0.0) for item in model.case.string])[model.mesh.item]
    with np.errstate(divide="ignore"):
        enough = LARGEST_STRESS_FREE_TURN / own
    long = (model.mesh.length > TOLERANCE * enough) & ~model.mesh.is_joint
    return _ranged(model, long, enough, lambda k: f"a residual curvature of {own[k]:.3g} 1/m")


def _turns(model: DrillingModel) -> list[Found]:
    """Elements in which the hole turns by too much."""
    if model.well is None:
        return []
    mesh, shift = model.mesh, top_of_string(model.case, model.mesh.total_length)
    share = np.linspace(0.05, 0.95, 7)
    depth = mesh.upper[:, None] + share * mesh.length[:, None] + shift
    bend = np.linalg.norm(np.asarray(model.well.at(depth)[2]), axis=-1).max(axis=1)
    with np.errstate(divide="ignore"):
        enough = LARGEST_TURN / bend
    long = (mesh.length > 1.5 * enough) & ~mesh.is_joint

    def cause(k: int) -> str:
        rate, unit = display(float(bend[k]), "dogleg", model.case.shown_units)
        return f"the curvature of the hole ({rate:.3g} {unit})"

    return _ranged(model, long, enough, cause)


def _supports(model: DrillingModel, load: _Loads) -> list[Found]:
    """Bending layers beside rigid items on the wall."""
    mesh = model.mesh
    if model.contact is None:
        return []
    touching = [
        b for b in mesh.bodies if b.radius > 0 and b.contact_length
    ]  # a bit, at one point, passes no moment to the hole
    ends = sorted({b.node for b in touching})
    out: list[Found | None] = []
    for b in touching:
        others = [n for n in [0, *ends, mesh.nodes - 1] if n != b.node]
        distance = min(
            (abs(float(mesh.node_depth[n] - mesh.node_depth[b.node])) for n in others), default=np.inf
        )
        out.append(_beside(model, load, b.node, distance, f"beside {b.name} at MD"))
    return _first(out)


def _jumps(model: DrillingModel, load: _Loads) -> list[Found]:
    """Bending layers beside jumps of the hole's curvature."""
    contact, mesh = model.contact, model.mesh
    if contact is None:
        return []
    well = contact.well
    shift = top_of_string(model.case, model.mesh.total_length)
    depth = np.asarray(well.node_md)[1:-1] - shift
    depth = depth[(depth > mesh.node_depth[0] + 1e-6) & (depth < mesh.node_depth[-1] - 1e-6)]
    above, below = (np.asarray(well.at(depth + shift + d)[2]) for d in (-1e-6, 1e-6))
    change = np.linalg.norm(below - above, axis=1)
    nodes = np.clip(np.searchsorted(mesh.node_depth, depth), 1, mesh.nodes - 1)
    stress = (_stress_by_moment(model) * mesh.bending_stiffness)[nodes - 1] * change
    lines = [
        _beside(model, load, int(node), np.inf, "beside a jump of the hole's curvature at MD")
        for node in nodes[stress > SHARP_BEND]
    ]
    return _first(lines)


def _steps(model: DrillingModel, load: _Loads) -> list[Found]:
    """Bending layers beside steps of the clearance: of the pipe's diameter, or of the hole's."""
    contact, mesh = model.contact, model.mesh
    if contact is None:
        return []
    well = contact.well
    place = mesh.node_depth[1:-1] + top_of_string(model.case, model.mesh.total_length)
    gap = [
        np.asarray(well.radius(place + d)) - 0.5 * diameter
        for d, diameter in ((-1e-6, mesh.contact_diameter[:-1]), (1e-6, mesh.contact_diameter[1:]))
    ]
    touch = (mesh.contact_diameter > 0) & ~mesh.is_joint
    height = np.where(touch[1:] & touch[:-1], np.abs(gap[1] - gap[0]), 0.0)
    # steps without a notable moment of their own, like that of a collar below tool joints of its diameter, are no support
    by_moment, stress = _stress_by_moment(model), np.zeros(len(height))
    for side in (slice(None, -1), slice(1, None)):
        moment = step_moment(mesh.bending_stiffness[side], height, np.maximum(load.side[1:-1], 0.0))
        stress = np.maximum(stress, by_moment[side] * moment)
    lines = [
        _beside(
            model,
            load,
            int(node) + 1,
            np.inf,
            "beside a step of the clearance between pipe and wall at MD",
            float(height[node]),
        )
        for node in np.flatnonzero((height > LEAST_STEP) & (stress > STEP_STRESS))
    ]
    return _first(lines)


def _stress_by_moment(model: DrillingModel) -> FloatArray:
    """Bending stress over bending moment (n,) [1/m3] of the elements; zero without a section."""
    mesh = model.mesh
    section = np.pi / 64 * (mesh.outer_diameter**4 - mesh.inner_diameter**4)
    return np.divide(0.5 * mesh.outer_diameter, section, out=np.zeros(len(section)), where=section > 0)


# ---------------------------------------------------------------------- places
def _beside(
    model: DrillingModel, load: _Loads, node: int, distance: float, where: str, height: float | None = None
) -> Found | None:
    """Values of the sentence on the elements at ``node`` where they are too long for the bending layer there, else None.

    distance: to the next support [m]; where: beginning of the place.
    height: of the step that the string comes down from [m], None: from the middle of the hole.
    """
    mesh = model.mesh
    worst: tuple[float, float, float] | None = None
    for cell in (node - 1, node):
        if not 0 <= cell < len(mesh.length) or mesh.is_joint[cell]:
            continue
        length, bending = float(mesh.length[cell]), float(mesh.bending_stiffness[cell])
        layer = np.sqrt(bending / max(abs(float(load.tension[node])), 1e-9))
        drop = float(load.clearance[node]) if height is None else height
        free = free_length(bending, drop, float(load.side[node]))
        span = min(distance, free)
        far = cell + 1 if cell == node else cell
        if load.stress is None:
            if span == distance and not load.side[node] > 0:
                continue  # nothing lets expect a moment
        elif max(load.stress[node], load.stress[far]) < LEAST_STRESS:
            continue
        # of a beam under tension; and of a length in which the pipe leaves a support for the wall, by refinement
        error = max((length / layer) ** 4 / 720, 0.05 * (length / min(free, distance)) ** 4)
        enough = max(min(LAYER_SHARE * layer, SPAN_SHARE * span), float(mesh.outer_diameter[cell]))
        if error > MOMENT_ERROR and length > 1.5 * enough and (worst is None or error > worst[0]):
            worst = error, length, enough
    if worst is None:
        return None
    error, length, enough = worst
    return {
        "length": length,
        "where": where,
        "md": float(mesh.node_depth[node]) + top_of_string(model.case, mesh.total_length),
        "size": f"about {100 * error:.2g} %" if error < 0.3 else "30 % and more",
        "enough": enough,
    }


def _ranged(
    model: DrillingModel, long: np.ndarray, enough: FloatArray, cause: Callable[[int], str]
) -> list[Found]:
    """Values for each range of neighbouring elements in ``long`` (n,); ``enough``: what would do (n,) [m]."""
    mesh, shift, out = model.mesh, top_of_string(model.case, model.mesh.total_length), []
    edges = np.flatnonzero(np.diff(np.concatenate([[0], long.astype(int), [0]])))
    for a, b in zip(edges[::2], edges[1::2], strict=True):
        worst = a + int(np.argmin(enough[a:b]))
        out.append(
            {
                "length": float(mesh.length[a:b].max()),
                "upper": float(mesh.upper[a]) + shift,
                "lower": float(mesh.lower[b - 1]) + shift,
                "cause": cause(worst),
                "enough": float(enough[worst]),
            }
        )
    return _first(out)


def _first(found: Iterable[Found | None]) -> list[Found]:
    """The first ``MOST_PLACES`` different ones, the last of them with the number of the others as ``more``."""
    every: list[Found] = []
    every += (q for q in found if q is not None and q not in every)
    more = len(every) - MOST_PLACES
    return every if more <= 0 else [*every[: MOST_PLACES - 1], {**every[MOST_PLACES - 1], "more": more}]


def too_coarse(model: DrillingModel) -> bool:
    """Whether an element is above the limit of ``coarse_elements``."""
    return bool(coarse_elements(model)[0].any())


def coarse_elements(model: DrillingModel) -> tuple[np.ndarray, FloatArray]:
    """Find the elements (n,) with L^3 > 240 EI/w, and this limit of L (n,) [m] (manual: eq-beam-length-limit).

    The bending stiffness of such an element does not balance the axial load of its own weight w per length.
    """
    mesh = model.mesh
    w = mesh.mass * np.linalg.norm(model.case.gravity)
    with np.errstate(divide="ignore"):
        limit = np.cbrt(np.where(w > 0, 240 * mesh.bending_stiffness / w, np.inf))
    return mesh.length**3 * w > 240 * mesh.bending_stiffness, limit
