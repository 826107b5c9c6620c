"""The `check` command: a text on what the model of a case contains and leaves out."""

from __future__ import annotations

from functools import partial

import numpy as np

from drillpetsc.analysis.commands.rank_model import rank_lines, step_counts
from drillpetsc.analysis.commands.string_figures import figure_lines, short_figure_lines
from drillpetsc.analysis.hydraulics.doubts import OfCase, window_in_measured_depth
from drillpetsc.analysis.hydraulics.open_hole import open_hole
from drillpetsc.analysis.loads.torque_drag.operations import Pair, pairs_of, plan_of, strings_of
from drillpetsc.analysis.loads.torque_drag.string_rows import partly_filled
from drillpetsc.analysis.motion.machine_report import drive_lines, hoist_lines
from drillpetsc.analysis.motion.run_options import options_of
from drillpetsc.analysis.motion.summary import field_counts
from drillpetsc.analysis.motion.time_scales import time_scales
from drillpetsc.analysis.statics.placement import top_depth
from drillpetsc.case.blocks.fluid import OwnRheology, Rheology, flow_constants, stress_at
from drillpetsc.case.blocks.formation import Formation
from drillpetsc.case.blocks.rig import Rig
from drillpetsc.case.blocks.sensors import STEPS_PER_PERIOD, sensor_depth
from drillpetsc.case.case import Case
from drillpetsc.case.files.mud_report import misfit
from drillpetsc.case.plausible.plausibility import notes
from drillpetsc.doubts import doubts_at
from drillpetsc.doubts.moments import Built
from drillpetsc.errors import CaseError
from drillpetsc.model.drilling_model import DrillingModel, build_model
from drillpetsc.model.mesh import element_lengths
from drillpetsc.unit_systems import System, display_unit, shown


def command_lines(case: Case) -> list[str]:
    """Window and roadmap of the case in a line each; a warning where a command refuses them."""
    return [*_window(case), *_roadmap(case)]


def _refused(commands: str, error: CaseError) -> str:
    hint = f" ({error.hint})" if error.hint else ""
    return f"WARNING: {commands}: {error.at} is {error.got}; allowed: {error.want}{hint}"


def _window(case: Case) -> list[str]:
    window, units = case.window, case.shown_units
    if window is None:
        return []
    pore, frac = (
        " to ".join(dict.fromkeys(shown(v, "mud_weight", units) for v in (values[0], values[-1])))
        for values in (window.pore, window.frac)
    )
    where = "the open hole"
    if window.tvd is not None:
        where = (
            f"TVD {shown(window.tvd[0], 'length', units, 5)} to {shown(window.tvd[-1], 'length', units, 5)}"
        )
    lines = [f"window: pore {pore}, frac {frac}, {where}"]
    try:
        open_hole(case, window)
    except CaseError as error:
        lines.append(_refused("hydraulics and surge refuse the window", error))
    return lines + [f"WARNING: {text}" for text in window_in_measured_depth.sentences(OfCase(case))]


def _roadmap(case: Case) -> list[str]:
    if case.roadmap is None or case.well is None:
        return []
    plan, units = plan_of(case), case.shown_units
    try:
        strings, pairs = strings_of(case, plan, []), pairs_of(case, plan, [])
    except CaseError as error:
        return [_refused("roadmap refuses the case", error)]
    ends = dict.fromkeys(shown(rows.depth, "length", units, 5) for rows in (strings[0], strings[-1]))
    text = (
        f"roadmap: {', '.join(plan.operations)}; {len(strings)} bit depths, {' to '.join(ends)}; "
        f"friction cased / open hole {', '.join(_factors(pair) for pair in pairs)}"
    )
    points = plan.measured or ()
    if points:
        text += f"; {len(points)} measured points, hook loads {'without' if plan.hookload_excludes_block else 'with'} the block"
    unfit = [rows for rows in strings if rows.misfit]
    if unfit:
        first = shown(unfit[0].depth, "length", units, 5)
        said = (
            f"the string does not fit at {len(unfit)} of the bit depths, first at {first}: {unfit[0].misfit}"
        )
        return [text, f"WARNING: roadmap: {said}"]
    return [text]


