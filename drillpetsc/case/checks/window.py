"""Checks of the pressure window against the well."""

from __future__ import annotations

from drillpetsc.case.blocks.case_blocks import CaseBlocks
from drillpetsc.case.key_paths import refuse


def check_window(case: CaseBlocks) -> None:
    """Raise CaseError if there is no hole for the window."""
    if case.window is None:
        return
    if case.well is None:
        raise refuse(
            "window", want="no window without a well", hint="pore and frac are limits of the open hole"
        )
