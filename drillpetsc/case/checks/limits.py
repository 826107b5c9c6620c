"""Limits of this version: commands without the quaternion element, and the largest mesh and output."""

from __future__ import annotations

from drillpetsc.case.blocks.case_blocks import CaseBlocks
from drillpetsc.case.blocks.items.string import Flexible
from drillpetsc.case.key_paths import refuse
from drillpetsc.case.quantities import said
from drillpetsc.errors import CaseError

MAX_ELEMENTS = 200_000  # some 5 to 10 GB with fluid and contact; 12 km of string at 6 cm
MAX_OUTPUTS = {
    "history_every": 10**7,
    "field_every": 10**6,
    "checkpoint_every": 10**6,
}  # rows, snapshots and checkpoints of a run


def refuse_quaternion(case: CaseBlocks, command: str) -> None:
    """Raise CaseError for a case with the quaternion element.

    command: name of a command that supports the ANCF element only.
    """
    if case.beam.formulation == "quaternion":
        raise CaseError(
            at="beam.formulation",
            got="quaternion",
            want=f"ancf with {command}: not with quaternion yet",
            hint="the string is the same, in other unknowns",
        )


def element_count(item: Flexible) -> int:
    """Number of equal elements of an item with a given element length; 0 if the length is chosen with the model."""
    if isinstance(item.element_length, str):
        return 0
    return max(1, round(min(item.length / item.element_length, 1e18)))


def check_size(case: CaseBlocks) -> None:
    """Raise if the mesh has more elements, or a run more output, than a machine can hold."""
    counts = {i: element_count(item) for i, item in enumerate(case.string) if isinstance(item, Flexible)}
    if sum(counts.values()) > MAX_ELEMENTS:
        i = max(counts, key=lambda i: counts[i])
        item = case.string[i]
        assert isinstance(item, Flexible)
        want = f"at most {MAX_ELEMENTS} elements in the string; with this it has {sum(counts.values()):.6g}"
        hint = f"elements of {said(max(1e-3, 2 * case.string_length / MAX_ELEMENTS), 'length', digits=2)} would do"
        raise refuse("string", i, "element_length", got=item.element_length, want=want, hint=hint)
    if case.time is None:
        return
    output, end = case.output.with_intervals(case.time.end), case.time.end
    for key, most in MAX_OUTPUTS.items():
        every = getattr(output, key)
        if end <= most * every:
            continue
        if getattr(case.output, key) is None:
            want = f"at most {most * every:g} s with output.{key} {every:g} s"
            raise refuse("time", "end", got=end, want=want, hint=f"give output.{key}")
        want = f"at least {end / most:g} s: a run of {end:g} s would write more than {most:g} times"
        raise refuse("output", key, got=every, want=want)