def _factors(pair: Pair) -> str:
    return f"{pair.cased:.3g} / {pair.open_hole:.3g}".replace("nan", "-")


MOST_RANGES = 40  # lines on automatic element lengths

TERMS = (
    ("bodies", "rigid bodies and eccentricity"),
    ("curvature", "stress-free curvature"),
    ("contact", "contact with the hole"),
    ("bit", "bit on the bottom"),
    ("reamer", "reamer cutting rock"),
    ("steering", "rotary steerable tool"),
    ("mud_motor", "downhole motor"),
    ("agitator", "agitator"),
    ("loads", "loads"),
    ("joints", "joints"),
    ("drive", "rotary drive with spring and damper"),
    ("top_motor", "motor of the top drive"),
    ("hoist", "hoist"),
    ("bore", "drilling fluid in the string"),
    ("annulus", "drilling fluid in the annulus"),
    ("side_nozzles", "nozzles above the bit"),
)

REGION_TEXT = {
    "junction": "section changes and rigid items",
    "top": "the upper end",
    "bottom": "the lower end",
    "joint": "joints",
    "stabilised_joint": "joints",
    "side_nozzles": "nozzles above the bit",
    "reamer": "the reamer",
    "motor": "the downhole motor",
    "agitator": "the agitator",
}


def describe(case: Case, verbose: bool = True) -> str:
    """Return the text for the user; raises CaseError where the model cannot be built.

    verbose: with element lengths, each figure's source, numbers of unknowns and times; otherwise what an engineer reads
    before a computation.
    """
    key, empty = partly_filled(case), ""
    if key is not None:
        value = shown(getattr(case.fluid, key), "length", case.shown_units, 6)
        empty = f"above MD {value}" if key == "level_in_string" else f"in its lowest {value}, with mud above"
        case = case.model_copy(update={"fluid": case.given_fluid.model_copy(update={key: None})})
    with options_of(case):
        lines = _lines(build_model(case), verbose)
    if empty:
        lines.append(f"  fluid: the string is empty {empty}, in roadmap and calibrate; other commands refuse")
    return "\n".join(lines)


def _quasi_static(case: Case) -> bool:
    return case.time is not None and case.time.mode == "quasi_static"


def _fitted(key: str, rheology: Rheology | None, units: System) -> list[str]:
    """Describe the fit of a rheology to dial readings; nothing if there are none."""
    if rheology is None or not rheology.dial:
        return []
    consistency, index, stress = flow_constants(rheology)
    rms = misfit(rheology.dial, partial(stress_at, rheology))
    return [
        f"    {key}: {len(rheology.dial)} dial readings ({', '.join(rheology.dial)} rpm), fit {rheology.fit or 'given'}: "
        f"yield stress {shown(stress, 'yield_point', units)}, consistency {shown(consistency, 'consistency', units)}, "
        f"index {index:.4g}; misfit {shown(rms, 'yield_point', units, 3)} rms"
    ]


def _cutting(formation: Formation | None, units: System) -> str:
    """Describe a bit on rock: law, drillabilities, layers."""
    if formation is None:
        return "bit cutting rock"
    values = [formation.drillability, *(layer.drillability for layer in formation.layers)]
    least, most = (shown(q, "drillability", units) for q in (min(values), max(values)))
    span = least if least == most else f"{least} to {most}"
    count = len(formation.layers)
    layers = f", {count} layer{'s' if count > 1 else ''}" if count else ""
    law = formation.bit_law
    lobes = ", ".join(f"{q.order:g} lobes of {shown(q.amplitude, 'diameter', units, 3)}" for q in law.orders)
    kind = law.kind + (f" on {law.torque_law.kind}: {lobes}" if lobes else "")
    return f"bit cutting rock (law {kind}, drillability {span}{layers})"


