"""Added mass and damping of the mud at each mode's own frequency (manual: verif-stokes-modes)."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import yaml
from scipy.special import iv, kv

import drillpetsc
from drillpetsc import Case
from drillpetsc.output import read_table
from drillpetsc.physics.fluid.added_mass import stokes_coefficients, stokes_force
from tests.helpers import frequency_models as m
from tests.helpers.command import main_succeeds
from tests.helpers.wells import newtonian, simple_well

HOLE, MUD, L = 0.2159, 1200.0, 20.0
#: viscosity [Pa s]: frequency [Hz] and damping ratio, as computed for this check (C22) before the code was written
SPAN = {1e-3: (0.518917, 0.0070985), 2e-2: (0.506408, 0.034329), 1e-1: (0.487613, 0.086314)}


def span(viscosity: float, elements: int = 16, **fluid) -> dict:
    """20 m of drill pipe hinged at both ends, with mud at rest inside and outside."""
    return {
        "string": [m.drill_pipe(L, elements)],
        "top": "pinned",
        "bottom": {"kind": "pinned"},
        "gravity": 0.0,
        "contact": "none",
        "well": simple_well(L, HOLE, kind="casing", friction=0.0),
        "fluid": newtonian(MUD, viscosity, added_mass="stokes") | fluid,
        "initial": {"from": "straight"},
    }


def first_mode(case: dict, folder: Path, **options) -> tuple[float, float, dict]:
    """Frequency [Hz] and damping ratio of the first mode, and modes.csv."""
    drillpetsc.modes(Case(**case), folder, overwrite=True, count=2, **options)
    table = read_table(folder / "modes.csv")
    return float(table["frequency [Hz]"][0]), float(table["damping_ratio [-]"][0]), table


def force(s: complex, radius: float, viscosity: float, ratio: float) -> complex:
    """H(s), written once more with unscaled Bessel functions: four wall conditions of A/r + B r + C I1 + D K1."""
    l = np.sqrt(s * radius**2 * MUD / viscosity)

    def at(r: float) -> list[list[complex]]:
        i0, i1, k0, k1 = iv(0, l * r), iv(1, l * r), kv(0, l * r), kv(1, l * r)
        return [[1 / r, r, i1, k1], [-1 / r**2, 1, l * i0 - i1 / r, -l * k0 - k1 / r]]

    rows = np.array([*at(1.0), *at(ratio)], dtype=complex)
    A = np.linalg.solve(rows, np.array([1.0, 1.0, 0.0, 0.0]))[0]
    return complex(2 * A - 1)


def root(viscosity: float, n: int = 1) -> complex:
    """Root of EI (n pi/L)^4 + s^2 (mu + rho A_i + rho A_o H(s)) = 0, by fixed-point iteration."""
    stiffness = m.EI * (n * np.pi / L) ** 4
    inner, outer = np.pi / 4 * m.ID**2, np.pi / 4 * m.OD**2
    s = 1j * np.sqrt(stiffness / (m.MASS + MUD * (inner + 2 * outer)))
    for _ in range(200):
        s = 1j * np.sqrt(
            stiffness / (m.MASS + MUD * inner + MUD * outer * force(s, m.OD / 2, viscosity, HOLE / m.OD))
        )
    return s


def test_force_off_the_imaginary_axis():
    """On the axis it is C_m - i C_d; off the axis it solves the wall conditions; slow motion continues it."""
    S = np.array([10.0, 100.0, 1e4])
    C_m, C_d = stokes_coefficients(S, 1.7)
    for number, mass, damping in zip(S, C_m, C_d, strict=True):
        assert stokes_force(1j * number, 1.0, 1.0, 1.7) == pytest.approx(mass - 1j * damping, rel=1e-12)
    for s in (2j - 0.5, 30j - 10, 5j + 3, 0.02j - 0.01):
        expected = force(s, 0.0635, 0.05, 1.7)
        assert stokes_force(s, 0.0635, 0.05 / MUD, 1.7) == pytest.approx(expected, rel=1e-6)
    below, above = (
        complex(stokes_force((0.8j - 0.6) * q * 1e-3 / 0.49, 1.0, 1.0, 1.7)) for q in (0.999, 1.001)
    )
    assert below == pytest.approx(above, rel=4e-3)
    for bad in ((-1.0, 1.0, 1.0, 1.7), (1j, 1.0, 0.0, 1.7), (1j, 1.0, 1.0, 1.0)):
        with pytest.raises(ValueError, match="stokes_force"):
            stokes_force(*bad)


@pytest.mark.parametrize("viscosity", SPAN)
def test_hinged_span_in_mud(viscosity, tmp_path):
    """Frequency within 0.5 %, damping ratio within 2 % (C22); both within 1e-4 of the root of the closed form."""
    s = root(viscosity)
    frequency, ratio, table = first_mode(span(viscosity), tmp_path)
    assert frequency == pytest.approx(SPAN[viscosity][0], rel=5e-3)
    assert ratio == pytest.approx(SPAN[viscosity][1], rel=2e-2)
    assert frequency == pytest.approx(s.imag / (2 * np.pi), rel=1e-4)
    assert ratio == pytest.approx(-s.real / abs(s), rel=1e-4)
    number = s.imag * (m.OD / 2) ** 2 * MUD / viscosity
    assert table["stokes_number [-]"][:2] == pytest.approx([number] * 2, rel=1e-3)


def test_the_reference_frequency_has_no_influence(tmp_path):
    """lateral_damping_speed and the start of the iteration: the same mode from 0.3 and from 30 rad/s."""
    found = [first_mode(span(2e-2, lateral_damping_speed=w), tmp_path)[:2] for w in (0.3, 30.0)]
    assert found[0] == pytest.approx(found[1], rel=1e-8)


def test_without_viscosity_and_without_damping(tmp_path):
    """No viscosity: the inviscid 0.522544 Hz.  `lateral_damping: none`: the mass of the viscous flow, undamped."""
    frequency, ratio, table = first_mode(span(0.0), tmp_path)
    assert frequency == pytest.approx(0.522544, rel=1e-4) and abs(ratio) < 1e-9
    assert np.isinf(table["stokes_number [-]"][0])
    frequency, ratio, _ = first_mode(span(2e-2, lateral_damping="none"), tmp_path)
    assert abs(ratio) < 1e-9 and 0.49 < frequency < 0.515


def test_from_a_case_file(tmp_path):
    """A case file through the command line; the second pair of modes too; the reference in a run is C_m there."""
    from drillpetsc.model.drilling_model import build_model

    file = tmp_path / "span.yaml"
    file.write_text(yaml.safe_dump(span(2e-2, 24)))
    main_succeeds("modes", file, "--count", "4", "--out", tmp_path / "run")
    table = read_table(tmp_path / "run" / "modes.csv")
    second = root(2e-2, 2)
    assert table["frequency [Hz]"][2:4] == pytest.approx([second.imag / (2 * np.pi)] * 2, rel=5e-4)
    assert table["damping_ratio [-]"][2:4] == pytest.approx([-second.real / abs(second)] * 2, rel=1e-3)
    model = build_model(Case(**span(2e-2, lateral_damping_speed=3.0)))
    number = 3.0 * (m.OD / 2) ** 2 * MUD / 2e-2
    assert model.fluid.annulus.lateral.added == pytest.approx(
        float(stokes_coefficients(number, HOLE / m.OD)[0]), rel=1e-12
    )


@pytest.mark.parametrize("swirl", ["none", "auto"])
def test_in_campbell_and_response(swirl, tmp_path):
    """Over the rotary speed the branches keep the mode's own force, and an unbalance meets it at the speed's frequency:
    an eccentric span answers with e m w^2 over the dynamic stiffness with H(i w) (first mode's share 4/pi: exact beam
    solution -e' + e'/2 (1/cos q + 1/cosh q), q^4 = M w^2 (L/2)^4/EI, e' = e m/M with the complex mass M).  In mud that swirls with
    the share l of the speed the unbalance, which goes round forward, meets it at the rate (1 - l) w (manual: eq-eigen-swirl)."""
    case = span(2e-2)
    case["fluid"] = {**case["fluid"], "swirl": swirl}
    past = 1.0 - (m.OD**2 / (m.OD**2 + HOLE**2) if swirl == "auto" else 0.0)
    drillpetsc.campbell(Case(**case), tmp_path / "c", speeds="0:20:20 rpm", count=2)
    table = read_table(tmp_path / "c" / "campbell.csv")
    s = root(2e-2)
    at_rest = table["rotary_speed [rpm]"] == 0
    assert table["frequency [Hz]"][at_rest][:2] == pytest.approx([s.imag / (2 * np.pi)] * 2, rel=1e-4)
    case["string"] = [m.drill_pipe(L, 16, eccentricity=1e-3)]
    case["output"] = {"probes": [10.0]}
    drillpetsc.response(Case(**case), tmp_path / "r", excite="unbalance", speeds="25,40 rpm")
    table = read_table(tmp_path / "r" / "response.csv")
    w = np.array([25.0, 40.0]) * m.RPM
    inner, outer = np.pi / 4 * m.ID**2, np.pi / 4 * m.OD**2
    H = past**2 * np.array([force(1j * past * q, m.OD / 2, 2e-2, HOLE / m.OD) for q in w])
    mass = m.MASS + MUD * inner + MUD * outer * H
    q = (mass * w**2 / m.EI) ** 0.25 * L / 2
    exact = np.abs(1e-3 * m.MASS / mass * (-1 + 0.5 / np.cos(q) + 0.5 / np.cosh(q)))
    rows = table["place [-]"] == "probe 10 m"
    assert table["lateral_amplitude [m]"][rows] == pytest.approx(exact, rel=5e-3)
