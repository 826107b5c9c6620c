"""Loss of the surface line in the pump pressure of a run, beside the mud of a mud report."""

from __future__ import annotations

import pytest

from drillpetsc.case import Case
from drillpetsc.fem.quantity import Sample
from drillpetsc.model.drilling_model import build_model
from drillpetsc.output.measured.flow_recorder import FlowRecorder
from tests.helpers.mud import pressures, started

PSI = 0.45359237 * 9.80665 / 0.0254**2


def model(**fluid):
    """The worked example of the API's power law (github.com/BillyFrcs, slips corrected): 12.8 ppg, 335 gpm."""
    case = Case(
        units="field",
        well={
            "survey": {"md": [0, 12031], "inclination": [0, 0], "azimuth": [0, 0]},
            "sections": [
                {"to": 10786, "kind": "casing", "diameter": 8.835},
                {"kind": "open_hole", "diameter": 8.625},
            ],
        },
        string=[
            {"kind": "pipe", "length": 11641, "od": 4.5, "id": 3.826},
            {"kind": "pipe", "length": 390, "od": 7, "id": 2.25},
        ],
        hold_string=True,
        gravity="0 m/s2",
        fluid={
            "density": 12.8,
            "flow_rate": 335,
            "rheology": {"dial": {600: 53, 300: 34, 100: 21, 3: 8}, "law": "api"},
            "bulk_modulus": "1e14 Pa",
            "elastic_walls": False,
            **fluid,
        },
    )
    return started(build_model(case))


def surface_loss(found):
    """Pump pressure less the pressure at the top of the string [psi]."""
    mud = FlowRecorder(found.system, found.fluid)
    return (mud.pump_pressure(Sample(found.system, 0.0)) - pressures(found, "bore")[0]) / PSI


def test_loss_of_surface_case_3() -> None:
    """41.5 psi (the losses in the hole: tests/verification/test_hydraulics_mud_report.py)."""
    assert surface_loss(model(surface_line={"case": 3})) == pytest.approx(41.5, rel=5e-3)


@pytest.mark.parametrize(("flow", "loss"), [(335, 50 * (335 / 500) ** 2), (250, 12.5)])
def test_a_measured_surface_loss(flow: float, loss: float) -> None:
    """It goes with the flow rate squared, and into nothing but the pump pressure."""
    measured = model(flow_rate=flow, surface_line={"loss": 50, "at": 500})
    assert surface_loss(measured) == pytest.approx(loss, rel=1e-9)
    at_string = pressures(measured, "bore")[0]
    assert at_string == pytest.approx(pressures(model(flow_rate=flow), "bore")[0], rel=1e-12)
