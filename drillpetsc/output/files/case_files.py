"""The case in the run folder: case.yaml, and case.resolved.yaml with the source of each figure of the catalogue."""

from __future__ import annotations

from drillpetsc.case.case import Case
from drillpetsc.output.files.run_folder import RunFolder


def write_case(case: Case, folder: RunFolder) -> None:
    """Write case.yaml; and case.resolved.yaml if the case has figures from catalogue, defaults or formulas."""
    case.dump(folder.case)
    if case.figures.of_item:
        folder.resolved_case.write_text(case.to_sourced_yaml(), encoding="utf-8")
