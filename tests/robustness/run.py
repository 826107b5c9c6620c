"""One computation of the extreme family, in this process."""

from __future__ import annotations

from pathlib import Path

from drillpetsc.analysis.statics import run_statics
from drillpetsc.analysis.transient import run
from drillpetsc.case import load_case
from tests.robustness.scenes import Part
from tests.robustness.start_in_wall import run_from_wall


def compute(part: Part, cases: Path, out: Path) -> None:
    """A part of a scene, its case file taken from the folder ``cases``, into the run folder ``out``/name;
    what is there is replaced."""
    case, folder = load_case(cases / f"{part.case}.yaml"), out / part.name
    if part.kind == "statics":
        if part.weight_on_bit is not None:
            case = case.model_copy(
                update={"initial": case.initial.model_copy(update={"wob": part.weight_on_bit})}
            )
        run_statics(case, folder, part.motion, overwrite=True, name=part.name)
    elif part.kind == "wall":
        run_from_wall(case, folder)
    else:
        run(case, folder, overwrite=True, name=part.name, progress="silent")
