"""Reflection of torsional waves at a controlled top (manual: eq-top-drive-reflection), check C1."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from drillpetsc import Case, top_drive
from drillpetsc.output import read_table
from drillpetsc.physics.top.control import Law, Motor, reflection, top_impedance
from tests.helpers import top_drive_models as m
from tests.helpers.component_models import build
from tests.helpers.tables import each_row

FREQUENCIES = np.array([0.05, 0.1, 0.2, 0.3, 0.5, 1.0])
STIFF = Law("stiff", p=50 * m.ZETA, i=5 * m.INERTIA)
SOFT = Law("soft_torque", p=4 * m.ZETA, i=(0.4 * np.pi) ** 2 * m.INERTIA)
COMPENSATED = replace(SOFT, i=0.25 * SOFT.i, compensation=0.75 * m.INERTIA)
Z_TORQUE = replace(STIFF, kind="z_torque", coupling=0.25 / m.ZETA, high_pass=10 / np.pi)
#: computed from the formula before the code was written
TABLE = [
    (STIFF, [0.99613, 0.98700, 0.96932, 0.96163, 0.96403, 0.98160]),
    (SOFT, [0.99627, 0.97785, 0.60000, 0.93644, 0.98837, 0.99772]),
    (COMPENSATED, [0.94798, 0.80879, 0.60000, 0.70219, 0.87179, 0.96648]),
    (Z_TORQUE, [0.77356, 0.64008, 0.55532, 0.55033, 0.62117, 0.80112]),
    (replace(Z_TORQUE, coupling=1 / m.ZETA), [0.44170, 0.22041, 0.06247, 0.09723, 0.25175, 0.52547]),
    (replace(SOFT, delay=0.05), [0.99699, 0.98203, 0.52805, 0.94295, 0.99024, 0.99819]),
]


@each_row(("law", "expected"), TABLE)
def test_reflection(law, expected):
    assert m.ZETA == pytest.approx(296.3714, rel=1e-6)
    r = np.abs(reflection(law, Motor(m.INERTIA), m.ZETA, FREQUENCIES))
    assert r == pytest.approx(expected, abs=1e-4)


def test_the_command_writes_the_same(tmp_path):
    """All controllers of the table in one case, between its rows by interpolation; 2e-3."""
    pipe = {"kind": "pipe", "length": 2000.0, "od": 0.127, "id": 0.1086, "element_length": 50.0}
    controls = [m.STIFF, m.SOFT, m.COMPENSATED, m.Z_TORQUE, m.Z_TORQUE_1, {**m.SOFT, "delay": 0.05}]
    case = Case(
        string=[pipe],
        material={"young": m.YOUNG, "poisson": 0.3, "density": m.DENSITY},
        top=m.top([{**q, "from": float(k)} for k, q in enumerate(controls)], 10.0),
    )
    result = top_drive(case, tmp_path / "out")
    table = read_table(result.folder / "reflection.csv")
    for k, (_, expected) in enumerate(TABLE):
        rows = table["controller [-]"] == k + 1
        r = np.interp(FREQUENCIES, table["wave_frequency [Hz]"][rows], table["reflection [-]"][rows])
        assert r == pytest.approx(expected, abs=2e-3)
    summary = result.summary["top_drive"]
    assert summary["impedance"] == pytest.approx(m.ZETA)
    assert summary["control"][1]["reflection"] == pytest.approx(0.6)
    # pipe held at its top, free below: c/4L
    assert summary["torsional_frequency"] == pytest.approx(m.SPEED / 8000, rel=1e-3)


@each_row(
    "kind",
    [
        "motor_pi",
        "motor_soft_delay",
        "motor_ztorque_direct_delay",
        "motor_ztorque_lag_delay",
        "motor_ztorque_estimated",
    ],
)
def test_rows_of_the_drive_have_the_impedance_of_the_law(kind):
    """Torque of the pipe over the speed of the top, from the rows of motor and controller, states eliminated; the delay's two
    states follow it to (s d)^5/720 (Pade), here 3e-6."""
    system, t, frequency = build(kind), 0.4, 0.3 / (0.6 * 2 * np.pi)
    asm, drive = system.assembly, system.components[-1]
    ready = next(b for b in asm.bound_blocks if b.block.name == "top_motor")
    index = ready.index[0]
    here = [
        6,
        *(k for k in range(7, len(index)) if index[k] != system.layout.size),
    ]  # spin and the states that there are
    start, columns = asm.block_rows(ready, t)[0].copy(), []
    for values in (asm.x, asm.y, asm.a):
        own = []
        for k in here:
            values[index[k]] += 1e-3
            own.append((asm.block_rows(ready, t)[0] - start)[here] / 1e-3)
            values[index[k]] -= 1e-3
        columns.append(np.array(own).T)
    s = 2j * np.pi * frequency
    S = columns[0] + s * columns[1] + s**2 * columns[2]
    impedance = (S[0, 0] - S[0, 1:] @ np.linalg.solve(S[1:, 1:], S[1:, 0])) / s
    expected = top_impedance(drive.laws[0], drive.motor, np.array([frequency]))[0]
    assert abs(impedance / expected - 1) < 1e-4
