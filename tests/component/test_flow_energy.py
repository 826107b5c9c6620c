"""Energy of mud in a pipe whose walls give way: weights, storage and lifting add up (manual: sec-mud-energy)."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from drillpetsc import Case, run
from drillpetsc.output import read_table
from drillpetsc.physics.fluid.channel_flow import RESULT_NAMES, FluidConstants
from drillpetsc.physics.fluid.rheology import Rheology
from tests.helpers.component_models import GRAVITY, SHIFT
from tests.helpers.flow_models import build
from tests.helpers.tables import each_row
from tests.helpers.wells import simple_well

WALL = 0.02  # d(ln A)/dp [1/Pa], and pressures of about 1 Pa: a give of 2 %
DENSITY, BULK, AREA_HOLE, SLOW = 3.0, 60.0, 0.3, 1e-4


@each_row("kind", ["pipe", "pipe_junction", "annulus"])
def test_slow_motion_of_a_give_in_the_walls_balances(kind):
    """V.F + (q + A V) R_q + (h - rho0 g.c) R_p over all rows = d(energy)/dt + dissipated - left out + ends, with the
    flow work h = K (1 - exp(-p/K)) and the position c of the mud.

    The string moves as one piece.  Motion and flow are slow, so that kinetic energy and the elements' products of
    speeds do not count and only pressure and weight are left.  The give of the walls holds a fiftieth of the mud: its weight in the potential, its
    lifting by the flow and the power left out must each be there, or the sum is off by as much.
    """
    law = Rheology(
        "newtonian", law="blend", consistency=1e-3, index=1.0, yield_stress=0.0, shear_rate_eps=1.0
    )
    fluid = FluidConstants(DENSITY, BULK, GRAVITY, law.parameters(), 0.4)
    system = build(kind, fluid=fluid, noise=0.003)
    asm, component = system.assembly, system.components[-1]
    for b in component._blocks:
        b.update = None
        b.named["control"], b.named["wall"] = 0.0, WALL
        if kind == "annulus":
            b.named["hole"] = AREA_HOLE
    asm.condense(SHIFT)
    pressure, flow = (
        system.layout.dofs[f"{component.name}.pressure"][:, 0],
        system.layout.dofs[f"{component.name}.flow"][1:, 0],
    )
    string = np.setdiff1d(np.arange(system.layout.size), np.concatenate([pressure, flow]))
    rng = np.random.default_rng(3)
    asm.y[:], asm.a[:] = 0.0, 0.0
    asm.x[pressure], asm.y[pressure] = (
        1.0,
        SLOW * rng.uniform(-1, 1),
    )  # alike at all nodes, as in a short string
    asm.x[flow] = 1e-3 * SLOW * rng.uniform(-1, 1, 4)
    asm.y[system.layout.dofs["string.position"]] = SLOW * rng.uniform(
        -1, 1, 3
    )  # as one piece, in any direction
    x, y, a = asm.x.copy(), asm.y.copy(), asm.a.copy()

    def energy(step: float) -> float:
        asm.x[:] = x + step * y
        asm.x[-1] = 1.0
        asm.y[string] = y[string] + step * a[string]
        return component.element_results(asm)[:, :3].sum()

    h = 1.0  # [s]: displacements of 1e-4
    e = [energy(k * h) for k in (-2, -1, 1, 2)]
    rate = (e[0] - 8 * e[1] + 8 * e[2] - e[3]) / (12 * h)
    asm.x[:], asm.y[:], asm.a[:] = x, y, a
    rows = np.zeros(system.layout.size)
    for ready in (b for b in asm.bound_blocks if b.block in component._blocks):
        np.add.at(rows, ready.index.ravel(), asm.block_rows(ready, 0.4).ravel())
    place = system.field("string.position")
    head, speed, ends = DENSITY * (place @ GRAVITY), np.zeros(4), 0.0
    density = DENSITY * np.exp(0.5 * (x[pressure][1:] + x[pressure][:-1]) / BULK)
    if kind == "annulus":
        u, w = system.field("string.position", "y"), system.field("string.tangent", "y")
        p = component.parameters(np.arange(4))
        t = p["tangent1"] + p["tangent2"]
        t /= np.linalg.norm(t, axis=1, keepdims=True)
        speed = np.sum(((u[:-1] + u[1:]) / 2 + (w[:-1] - w[1:]) / 12) * t, axis=1)
        ends = AREA_HOLE * (
            x[pressure[-1]] * u[-1] @ p["tangent2"][-1] - x[pressure[0]] * u[0] @ p["tangent1"][0]
        )
        height = component.well.at(np.arange(5.0))[0] @ GRAVITY
        head = DENSITY * height
        # elements of 1 m are chords of this hole: (1 - cos) of half its turn in the weight that moves along
        turn = 0.5 * np.sum((u[:-1] + u[1:]) * t - u[1:] * p["tangent2"] - u[:-1] * p["tangent1"], axis=1)
        ends += AREA_HOLE * np.sum(density * np.diff(height) * turn)
    flow_work = BULK * -np.expm1(-x[pressure] / BULK)
    results = component.element_results(asm).sum(axis=0)
    lost, left_out = (results[RESULT_NAMES.index(name)] for name in ("dissipated", "left_out"))
    parts = (
        rows[string] * y[string],
        1e2 * rows[flow] * (x[flow] * DENSITY / density + (AREA_HOLE - 0.126) * speed),
        1e-6 * rows[pressure] * (flow_work - head),
    )
    total, expected = sum(q.sum() for q in parts), rate + lost - left_out + ends
    size = sum(np.abs(q).sum() for q in parts)
    assert total == pytest.approx(expected, abs=1e-3 * size)
    assert abs(left_out) > 4e-3 * size, "the motion does not show what is tested"


WELL = simple_well([0, 100, 300, 500], 0.2159, [0, 0, 1.0, 1.0], kind="casing", friction=0.2)
MUD = {"density": 1200, "rheology": {"model": "newtonian", "viscosity": 0.02}, "bulk_modulus": 2.2e9}
CASES = {
    "lowered in a curved hole": {
        "top": {"kind": "top_drive", "lowering": {"time": [0, 0.5], "value": [0, 0.3]}},
        "fluid": MUD | {"flow_rate": 0.0},
    },
    "pump starts": {"fluid": MUD | {"flow_rate": {"time": [0, 0.3, 0.6], "value": [0, 0, 0.02]}}},
    "pump trips": {
        "fluid": MUD
        | {"outlet_pressure": 2e6, "flow_rate": {"time": [0, 0.3, 0.6], "value": [0.02, 0.02, 0]}}
    },
    "held": {
        "hold_string": True,
        "fluid": MUD
        | {"outlet_pressure": 2e6, "flow_rate": {"time": [0, 0.3, 0.6], "value": [0.02, 0.02, 0]}},
    },
    "no annulus": {"fluid": MUD | {"flow_rate": 0.02, "annulus": False}},
}


@pytest.mark.parametrize("name", CASES)
def test_balance_of_a_string_with_mud_closes(name, tmp_path: Path):
    """Every row of the energy error is within 1 % of the energy exchanged, and no alarm is raised."""
    data = {
        "well": WELL,
        "string": [{"kind": "pipe", "length": 400, "od": 0.127, "id": 0.1086, "element_length": 20}],
        "top": {"kind": "top_drive"},
        "bottom": "free",
        "time": {"end": 1.5},
        "output": {"history_every": 0.02},
    }
    if name == "held":
        del data["top"], data["bottom"]
    summary = run(Case(**(data | CASES[name])), tmp_path / "run", progress="silent").summary
    error = read_table(tmp_path / "run" / "history.csv")["energy_error [J]"]
    exchanged = abs(summary["energy"]["error"] / summary["energy"]["error_share"])
    assert np.abs(error).max() < 0.01 * exchanged
    assert not summary["energy"]["flag"]


def test_a_loss_is_named_as_numerical_damping():
    """2 % lost that the time formula has removed are named; a loss that it has not removed, a gain, and 0.01 % are not."""
    from drillpetsc.analysis.motion.summary import closing_lines

    summary = {"title": "", "elements": 1, "unknowns": 1, "ranks": 1, "simulated": 1.0, "wall_seconds": 1.0}
    summary |= {
        "real_time_factor": 1.0,
        "steps": 1,
        "rejected_steps": 0,
        "newton_iterations": 1,
        "jacobians": 1,
    }
    for share, damped, named in (
        (-0.02, {"damped": 20.0, "damped_share": 0.02}, True),
        (-0.02, {"damped": 0.0, "damped_share": 0.0}, False),
        (-0.02, {}, False),
        (0.02, {"damped": -20.0, "damped_share": -0.02}, False),
        (-1e-4, {"damped": 0.1, "damped_share": 1e-4}, False),
    ):
        energy = {"error": 1e3 * share, "error_share": share} | damped
        lines = closing_lines(summary | {"energy": energy}, "run")
        assert ("removed by numerical damping" in lines[2]) is named
