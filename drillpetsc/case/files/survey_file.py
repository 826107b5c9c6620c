"""Surveys from files: text tables, xlsx, LAS, WITSML, and the trajectory.csv of a run.

The file is found here; its format is read in `importers/`.
"""

from __future__ import annotations

import os
from pathlib import Path

from drillpetsc.case.files.named_file import SHEETS, find_file, named_file
from drillpetsc.case.importers.stations import Rules, Stations, stations_of
from drillpetsc.case.importers.table import table_of_text
from drillpetsc.case.key_paths import refuse

OWN_HEADS = ["md [m]", "inclination [deg]", "azimuth [deg]", "north [m]"]  # of the trajectory.csv of a run
LOGS, XML = (".las",), (".xml",)


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
    found = find_file(name, os.path.exists)
    if found is not None and found.is_dir():
        run = found / "trajectory.csv"
        if not run.is_file():
            raise refuse(got=name, want="a survey file, or a run folder that holds a trajectory.csv")
        return run, "", True
    want = "a survey file that exists, a run folder, or {md: [...], inclination: [...], azimuth: [...]}"
    return *named_file(name, want), False
