"""Borehole files of a run: trajectory.csv and well.vtu."""

from __future__ import annotations

import numpy as np

from drillpetsc.fem.component import FloatArray
from drillpetsc.geometry.trajectory import COURSE, angles, dogleg_severity, refine_stations
from drillpetsc.geometry.well import Well
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.output import RunFolder, write_table, write_well
from drillpetsc.output.quantities.tables import COLUMNS

SPACING = 10.0  # largest distance of stations in the old hole [m]


def stations(model: DrillingModel, well: Well) -> FloatArray:
    """(n,) measured depths [m] of the stations in trajectory.csv.

    In the old hole: every ten metres, survey stations, ends of sections.  In the new hole: all nodes, and more if the
    table requires them as the survey of a following case.
    """
    case_well = model.case.well
    assert case_well is not None
    old = float(case_well.survey.md[-1])
    hole = None if model.drilling is None else model.drilling.hole
    new = hole.path_start if hole is not None and well.depth > old else old
    even = np.linspace(0.0, old, max(2, int(np.ceil(old / SPACING)) + 1))
    md = np.sort(
        np.concatenate(
            [
                even,
                case_well.survey.md,
                [s.to for s in case_well.sections],
                well.node_md[well.node_md > new - 1e-6],
                [well.depth],
            ]
        )
    )
    return refine_stations(well, md[np.append(True, np.diff(md) > 1e-6)])


def write_well_files(model: DrillingModel, folder: RunFolder) -> None:
    """Write trajectory.csv and well.vtu of the present hole with its newly drilled part; nothing without a hole."""
    bit = model.drilling
    well = model.well if bit is None else bit.drilled_hole()
    if well is None:
        return
    md = stations(model, well)
    position, tangent, _ = map(np.asarray, well.at(md))
    inclination, azimuth = map(np.degrees, angles(tangent))
    write_table(
        folder.trajectory,
        COLUMNS["trajectory.csv"],
        [md, inclination, azimuth, *position.T, np.degrees(COURSE * dogleg_severity(md, tangent))],
    )
    write_well(folder.well, md, position, np.asarray(well.radius(md)), np.asarray(well.friction(md)))
