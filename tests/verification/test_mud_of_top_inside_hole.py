"""Mud around a string whose top lies inside a curved hole: a still column up to the flow line (manual: sec-mud-ends).

The column is hydrostatics; mud and walls are stiff, so that the density of the column is that of the case.
"""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc.analysis.hydraulics.hydraulics import Hydraulics
from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
from drillpetsc.case import Case
from drillpetsc.fem.quantity import OneStep
from drillpetsc.model.drilling_model import build_model
from tests.helpers.motion import integrate
from tests.helpers.mud import started

DENSITY, GRAVITY, FLOW_LINE = 1250.0, 9.80665, 12.0
RADIUS, KICKOFF, LEAN = 300.0, 200.0, np.radians(60.0)
STIFF = {"bulk_modulus": 1e13, "elastic_walls": False}
END_OF_BUILD = KICKOFF + RADIUS * LEAN


def vertical_depth(md: np.ndarray) -> np.ndarray:
    """Vertical depth [m] of the hole: straight down, an arc of RADIUS to LEAN, straight."""
    md = np.asarray(md, dtype=float)
    angle = np.clip((md - KICKOFF) / RADIUS, 0.0, LEAN)
    arc = RADIUS * np.sin(angle)
    return np.minimum(md, KICKOFF) + arc + np.maximum(md - END_OF_BUILD, 0.0) * np.cos(LEAN)


def case(length: float = 420.0, **keys) -> Case:
    """A string of ``length`` [m] that stands on the bottom of a hole of 800 m; its top lies in the build."""
    stations = [0.0, KICKOFF, END_OF_BUILD, 800.0]
    well = {
        "survey": {"md": stations, "inclination": [0.0, 0.0, LEAN, LEAN], "azimuth": [0.3] * 4},
        "sections": [
            {"kind": "casing", "to": 250.0, "diameter": 0.2205},
            {"kind": "open_hole", "to": 800.0, "diameter": 0.2159},
        ],
    }
    fluid = {
        "density": DENSITY,
        **keys.pop("stiffness", STIFF),
        "rheology": {"model": "newtonian", "viscosity": 0.02},
        "flow_line": FLOW_LINE,
        **keys.pop("fluid", {}),
    }
    string = [
        {"kind": "pipe", "length": length - 30.0, "od": 0.127, "id": 0.1086, "element_length": 12.0},
        {"kind": "pipe", "length": 30.0, "od": 0.1651, "id": 0.0714, "element_length": 5.0},
        {"kind": "bit", "length": 0.0, "od": 0.2159, "mass": 40.0, "nozzle_area": 5e-4},
    ]
    return Case(
        **{
            "well": well,
            "string": string,
            "fluid": fluid,
            "top": "clamped",
            "bottom": "bit",
            "initial": {"wob": 1e4},
            **keys,
        }
    )


@pytest.mark.parametrize("length", [150.0, 420.0, 560.0])
def test_hydraulics_of_a_string_with_its_top_in_the_build(length):
    """Still mud has its own density as ESD at every depth; flowing mud adds its friction below the top, none above it."""
    window = {"pore": DENSITY - 5.0, "frac": 2000.0}
    c = case(length, window=window)
    flow = Hydraulics(c)
    still = flow.at(1e-7)
    tvd = vertical_depth(np.asarray(still.profile["md"]))
    assert still.profile["tvd"] == pytest.approx(tvd, abs=0.01)
    assert still.profile["annulus_pressure"] == pytest.approx(DENSITY * GRAVITY * (tvd - FLOW_LINE), rel=1e-4)
    assert still.profile["ecd"] == pytest.approx(DENSITY, rel=1e-4)
    assert still.summary["ecd_bit"] == pytest.approx(DENSITY, rel=1e-4)
    assert still.summary["ecd_shoe"] == pytest.approx(DENSITY, rel=1e-4)
    assert still.limited_by == "none"
    assert any(f"top lies at MD {800 - length:g} m: the pump pressure is" in note for note in flow.notes)
    moving = flow.at(0.02).summary
    column = vertical_depth(800.0) - FLOW_LINE
    # from the flow line without pressure to the bit: the column, friction, and the velocity head of the annulus
    speed = 0.02 / (np.pi / 4 * (0.2159**2 - 0.1651**2))
    at_bit = DENSITY + moving["annulus_loss"] / (GRAVITY * column)
    assert moving["ecd_bit"] == pytest.approx(at_bit, abs=1.1 * DENSITY * speed**2 / 2 / (GRAVITY * column))
    if length < 550.0:  # the shoe lies above the string
        assert moving["ecd_shoe"] == pytest.approx(DENSITY, rel=1e-4)


@pytest.mark.parametrize("formulation", ["mixed", "hermite"])
def test_static_pressure_at_the_top(formulation):
    """Pressure around the string in statics: rho g times the depth below the flow line."""
    c = case(fluid={"flow_rate": 0.0, "formulation": formulation})
    model = build_model(c)
    find_equilibrium(model)
    assert model.fluid is not None and model.fluid.annulus is not None
    found = np.asarray(model.fluid.annulus.pressures(model.system))
    depth = model.system.field("string.position")[:, 2] - FLOW_LINE
    assert depth[0] > 200.0
    assert found == pytest.approx(DENSITY * GRAVITY * depth, rel=2e-4)


@pytest.mark.parametrize("formulation", ["mixed", "hermite"])
def test_pressure_follows_a_top_that_moves_round_the_build(formulation):
    """A string pulled up by 0.1 m in the build: the pressure at its top falls with the depth of the hole there.

    The direction of the hole turns by 3.3e-4 on the way; times the 350 m to the rig that is as much as the rise of the top.
    """
    speed = {"time": [0.0, 0.2, 0.6], "value": [0.0, -0.2, -0.2]}
    c = case(
        stiffness={},
        fluid={"flow_rate": 0.0, "formulation": formulation},
        top={"kind": "top_drive", "lowering": speed},
    )
    model = started(build_model(c))
    assert model.well is not None and model.fluid is not None and model.fluid.annulus is not None
    column = []
    for end in (0.0, 0.6):
        if end:
            integrate(model.system, end, breaks=model.breaks)
        md = model.well.project(model.system.field("string.position")[:1]).md
        column.append(
            (
                float(vertical_depth(md)[0]),
                model.fluid.annulus.upper_pressure_of(OneStep(model.system.assembly, 0.0))[0],
            )
        )
    (before, upper), (after, lower) = column
    assert before - after == pytest.approx(0.1 * np.cos((np.mean(md) - KICKOFF) / RADIUS), rel=0.02)
    assert upper - lower == pytest.approx(DENSITY * GRAVITY * (before - after), rel=0.02)
