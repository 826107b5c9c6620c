"""Rows of the parallel matrix about the mud: side nozzles, losses, swirl, and flow in a string at rest, that moves, or that drills."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.helpers.collar_in_mud import CASE as COLLAR_IN_MUD
from tests.helpers.ranks import same_histories
from tests.parallel.rows import flow
from tests.parallel.rows.row import Columns, Row, steps, summaries

#: a string in a hole that builds slowly, with a pump that is turned down
PUMPED = """
string: STRING
well:
  survey: {md: [0, 210], inclination: [0.0, 0.1], azimuth: [0, 0]}
  sections: [{to: 210, kind: open_hole, diameter: 0.22}]
top: {kind: top_drive, rotation: 1.0}
fluid: {density: 1200, rheology: {model: newtonian, viscosity: 0.02}, flow_rate: {time: [0.02, 0.06], value: [0.03, 0.02]}}
time: {end: 0.1}
output: {history_every: 0.02}
"""
PIPE = "{kind: pipe, od: 0.127, id: 0.1086, element_length: 20.0, "
BIT = "{kind: bit, length: 0.3, od: 0.2159, mass: 50.0, nozzle_area: 4.0e-4}"
NOZZLES = "{kind: stabilizer, length: 1.0, od: 0.2159, body_od: 0.17, id: 0.0714, blade_length: 0.5, "
LOSS = (
    "pressure_loss: {curve: {flow_rate: [0.01, 0.02, 0.04], loss: [2.0e+5, 9.0e+5, 1.2e+6]}, density: 1000.0}"
)
#: nozzles above the bit, and tools whose losses have curves and whose mud has its own sections, a flexible and a rigid one
NOZZLES_AND_LOSSES = f"""
  - {PIPE}length: 60.0}}
  - {PIPE}length: 40.0, name: tool, {LOSS}, bore_volume: 0.25, annulus_od: 0.14}}
  - {NOZZLES}nozzle_area: 2.0e-4}}
  - {{kind: body, length: 1.0, od: 0.17, id: 0.07, {LOSS}, bore_volume: 0.003, annulus_od: 0.19}}
  - {PIPE}length: 60.0}}
  - {NOZZLES}nozzle_area: 1.0e-4}}
  - {PIPE}length: 40.0}}
  - {BIT}"""


def side_flow(folders: list[Path], history: Columns) -> None:
    flow, pressure = history["side_flow [m3/s]"], history["pump_pressure [Pa]"]
    assert 0.005 < flow[-1] < flow[0] < 0.02 and pressure[-1] < pressure[0] - 5e5


def whirls(folders: list[Path], history: Columns) -> None:
    """Mud that swirls about a turning string, its rigid items and its bit: probes and energy errors agree, too."""
    probes = same_histories(folders, least=1e-9, table="probes.csv")
    for depth in ("6", "12.5", "20"):
        assert np.hypot(probes[f"x_{depth} [m]"], probes[f"y_{depth} [m]"]).max() > 1e-5
    error = [summary["energy"]["error_share"] for summary in summaries(folders)]
    assert error == pytest.approx([error[0]] * len(error), rel=1e-3)


def swirling(**fluid: Any) -> Row:
    case = COLLAR_IN_MUD | {"fluid": COLLAR_IN_MUD["fluid"] | fluid}
    return Row(case, ("-ts_type", "bdf", *steps("5e-3")), least=1e-9, shows=whirls)


ROWS = {
    "side nozzles, tool losses": Row(
        PUMPED.replace("STRING", NOZZLES_AND_LOSSES), steps("5e-3"), least=1e-9, shows=side_flow
    ),
    "swirl with its lag": swirling(),
    "swirl at once": swirling(swirl=0.4, swirl_lag=False),
}
ROWS |= {
    f"mud, {kind}": Row(
        flow.keys(**case),
        steps("2e-3"),
        1.0,
        np.inf,
        shows=partial(flow.same_flow, kind in ("drilling", "moving")),
    )
    for kind, case in flow.CASES.items()
}