def _chosen_lengths(case: Case, model: DrillingModel) -> list[str]:
    """Lengths of automatic elements and what decided each, from the top down; empty if all are given."""
    lengths = element_lengths(case, model.well)
    count = sum(r.count for r in lengths.ranges)
    if not count:
        return []
    units = case.shown_units
    scale, _, unit = display_unit("length", units)
    top = top_depth(model)
    lines = [f"  automatic element lengths, {count} elements:"]
    for r in lengths.ranges[:MOST_RANGES]:
        longest = f"{r.longest / scale:.3g}"
        size = longest if r.longest < 1.02 * r.shortest else f"{r.shortest / scale:.3g} to {longest}"
        upper, lower = (r.upper + top) / scale, (r.lower + top) / scale
        place = f"MD {upper:.1f} to {lower:.1f} {unit} ({case.string[r.item].name})"
        lines.append(f"    {place}: {size} {unit}, {r.reason}")
    rest = lengths.ranges[MOST_RANGES:]
    if rest:
        lines.append(
            f"    ... and {len(rest)} more ranges below MD {(rest[0].upper + top) / scale:.1f} {unit}"
        )
    return lines


def _rig(rig: Rig, units: System) -> str:
    """Describe the rig, in a system of units."""
    given = (
        ("block", rig.block_weight, "force"),
        ("largest hook load", rig.max_hookload, "force"),
        ("largest surface torque", rig.max_surface_torque, "torque"),
        ("largest standpipe pressure", rig.max_spp, "pressure"),
    )
    parts = [f"{name} {shown(value, kind, units, 6)}" for name, value, kind in given if value is not None]
    if rig.elevation is not None:
        parts.insert(
            0, f"datum {shown(rig.elevation, 'length', units, 6)} above {rig.elevation_ref or 'MSL'}"
        )
    return "  rig: " + "; ".join(
        [*([f"depths from {rig.datum}"] if rig.datum else []), *parts] or ["nothing given"]
    )


def _lines(model: DrillingModel, verbose: bool) -> list[str]:
    case, units = model.case, model.case.said_units
    said = [f"  {line}" for line in notes(case)]
    warnings = [line for line in said if line.startswith("  WARNING")]
    built = Built(model=model)
    warnings += [f"  WARNING: {text}" for text in doubts_at(built, "warning")]
    count = f", {len(warnings)} warning{'s' if len(warnings) > 1 else ''}" if warnings else ""
    return [
        f"{case.title or 'case'}: valid{count}",
        *warnings,
        *_string_and_hole(model, units, verbose),
        *_operation(model, units),
        *_contents(model, units),
        *_cost(model, verbose),
        *(f"  {text}" for text in doubts_at(built, "remark")),
        *(line for line in said if not line.startswith("  WARNING")),
        *([] if verbose else ["  --verbose: element lengths, sources of the figures, unknowns, time scales"]),
    ]


def _string_and_hole(model: DrillingModel, units: System, verbose: bool) -> list[str]:
    """String, rig and hole."""
    case, mesh = model.case, model.mesh
    size, _, unit = display_unit("length", units)
    element = ~mesh.is_joint
    lines = [
        f"  string: {len(case.string)} items, {mesh.total_length / size:g} {unit}, {int(element.sum())} elements of "
        f"{mesh.length[element].min() / size:.3g} to {mesh.length.max() / size:.3g} {unit}, {mesh.nodes} nodes, "
        f"{len(mesh.bodies)} rigid items",
        *(_chosen_lengths(case, model) if verbose else []),
        *(figure_lines(case, units) if verbose else short_figure_lines(case, units)),
    ]
    if case.rig is not None:
        lines.append(_rig(case.rig, units))
    if case.well is not None:
        q = case.well
        lines.append(
            f"  well: {len(q.survey.md)} survey stations to {q.survey.md[-1] / size:g} {unit}, inclination up to "
            f"{np.degrees(max(q.survey.inclination)):.3g} deg, {len(q.sections)} sections"
        )
    return lines


