"""Shortest times of a model against closed forms, and against the eigenvalues of the elements themselves."""

from __future__ import annotations

import numpy as np
import pytest
import yaml
from scipy.integrate import solve_ivp
from scipy.linalg import eigh, eigvals

from drillpetsc.analysis.commands.check import describe
from drillpetsc.analysis.motion.time_scales import (
    AXIAL,
    BENDING,
    MUD,
    TORSIONAL,
    impact_time,
    time_scales,
)
from drillpetsc.analysis.statics.placement import place_along_hole
from drillpetsc.case.reader import load_case
from drillpetsc.doubts.moments import Start
from drillpetsc.doubts.motion import steps_beyond_impacts
from drillpetsc.model.drilling_model import build_model
from drillpetsc.physics.contact import ContactLaw
from drillpetsc.solvers.linear.linearization import linearise
from drillpetsc.unit_systems import duration
from tests.helpers.wells import newtonian, simple_well

ONE = {
    "string": [
        {
            "kind": "beam",
            "length": 4.0,
            "axial_stiffness": 7.2e8,
            "bending_stiffness": 3.0e6,
            "torsional_stiffness": 2.5e6,
            "mass": 30.0,
            "polar_inertia": 0.08,
            "element_length": 4.0,
        }
    ],
    "top": "free",
    "bottom": "free",
    "gravity": [0, 0, 0],
    "initial": {"from": "straight"},
}


def scene_of(tmp_path, case: dict):
    (tmp_path / "case.yaml").write_text(yaml.safe_dump(case))
    model = build_model(load_case(tmp_path / "case.yaml"))
    place_along_hole(model)
    return model


def test_impact_of_a_linear_wall_takes_half_a_period():
    """pi sqrt(m/k), at any speed."""
    law = ContactLaw(stiffness=1e8, restitution_speed=0.3)
    assert impact_time(law, np.array([25.0]), np.array([9.0]))[0] == pytest.approx(
        np.pi * np.sqrt(25.0 / 1e8), rel=1e-12
    )


def test_impact_on_a_hertz_wall_against_integration_in_time():
    """m u'' = -k u^1.5 integrated from the wall with speed v until it is left again."""
    m, k, v = 25.0, 3e9, 0.7
    left = lambda t, y: y[0]  # noqa: E731
    left.terminal, left.direction = True, -1  # type: ignore[attr-defined]
    path = solve_ivp(
        lambda t, y: [y[1], -k / m * max(y[0], 0.0) ** 1.5],
        (0, 1),
        [1e-12, v],
        events=left,
        rtol=1e-10,
        atol=1e-14,
    )
    law = ContactLaw(stiffness=k, law="hertz", restitution_speed=v)
    assert impact_time(law, np.array([m]), np.array([9.0]))[0] == pytest.approx(path.t_events[0][0], rel=1e-5)
    shared = ContactLaw(
        stiffness=k, law="hertz_point", restitution_speed=v, points=2
    )  # a point carries half of 9 m of pipe
    expected = impact_time(
        ContactLaw(stiffness=k, law="hertz", restitution_speed=v), np.array([m * 4.5]), np.array([1.0])
    )
    assert impact_time(shared, np.array([m]), np.array([9.0])) == pytest.approx(expected)


def test_periods_of_one_free_element_are_its_highest_eigenvalues(tmp_path):
    """K and M of the own element: bending sqrt(8400 EI/(mu L^4)) (e.g. Cook, Concepts and
    Applications of FEA, 11.4), torsion sqrt(6 GJ/(I L^2)) (mean of consistent and lumped inertia); along the
    axis it is no stiffer than the full cubic."""
    model = scene_of(tmp_path, ONE)
    scales, system = time_scales(model), linearise(model.system)
    K, M = system.K.toarray(), system.M.toarray()
    names = [f.name for f in model.system.layout.fields]
    of_line = np.isin(system.field, [names.index("string.position"), names.index("string.tangent")])
    across, along = (np.flatnonzero((system.component == k) & of_line) for k in (0, 2))
    turning = np.flatnonzero(system.field == names.index("string.spin"))

    def fastest(rows) -> float:
        return 2 * np.pi / np.sqrt(eigh(K[np.ix_(rows, rows)], M[np.ix_(rows, rows)], eigvals_only=True)[-1])

    assert scales.bending == pytest.approx(fastest(across), rel=1e-6)
    assert scales.torsional == pytest.approx(fastest(turning), rel=1e-6)
    assert 0.5 * fastest(along) < scales.axial <= fastest(along) * (1 + 1e-9)


