"""Hydraulics of a mud report through a case: losses in the string, the annulus and the surface line."""

from __future__ import annotations

import numpy as np
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


def head(outer: float, inner: float = 0.0) -> float:
    """rho v^2/2 [psi] of 335 gpm of 12.8 ppg mud between two diameters [in]."""
    area = np.pi / 4 * (outer**2 - inner**2) * 0.0254**2
    density, flow = 12.8 * 0.45359237 / (231 * 0.0254**3), 335 * 231 * 0.0254**3 / 60
    return float(density * (flow / area) ** 2 / 2 / PSI)


def slot(outer: float, inner: float, length: float) -> float:
    """Laminar loss [psi] in an annulus with diameters [in] and a length [ft], n 0.2754, K 2.609 Pa s^n."""
    n, consistency, gap = 0.2754, 2.609, (outer - inner) * 0.0254
    speed = 335 * 231 * 0.0254**3 / 60 / (np.pi / 4 * (outer**2 - inner**2) * 0.0254**2)
    return float(
        consistency * (12 * speed / gap * (2 * n + 1) / (3 * n)) ** n * 4 * length * 0.3048 / gap / PSI
    )


def test_losses_of_the_api_power_law() -> None:
    """792.8 psi in the pipe, 277.9 in the collars, 15.4 and 178.6 around the pipe, 41.5 in surface case 3.

    The annulus has its own constants, from the readings at 100 and 3 rpm. The model's pressures contain rho v^2/2 besides.
    The loss around the collars is compared with the laminar slot formula (API RP 13D), K [12 v/d (2n+1)/(3n)]^n 4 L/d.
    """
    assert slot(8.625, 4.5, 855) == pytest.approx(15.4, rel=5e-3)
    found = model(surface_line={"case": 3})
    bore, annulus = (pressures(found, channel) / PSI for channel in ("bore", "annulus"))
    depth = found.mesh.node_depth / 0.3048
    collars = int(np.argmin(abs(depth - 11641)))
    assert bore[0] - bore[collars] == pytest.approx(792.8, rel=5e-3)
    in_pipe, in_collars = head(3.826), head(2.25)
    assert bore[collars] - bore[-1] + in_pipe - in_collars == pytest.approx(277.9, rel=5e-3)
    around_pipe, around_collars = head(8.625, 4.5), head(8.625, 7.0)
    assert annulus[-1] - annulus[collars] + around_collars - around_pipe == pytest.approx(
        slot(8.625, 7.0, 390), rel=5e-3
    )
    assert annulus[collars] - annulus[0] == pytest.approx(15.4 + 178.6, rel=5e-3)
    mud = FlowRecorder(found.system, found.fluid)
    loss = mud.pump_pressure(Sample(found.system, 0.0)) / PSI - bore[0]
    assert loss == pytest.approx(41.5, rel=5e-3)


@pytest.mark.parametrize(("flow", "loss"), [(335, 50 * (335 / 500) ** 2), (250, 12.5)])
def test_a_measured_surface_loss(flow: float, loss: float) -> None:
    """It goes with the flow rate squared, and into nothing but the pump pressure."""
    measured = model(flow_rate=flow, surface_line={"loss": 50, "at": 500})
    mud = FlowRecorder(measured.system, measured.fluid)
    at_string = pressures(measured, "bore")[0]
    assert (mud.pump_pressure(Sample(measured.system, 0.0)) - at_string) / PSI == pytest.approx(
        loss, rel=1e-9
    )
    assert at_string == pytest.approx(pressures(model(flow_rate=flow), "bore")[0], rel=1e-12)
