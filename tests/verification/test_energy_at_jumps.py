"""Energy balance at a jump of a prescribed velocity (manual: verif-energy-at-jumps)."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc import Case, run
from drillpetsc.output import read_table


def test_a_jump_of_rotation_keeps_the_energy_balance(tmp_path):
    """A hanging pipe whose top speed jumps from 60 to 90 rpm: the drive supplies impedance GJ/c times the
    jump times the new speed (d'Alembert), and the energy balance closes before and after the jump."""
    pipe = {"kind": "pipe", "length": 200, "od": 0.127, "id": 0.1086, "element_length": 5}
    rotation = {"time": [0, 0.02, 0.02, 1], "value": ["60 rpm", "60 rpm", "90 rpm", "90 rpm"]}
    case = Case(
        string=[pipe],
        top={"kind": "top_drive", "rotation": rotation},
        time={"end": 0.05},
        gravity=0.0,
        output={"history_every": 0.001},
        petsc={"ts_rtol": 1e-6},
    )
    h = read_table(run(case, tmp_path / "jump", progress="silent").folder / "history.csv")
    t, stored = h["time [s]"], h["kinetic_energy [J]"] + h["strain_energy [J]"]
    shear, density, polar = 206e9 / 2.6, 7850.0, np.pi / 32 * (0.127**4 - 0.1086**4)
    jump = np.pi
    impedance = polar * np.sqrt(
        shear * density
    )  # [N m s]; the drive's torque is impedance * jump, at its new speed
    late = t > 0.025
    gained = np.polyfit(t[late], stored[late], 1)[0]
    expected = impedance * jump * 3 * np.pi
    assert gained == pytest.approx(expected, rel=0.02)
    # the energy balance includes the work of the jump, so the energy gained at the jump is checked separately
    assert stored[-1] - stored[0] == pytest.approx(expected * (t[-1] - 0.02), rel=0.005)
    assert np.abs(h["energy_error [J]"]).max() < 2e-3 * stored.max()
