"""Checks of hoist and autodriller against other blocks."""

from __future__ import annotations

from drillpetsc.case.blocks.case_blocks import CaseBlocks
from drillpetsc.case.key_paths import refuse


def check_hoist(case: CaseBlocks) -> None:
    """Raise CaseError if a hoist or an autodriller has nothing to move or to measure."""
    drill, hoist = case.top.autodriller, case.top.hoist
    if case.time is not None and case.time.mode == "quasi_static":
        hint = "without inertia the drum's lowering moves the top itself"
        if drill is not None:
            raise refuse("top", "autodriller", want="no autodriller in a quasi-static run", hint=hint)
        if hoist is not None and hoist.heave is not None:
            raise refuse("top", "hoist", "heave", want="no heave in a quasi-static run", hint=hint)
    if drill is None:
        return
    if case.bottom.kind != "bit":
        for key, given in (("mode", "wob" in drill.mode), ("mode", "rop" in drill.mode)):
            if given:
                want = "no wob or rop unless bottom is a bit on the end of the hole"
                raise refuse(
                    "top", "autodriller", key, got=", ".join(drill.mode), want=want, hint="bottom: bit"
                )
    if "differential_pressure" in drill.mode and (case.fluid is None or not case.has_bore):
        want = "no differential_pressure without mud that is pumped into the string"
        raise refuse("top", "autodriller", "mode", got=", ".join(drill.mode), want=want)
    fixed = case.petsc.get("ts_dt") if case.petsc.get("ts_adapt_type") == "none" else None
    if drill.sample and isinstance(fixed, (int, float)) and fixed > drill.sample * (1 + 1e-9):
        want = f"at least the fixed step petsc.ts_dt, {fixed:g} s"
        raise refuse("top", "autodriller", "sample", got=drill.sample, want=want)
