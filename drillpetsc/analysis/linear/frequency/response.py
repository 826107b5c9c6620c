"""The `response` command: harmonic response to unbalance or to an excitation at the bit, over rotary speeds.

Manual: sec-response.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from drillpetsc.analysis.linear.doubts import Responded
from drillpetsc.analysis.linear.frequency.harmonic import (
    Response,
    SectionForces,
    motion_at,
    orbit_load,
    respond,
    rock_load,
    section_forces,
    steady_forces,
    stresses,
    turning_load,
)
from drillpetsc.analysis.linear.frequency.stokes import StokesForces, present
from drillpetsc.analysis.linear.frequency.turning import TurningModel, turning_case
from drillpetsc.analysis.linear.linearised_model import linearise_model
from drillpetsc.analysis.motion.run_options import options_of
from drillpetsc.arrays import FloatArray
from drillpetsc.case.case import Case
from drillpetsc.case.options.excitation import Excitation
from drillpetsc.doubts import doubts_at
from drillpetsc.errors import CaseError, SolveError
from drillpetsc.fem.string_mesh import StringMesh
from drillpetsc.geometry.frames import two_across
from drillpetsc.model.drilling_model import DrillingModel, build_model
from drillpetsc.output.files.run_folder import RESPONSE_TABLE
from drillpetsc.output.job import Job, RunResult
from drillpetsc.output.measured.flow_recorder import flow_recorder
from drillpetsc.output.progress import counted
from drillpetsc.output.quantities.tables import COLUMNS
from drillpetsc.parallel import first_rank_gives, total
from drillpetsc.physics.tools.mud_motor import MudMotor
from drillpetsc.solvers.linear.linearization import Linearised
from drillpetsc.unit_systems import display_unit, shown

RPM = 2 * np.pi / 60
PHASES = np.exp(2j * np.pi * np.arange(48) / 48)  # of a period, at which clearances are checked
LEAST_ORBIT = 1e-3  # angular frequency of a rotor's orbit that is none [rad/s]
LEAST = 1e-10  # amplitude that is shown as 0 [SI]
SMALL = 1e-6  # share of the largest amplitude below which a motion is rounding


def rpm_of(speed: float) -> float:
    """Revolutions per minute of a speed [rad/s], without the rounding of the conversion."""
    return float(f"{speed / RPM:.10g}")


def case_rpm(case: Case, time: float = 0.0) -> float:
    """Rotation of the case at a time [s] [rpm], 0 without one."""
    return rpm_of(case.top.rotation.value(time)) if case.top.rotation is not None else 0.0


@dataclass(frozen=True)
class Place:
    """A named place: ``arm`` [m] below a node, on a rigid item."""

    name: str
    node: int
    md: float
    arm: float = 0.0


def places(model: DrillingModel) -> list[Place]:
    """Top, probes (at their nearest nodes), rigid items and the lower end, in order of depth."""
    mesh = model.mesh
    found = [Place("top", 0, float(mesh.node_depth[0]))]
    for depth in model.case.output.probes:
        node = mesh.nearest_node(depth)
        found.append(
            Place(
                f"probe {shown(depth, 'length', model.case.shown_units, 6)}",
                node,
                float(mesh.node_depth[node]),
            )
        )
    for b in mesh.bodies:
        arm = b.contact_above + 0.5 * b.contact_length
        found.append(Place(b.name or b.kind, b.node, float(mesh.node_depth[b.node] + arm), arm))
    if not any(b.kind == "bit" and b.node == mesh.nodes - 1 for b in mesh.bodies):
        arm = mesh.total_length - float(mesh.node_depth[-1])
        found.append(Place("lower end", mesh.nodes - 1, mesh.total_length, arm))
    seen, out = dict[str, int](), []
    for place in sorted(found, key=lambda p: p.md):
        seen[place.name] = seen.get(place.name, 0) + 1
        number = seen[place.name]
        out.append(replace(place, name=place.name if number == 1 else f"{place.name} {number}"))
    return out


# ---------------------------------------------------------------------- clearances
@dataclass(frozen=True)
class Gaps:
    """Points of the string that can touch the wall.

    node: (k,); arm: (k,) distance below the node [m]; offset: (k, 3) from the axis of the hole in the state [m];
    gap: (k,) radial clearance [m].
    """

    node: np.ndarray
    arm: FloatArray
    offset: FloatArray
    gap: FloatArray


def gaps(model: DrillingModel, position: FloatArray, slope: FloatArray) -> Gaps | None:
    """Points at the nodes and at rigid items, from positions and slopes (n, 3) of all nodes; None without contact."""
    if model.contact is None:
        return None
    mesh = model.mesh
    radius = np.zeros(mesh.nodes)
    np.maximum.at(radius, np.arange(mesh.nodes - 1), 0.5 * mesh.contact_diameter)
    np.maximum.at(radius, np.arange(1, mesh.nodes), 0.5 * mesh.contact_diameter)
    bodies = [b for b in mesh.bodies if b.radius > 0]
    node = np.concatenate([np.arange(mesh.nodes), [b.node for b in bodies]]).astype(int)
    arm = np.concatenate([np.zeros(mesh.nodes), [b.contact_above + 0.5 * b.contact_length for b in bodies]])
    radius = np.concatenate([radius, [b.radius for b in bodies]])
    direction = slope / np.linalg.norm(slope, axis=1, keepdims=True)
    foot = model.contact.well.project(position[node] + arm[:, None] * direction[node])
    used = radius > 0
    return Gaps(node[used], arm[used], foot.offset[used], (np.asarray(foot.radius) - radius)[used])


# ---------------------------------------------------------------------- rows of the table
@dataclass
class _Shape:
    """What does not change with the speed, on rank 0."""

    mesh: StringMesh
    places: list[Place]
    axes: FloatArray
    """(n, 3, 3) rows: two directions across the string and the tangent, right-handed."""
    slope: FloatArray
    gaps: Gaps | None
    clearance: FloatArray
    """(places,) [m], nan without a hole."""
    fields: list[str]
    """Names of the unknowns."""


@dataclass(frozen=True)
class _Shaken:
    """The response at one rotary speed and frequency [rad/s], on rank 0.

    values: amplitudes of position, tangent and spin at the nodes.  forces: amplitudes, None if they are infinite.
    steady: forces of the steady state, with which stresses are added, None without stresses.
    """

    shape: _Shape
    values: dict[str, np.ndarray]
    found: Response
    forces: SectionForces | None
    steady: SectionForces | None
    speed: float
    omega: float


def _shape(model: DrillingModel) -> _Shape | None:
    """Collect positions, directions and gaps in the state; None away from rank 0; collective."""
    system, found = model.system, places(model)
    both = system.gather(np.hstack([system.field("string.position"), system.field("string.tangent")]))
    if both is None:
        return None
    position, slope = both[:, :3], both[:, 3:]
    t = slope / np.linalg.norm(slope, axis=1, keepdims=True)
    axes = np.stack([*two_across(t), t], axis=1)
    around = gaps(model, position, slope)
    clearance = np.full(len(found), np.nan)
    if around is not None:
        for k, place in enumerate(found):
            at = np.flatnonzero(around.node == place.node)
            if len(at):
                nearest = at[np.argmin(np.abs(around.arm[at] - place.arm))]
                clearance[k] = around.gap[nearest] if around.gap[nearest] > 0 else np.nan
    fields = [f.name for f in system.layout.fields]
    return _Shape(model.mesh, found, axes, slope, around, clearance, fields)


def _validity(shape: _Shape, position: np.ndarray, slope: np.ndarray) -> tuple[str, float]:
    """Word for the linear result, and the measured depth [m] of the worst place; nan where it is linear.

    A point without clearance has a spring on all sides: it neither touches nor lifts.
    """
    g = shape.gaps
    if g is None:
        return "linear", np.nan
    t = shape.axes[g.node, 2]
    length = np.linalg.norm(shape.slope[g.node], axis=1, keepdims=True)
    tilt = slope[g.node] / length
    tilt = tilt - t * np.sum(t * tilt, axis=1, keepdims=True)
    u = position[g.node] + g.arm[:, None] * tilt
    u = u - t * np.sum(t * u, axis=1, keepdims=True)
    size = np.linalg.norm(g.offset, axis=1)
    open_all_round = g.gap > 0
    closed = size > g.gap
    moving = g.offset[None] + (u[None] * PHASES[:, None, None]).real
    reach = np.linalg.norm(moving, axis=2).max(axis=0) - g.gap
    reach[closed | ~open_all_round] = -np.inf
    closed = closed & open_all_round
    md = shape.mesh.node_depth[g.node] + g.arm
    if len(reach) and reach.max() > 0:
        return "touches", float(md[reach.argmax()])
    if closed.any():
        normal = g.offset[closed] / size[closed, None]
        opened = np.abs(np.sum(u[closed] * normal, axis=1)) - (size - g.gap)[closed]
        if opened.max() > 0:
            return "lifts", float(md[closed][opened.argmax()])
    return "linear", np.nan


def _degrees(value: complex, size: float) -> float:
    return float(np.degrees(np.angle(value))) if abs(value) > SMALL * size and np.isfinite(value) else 0.0


def _values(shape: _Shape, linearised: Linearised, found: Response) -> dict[str, np.ndarray]:
    """Amplitudes of position, tangent and spin at the nodes."""
    return {
        name: linearised.field_values(shape.fields.index(name), found.u[:, None], shape.mesh.nodes, size)[0]
        for name, size in (("string.position", 3), ("string.tangent", 3), ("string.spin", 1))
    }


def _rows(at: _Shaken, word: str) -> list[list[Any]]:
    """Rows of the table at one speed.  word: validity of the response."""
    out: list[list[Any]] = []
    shape, values, found, forces, steady = at.shape, at.values, at.found, at.forces, at.steady
    speed, frequency = at.speed, at.omega / (2 * np.pi)
    for k, place in enumerate(shape.places):
        tilt = values["string.tangent"][place.node] / np.linalg.norm(shape.slope[place.node])
        local = shape.axes[place.node] @ values["string.position"][place.node]
        local[:2] += place.arm * (shape.axes[place.node][:2] @ tilt)
        forward, backward = 0.5 * (local[0] + 1j * local[1]), 0.5 * (local[0] - 1j * local[1])
        large, small = abs(forward) + abs(backward), abs(forward) - abs(backward)
        twist = values["string.spin"][place.node, 0]
        size = float(np.abs(local).max())
        head = [rpm_of(speed), frequency, place.name, place.md]
        if word == "infinite" or forces is None:
            infinite = [np.inf if v > SMALL else 0.0 for v in _shares(found, values, place, local, twist)]
            lateral, axial, turning = infinite
            out.append([*head, lateral, 0.0, 0.0, axial, 0.0, turning, 0.0, axial, turning, lateral,
                        lateral / shape.clearance[k] if np.isfinite(shape.clearance[k]) else np.nan, word])  # fmt: skip
            if steady is not None:
                out[-1] += [np.nan] * (len(COLUMNS[RESPONSE_TABLE]) - len(out[-1]))
            continue
        cell, end = (place.node - 1, 1) if place.node else (0, 0)
        while cell > 0 and np.isclose(shape.mesh.length[cell], 0.0):
            cell -= 1
        moment = forces.moment[cell, end]
        across = shape.axes[place.node][:2] @ moment
        largest = abs(0.5 * (across[0] + 1j * across[1])) + abs(0.5 * (across[0] - 1j * across[1]))
        whirl = small / large if large > SMALL * max(size, 1e-300) else 0.0
        out.append([
            *head, large, _degrees(forward if abs(forward) >= abs(backward) else backward, size), whirl,
            abs(local[2]), _degrees(local[2], size), abs(twist), _degrees(twist, abs(twist)),
            abs(forces.tension[cell, end]), abs(forces.torque[cell]), largest,
            large / shape.clearance[k], word,
        ])  # fmt: skip
        if steady is not None:
            axes, turning = shape.axes[place.node], 2 * np.pi * frequency
            out[-1] += stresses(shape.mesh, place.node, axes, forces, steady, turning, speed)
    return out


def _shares(found: Response, values, place: Place, local: np.ndarray, twist: complex) -> list[float]:
    """Lateral, axial and torsional motion at a place as shares of the largest of the response."""
    with np.errstate(invalid="ignore"):
        position = float(np.abs(values["string.position"]).max()) or 1.0
        spin = float(np.abs(values["string.spin"]).max()) or 1.0
        shares = [
            np.linalg.norm(local[:2]) / position,
            abs(local[2]) / position,
            abs(twist) / spin * (spin > SMALL * position),
        ]
    return [1.0 if np.isnan(q) else float(q) for q in shares]


# ---------------------------------------------------------------------- command
def run_response(
    job: Job,
    excitation: Excitation,
    speeds: tuple[float, ...],
    without_control: bool = False,
    stress: bool = False,
) -> RunResult:
    """Compute the harmonic response at rotary speeds [rad/s]; collective.

    without_control: leave out motor and controller, and hold the top at the rotation.
    stress: add the stresses of the turning pipe to the table.

    Raises CaseError for wrong arguments, SolveError if no state is found.
    """
    case, comm = job.case, job.comm
    turning = turning_case(case, "response", without_control)
    with options_of(case):
        states = TurningModel(turning, comm, balanced=True)
        model = states.model
        asymmetric = build_model(turning, comm) if excitation.kind == "unbalance" else None
        if asymmetric is not None:
            _demand_asymmetry(asymmetric)
        if excitation.kind == "motor" and not any(m.rotor.unbalance > 0 for m in model.parts(MudMotor)):
            want = "a pdm with rotor_mass, eccentricity and lobes, which the case does not have"
            raise CaseError(at="--excite", got="motor", want=want)
        folder = job.make_folder()
        mud = flow_recorder(model)
        table: list[list[Any]] = []
        notes: list[str] = []
        valid: list[tuple[str, float]] = []
        losses: list[float] = []
        warnings: list[str] = []
        for speed in counted(speeds, "speeds", comm.rank):
            state = states.at(speed)
            warnings += [w for w in state.warnings if w not in warnings]
            load, omega = _load(model, excitation, asymmetric, speed)
            wob = _weight_on_bit(model)
            if present(model):  # unbalance turns forward
                StokesForces(model).set_frequency(omega, 0.0 if asymmetric is None else 1.0)
            shape, linearised = _shape(model), linearise_model(model)
            answer = _answer(model, linearised, excitation, omega, load)
            forces = None if answer.infinite else section_forces(model, mud, answer.u, omega)
            steady = steady_forces(model, mud) if stress else None
            if shape is None or linearised is None:
                continue
            values = _values(shape, linearised, answer)
            at = _Shaken(shape, values, answer, forces, steady, speed, omega)
            word, md = _holds(at, wob)
            if not answer.infinite:
                losses.append(_loss(answer, linearised, omega))
            valid.append((word, md))
            table += _rows(at, word)
        closed = _closed_contacts(model)
        if comm.rank == 0:
            notes = doubts_at(
                Responded(
                    model=model,
                    excitation=excitation,
                    speeds=speeds,
                    validity=valid,
                    losses=losses,
                    closed=closed,
                )
            )
        table, notes, valid = (
            comm.tompi4py().bcast((table, notes, valid)) if comm.size > 1 else (table, notes, valid)
        )
        summary = {
            "title": case.title,
            "excitation": excitation.words(case.said_units),
            "order": None if excitation.kind == "motor" else excitation.order,
            "speeds": [rpm_of(s) for s in speeds],
            "validity": [word for word, _ in valid],
            "peaks": _peaks(table),
            "static_solutions": states.solved,
            "warnings": [*notes, *warnings],
        }
    return job.result(folder, summary, _lines(case, summary), {RESPONSE_TABLE: table})


def _load(
    model: DrillingModel, excitation: Excitation, asymmetric: DrillingModel | None, speed: float
) -> tuple[np.ndarray | None, float]:
    """Load of the excitation, None if ``_respond`` makes it, and its angular frequency [rad/s], at a rotary speed [rad/s]."""
    omega = excitation.order * speed
    if asymmetric is not None:
        return turning_load(model, asymmetric), omega
    if excitation.kind == "motor":
        load, omega = orbit_load(model)
        if omega < LEAST_ORBIT:
            raise SolveError(
                f"at {rpm_of(speed):g} rpm the motor's rotor does not orbit, so it excites nothing"
            )
        return load, omega
    if excitation.kind == "bit" and excitation.what == "displacement" and model.bit is not None:
        return rock_load(model, excitation.amplitude, omega), omega
    return None, omega


def _answer(
    model: DrillingModel,
    linearised: Linearised | None,
    excitation: Excitation,
    omega: float,
    load: np.ndarray | None,
) -> Response:
    """The response, which the first rank computes, on all ranks; collective."""

    def respond() -> Response:
        assert linearised is not None  # the first rank has it
        return _respond(model, linearised, excitation, omega, load)

    found: Response = first_rank_gives(model.system.comm.tompi4py(), respond)
    return found


def _holds(at: _Shaken, wob: float | None) -> tuple[str, float]:
    """Whether the response is linear, as in the table, and where it is not first [m]; nan for nowhere.

    wob: weight on bit of the steady state [N], None without a bit on bottom.
    """
    if at.found.infinite:
        return "infinite", np.nan
    word, md = _validity(at.shape, at.values["string.position"], at.values["string.tangent"])
    lifts = wob is not None and at.forces is not None and abs(at.forces.tension[-1, 1]) > wob
    return ("lifts", at.shape.mesh.total_length) if word == "linear" and lifts else (word, md)


def _demand_asymmetry(model: DrillingModel) -> None:
    """Raise CaseError for a string without anything that could excite it."""
    mesh = model.mesh
    if not (mesh.eccentricity.any() or mesh.curvature.any() or any(any(b.offset) for b in mesh.bodies)):
        raise CaseError(
            at="--excite", got="unbalance",
            want="a string with an unbalance, eccentricity, bend or curvature, which the case does not have",
        )  # fmt: skip


def _respond(
    model: DrillingModel,
    linearised: Linearised,
    excitation: Excitation,
    omega: float,
    load: np.ndarray | None,
) -> Response:
    """The response on rank 0."""
    if load is not None:
        return respond(linearised, omega, load)
    node = model.mesh.nodes - 1
    if excitation.kind == "place":
        node = int(np.argmin(np.abs(model.mesh.node_depth - excitation.md)))
    end, f = motion_at(model, linearised, node), np.zeros(len(linearised.scale), dtype=complex)
    if excitation.what == "displacement":
        return respond(linearised, omega, f, (end.position, end.tangent, excitation.amplitude))
    # a force on the string is a negative part of its residual
    if excitation.what == "force":
        f[end.position] = -excitation.amplitude * end.tangent
    else:
        f[end.spin] = -excitation.amplitude
    return respond(linearised, omega, f)


def _weight_on_bit(model: DrillingModel) -> float | None:
    """Weight on bit [N] in the state; None without a bit on bottom; collective."""
    if model.bit is None:
        return None
    return max(float(total(model.system.comm, model.bit.weight_and_torque(model.system.assembly)[0])), 0.0)


def _loss(found: Response, system: Linearised, omega: float) -> float:
    """Dissipated over exchanged power [-]."""
    u = found.u
    exchanged = abs(np.vdot(u, system.K @ u)) + omega**2 * abs(np.vdot(u, system.M @ u))
    return abs(float(np.vdot(u, found.rows).imag)) / max(float(exchanged), 1e-300)


def _closed_contacts(model: DrillingModel) -> int:
    """Number of nodes and items whose contact is closed in the state; collective."""
    shape = _shape(model)
    count = 0
    if shape is not None and shape.gaps is not None:
        touching = np.linalg.norm(shape.gaps.offset, axis=1) > shape.gaps.gap
        count = int((touching | (shape.gaps.gap <= 0)).sum())
    return count


PEAKED = (4, 7, 9, 11, 12, 13, 16, 17)  # columns of amplitudes


def _peaks(table: list[list[Any]]) -> list[dict[str, Any]]:
    """Largest amplitudes at each place, with their speeds [rpm]."""
    peaks: dict[str, dict[str, Any]] = {}
    for row in table:
        entry = peaks.setdefault(row[2], {"place": row[2], "md": row[3]})
        for k in PEAKED:
            if k >= len(row):
                continue
            column = COLUMNS[RESPONSE_TABLE][k].name
            if row[k] > entry.get(column, (-1.0, 0.0))[0]:
                entry[column] = (row[k], row[0])
    return list(peaks.values())


SHOWN = (
    ("lateral_amplitude", "lateral", "diameter"),
    ("axial_amplitude", "axial", "diameter"),
    ("axial_force_amplitude", "axial force", "force"),
    ("torque_amplitude", "torque", "torque"),
    ("bending_moment_amplitude", "bending", "torque"),
    ("stress_amplitude", "stress", "stress"),
)


def _lines(case: Case, summary: dict[str, Any]) -> list[str]:
    """Return the lines to show: largest amplitudes by place."""
    speeds, system = summary["speeds"], case.shown_units
    found = {name for entry in summary["peaks"] for name in entry}
    shown = [q for q in SHOWN if q[0] in found]
    units = [display_unit(kind, system) for _, _, kind in shown]
    span = f"{len(speeds)} speeds from {speeds[0]:g} to {speeds[-1]:g} rpm"
    titles = [f"{words} [{unit[2]}]" for (_, words, _), unit in zip(shown, units, strict=True)]
    size, _, text = display_unit("length", system)
    lines = [
        f"{case.title or 'case'}: response to {summary['excitation']}, "
        + (span if len(speeds) > 1 else f"{speeds[0]:g} rpm"),
        "  largest amplitudes (at rpm)    " + " ".join(f"{title:>20}" for title in titles),
    ]
    for entry in summary["peaks"]:
        cells = []
        for (name, _, _), unit in zip(shown, units, strict=True):
            value, rpm = entry.get(name, (np.nan, 0.0))
            number = "infinite" if np.isinf(value) else f"{value / unit[0]:.4g}"
            cells.append(f"{f'{number} ({rpm:g})' if value > LEAST else '-' if np.isnan(value) else '0':>20}")
        lines.append(f"  {entry['place'][:18]:<18} {entry['md'] / size:>8.1f} {text:<3}{' '.join(cells)}")
    return lines
