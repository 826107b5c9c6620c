"""What four choices of a case exclude: a string that is held, the quaternion element, a run without inertia, the formulation hermite.

A row: whether the case has something that the choice excludes, its place, what stands there, what is wanted, and a hint.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from drillpetsc.case.blocks.case_blocks import CaseBlocks
from drillpetsc.case.blocks.ends import DrivenTop, ForcedBottom
from drillpetsc.case.blocks.fluid import Fluid
from drillpetsc.case.blocks.items.agitator import AgitatorTool
from drillpetsc.case.blocks.items.motor import PositiveDisplacementMotor
from drillpetsc.case.blocks.items.steering import RotarySteerable
from drillpetsc.case.blocks.items.tools import Jar
from drillpetsc.case.key_paths import refuse
from drillpetsc.case.quantities import largest

Row = tuple[bool, tuple[str | int, ...], Any, str, str]


def check_exclusions(case: CaseBlocks) -> None:
    """Raise on the first part of the case that one of its choices excludes."""
    rows: list[Row] = []
    if case.hold_string:
        rows += _held(case)
    if case.beam.formulation == "quaternion":
        rows += _quaternion(case)
    if case.time is not None and case.time.mode == "quasi_static":
        rows += _quasi_static(case)
    if case.fluid is not None and case.fluid.formulation == "hermite":
        rows += _hermite(case, case.fluid)
    for excluded, at, got, want, hint in rows:
        if excluded:
            raise refuse(*at, got=got, want=want, hint=hint)


def _kinds(case: CaseBlocks, kind: type, want: str, hint: str = "") -> Iterable[Row]:
    """A row for each item of a kind."""
    for i, item in enumerate(case.string):
        if isinstance(item, kind):
            yield True, ("string", i, "kind"), item.kind, want, hint


def _held(case: CaseBlocks) -> Iterable[Row]:
    """A held string has no unknowns. The flow is the only thing left to compute."""
    top, wob, still = case.top, case.initial.wob, "in a string that hold_string keeps still"
    hint = "hold_string leaves the geometry of the string, without its motion"
    alone = "without a fluid the case has no unknowns"
    cuts = "a bit that is held cuts nothing; leave hold_string out"
    yield case.fluid is None, ("hold_string",), True, "hold_string only with a fluid", alone
    yield isinstance(top, DrivenTop), ("top", "kind"), "driven", "no drive of a held string: clamped", hint
    for key, given in (
        ("rotation", largest(top.rotation) > 0),
        ("lowering", largest(top.lowering) > 0),
        ("force", top.force is not None),
        ("hoist", top.hoist is not None),
    ):
        yield given, ("top", key), None, f"no {key} of a held string", hint
    forced = isinstance(case.bottom, ForcedBottom)
    yield forced, ("bottom", "kind"), "force", "no force on a held string: free", hint
    yield bool(case.loads), ("loads",), None, "no loads on a held string", hint
    yield wob is not None, ("initial", "wob"), wob, "no wob with a held string", hint
    yield case.formation is not None, ("formation",), None, "no formation with a held string", cuts
    for i, joint in enumerate(case.joints):
        yield True, ("joints", i), joint.kind, f"no joints {still}", ""
    yield from _kinds(case, PositiveDisplacementMotor, f"no motor {still}")
    yield from _kinds(case, AgitatorTool, f"no agitator {still}")
    yield from _kinds(case, RotarySteerable, "no steerable tool with hold_string")


def _quaternion(case: CaseBlocks) -> Iterable[Row]:
    top, hint = case.top, "leave it out, or take beam.formulation ancf"
    for given, at, got, what in (
        (case.hold_string, ("hold_string",), True, "hold_string (there is no string to compute)"),
        (isinstance(top, DrivenTop), ("top", "kind"), "driven", "a driven top"),
        (top.motor is not None, ("top", "motor"), None, "a motor of the top drive"),
        (top.hoist is not None, ("top", "hoist"), None, "a hoist"),
        (getattr(top, "hinged", False), ("top", "hinged"), True, "a hinged top drive"),
        (not getattr(top, "guided", True), ("top", "guided"), False, "a top that moves across the hole"),
    ):
        yield given, at, got, f"not with quaternion yet: {what}", hint
    for i, joint in enumerate(case.joints):
        want = "position: not with quaternion yet: joints with a constraint on velocities"
        other = "take position, or beam.formulation ancf"
        yield joint.constraint == "stabilised", ("joints", i, "constraint"), joint.constraint, want, other
    for number, tool, _ in case.tools:
        yield True, ("string", number, "kind"), tool.kind, "not with quaternion yet: telescoping tools", hint
    yield from _kinds(case, PositiveDisplacementMotor, "not with quaternion yet: a downhole motor", hint)


def _quasi_static(case: CaseBlocks) -> Iterable[Row]:
    """Such a run is a sequence of equilibria."""
    top, run, start = case.top, "in a quasi-static run", case.initial.from_
    hint = "a held string has no equilibrium to follow; fluid: {dynamics: quasi_steady} takes the inertia from the fluid"
    yield case.hold_string, ("time", "mode"), "quasi_static", "dynamic with a held string", hint
    cone = case.formation is not None and bool(case.formation.bit_law.orders)
    hint = "without inertia the bottom is plane: bit_law: rop, or velocity_weakening"
    yield cone, ("formation", "bit_law", "kind"), "roller_cone", f"no roller_cone {run}", hint
    hint = "a drive has inertia only; kind: top_drive turns the string at the rotation given"
    yield isinstance(top, DrivenTop), ("top", "kind"), "driven", f"no drive {run}", hint
    want = "statics, or a run folder, with time.mode quasi_static"
    hint = "the string is in equilibrium at all times in such a run"
    yield start in ("rest", "straight"), ("initial", "from"), start, want, hint
    hint = "without inertia the drum's lowering moves the top itself"
    yield top.autodriller is not None, ("top", "autodriller"), None, f"no autodriller {run}", hint
    heaves = top.hoist is not None and top.hoist.heave is not None
    yield heaves, ("top", "hoist", "heave"), None, f"no heave {run}", hint
    jar = any(isinstance(tool, Jar) for _, tool, _ in case.tools)
    want = "dynamic with a jar: it fires within milliseconds"
    yield jar, ("time", "mode"), "quasi_static", want, ""
    hint = "mode: dynamic, because the law of a motor needs speeds; or kind: pipe with the same bend"
    yield from _kinds(case, PositiveDisplacementMotor, f"no motor {run}", hint)
    yield from _kinds(case, AgitatorTool, f"no agitator {run}", "pulses need inertia: mode: dynamic")


def _hermite(case: CaseBlocks, fluid: Fluid) -> Iterable[Row]:
    losses = any(item.pressure_loss is not None for item in case.string)
    grows = "hermite needs a hole of constant size; formulation: mixed lets the hole grow"
    branches = "only formulation: mixed has branches of the flow"
    tools = "motors, agitators, jars and other telescoping tools have a joint"
    for given, want, hint in (
        (case.formation is not None, "mixed with a formation", grows),
        (fluid.added_mass == "eccentric", "mixed with added_mass: eccentric", ""),
        (fluid.annulus_rheology is not None, "formulation mixed with an annulus_rheology", ""),
        (losses, "formulation mixed with a pressure_loss of a string item", ""),
        (bool(case.side_nozzles), "mixed with nozzles above the bit", branches),
        (bool(case.all_joints), "formulation mixed in a case with joints", "" if case.joints else tools),
    ):
        yield given, ("fluid", "formulation"), "hermite", want, hint
