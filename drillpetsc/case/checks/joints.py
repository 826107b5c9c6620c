"""Checks of joints against the string and the rest of the case."""

from __future__ import annotations

from drillpetsc.case.blocks.case_blocks import CaseBlocks
from drillpetsc.case.blocks.items.string import Flexible, Rigid
from drillpetsc.case.blocks.items.tools import Jar
from drillpetsc.case.key_paths import refuse
from drillpetsc.case.quantities import said

TOLERANCE = 1e-6  # [m] depths closer than this are equal


def check_joints(case: CaseBlocks) -> None:
    """Raise if joints do not fit the string or the rest of the case."""
    end = case.string_length
    seen: dict[float, int] = {}
    _jars(case)
    for number, tool, slider in case.tools:
        for joint in case.joints:
            if abs(joint.at - slider.at) <= TOLERANCE:
                want = f"another depth of the joint at {said(joint.at, 'length')}: the slider of {tool.kind} is there"
                raise refuse("string", number, "joint_at", got=tool.joint_at, want=want)
    in_motors = {joint.at: number for number, joint in case.motor_joints}
    for i, joint in enumerate(case.joints):
        if joint.at <= TOLERANCE:
            _joint_at_the_top(case, i)
        elif joint.at >= end - TOLERANCE:
            raise refuse(
                "joints",
                i,
                "at",
                got=joint.at,
                want=f"a measured depth on the string, from 0 to less than {said(end, 'length')}",
                hint="a joint connects the part above it with the part below; for a lower end that can bend: bottom pinned",
            )
        for other, k in seen.items():
            if abs(other - joint.at) <= TOLERANCE:
                raise refuse(
                    "joints",
                    i,
                    "at",
                    got=joint.at,
                    want=f"a depth other than at joints[{k}]: one joint at a place",
                )
        for depth, number in in_motors.items():
            if abs(depth - joint.at) <= TOLERANCE:
                want = f"a depth other than at the joint in string[{number}]: one joint at a place"
                raise refuse("joints", i, "at", got=joint.at, want=want)
        seen[joint.at] = i
        for k, (item, (above, below)) in enumerate(zip(case.string, case.item_depths, strict=True)):
            if not isinstance(item, Flexible) and above + TOLERANCE < joint.at < below - TOLERANCE:
                want = f"an end of the rigid item string[{k}], {said(above, 'length')} or {said(below, 'length')}, or a depth in a pipe or beam"
                raise refuse("joints", i, "at", got=joint.at, want=want)
    _no_massless_part(case)


def _joint_at_the_top(case: CaseBlocks, i: int) -> None:
    """Raise CaseError unless the top holds the part above joint ``i`` at depth 0: a section without mass."""
    top, joint = case.top, case.joints[i]
    if case.fluid is not None:
        want = "a depth above 0 in a case with a fluid"
        raise refuse("joints", i, "at", got=joint.at, want=want)
    if top.kind in ("free", "pinned") or getattr(top, "hinged", False):
        raise refuse(
            "joints",
            i,
            "at",
            got=joint.at,
            want="a top that holds its section, clamped, driven or a top drive without hinge; or a depth above 0",
            hint="a joint at depth 0 connects the string with the top",
        )
    if joint.constraint == "stabilised":
        want = "position, at depth 0: the top holds what is above"
        raise refuse("joints", i, "constraint", got=joint.constraint, want=want)


def _jars(case: CaseBlocks) -> None:
    """Raise if the time integration does not locate the events of a jar."""
    if case.time is None or not any(isinstance(tool, Jar) for _, tool, _ in case.tools):
        return
    for key, allowed in (("ts_type", ("bdf", "alpha2", "genalpha")), ("snes_type", ("python",))):
        if case.petsc.get(key, allowed[0]) not in allowed:
            raise refuse("petsc", key, got=case.petsc[key], want=f"{' | '.join(allowed)} with a jar")


def _no_massless_part(case: CaseBlocks) -> None:
    """Raise if the string between two joints, or between a joint and an end, has no mass."""
    inner = sorted(joint.at for joint in case.all_joints if joint.at > TOLERANCE)
    marks = [0.0, *inner, case.string_length]
    for above, below in zip(marks, marks[1:], strict=False):
        inside = [
            i for i, (a, b) in enumerate(case.item_depths) if b > above + TOLERANCE and a < below - TOLERANCE
        ]
        if len(marks) == 2 or any(isinstance(case.string[i], Flexible) for i in inside):
            continue
        for i, joint in enumerate(case.joints):
            if joint.at == below and joint.constraint == "stabilised":
                want = "constraint: position, or a pipe or beam above the joint"
                raise refuse(
                    "joints",
                    i,
                    "constraint",
                    got=joint.constraint,
                    want=want,
                    hint="only rigid items hang above it",
                )
        rigid = [item for i in inside if isinstance(item := case.string[i], Rigid)]
        if all(item.mass == 0 for item in rigid):
            raise refuse(
                "string",
                inside[0],
                "mass",
                got=0.0,
                want="a mass: only rigid items hang between the joints here",
            )
