"""What the commands for a case would say of it: its pressure window and its roadmap, for `check`."""

from __future__ import annotations

from drillpetsc.analysis.hydraulics.doubts import OfCase, WindowInMeasuredDepth
from drillpetsc.analysis.hydraulics.open_hole import open_hole
from drillpetsc.analysis.loads.torque_drag.operations import Pair, pairs_of, plan_of, strings_of
from drillpetsc.case.case import Case
from drillpetsc.errors import CaseError
from drillpetsc.unit_systems import shown


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
    return lines + [f"WARNING: {text}" for text in WindowInMeasuredDepth().sentences(OfCase(case))]


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
