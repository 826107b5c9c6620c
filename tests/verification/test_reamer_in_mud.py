"""A reamer in mud: areas of the flow past it, what returns while it widens the hole, balances of mass and energy
(manual: verif-reamer-mud)."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from drillpetsc import Case, Session, run
from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
from drillpetsc.model.drilling_model import build_model
from drillpetsc.output import read_table
from drillpetsc.physics.fluid import moving_hole
from tests.helpers.wells import newtonian
from tests.verification.test_reamer import LENGTH, PILOT_LENGTH, reaming
from tests.verification.test_two_of_a_kind import two_reamers

OUTER = np.pi / 4 * 0.1778**2


def area(diameter: float) -> float:
    return np.pi / 4 * diameter**2


def in_mud(case: dict, flow: float = 0.03, gravity: bool = True, **fluid: Any) -> dict:
    """``case`` with mud in and around the string; bodies of 0.19 m, and cutters at the lower end of the reamers."""
    for item in case["string"]:
        if item["kind"] == "reamer":
            item |= {"body_od": 0.19, "blade_length": 0.4, "blade_position": 0.2}
    case["fluid"] = newtonian(1200, 0.02, flow_rate=flow) | fluid
    if gravity:
        del case["gravity"]
    return case


SIZES = [(0.2159, 0.2667), (0.3112, 0.4064)]


@pytest.mark.parametrize(("bit", "reamer"), SIZES)
def test_areas_of_the_hole_beside_and_below_the_reamer(bit, reamer):
    """Wide beside the item down to its cutters, and the pilot's below, with the wall's transition of 0.5 m in between:
    its radius has the mean of both, so its area is between the pilot's and the reamer's."""
    model = build_model(Case(**in_mud(reaming(bit, reamer, 30e6, 0.6, 120, 0.0, 40e3, "dynamic"))))
    find_equilibrium(model)
    annulus, mesh = model.fluid.annulus, model.mesh
    k = int(np.flatnonzero(mesh.rigid_above > 0)[0])
    assert mesh.rigid_above[k] == pytest.approx(1.0)
    assert annulus.parameter("hole_above")[k] == pytest.approx(area(reamer), rel=2e-3)
    length = mesh.length[k]
    excess = (annulus.parameter("hole")[k] - area(bit)) * length
    assert 0.35 * 0.5 < excess / (area(reamer) - area(bit)) < 0.6 * 0.5
    assert annulus.parameter("hole")[k + 1] == pytest.approx(area(bit), rel=1e-6)
    assert annulus.parameter("hole")[k - 1] == pytest.approx(area(reamer), rel=1e-6)


@pytest.mark.parametrize("cuttings", ["removed", "returned"])
@pytest.mark.parametrize(("bit", "reamer"), SIZES)
def test_what_returns_while_a_reamer_widens_the_hole(bit, reamer, cuttings, tmp_path):
    """A full bore that moves rigidly: the hole gains the reamed area A_r V, the string takes A_o V of it.

    Mud returns at q - (A_r - A_o) V where the cuttings are removed, at q + A_o V where the rock becomes mud.
    """
    rpm, flow = 120.0, 0.03
    depth = 20e-3
    rate = depth * rpm / 60
    energy, ratio = 10e6, 0.6
    wob = ratio * energy * 0.5 * bit * depth
    case = in_mud(reaming(bit, reamer, energy, ratio, rpm, rate, wob, "dynamic"), flow, cuttings=cuttings)
    summary = run(Case(**case), tmp_path / "run", progress="silent").summary
    got = {k.split(" [")[0]: q for k, q in read_table(tmp_path / "run" / "history.csv").items()}
    late = got["time"] > 1.0
    speed = np.polyfit(got["time"][late], got["hole_depth_reamer"][late], 1)[0]
    assert speed == pytest.approx(rate, rel=5e-3)
    gain = OUTER if cuttings == "returned" else OUTER - area(reamer)
    returned = got["outlet_flow"][late].mean() - flow
    assert returned == pytest.approx(gain * rate, abs=0.01 * area(reamer) * rate)
    if cuttings == "returned":
        assert summary["mass"]["cuttings"] == pytest.approx(area(reamer) * rate * 3.0, rel=1e-2)
    # between two readings of the hole the content lags behind by what the reamer's metres differ from the string's, 0.6 mm
    assert abs(summary["mass"]["error"]) < 1e-3 * (area(reamer) - area(bit))
    assert abs(summary["energy"]["error_share"]) < 1e-3


def test_mass_closes_where_the_hole_is_read_in_every_step(tmp_path, monkeypatch):
    """Without the lag of 10 mm between two readings the balance of mass closes to what the stretch of the string leaves."""
    monkeypatch.setattr(moving_hole, "REFRESH", 1e-7)
    monkeypatch.setattr(moving_hole, "SURELY_NEAR", (0.0, 0.0))
    bit, reamer, depth = 0.3112, 0.4064, 20e-3
    wob = 0.6 * 10e6 * 0.5 * bit * depth
    case = in_mud(reaming(bit, reamer, 10e6, 0.6, 120.0, 2 * depth, wob, "dynamic"))
    summary = run(Case(**case), tmp_path / "run", progress="silent").summary
    print(summary["mass"])
    assert abs(summary["mass"]["error"]) < 1e-5 * (area(reamer) - area(bit))


@pytest.mark.parametrize("two", [False, True])
def test_the_mud_keeps_the_volume_of_the_hole(two):
    """After 0.15 m: volume above each node against that of the hole when it was read last, within the rings times 2 mm."""
    rate = 0.05
    make = two_reamers if two else reaming
    sizes = ((0.2159, 0.2667, 0.3112),) if two else (0.2159, 0.2667)
    wob = 0.6 * 10e6 * 0.5 * 0.2159 * 0.025
    case = Case(**in_mud(make(*sizes, 10e6, 0.6, 120, rate, wob, "dynamic"), 0.02))
    with Session(case) as session:
        session.step(3.0)
        around = session._model.fluid.annulus.moving_hole
        since = around._rings(np.ones(len(around.depth), dtype=bool), lambda q: q.reamed) - around._ringed
        true = around.hole.volume(around.depth) - since
        widest = area(0.3112 if two else 0.2667)
        assert around.depth[-1] > LENGTH - PILOT_LENGTH
        assert np.abs(around.volume - true).max() < (widest - area(0.2159)) * 2e-3
