"""What would fill the memory or the disk before anything is computed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from drillpetsc.case.blocks.string import Flexible
from drillpetsc.case.key_paths import refuse

if TYPE_CHECKING:
    from drillpetsc.case.case import Case

MOST_ELEMENTS = 200_000  # some 5 to 10 GB with fluid and contact; 12 km of string at 6 cm
MOST_WRITINGS = {
    "history_every": 10**7,
    "field_every": 10**6,
    "checkpoint_every": 10**6,
}  # rows, pictures, checkpoints of a run


def element_count(item: Flexible) -> int:
    """Number of equal elements that an item is divided into."""
    return max(1, round(min(item.length / item.element_length, 1e18)))


def check_size(case: Case) -> None:
    """Raises where a scene has more elements, or a run more output, than a machine can hold."""
    counts = {i: element_count(item) for i, item in enumerate(case.string) if isinstance(item, Flexible)}
    if sum(counts.values()) > MOST_ELEMENTS:
        i = max(counts, key=lambda i: counts[i])
        item = case.string[i]
        want = f"at most {MOST_ELEMENTS} elements in the string; with this it has {sum(counts.values()):.6g}"
        hint = f"elements of {max(1e-3, 2 * case.string_length / MOST_ELEMENTS):.2g} m would do"
        raise refuse(
            "string", i, "element_length", got=getattr(item, "element_length", None), want=want, hint=hint
        )
    if case.time is None:
        return
    output = case.output.settled(case.time.end)
    for key, most in MOST_WRITINGS.items():
        every, end = getattr(output, key), case.time.end
        if end <= most * every:
            continue
        if getattr(case.output, key) is None:
            want = f"at most {most * every:g} s with output.{key} {every:g} s"
            raise refuse("time", "end", got=end, want=want, hint=f"give output.{key}")
        want = f"at least {end / most:g} s: a run of {end:g} s would write more than {most:g} times"
        raise refuse("output", key, got=every, want=want)
