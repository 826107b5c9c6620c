"""Elements that are too long for what a state shows, or for what a case lets expect, with the length that would do.

Manual: sec-mesh-coarse.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from drillpetsc.analysis.statics.placement import top_depth
from drillpetsc.analysis.statics.start.buckling import ELEMENTS_PER_PITCH, buckling
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
    instead_of_length,
    step_moment,
)
from drillpetsc.model.mesh import string_forces
from drillpetsc.output.files.tables import Column
from drillpetsc.output.static_table import at_nodes, static_table
from drillpetsc.unit_systems import System, display, display_unit

TOLERANCE = 1.25  # of a turn in one element over that which suffices
MOMENT_ERROR = 0.03  # of a bending moment beside a support, from which it is reported
#: moments at the nodes follow from equilibrium (manual: sec-beam-nodal): lengths that leave about 1 % of them, over the
#: bending layer and over the free length
LAYER_SHARE, SPAN_SHARE = 1.5, 0.6
LEAST_STRESS = 10e6  # bending stress of which the error is reported [Pa]
SHARP_BEND = 50e6  # bending stress of a jump of the hole's curvature beside which elements are judged [Pa]
MOST_LINES = 6  # of one kind


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


def state_warnings(
    model: DrillingModel, columns: list[Column] | None = None, values: FloatArray | None = None
) -> list[str]:
    """Sentences on elements that are too long for the model's present state, those for buckles left out; collective.

    columns, values: of ``static_table``, computed here where ``columns`` is None.  Empty on other ranks than 0.
    """
    if model.beam is None or model.beam.needs_ancf_equilibrium:
        return []
    if columns is None:
        columns, values = static_table(model)
    if values is None:
        return []
    return _lines(model, _of_state(model, columns, values))


def run_warnings(model: DrillingModel) -> list[str]:
    """``state_warnings`` and those on buckles of the state a run starts from; the same on all ranks; collective."""
    if model.beam is None or model.beam.needs_ancf_equilibrium:
        return []
    columns, values = static_table(model)
    lines: list[str] = []
    if values is not None:
        lines = [
            *buckling(model, columns, values).coarse_lines(_units(model)),
            *state_warnings(model, columns, values),
        ]
    comm = model.system.comm
    return lines if comm.size == 1 else list(comm.tompi4py().bcast(lines))


def expected_warnings(model: DrillingModel) -> list[str]:
    """Sentences on elements that are too long for the forces estimated before any solve (manual: sec-mesh-forces)."""
    case, mesh = model.case, model.mesh
    if case.hold_string:
        return []
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
    lines = _ranged(model, long, pitch / ELEMENTS_PER_PITCH, lambda k: "the expected helix")
    return lines + _lines(model, load)


def _units(model: DrillingModel) -> System:
    return model.case.shown_units


def _of_state(model: DrillingModel, columns: list[Column], values: FloatArray) -> _Loads:
    table = dict(zip([c[0] for c in columns], values.T, strict=True))
    mesh = model.mesh
    clearance = np.full(mesh.nodes, np.inf)
    if model.well is not None and model.contact is not None:
        radius = at_nodes(0.5 * mesh.contact_diameter, 0.5 * mesh.contact_diameter)
        clearance = np.asarray(model.well.radius(mesh.node_depth + top_depth(model))) - radius
        clearance = np.maximum(clearance, 1e-3)
    stiffness = at_nodes(mesh.bending_stiffness, mesh.bending_stiffness)
    load = np.nan_to_num(table["buckling_load"]) if "buckling_load" in table else np.zeros(mesh.nodes)
    side = (
        (0.5 * load) ** 2 * np.where(np.isfinite(clearance), clearance, 0.0) / stiffness
    )  # of Dawson and Paslay
    tension = table.get("effective_tension", table["axial_force"])
    return _Loads(tension, side, clearance, table["bending_stress"])


def _lines(model: DrillingModel, load: _Loads) -> list[str]:
    return [
        *_residual(model),
        *_turns(model),
        *_supports(model, load),
        *_jumps(model, load),
        *_steps(model, load),
    ]


# ---------------------------------------------------------------------- kinds
def _residual(model: DrillingModel) -> list[str]:
    """Elements in which the stress-free shape turns by too much."""
    own = np.array([getattr(item, "curvature", 0.0) for item in model.case.string])[model.mesh.item]
    with np.errstate(divide="ignore"):
        enough = LARGEST_STRESS_FREE_TURN / own
    long = (model.mesh.length > TOLERANCE * enough) & ~model.mesh.is_joint
    return _ranged(model, long, enough, lambda k: f"a residual curvature of {own[k]:.3g} 1/m")


def _turns(model: DrillingModel) -> list[str]:
    """Elements in which the hole turns by too much."""
    if model.well is None:
        return []
    mesh, shift = model.mesh, top_depth(model)
    share = np.linspace(0.05, 0.95, 7)
    depth = mesh.upper[:, None] + share * mesh.length[:, None] + shift
    bend = np.linalg.norm(np.asarray(model.well.at(depth)[2]), axis=-1).max(axis=1)
    with np.errstate(divide="ignore"):
        enough = LARGEST_TURN / bend
    long = (mesh.length > 1.5 * enough) & ~mesh.is_joint

    def cause(k: int) -> str:
        rate, unit = display(float(bend[k]), "dogleg", _units(model))
        return f"the curvature of the hole ({rate:.3g} {unit})"

    return _ranged(model, long, enough, cause)


def _supports(model: DrillingModel, load: _Loads) -> list[str]:
    """Bending layers beside rigid items on the wall."""
    mesh = model.mesh
    if model.contact is None:
        return []
    touching = [
        b for b in mesh.bodies if b.radius > 0 and b.contact_length
    ]  # a bit, at one point, passes no moment to the hole
    ends = sorted({b.node for b in touching})
    out: list[str] = []
    for b in touching:
        others = [n for n in [0, *ends, mesh.nodes - 1] if n != b.node]
        distance = min(
            (abs(float(mesh.node_depth[n] - mesh.node_depth[b.node])) for n in others), default=np.inf
        )
        line = _beside(model, load, b.node, distance, f"beside {b.name} at MD")
        out += [line] if line and line not in out else []
    return _first(out)


def _jumps(model: DrillingModel, load: _Loads) -> list[str]:
    """Bending layers beside jumps of the hole's curvature."""
    well, mesh = model.well, model.mesh
    if well is None or model.contact is None:
        return []
    shift = top_depth(model)
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
    return _first([line for line in dict.fromkeys(lines) if line])