def test_constants_from_the_shape_functions():
    """Consistent matrices of the cubic and the linear element by Gauss quadrature of their shape functions,
    length 1."""
    x, w = np.polynomial.legendre.leggauss(6)
    x, w = 0.5 * (x + 1), 0.5 * w
    N = np.array([1 - 3 * x**2 + 2 * x**3, x - 2 * x**2 + x**3, 3 * x**2 - 2 * x**3, x**3 - x**2])
    first = np.array([-6 * x + 6 * x**2, 1 - 4 * x + 3 * x**2, 6 * x - 6 * x**2, 3 * x**2 - 2 * x])
    second = np.array([-6 + 12 * x, -4 + 6 * x, 6 - 12 * x, 6 * x - 2])
    mass = (N * w) @ N.T
    assert eigh((first * w) @ first.T, mass, eigvals_only=True)[-1] == pytest.approx(AXIAL, rel=1e-10)
    assert eigh((second * w) @ second.T, mass, eigvals_only=True)[-1] == pytest.approx(BENDING, rel=1e-10)
    linear = np.array([1 - x, x])
    slope = np.array([-np.ones(6), np.ones(6)])
    between = 0.5 * ((linear * w) @ linear.T + 0.5 * np.eye(2))
    assert eigh((slope * w) @ slope.T, between, eigvals_only=True)[-1] == pytest.approx(TORSIONAL, rel=1e-10)


def test_period_of_mud_bounds_that_of_the_mesh(tmp_path):
    """Stiff pipe closed below, a = sqrt(K/rho): 2 pi/(sqrt(6) a/h), and no frequency of a mesh of eight such
    elements is above it."""
    rho, bulk, h = 1100.0, 1.9e9, 10.0
    case = {
        "hold_string": True,
        "string": [{"kind": "pipe", "length": 80.0, "od": 0.127, "id": 0.1086, "element_length": h}],
        "fluid": newtonian(rho, 1e-3, bulk_modulus=bulk, flow_rate=0.0, elastic_walls=False, annulus=False),
        "top": "clamped",
        "bottom": "free",
        "gravity": [0, 0, 0],
    }
    model = scene_of(tmp_path, case)
    scales, system = time_scales(model), linearise(model.system)
    assert scales.mud == pytest.approx(2 * np.pi / np.sqrt(MUD) * h / np.sqrt(bulk / rho), rel=1e-12)
    inside = np.flatnonzero(system.field != [f.name for f in model.system.layout.fields].index("bit.flow"))
    K, C = (A.toarray()[np.ix_(inside, inside)] for A in (system.K, system.C))
    roots = eigvals(K, -C)
    fastest = np.abs(roots[np.isfinite(roots)].imag).max()
    assert 0.98 * 2 * np.pi / scales.mud < fastest <= 2 * np.pi / scales.mud * (1 + 1e-6)


def said(model, step: float | None) -> list[str]:
    """What the user reads of fixed steps of this length [s]."""
    return steps_beyond_impacts.sentences(
        Start(model=model, fixed_step=step, impact=time_scales(model).impact)
    )


def test_warnings_of_fixed_steps_and_the_words_of_check(tmp_path):
    """A fixed step of 0.29 t_c is fine, one of 0.31 t_c is not; nothing to say without a wall, or with steps
    by tolerance."""
    well = simple_well(100, 0.2159, 0.5, kind="casing", friction=0.2)
    case = {
        "well": well,
        "string": [{"kind": "pipe", "length": 50.0, "od": 0.127, "id": 0.1086}],
        "top": "clamped",
        "bottom": "free",
        "contact": {"stiffness": 1e9},
    }
    model = scene_of(tmp_path, case)
    mass = 7850 * np.pi / 4 * (0.127**2 - 0.1086**2)
    t_c = np.pi * np.sqrt(mass / 1e9)
    assert time_scales(model).impact == pytest.approx(t_c, rel=1e-9)
    assert said(model, 0.29 * t_c) == [] == said(model, None)
    assert "do not resolve impacts" in said(model, 0.31 * t_c)[0]
    text = describe(model.case)
    assert f"impact on the wall {duration(t_c)}" in text and f"caps them at {duration(0.5 * t_c)}" in text
    assert said(scene_of(tmp_path, ONE), 1.0) == []
    assert [duration(s) for s in (1.5, 0.0017, 4.2e-5)] == ["1.5 s", "1.7 ms", "42 us"]
