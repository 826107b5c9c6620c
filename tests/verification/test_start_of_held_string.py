"""A string whose lower end is held, and whose top moves from time 0 on (manual: eq-statics-share-of-top).

Stretched evenly from the start it has no waves: hook load and torque rise by the velocity over the compliance.
"""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc import Case, run
from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
from drillpetsc.analysis.statics.flow_coupling import surge_rates
from drillpetsc.model.drilling_model import build_model
from tests.helpers.wells import simple_well

YOUNG, POISSON = 206e9, 0.3
PIPES = ((0.127, 0.1086, 600.0), (0.1714, 0.0714, 200.0))  # od, id, length [m]
MUD = {
    "density": 1260.0,
    "flow_rate": 0.03,
    "bulk_modulus": 2e9,
    "rheology": {"model": "bingham", "plastic_viscosity": 0.02, "yield_stress": 4.0},
}


def string(lowering: float, rotation: float = 0.0, bottom: str = "clamped", **more) -> Case:
    """Two pipes in a vertical hole without friction."""
    length = sum(q[2] for q in PIPES)
    return Case(
        well=simple_well(length, 0.2159, friction=0.0),
        string=[{"kind": "pipe", "od": a, "id": b, "length": c, "element_length": 20.0} for a, b, c in PIPES],
        top={"kind": "top_drive", "lowering": lowering, "rotation": rotation},
        bottom=bottom,
        initial={"from": "statics"},
        time={"end": 0.2},
        output={"history_every": 0.01},
        **more,
    )


def compliance(modulus: float, power: int) -> float:
    """Sum of length over stiffness: area for power 2, polar second moment of area for power 4."""
    share = {2: np.pi / 4, 4: np.pi / 32}[power]
    return sum(c / (modulus * share * (a**power - b**power)) for a, b, c in PIPES)


@pytest.mark.parametrize("beam", ["ancf", "quaternion"])
@pytest.mark.parametrize("bottom", ["clamped", "pinned"])
def test_hook_load_rises_by_the_stiffness_of_the_string(tmp_path, bottom, beam):
    """A string of two sections, pulled by 0.2 m/s: dF/dt = V / sum(L/EA), without the shock rho c V A of a rigid start (25 kN)."""
    result = run(string(-0.2, bottom=bottom, beam={"formulation": beam}, gravity=0.0), tmp_path / "run")
    time, load = result.history["time"], result.history["hook_load"]
    exact = load[0] + 0.2 * time / compliance(YOUNG, 2)
    assert np.abs(load - exact).max() < 0.02 * (exact[-1] - exact[0])


def test_torque_rises_by_the_stiffness_of_the_string(tmp_path):
    """1 rad/s wind the string up: dM/dt = Omega / sum(L/GJ)."""
    result = run(string(0.0, rotation=1.0, gravity=0.0), tmp_path / "run")
    time, torque = result.history["time"], result.history["surface_torque"]
    exact = torque[0] + time / compliance(YOUNG / (2 + 2 * POISSON), 4)
    assert np.abs(torque - exact).max() < 0.02 * (exact[-1] - exact[0])


def test_a_string_stuck_in_mud_is_pulled(tmp_path):
    """With mud the step that met the held end fell to 1e-12 s, and the run ended at time 0."""
    result = run(string(-1.0, fluid=MUD), tmp_path / "run")
    load = result.history["hook_load"]
    assert load[-1] - load[0] == pytest.approx(0.2 / compliance(YOUNG, 2), rel=0.05)
    assert not any("the whole string moves" in w for w in result.summary["warnings"])


def test_mud_of_a_stuck_string_knows_its_stretch():
    """Rates that the steady flow sees: those of the top at the top, none at the held end, V x / L within one pipe."""
    model = build_model(string(-1.0, fluid=MUD))
    find_equilibrium(model)
    rates = surge_rates(model, -1.0)
    down = rates[model.system.layout.dofs["string.position"]][:, 2]
    soft = np.append(0.0, np.cumsum(model.mesh.length / model.mesh.axial_stiffness))
    assert np.allclose(down, -(1 - soft / soft[-1]), atol=1e-6)