def _steps(model: DrillingModel, load: _Loads) -> list[str]:
    """Bending layers beside steps of the clearance: of the pipe's diameter, or of the hole's."""
    well, mesh = model.well, model.mesh
    if well is None or model.contact is None:
        return []
    place = mesh.node_depth[1:-1] + top_depth(model)
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
    return _first([line for line in dict.fromkeys(lines) if line])


def _stress_by_moment(model: DrillingModel) -> FloatArray:
    """Bending stress over bending moment (n,) [1/m3] of the elements; zero without a section."""
    mesh = model.mesh
    section = np.pi / 64 * (mesh.outer_diameter**4 - mesh.inner_diameter**4)
    return np.divide(0.5 * mesh.outer_diameter, section, out=np.zeros(len(section)), where=section > 0)


# ---------------------------------------------------------------------- sentences
def _beside(
    model: DrillingModel, load: _Loads, node: int, distance: float, where: str, height: float | None = None
) -> str | None:
    """Sentence on the elements at ``node`` where they are too long for the bending layer there, else None.

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
    scale, _, unit = display_unit("length", _units(model))
    depth = (float(mesh.node_depth[node]) + top_depth(model)) / scale
    size = f"about {100 * error:.2g} %" if error < 0.3 else "30 % and more"
    return (
        f"elements of {length / scale:.3g} {unit} {where} {depth:.0f} {unit} leave {size} in the bending moment, and make side forces "
        f"and their friction too large: "
        f"element_length of {enough / scale:.2g} {unit} or less there ({instead_of_length(model.case)})"
    )


def _ranged(
    model: DrillingModel, long: np.ndarray, enough: FloatArray, cause: Callable[[int], str]
) -> list[str]:
    """A sentence for each range of neighbouring elements in ``long`` (n,); ``enough``: what would do (n,) [m]."""
    mesh, shift, out = model.mesh, top_depth(model), []
    scale, _, unit = display_unit("length", _units(model))
    edges = np.flatnonzero(np.diff(np.concatenate([[0], long.astype(int), [0]])))
    for a, b in zip(edges[::2], edges[1::2], strict=True):
        worst = a + int(np.argmin(enough[a:b]))
        out.append(
            f"elements of {mesh.length[a:b].max() / scale:.3g} {unit} from MD {(mesh.upper[a] + shift) / scale:.0f} to "
            f"{(mesh.lower[b - 1] + shift) / scale:.0f} {unit} are too long for {cause(worst)}: element_length of "
            f"{enough[worst] / scale:.2g} {unit} or less ({instead_of_length(model.case)})"
        )
    return _first(out)


def _first(lines: Iterable[str]) -> list[str]:
    """The first ``MOST_LINES`` sentences, and how many more there are."""
    every = list(lines)
    rest = len(every) - MOST_LINES
    return every if rest <= 0 else [*every[:MOST_LINES], f"... and {rest} more places with too long elements"]


def too_coarse(model: DrillingModel) -> bool:
    """Whether an element is above the limit of ``coarse_elements``."""
    return bool(coarse_elements(model).any())


def coarse_elements(model: DrillingModel) -> np.ndarray:
    """Find the elements (n,) with L^3 > 240 EI/w (manual: eq-beam-length-limit).

    The bending stiffness of such an element does not balance the axial load of its own weight w per length.
    """
    mesh = model.mesh
    w = mesh.mass * np.linalg.norm(model.case.gravity)
    return mesh.length**3 * w > 240 * mesh.bending_stiffness
