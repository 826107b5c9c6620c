"""Surveys from files: text tables, xlsx, LAS, WITSML, and the trajectory.csv of a run.

The file is found here; its format is read in `importers/`.
"""

from __future__ import annotations

import os
from contextvars import ContextVar
from pathlib import Path

from drillpetsc.case.importers.stations import Rules, Stations, stations_of
from drillpetsc.case.importers.table import table_of_text
from drillpetsc.case.key_paths import refuse, suggestion

FOLDER: ContextVar[Path] = ContextVar("FOLDER", default=Path())
"""Base of relative file names in a case: the folder of the case file, else the working directory."""

OWN_HEADS = ["md [m]", "inclination [deg]", "azimuth [deg]", "north [m]"]  # of the trajectory.csv of a run
SHEETS, LOGS, XML = (".xlsx", ".xlsm"), (".las",), (".xml",)


def read_survey(name: str, rules: Rules) -> Stations:
    """Stations of a survey file, or of the trajectory.csv of a run folder.

    name: of the file, of a run folder, or `well.xlsx#Sheet2`
    rules: what the survey may be
    """
    file, sheet, is_run = _file(name)
    kind = file.suffix.casefold()
    try:
        if kind in SHEETS:
            from drillpetsc.case.importers.sheet import table_of_sheet

            return stations_of(table_of_sheet(file, sheet, rules.columns), rules)
        if kind in LOGS:
            from drillpetsc.case.importers.las import table_of_las

            return stations_of(table_of_las(file, rules.columns), rules)
        if kind in XML:
            from drillpetsc.case.importers.witsml import trajectory_table

            return stations_of(trajectory_table(file), rules)
        table = table_of_text(file, rules.columns)
        own = is_run or (file.name == "trajectory.csv" and table.heads[: len(OWN_HEADS)] == OWN_HEADS)
        return stations_of(table, Rules(exact=True) if own else rules)
    except OSError as error:
        raise refuse(got=name, want="a survey file that can be read", hint=str(error)) from None


def _file(name: str) -> tuple[Path, str, bool]:
    """(file, sheet or "", whether a run wrote it), searched beside the case file, then in the working directory."""
    folder = FOLDER.get()
    book, mark, sheet = name.partition("#")
    for path in (folder / name, Path(name)):
        if name.strip() and os.path.isdir(path):  # Path.is_dir raises for a name longer than any file's
            run = path / "trajectory.csv"
            if not run.is_file():
                raise refuse(got=name, want="a survey file, or a run folder that holds a trajectory.csv")
            return run, "", True
        if os.path.isfile(path):
            return path, "", False
    for path in (folder / book, Path(book)):
        if mark and book.casefold().endswith(SHEETS) and os.path.isfile(path):
            return path, sheet, False
    hint = suggestion(name, [other.name for other in folder.glob("*.csv")])
    hint = hint or f"looked in {'' if str(folder) == '.' else f'{folder} and '}the working directory"
    raise refuse(
        got=name,
        want="a survey file that exists, a run folder, or {md: [...], inclination: [...], azimuth: [...]}",
        hint=hint,
    )
