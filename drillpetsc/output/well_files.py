"""Files of a run that hold the hole: trajectory.csv and well.vtu."""

from __future__ import annotations

import numpy as np

from drillpetsc.fem.component import FloatArray
from drillpetsc.geometry.trajectory import COURSE, angles, dogleg_severity, refine_stations
from drillpetsc.geometry.well import Well
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.output import RunFolder, write_table, write_well

COLUMNS = [
    ("md", "m"),
    ("inclination", "deg"),
    ("azimuth", "deg"),
    ("north", "m"),
    ("east", "m"),
    ("tvd", "m"),
    ("dogleg_severity", "deg/30m"),
]
SPACING = 10.0  # of the stations in the old hole, at most [m]


def present_hole(model: DrillingModel) -> Well | None:
    """The hole with what was drilled of it."""
    return model.drilling.drilled_hole() if model.drilling is not None else model.well


def stations(model: DrillingModel, well: Well) -> FloatArray:
    """(n,) measured depths [m]: every ten metres, survey stations and ends of sections in the old hole; all
    nodes of the new one, and more where it needs them to be the survey of the next case."""
    q = model.case.well
    assert q is not None
    old = float(q.survey.md[-1])
    even = np.linspace(0.0, old, max(2, int(np.ceil(old / SPACING)) + 1))
    md = np.sort(
        np.concatenate(
            [even, q.survey.md, [s.to for s in q.sections], well.node_md[well.node_md > old], [well.depth]]
        )
    )
    return refine_stations(well, md[np.append(True, np.diff(md) > 1e-6)])


def write_well_files(model: DrillingModel, folder: RunFolder) -> None:
    """trajectory.csv and well.vtu of the hole as it is now."""
    well = present_hole(model)
    assert well is not None
    md = stations(model, well)
    position, tangent, _ = map(np.asarray, well.at(md))
    inclination, azimuth = map(np.degrees, angles(tangent))
    write_table(
        folder.trajectory,
        COLUMNS,
        [md, inclination, azimuth, *position.T, np.degrees(COURSE * dogleg_severity(md, tangent))],
    )
    write_well(folder.well, md, position, np.asarray(well.radius(md)), np.asarray(well.friction(md)))
