"""Cases as the functions of the Python interface take them."""

from __future__ import annotations

from pathlib import Path

from drillpetsc.case import Case, load_case


def loaded(case: Case | str | Path, name: str | None) -> tuple[Case, str]:
    """(case, name) of a case or of the path of a case file."""
    if isinstance(case, Case):
        return case, name or "case"
    return load_case(case), name or Path(case).stem
