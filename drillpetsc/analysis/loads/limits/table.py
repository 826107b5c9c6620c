"""Rows of limits.csv: stresses, strength, buckling and fatigue at the nodes and at both ends of each item."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from drillpetsc.analysis.loads.limits import fatigue, strength
from drillpetsc.analysis.loads.limits.along_string import State, Surroundings
from drillpetsc.analysis.loads.limits.buckling_loads import Helical
from drillpetsc.analysis.loads.limits.side_force import largest_on_joint
from drillpetsc.analysis.loads.torque_drag.string_rows import JOINT
from drillpetsc.arrays import FloatArray
from drillpetsc.case.blocks.items.tubulars import DrillPipe, Jointed, Tubular
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.output.quantities.tables import COLUMNS

WORDS = ("item", "grade", "class", "buckling_state")  # columns of words


@dataclass(frozen=True)
class Choices:
    """What a user may choose.

    helical: law of the helical load. design_factor: least yield strength over von Mises stress.
    tension_design_factor: least pull at yield over axial force; tension_fraction: of the pull at yield that is allowed.
    side_force_per_joint: largest force on a joint [N].
    corrosive: the mud is corrosive: 0.6 of the permissible doglegs (API RP 7G). sn: curve for Miner's damage, None without one.
    """

    helical: Helical = "chen"
    design_factor: float = 1.25
    tension_design_factor: float = 1.1
    tension_fraction: float = 0.9
    side_force_per_joint: float = 2000 * 4.4482216152605
    corrosive: bool = False
    sn: fatigue.SnCurve | None = None


class Strength:
    """Figures of the pipe, (n,) for each element, nan where they are not known.

    outer: diameter of the worn tube, inner: bore [m]; yield_strength [Pa]; joint_length [m].
    tension_limit: (n,) pull that is allowed [N].
    half_joint: (n,) [m], nan where bending does not gather beside tool joints.
    make_up: (n,) make-up torque of the tool joints [N m].
    """

    def __init__(self, model: DrillingModel, choices: Choices) -> None:
        mesh, items = model.mesh, model.case.string
        tube = (mesh.worn_diameter > 0) & (mesh.worn_diameter > mesh.inner_diameter) & ~mesh.is_joint
        self.outer = np.where(tube, mesh.worn_diameter, np.nan)
        self.new_outer = np.where(tube, mesh.outer_diameter, np.nan)
        self.inner = np.where(tube, mesh.inner_diameter, np.nan)
        self.yield_strength, self.joint_length = mesh.yield_strength, mesh.joint_length
        self.tension_limit = choices.tension_fraction * strength.tension_at_yield(
            self.outer, self.inner, self.yield_strength
        )
        touches = [isinstance(item, Jointed) and item.contact_on == "tool_joint" for item in items]
        self.half_joint = np.where(np.array(touches)[mesh.item], 0.5 * mesh.joint_length, np.nan)
        grades = [item.grade if isinstance(item, Tubular) else None for item in items]
        made_up = [item.tool_joint.make_up_torque if isinstance(item, Jointed) else None for item in items]
        self.make_up = np.array(
            [np.nan if made_up[i] is None else made_up[i] for i in mesh.item], dtype=float
        )
        rules = [
            fatigue.rule_of(g) if isinstance(i, DrillPipe) else None
            for i, g in zip(items, grades, strict=True)
        ]
        self.rule = np.array([rules[i] or "" for i in mesh.item])
        material = [getattr(item, "material", None) for item in items]
        self.young = np.array([np.nan if material[i] is None else material[i].young for i in mesh.item])

    def permissible_dogleg(self, effective: FloatArray) -> FloatArray:
        """(n, 2) permissible dogleg [1/m] under an effective tension (n, 2) [N]."""
        out = np.full(effective.shape, np.nan)
        for rule in ("E", "S"):
            k = self.rule == rule
            section = strength.area(self.outer[k], self.inner[k])[:, None]
            bend = self.young[k] * strength.second_moment(self.new_outer[k], self.inner[k])
            out[k] = fatigue.permissible_dogleg(
                effective[k],
                self.new_outer[k][:, None],
                section,
                bend[:, None],
                0.5 * self.joint_length[k][:, None],
                rule,
                self.young[k][:, None],
            )
        return out


def element_values(
    model: DrillingModel,
    state: State,
    hole: Surroundings,
    pipe: Strength,
    choices: Choices,
    rotation: float = 0.0,
) -> dict[str, FloatArray]:
    """Columns of numbers of limits.csv, (n, 2) at both ends of each element.

    Forces that two elements of one item have at their node are the mean of both.
    rotation: of the string [rad/s], for the damage by an S-N curve and the wear of casing.
    """
    state = _smoothed(model, state)
    outer, inner, strong = pipe.outer[:, None], pipe.inner[:, None], pipe.yield_strength[:, None]
    stiffness = np.where(hole.stiffness > 0, hole.stiffness, np.nan)[:, None]
    gathered = 1 / fatigue.tension_factor(
        np.maximum(state.effective, 0.0), stiffness, pipe.half_joint[:, None]
    )
    moment = state.moment * np.where(np.isfinite(gathered), gathered, 1.0)
    # the mud outside presses on less of a worn tube
    lost = strength.area(pipe.new_outer, pipe.outer)[:, None]
    wall = state.axial + state.outside * lost
    s = strength.stresses(outer, inner, wall, moment, state.torque, state.inside, state.outside)
    sinusoidal, helical = hole.loads(state.effective, choices.helical)
    dogleg = pipe.permissible_dogleg(state.effective) * (fatigue.CORROSIVE if choices.corrosive else 1.0)
    torque_limit = strength.torque_at_yield(outer, inner, strong, state.axial)
    wet = model.fluid
    nothing = np.full(state.axial.shape, np.nan)
    pressures = (nothing, nothing) if wet is None else (state.inside, state.outside)
    more = strength.pressure_ratios(pipe.new_outer[:, None], outer, inner, strong, s.axial, *pressures)
    if choices.sn is not None:
        more["damage_per_hour"] = choices.sn.damage_per_hour(s.bending, rotation)
    if (cased := _in_casing(model, hole.md)).any() and rotation:
        slip = abs(rotation) * 0.5 * model.mesh.contact_diameter[:, None]
        joint = np.where(np.isfinite(pipe.joint_length), pipe.joint_length, JOINT)
        worn = (
            _force_on_joint(hole.md, state, joint) / joint[:, None]
        )  # of a joint: an element has no length of its own
        more["casing_wear_rate"] = np.where(cased, worn * slip, np.nan)
    if np.isfinite(pipe.make_up).any():
        make_up = np.broadcast_to(pipe.make_up[:, None], nothing.shape)
        more |= {"make_up_torque": make_up, "make_up_ratio": np.abs(state.torque) / make_up}
    with np.errstate(divide="ignore", invalid="ignore"):
        return {
            "md": hole.md,
            "tvd": hole.tvd,
            "inclination": np.degrees(hole.inclination),
            "effective_tension": state.effective,
            "axial_force": state.axial,
            "torque": state.torque,
            "bending_moment": state.moment,
            "curvature": state.dls,
            "internal_pressure": state.inside if wet is not None and wet.bore is not None else nothing,
            "annulus_pressure": state.outside if wet is not None and wet.annulus is not None else nothing,
            "axial_stress": s.axial,
            "worst_bending_stress": s.bending,
            "torsional_stress": s.shear,
            "hoop_stress": s.hoop,
            "von_mises": s.von_mises,
            "yield_strength": np.broadcast_to(strong, nothing.shape),
            "safety_factor": strong / s.von_mises,
            "tension_limit": np.broadcast_to(pipe.tension_limit[:, None], nothing.shape),
            "torque_limit": torque_limit,
            "tension_ratio": state.axial / pipe.tension_limit[:, None],
            "torque_ratio": np.abs(state.torque) / torque_limit,
            "sinusoidal_limit": sinusoidal,
            "helical_limit": helical,
            "contact_force": state.side_force,
            "side_force_per_joint": _force_on_joint(hole.md, state, pipe.joint_length),
            "fatigue_dls": dogleg,
            "fatigue_ratio": state.dls / dogleg,
            **more,
        }


def _in_casing(model: DrillingModel, md: FloatArray) -> np.ndarray:
    """(n, 2) whether the hole around measured depths (n, 2) [m] is cased; elements end where casing does, or beside it."""
    sections = () if model.case.well is None else model.case.well.sections
    if not sections:
        return np.zeros(md.shape, dtype=bool)
    middle = np.searchsorted([s.to for s in sections], md.mean(axis=1)).clip(max=len(sections) - 1)
    cased = np.array([s.kind != "open_hole" for s in sections])[middle]
    return np.broadcast_to(cased[:, None], md.shape)


def _force_on_joint(md: FloatArray, state: State, joint: FloatArray) -> FloatArray:
    """(n, 2) side force [N] on a joint (`largest_on_joint`), nan where there is no wall or no joint.

    md: (n, 2) measured depths [m]; joint: (n,) length [m], nan where there are no joints.
    """
    own = np.nan_to_num(state.side_force_of_elements) * (md[:, 1] - md[:, 0])
    return np.where(np.isfinite(state.side_force), largest_on_joint(md, own, joint), np.nan)


def _smoothed(model: DrillingModel, state: State) -> State:
    """The state with means where elements of one item meet, so that stresses and limits of a row belong together."""
    out: dict[str, FloatArray] = {}
    for name in ("axial", "effective", "torque", "moment", "dls", "side_force"):
        values = getattr(state, name).copy()
        for run in _runs(model):
            middle = 0.5 * (values[run[1:], 0] + values[run[:-1], 1])
            values[run[1:], 0], values[run[:-1], 1] = middle, middle
        out[name] = values
    return replace(state, **out)


def rows(model: DrillingModel, values: dict[str, FloatArray]) -> dict[str, Any]:
    """Columns of limits.csv: a row at every node of an item, so two where items meet, and both ends of rigid items.

    Beside them ``jointed``: 1 for pipe with tool joints.
    """
    mesh, items = model.mesh, model.case.string
    numbers: dict[str, list[FloatArray]] = {name: [] for name in values}
    labels: list[int] = []
    for run in _runs(model):
        for name, both in values.items():
            upper, lower = both[run, 0], both[run, 1]
            middle = 0.5 * (upper[1:] + lower[:-1])
            numbers[name].append(np.concatenate([upper[:1], middle, lower[-1:]]))
        labels += [int(mesh.item[run[0]])] * (len(run) + 1)
    table: dict[str, Any] = {name: np.concatenate(parts) for name, parts in numbers.items()}
    names = [item.name for item in items]
    table["item"] = np.array([names[i] for i in labels], dtype=object)
    table["grade"] = np.array([getattr(items[i], "grade", None) or "-" for i in labels], dtype=object)
    table["class"] = np.array([getattr(items[i], "class_", None) or "-" for i in labels], dtype=object)
    table["buckling_state"] = buckling_states(table)
    table["jointed"] = np.array([float(isinstance(items[i], Jointed)) for i in labels])
    middle = {i: float(values["md"][mesh.item == i].mean()) for i in set(labels)}
    table["middle"] = np.array([middle[i] for i in labels])  # orders rows where items meet
    table = _with_rigid_items(model, table, values)
    order = np.lexsort((table.pop("middle"), np.round(table["md"], 6)))
    return {
        name: table[name][order]
        for name in (*(q.name for q in COLUMNS["limits.csv"] if q.name in table), "jointed")
    }


def buckling_states(table: dict[str, Any]) -> np.ndarray:
    """none, sinusoidal, helical, or - where the string is in compression without a limit; one word a row."""
    push = -table["effective_tension"]
    sinusoidal, helical = table["sinusoidal_limit"], table["helical_limit"]
    with np.errstate(invalid="ignore"):
        out = np.where(push > sinusoidal, "sinusoidal", "none").astype(object)
        out[push > helical] = "helical"
        out[np.isnan(sinusoidal) & ~(push <= 0)] = "-"
    return out


def _runs(model: DrillingModel) -> list[np.ndarray]:
    """Cells of each stretch of one item without a joint in it, from the top down."""
    mesh = model.mesh
    cells = np.flatnonzero(~mesh.is_joint)
    cut = np.flatnonzero((np.diff(cells) > 1) | (np.diff(mesh.item[cells]) != 0)) + 1
    return np.split(cells, cut)


def _with_rigid_items(
    model: DrillingModel, table: dict[str, Any], values: dict[str, FloatArray]
) -> dict[str, Any]:
    """The table with two rows for each rigid item that has a length: forces of the pipe beside it, no limits."""
    mesh, gravity = model.mesh, np.array(model.case.gravity, dtype=float)
    shift = float(values["md"][0, 0] - mesh.upper[0])
    for body in mesh.bodies:
        if body.length <= 0:
            continue
        first = mesh.node_depth[body.node] + body.above
        for depth, sides, end in ((first, mesh.lower, 1), (first + body.length, mesh.upper, 0)):
            beside = np.flatnonzero((np.abs(sides - depth) < 1e-6) & ~mesh.is_joint)
            for name in table:
                if name in WORDS:
                    value: Any = body.name if name == "item" else "-"
                elif name == "md":
                    value = depth + shift
                elif name == "middle":
                    value = first + 0.5 * body.length + shift
                elif name == "tvd" and model.well is not None and gravity.any():
                    at = np.asarray(model.well.at(np.array([depth + shift]))[0])[0]
                    value = float(at @ gravity) / float(np.linalg.norm(gravity))
                elif len(beside) and name in ("axial_force", "effective_tension", "torque", "tvd"):
                    value = values[name][beside[0], end]
                else:
                    value = np.nan
                table[name] = np.append(table[name], value)
    return table
