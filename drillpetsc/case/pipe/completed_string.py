"""The string with all its figures: from the case, the catalogue, defaults and formulas.

`completed_string` runs once, when a case is built. Every figure that it adds is recorded with its source. Items come out with
all keys written in SI and without references, so that the case reads back the same without the catalogue.
"""

from __future__ import annotations

import os

from drillpetsc.case.blocks.case_blocks import CaseBlocks
from drillpetsc.case.blocks.items.string import Bit, Item, Stabilizer
from drillpetsc.case.blocks.items.tubulars import Jointed, Tubular
from drillpetsc.case.catalogue.tables import Catalogue
from drillpetsc.case.files.named_file import FOLDER, find_file
from drillpetsc.case.key_paths import refuse, suggestion
from drillpetsc.case.pipe.completion import Completion
from drillpetsc.case.pipe.figures import Figure, Figures
from drillpetsc.case.pipe.stabilizers import StabilizerCompletion
from drillpetsc.case.pipe.tubulars import TubularCompletion


def read_catalogue(name: str | None) -> Catalogue:
    """The built-in catalogue, preceded by the rows of the user's folder or file.

    Relative names refer to the folder of the case file first, then to the working directory.
    """
    if name is None:
        return Catalogue.built_in()
    path = find_file(name, os.path.exists)
    if path is not None:
        return Catalogue.built_in().with_files(path)
    folder = FOLDER.get()
    others = [p.name for p in folder.iterdir()] if folder.is_dir() else []
    raise refuse(
        "catalogue",
        got=name,
        want="a folder with CSV files, or one CSV file, beside the case file",
        hint=suggestion(name, others) or f"looked in {folder} and the working directory",
    )


#: kind of item -> what completes it; `Completion` for the others
KINDS: dict[type[Item], type[Completion]] = {Tubular: TubularCompletion, Stabilizer: StabilizerCompletion}


def completed_string(case: CaseBlocks, fill: str = "") -> tuple[tuple[Item, ...], Figures, tuple[int, ...]]:
    """(items with all figures, what was added, number in the case file of each item).

    A stabilizer whose body bends becomes up to three items.
    fill: source of the length of the topmost item, if the case did not give it
    """
    if not fill and not any(
        item.weight is not None or isinstance(item, (Tubular, Stabilizer, Bit)) for item in case.string
    ):
        return case.string, Figures(), tuple(range(len(case.string)))
    catalogue = read_catalogue(case.catalogue)
    items: list[Item] = []
    found: dict[int, tuple[Figure, ...]] = {}
    references: dict[int, str] = {}
    origins: list[int] = []
    for number, item in enumerate(case.string):
        of_kind = next((done for kind, done in KINDS.items() if isinstance(item, kind)), Completion)
        work = of_kind(number, item, case, catalogue)
        parts = work.items()
        if fill and number == 0:
            work.note("length", item.length, "m", fill)
        for part in parts:
            if work.figures and (len(parts) == 1 or isinstance(part, Stabilizer)):
                found[len(items)] = tuple(work.figures)
            if isinstance(item, Jointed) and item.pipe is not None:
                references[len(items)] = item.pipe
            items.append(part)
            origins.append(number)
    return tuple(items), Figures(found, references), tuple(origins)