def _operation(model: DrillingModel, units: System) -> list[str]:
    """Ends, start, sensors and machines."""
    case = model.case
    lines = [f"  top: {case.top.kind}; bottom: {case.bottom.kind}; start: {case.initial.from_}"]
    for sensor in case.output.sensors:
        depth = float(sensor_depth(case.string, case.item_depths, sensor) or 0.0)
        lines.append(
            f"  sensor {sensor.name}: MD {shown(depth, 'length', units, 6)}, {sensor.rate:g} Hz, {', '.join(sensor.channels)}; steps resolve "
            f"{sensor.finest:g} Hz up to {1e3 / (STEPS_PER_PERIOD * sensor.finest):.3g} ms"
        )
    if _quasi_static(case):
        grows = ", while the hole grows" if case.formation is not None else ""
        lines.append(f"  time: quasi-static, in equilibrium at all times{grows}")
    return lines + [f"  {line}" for line in (*drive_lines(model), *hoist_lines(model))]


def _contents(model: DrillingModel, units: System) -> list[str]:
    """The mud, and the physics that the model contains and leaves out."""
    case, mesh, lines = model.case, model.mesh, []
    if case.fluid is not None:
        mud = case.fluid
        lines = [
            f"  fluid: {shown(mud.density, 'mud_weight', units, 6)}, {mud.rheology.model}, law {mud.rheology.law}, bulk modulus {shown(mud.bulk_modulus, 'stress', units, plot=True)}",
            *_fitted("rheology", mud.rheology, units),
            *_fitted("annulus_rheology", mud.annulus_rheology, units),
        ]
    names = {component.name for component in model.components}
    # stress-free curvature is part of the quaternion element, not a component
    names |= {"curvature"} if mesh.curvature.any() else set()
    damped = bool(mesh.stiffness_damping.any() or mesh.mass_damping.any())
    string = model.beam.moves
    parts = [
        (string, "axial, bending, torsion"),
        (bool(np.any(case.gravity)), "gravity"),
        (string and not _quasi_static(case), "inertia"),
        (string and damped, "material damping"),
        *((name in names, text) for name, text in TERMS),
        (case.formation is not None, _cutting(case.formation, units)),
    ]
    contained, left_out = ([text for present, text in parts if present == kind] for kind in (True, False))
    return [
        *lines,
        *(f"  {line}" for line in command_lines(case)),
        "  contains: " + "; ".join(contained),
        "  leaves out (no unknowns, no cost): " + "; ".join(left_out),
        *_own(model),
    ]


def _own(model: DrillingModel) -> list[str]:
    """Laws and components of the user."""
    laws = [f"{law.kind.key} {law.name}" for component in model.components for law in component.own_laws]
    rheologies = [q for q in (model.case.fluid and model.case.fluid.rheology,) if isinstance(q, OwnRheology)]
    laws += [f"fluid.rheology {q.function}" for q in rheologies]
    found = laws + [q.function for q in model.case.components]
    return [f"  of the user: {'; '.join(found)}"] if found else []


def _cost(model: DrillingModel, verbose: bool) -> list[str]:
    """Unknowns, time of a step, ranks and time scales."""
    counts, time = field_counts(model.system), model.case.time
    per_node = sum(f.size for f, n in counts if n >= model.mesh.nodes - 1)
    unknowns, rates = sum(f.size * n for f, n in counts), sum(f.size * n for f, n in counts if f.second_order)
    lines = [
        f"  unknowns: {per_node} per node; {unknowns} solved for in a step, {unknowns + rates} in the state"
    ]
    for f, n in counts:
        if verbose and f.region in REGION_TEXT and n:
            lines.append(f"    {f.name}: {f.size} at {n} nodes ({REGION_TEXT[f.region]})")
    to_do = f"; {time.end:g} s to simulate" if time is not None else ""
    step = 1e3 * step_counts(model).time(1)
    lines.append(f"  expected cost: about {step:.2g} ms per step on one core{to_do}")
    lines += [f"  {line}" for line in rank_lines(model)]
    return lines + [f"  {line}" for line in (time_scales(model).lines() if verbose else ())]
