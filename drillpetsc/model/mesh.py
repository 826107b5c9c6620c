"""From the string items of a case to the string mesh: elements, nodes, rigid items, joints."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterable
from dataclasses import dataclass, replace
from itertools import takewhile
from pathlib import Path
from typing import Any

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.case.block import by_names
from drillpetsc.case.blocks.ends import PointLoad
from drillpetsc.case.blocks.items.joints import Joint
from drillpetsc.case.blocks.items.motor import PositiveDisplacementMotor
from drillpetsc.case.blocks.items.steering import PushSteering, RotarySteerable
from drillpetsc.case.blocks.items.string import Bend, Bit, Flexible, Item, Rigid, Stabilizer
from drillpetsc.case.blocks.items.tools import Jar, JarSection, ShockSub, TelescopingTool
from drillpetsc.case.blocks.settings import STARTS
from drillpetsc.case.case import Case
from drillpetsc.case.checks.limits import element_count
from drillpetsc.errors import CaseError
from drillpetsc.fem.string_mesh import BentCell, JarLaw, RigidItem, StringJoint, StringMesh
from drillpetsc.geometry.frames import Frames, axial_curvature
from drillpetsc.geometry.well import Well
from drillpetsc.model.element_length import ElementLengths, choose_lengths
from drillpetsc.model.hole import build_well
from drillpetsc.model.item_section import section_of
from drillpetsc.model.string_forces import StringForces, estimate_forces
from drillpetsc.unit_systems import System, shown

BEND_LENGTH = 0.5  # the kink of a bent sub is distributed over an element of this length [m] (manual: sec-junctions-bend)
NODE_TOLERANCE = 1e-6  # depths closer than this are one node [m]; relative beyond 1 m

JAR_ROUNDING = 1e-5  # length over which the stop of a jar sets in [m]


@dataclass(frozen=True)
class MeshOf:
    """The mesh of a case, whose elements nearly the same case takes over: as many, ending at the same share of an item."""

    case: Case
    mesh: StringMesh

    def edges(self, case: Case) -> dict[int, list[float]]:
        """Depths of the element ends of each flexible item of ``case`` [m]; raises CaseError if the elements do not correspond."""
        out, before, after = {}, self._marks(self.case), self._marks(case)
        for number, marks in after.items():
            mine = (self.mesh.item == number) & ~self.mesh.is_joint
            own = np.append(self.mesh.upper[mine], self.mesh.lower[mine][-1:])
            if len(marks) != len(before.get(number, ())):
                want = "a value at which no two places of the string, such as a load and the end of an item, fall together"
                raise CaseError(at=f"string[{number}]", got=case.string[number].name, want=want)
            out[number] = [float(q) for q in np.interp(own, before[number], marks)]
            out[number][0], out[number][-1] = marks[0], marks[-1]
        return out

    @staticmethod
    def _marks(case: Case) -> dict[int, list[float]]:
        """Depths of each flexible item at which elements must end [m]."""
        depths, places = case.item_depths, _places(case)
        return {
            i: _edges(case, i, item.model_copy(update={"element_length": "auto"}), depths[i], places)
            for i, item in enumerate(case.string)
            if isinstance(item, Flexible)
        }


def build_mesh(
    case: Case,
    well: Well | None = None,
    motion: tuple[float, float] | None = None,
    like: MeshOf | None = None,
) -> StringMesh:
    """Mesh the string of ``case``, with nodes at item ends, at point loads, at joints and by element_length.

    ``curvature_by_tool_face`` completes the stress-free curvature when the frames of the nodes are known.

    well: the hole, None: the hole of the case.
    motion: axial speed [m/s, down positive] and rotation [rad/s] of a static problem, for which automatic
    lengths are chosen; None: the motion of the case.
    like: the mesh of nearly the same case, whose elements are taken.
    Raises CaseError if no item of the string is flexible, or a bend is right below a joint.
    """
    if not any(isinstance(item, Flexible) for item in case.string):
        raise CaseError(
            at="string",
            want="at least one flexible item (pipe or beam)",
            hint="rigid items alone have no element",
        )
    rows: list = []
    rigid: list = []
    tops: dict[int, int] = {}  # cell at the upper end of each flexible item
    pending: list = []
    joints: list[StringJoint] = []
    remaining = sorted(_joints(case), key=lambda j: j.depth)
    if like is None:
        item_edges, lengths = _element_ends(case, well, motion)
    else:
        item_edges, lengths = like.edges(case), ElementLengths({})

    def add_joint(item, depth: float) -> None:
        """Add the joint at ``depth`` [m], if there is one, as a row without length below the pending rigid items."""
        if remaining and abs(remaining[0].depth - depth) <= NODE_TOLERANCE * max(1.0, depth):
            joint = remaining.pop(0)
            joints.append(replace(joint, cell=len(rows)))
            rows.append((-1, item, depth, depth, sum(q.length for _, q in pending)))
            pending.clear()

    for number, (item, (top, _)) in enumerate(zip(case.string, case.item_depths, strict=True)):
        add_joint(item, top)
        if isinstance(item, Flexible):
            edges = item_edges[number]
            tops[number] = len(rows)
            for k, (a, b) in enumerate(zip(edges, edges[1:], strict=False)):
                if k:
                    add_joint(item, a)
                rows.append((number, item, a, b, sum(q.length for _, q in pending)))
                pending.clear()  # a joint further down has no rigid item above it
        else:
            rigid.append((number, item, len(rows), sum(q.length for _, q in pending)))
            pending.append((number, item))
    mesh = replace(_assemble(case, rows, rigid, tops, tuple(joints)), limited=lengths.limited)
    # pipes of one size share their strain at the node between them: a small change of one of them adds no unknown
    return mesh if like is None else replace(mesh, junction=like.mesh.junction)


def coarsened(case: Case, factor: float) -> Case:
    """The case with elements ``factor`` times as long; an item keeps at least one element."""
    items = [
        item.model_copy(update={"element_length": min(factor * item.element_length, item.length)})
        if isinstance(item, Flexible) and not isinstance(item.element_length, str)
        else item
        for item in case.string
    ]
    mesh = case.mesh.model_copy(update={"refinement": case.mesh.refinement / factor})
    return case.model_copy(update={"string": tuple(items), "mesh": mesh})


def element_lengths(case: Case, well: Well | None = None) -> ElementLengths:
    """Automatic element lengths of ``case`` with their reasons; arguments as in ``build_mesh``."""
    return _element_ends(case, well, None)[1]


def string_forces(case: Case, well: Well | None) -> StringForces:
    """Forces along the string estimated before any solve (manual: sec-mesh-forces)."""
    sections = {
        i: _section(item, case.said_units) for i, item in enumerate(case.string) if isinstance(item, Flexible)
    }
    return estimate_forces(case, well, sections, None)


def _element_ends(
    case: Case, well: Well | None, motion: tuple[float, float] | None
) -> tuple[dict[int, list[float]], ElementLengths]:
    """Depths of the element ends of each flexible item [m] by its number, and the automatic ones with reasons."""
    given: dict[int, list[float]] = {}
    marks: dict[int, list[float]] = {}
    flexible = {i: item for i, item in enumerate(case.string) if isinstance(item, Flexible)}
    depths = (
        case.item_depths
    )  # worked out at every call, as are the places at which all items may have to end
    places = _places(case)
    for number, item in flexible.items():
        ends = _edges(case, number, item, depths[number], places)
        (marks if isinstance(item.element_length, str) else given)[number] = ends
    if not marks:
        return given, ElementLengths({})
    earlier = _depths_of_run(case)
    if earlier is not None:
        edges = {i: _with_depths(m, earlier) for i, m in marks.items()}
        return {**given, **edges}, ElementLengths(edges)
    sections = {i: _section(item, case.said_units) for i, item in flexible.items()}
    lengths = choose_lengths(case, well or build_well(case), sections, marks, given, motion)
    return {**given, **lengths.edges}, lengths


def _places(case: Case) -> list[float]:
    """Depths of point loads and joints along the string [m]."""
    at_loads = [load.at for load in case.loads if isinstance(load, PointLoad)]
    return at_loads + [joint.at for joint in case.all_joints]


def _depths_of_run(case: Case) -> FloatArray | None:
    """Measured depths of the nodes [m] of the run that ``case`` starts from; None for another start.

    A run that starts from another one has its mesh, whatever the loads of the new case require.
    """
    if case.initial.from_ in STARTS:
        return None
    import h5py

    try:
        with h5py.File(Path(case.initial.from_) / "checkpoint.h5", "r") as file:
            return np.array(file["depths"])
    except (OSError, KeyError):  # the reader of checkpoints reports what is wrong with the file
        return None


def _with_depths(marks: list[float], depths: FloatArray) -> list[float]:
    """``marks`` with the ``depths`` [m] between the first and the last."""
    tolerance = NODE_TOLERANCE * max(1.0, marks[-1])
    inside = depths[(depths > marks[0] + tolerance) & (depths < marks[-1] - tolerance)]
    known = np.array(marks)
    new = [float(d) for d in inside if np.abs(known - d).min() > tolerance]
    return sorted([*marks, *new])


def _joints(case: Case) -> list[StringJoint]:
    """Joints of the case and of its tools, their cells not yet known."""
    tools = [_joint(joint, item, number) for number, item, joint in case.tools]
    motor = [
        StringJoint(joint.at, "revolute", -1, joint.axes, item=number, driven=True)
        for number, joint in case.motor_joints
    ]
    return [*(_joint(joint) for joint in case.joints), *tools, *motor]


def _joint(joint: Joint, tool: TelescopingTool | None = None, number: int = -1) -> StringJoint:
    """The joint of the mesh; ``tool``: the item that it belongs to, with its number."""
    preload, torsion = 0.0, None
    if isinstance(tool, ShockSub):
        preload, torsion = tool.preload, tool.torsion_stiffness
    made = StringJoint(
        depth=joint.at,
        cell=-1,
        stabilised=joint.constraint == "stabilised",
        preload=preload,
        torsion_spring=torsion or 0.0,
        stop_rounding=JAR_ROUNDING if isinstance(tool, Jar) else None,
        jar=_latch(tool.jar, number) if isinstance(tool, Jar) else None,
        **by_names(StringJoint, joint),
    )
    return made if torsion is None else replace(made, kind="torsion_slider")


def _latch(jar: JarSection, number: int) -> JarLaw:
    """The latch of a jar, which is as stiff as its stops."""
    return JarLaw(
        jar.latch_load,
        jar.metering_stroke,
        jar.metering_resistance or 0.0 if jar.metering_stroke > 0 else 0.0,
        jar.stop_stiffness,
        jar.direction != "down",
        jar.direction != "up",
        number,
    )


def _bend_of(item: Item) -> Bend | None:
    bend = item.bend
    return bend if bend is not None and bend.angle != 0 else None


def _kink_zone(item: Flexible, top: float, bottom: float) -> tuple[float, float]:
    """Depths [m] between which the kink of a flexible item from ``top`` to ``bottom`` [m] is distributed.

    Below the item's upper end, or about the position of the kink.
    """
    bend = item.bend
    if bend is None or bend.position is None or bend.position >= item.length:
        return top, min(top + BEND_LENGTH, bottom)
    upper = min(max(bottom - bend.position - 0.5 * BEND_LENGTH, top), max(bottom - BEND_LENGTH, top))
    return upper, min(upper + BEND_LENGTH, bottom)


def steering_zone(item: RotarySteerable, top: float, bottom: float) -> tuple[float, ...]:
    """Depth of the pads [m]; or the depths between which the tilt of a shaft is distributed, like a kink."""
    if isinstance(item.rss, PushSteering):
        return (bottom - item.place,)
    upper = min(max(bottom - item.place - 0.5 * BEND_LENGTH, top), max(bottom - BEND_LENGTH, top))
    return upper, min(upper + BEND_LENGTH, bottom)


def _bent_after(items: Iterable[Item]) -> bool:
    """Whether one of the rigid items at the beginning of ``items`` has a bend."""
    return any(_bend_of(q) for q in takewhile(lambda q: isinstance(q, Rigid), items))


def _edges(
    case: Case, number: int, item: Flexible, ends: tuple[float, float], places: list[float]
) -> list[float]:
    """Compute the measured depths [m] of the element ends of a flexible item between its ``ends`` [m].

    Depths at which elements of an item with automatic lengths must end.

    places: of loads and joints of the whole string [m].
    """
    (top, bottom), string = ends, case.string
    count = max(1, element_count(item))
    edges = [top, bottom] if count == 1 else list(np.linspace(top, bottom, count + 1))
    extra: list[float] = []
    if _bend_of(item) and item.length > 2 * BEND_LENGTH:
        extra += [at for at in _kink_zone(item, top, bottom) if top < at < bottom]
    # without slices, which would make the mesh of a long tally quadratic in its items
    if _bent_after(string[k] for k in range(number + 1, len(string))) and item.length > 2 * BEND_LENGTH:
        extra.append(bottom - BEND_LENGTH)
    first = not any(isinstance(string[k], Flexible) for k in range(number))
    if first and _bent_after(string[:number]) and item.length > 2 * BEND_LENGTH:
        extra.append(top + BEND_LENGTH)
    extra += [at for at in places if top < at < bottom]
    if isinstance(item, RotarySteerable):
        extra += [at for at in steering_zone(item, top, bottom) if top < at < bottom]
    # a depth at an existing element end adds no node; elements may be as short as the case gives them
    for at in extra:
        k = bisect_left(edges, at)
        if min(at - edges[k - 1], edges[k] - at) > NODE_TOLERANCE * max(1.0, at):
            edges.insert(k, at)
    return edges


def _with_sections(rows: list) -> list:
    """Give the rows of joints number and item of the element above; joints at the top take the element below.

    The section of a joint has no effect, but must be a number.
    """
    out, last = [], next((row for row in rows if row[0] >= 0), None)
    for row in rows:
        if row[0] >= 0:
            last = row
        out.append(row if row[0] >= 0 or last is None else (last[0], last[1], *row[2:]))
    return out


def _section(item: Flexible, units: System) -> dict[str, float]:
    """Section values of a flexible item; the mass of a motor's rotor is at the motor's joint."""
    values = section_of(item)
    if isinstance(item, PositiveDisplacementMotor):
        whole, rotor = values["mass"] * item.length, item.pdm.rotor_mass
        values["mass"] -= rotor / item.length
        if not values["mass"] > 0:
            want = f"less than the mass of the item, {shown(whole, 'mass', units)}"
            raise CaseError(at="string: pdm.rotor_mass", got=shown(rotor, "mass", units), want=want)
    return values


def _polar(size: float, angle: float) -> tuple[float, float]:
    """Components along the directors of a vector of ``size`` at ``angle`` [rad]."""
    return size * np.cos(angle), size * np.sin(angle)


def _bent_cells(rows, rigid, tops: dict[int, int], is_joint: np.ndarray) -> tuple[BentCell, ...]:
    """Return the stress-free curvatures of the elements (manual: sec-junctions-bend).

    is_joint: (n,) mask of the cells that are joints; the other arguments are as in ``_assemble``.
    Raises CaseError if the kink of a rigid item would be in a joint.
    """
    bent: list[BentCell] = []

    def kink(cell: int, bend: Bend) -> None:
        upper, lower = rows[cell][2:4]
        bent.append(BentCell(cell, cell, bend.angle / (lower - upper), bend.tool_face))

    for cell, (number, item, *_) in enumerate(rows):
        if not is_joint[cell] and item.curvature != 0:
            bent.append(BentCell(cell, tops[number], item.curvature, item.curvature_angle))
    for number, cell in tops.items():
        bend = _bend_of(rows[cell][1])
        if bend is None:
            continue
        if bend.position is None:
            kink(cell, bend)
            continue
        own = [k for k in range(cell, len(rows)) if rows[k][0] == number and not is_joint[k]]
        upper, lower = _kink_zone(rows[cell][1], rows[own[0]][2], rows[own[-1]][3])
        if (
            rows[cell][1].length <= 2 * BEND_LENGTH
        ):  # no node at the zone's ends: the elements around the kink
            middle = 0.5 * (upper + lower)
            around = next(k for k in own if rows[k][2] <= middle <= rows[k][3])
            upper, lower = rows[around][2:4]
        for k in own:
            a, b = max(rows[k][2], upper), min(rows[k][3], lower)
            if b - a > NODE_TOLERANCE:
                share = bend.angle * (b - a) / (lower - upper)
                bent.append(BentCell(k, k, share / (rows[k][3] - rows[k][2]), bend.tool_face))
    for _, item, node, _ in rigid:  # a bent rigid item kinks the end of the flexible one above it
        bend = _bend_of(item)
        if bend is None:
            continue
        cell = max(node - 1, 0)
        if is_joint[cell]:
            raise CaseError(
                at="string",
                got=f"a bend of {item.kind}",
                want="no bend right below a joint" if node else "no bend between the top and a joint",
                hint="put a pipe between",
            )
        kink(cell, bend)
    return tuple(bent)


def curvature_by_tool_face(mesh: StringMesh, frames: Frames) -> StringMesh:
    """Return ``mesh`` with the stress-free curvature along the directors (manual: eq-bend-curvature).

    frames: reference frames of the nodes, at spin angle zero.
    """
    curvature = np.zeros_like(mesh.curvature)
    for q in mesh.bent:
        tangent, second = frames.reference[q.node], frames.second_director[q.node]
        curvature[q.cell] += axial_curvature(tangent, second, q.size, q.tool_face)
    return replace(mesh, curvature=curvature)


def _assemble(case: Case, rows, rigid, tops: dict[int, int], joints: tuple[StringJoint, ...]) -> StringMesh:
    """Assemble the mesh.

    rows: (number, item, upper, lower, rigid length above) of each element and joint, depths in m.
    rigid: (number, item, node, distance from the node down to the item [m]) of each rigid item.
    tops: row at the upper end of each flexible item, by its number.
    """
    n = len(rows)
    rows = _with_sections(rows)
    is_joint = np.zeros(n + 2, dtype=bool)  # with one more entry at either end
    is_joint[[1 + j.cell for j in joints]] = True
    items = {number: item for number, item, *_ in rows}
    sections = {number: _section(item, case.said_units) for number, item in items.items()}
    offsets = {number: _polar(item.eccentricity, item.eccentricity_angle) for number, item in items.items()}
    keys = next(iter(sections.values()))
    columns: dict[str, Any] = {k: np.array([sections[number][k] for number, *_ in rows]) for k in keys}
    upper, lower = np.array([r[2] for r in rows]), np.array([r[3] for r in rows])
    above = np.array([r[4] for r in rows])
    node_depth = np.append(upper - above, lower[-1])
    bodies = tuple(_body(item, node, before) for _, item, node, before in rigid)
    junction = np.zeros(n + 1, dtype=bool)
    stiffness = columns["axial_stiffness"]
    junction[1:n] = ~np.isclose(stiffness[1:], stiffness[:-1], rtol=1e-12)
    for body in bodies:
        junction[body.node] = body.node < n and not is_joint[body.node + 1]
    for load in case.loads:
        if isinstance(load, PointLoad):
            node = int(np.argmin(np.abs(node_depth - load.at)))
            junction[node] |= 0 < node < n
    # the parts at a joint have no common strain; a stretch ratio belongs to a rigid item between joint and element
    for node in np.flatnonzero(is_joint[:-1] | is_joint[1:]):
        junction[node] = node < n and not is_joint[node + 1] and above[node] > 0
    junction[0] = False  # no element above the top shares its strain
    friction = np.array([np.nan if item.friction is None else item.friction for _, item, *_ in rows])
    eccentricity = np.array([offsets[number] for number, *_ in rows])
    eccentricity[is_joint[1:-1]] = 0.0
    return StringMesh(
        upper=upper,
        lower=lower,
        node_depth=node_depth,
        rigid_above=above,
        eccentricity=eccentricity,
        curvature=np.zeros((n, 2)),
        bent=_bent_cells(rows, rigid, tops, is_joint[1:-1]),
        item=np.array([r[0] for r in rows]),
        friction=friction,
        bodies=bodies,
        junction=junction,
        joints=joints,
        **columns,
    )


def _body(item: Any, node: int, before: float) -> RigidItem:
    """Create a rigid item at ``node``; ``before``: distance from the node down to its upper end [m]."""
    along, *across = item.center_of_gravity
    offset = np.array(across)
    if item.mass > 0:
        offset = offset + np.array(_polar(item.unbalance / item.mass, item.unbalance_angle))
    return RigidItem(
        item.name or item.kind,
        item.kind,
        node,
        before,
        item.length,
        item.mass,
        before + along,
        (float(offset[0]), float(offset[1])),
        item.inertia.axial,
        item.inertia.transverse,
        0.5 * (item.od or 0.0),
        item.friction,
        _touching(item, before),
        isinstance(item, Bit) and item.side == "guided",
    )


def _touching(item: Item, before: float) -> tuple[float, float] | None:
    """Part of a stabilizer or bit that touches the wall, for ``RigidItem``; None if the whole item does.

    A bit may tilt in the hole that it has cut. Held at both ends in a curved hole, it would be a wedge whose couple depends on the
    wall's stiffness.  It touches at the middle of its cutting part, which is about as high as wide.
    """
    if isinstance(item, Bit) and item.od:
        return before + item.length - 0.5 * min(item.length, item.od), 0.0
    if not isinstance(item, Stabilizer) or item.blade_length is None:
        return None
    above, length = item.touching
    return before + above, length
