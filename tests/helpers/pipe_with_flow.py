"""A straight pipe that conveys fluid, alone or in a filled hole: its model, its linearised lateral motion,
and the same from a spectral solution of the linear equation.

Units: lengths in L, times in sqrt(m_all L^4/EI) with m_all the mass per length of pipe and fluid in it,
forces in EI/L^2.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import Legendre, Polynomial
from scipy.linalg import eigvals

from drillpetsc import Case
from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
from drillpetsc.model.drilling_model import DrillingModel, build_model
from tests.helpers.moving import matrices
from tests.helpers.wells import newtonian

LENGTH, BENDING, DENSITY, OUTER, INNER = 10.0, 1e4, 1000.0, 0.12, 0.1  # [m], [N m2], [kg/m3], [m], [m]
BORE, SOLID = np.pi / 4 * INNER**2, np.pi / 4 * OUTER**2  # [m2]
FORCE = BENDING / LENGTH**2  # unit of force [N]
INCOMPRESSIBLE = newtonian(DENSITY, 0.0, bulk_modulus=1e14, elastic_walls=False)


@dataclass(frozen=True)
class Tube:
    """Pipe (or solid cylinder) of ``elements``; mass of the pipe [kg/m]; hole: diameter [m], 0: none."""

    mass: float
    elements: int = 16
    hole: float = 0.0
    axial: float = 1e10

    @classmethod
    def of(cls, beta: float, elements: int = 16) -> Tube:
        """Tube with beta = fluid mass over total mass."""
        return cls(DENSITY * BORE * (1 - beta) / beta, elements)

    @property
    def time(self) -> float:
        """Unit of time [s]."""
        return float(np.sqrt((self.mass + DENSITY * BORE) * LENGTH**4 / BENDING))

    def case(self, fluid: dict, top="pinned", bottom="pinned", **keys) -> Case:
        item = {
            "kind": "beam",
            "length": LENGTH,
            "axial_stiffness": self.axial,
            "bending_stiffness": BENDING,
            "torsional_stiffness": 1e4,
            "mass": self.mass,
            "polar_inertia": 1.0,
            "od": OUTER,
            "id": INNER,
            "element_length": LENGTH / self.elements,
        }
        model = {
            "string": [item],
            "top": top,
            "bottom": bottom,
            "gravity": 0.0,
            "initial": {"imperfection": 0.0},
            "fluid": {**INCOMPRESSIBLE, **fluid},
        }
        if self.hole:
            survey = {"md": [0.0, LENGTH + 2], "inclination": [0.0, 0.0], "azimuth": [0.0, 0.0]}
            section = {"to": LENGTH + 2, "kind": "casing", "diameter": self.hole, "friction": 0.0}
            model |= {"contact": "none", "well": {"survey": survey, "sections": [section]}}
        return Case(**{**model, **keys})

    def at_rest(self, fluid: dict, stretch: float = 0.0, **case) -> DrillingModel:
        """DrillingModel in its steady state; stretch: elevation of the upper end [m]."""
        model = build_model(self.case(fluid, **case))
        if stretch:
            model.top.shift(-stretch)
        find_equilibrium(model)
        assert np.abs(model.system.field("string.position")[:, :2]).max() == 0.0  # straight
        return model


def flow_of(u: float) -> float:
    """Pump rate [m3/s] of the speed u = U L sqrt(rho A_i/EI)."""
    return float(u / LENGTH * np.sqrt(BENDING / (DENSITY * BORE)) * BORE)


def across(model: DrillingModel) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """K, C, M (m, m) of the free motion of a vertical string in one plane, in SI; it must be independent of
    all other unknowns."""
    system = model.system
    place = system.layout.dofs
    lateral = np.concatenate([place["string.position"][:, 0], place["string.tangent"][:, 0]])
    held = [row for f in system.assembly.row_replacements for row in f.rows[np.abs(f.D).max(axis=0) > 0]]
    free, others = np.setdiff1d(lateral, held), np.setdiff1d(np.arange(system.layout.size), lateral)
    out = matrices(system)
    for A in out:
        assert np.abs(A[np.ix_(free, others)]).max(initial=0.0) <= 1e-9 * np.abs(A).max()
    return tuple(A[np.ix_(free, free)] for A in out)  # type: ignore[return-value]


def roots_of(K: np.ndarray, C: np.ndarray, M: np.ndarray) -> np.ndarray:
    """All s with K + s C + s^2 M singular."""
    zero, one = np.zeros_like(K), np.eye(len(K))
    return eigvals(np.block([[zero, one], [-K, -C]]), np.block([[one, zero], [zero, M]]))


def oscillating(s: np.ndarray, count: int) -> np.ndarray:
    """The slowest oscillating roots, one of each pair."""
    s = s[np.isfinite(s) & (s.imag > 1e-6)]
    return s[np.argsort(np.abs(s))][:count]


def softest(model: DrillingModel) -> float:
    """Smallest eigenvalue of the (symmetric) lateral stiffness: zero at divergence."""
    K = across(model)[0]
    assert np.abs(K - K.T).max() < 1e-6 * np.abs(K).max()
    return float(np.linalg.eigvalsh(0.5 * (K + K.T))[0])


def fastest_growing(s: np.ndarray) -> complex:
    """The root with the largest real part, of positive frequency, among the first few that oscillate."""
    s = oscillating(s, 5)
    return complex(s[np.argmax(s.real)])


# ---------------------------------------------------------------------- the linear equation, solved by
# polynomials over the whole length
ENDS = {
    "cantilever": Polynomial([0, 0, 1]),
    "pinned": Polynomial([0, 1, -1]),
    "clamped": Polynomial([0, 0, 1, -2, 1]),
}


def spectral(
    ends: str, tension=(0.0,), centrifugal=0.0, coriolis=0.0, damping=0.0, drag=0.0, mass=1.0, terms: int = 14
) -> np.ndarray:
    """Eigenvalues s of y'''' - (T y')' + centrifugal y'' + coriolis y_t' + damping y_t + drag y' + mass y_tt
    = 0 on 0..1.

    tension: coefficients of the polynomial T(x). Galerkin's method with Legendre polynomials times factors
    that satisfy the conditions at the ends. Moment and shear of a free end are zero in the weak form of y''''
    alone, so T(1) must be zero there.
    """
    T = Polynomial(tension)
    assert ends != "cantilever" or abs(T(1.0)) < 1e-9
    shapes = [Legendre.basis(j, domain=[0, 1]).convert(kind=Polynomial) * ENDS[ends] for j in range(terms)]
    x, w = np.polynomial.legendre.leggauss(2 * terms + 6)
    x, w = 0.5 * (x + 1), 0.5 * w
    y, y1, y2 = (np.array([f.deriv(k)(x) if k else f(x) for f in shapes]) for k in range(3))
    test = y * w
    K = (y2 * w) @ y2.T + test @ (-T(x) * y2 - T.deriv()(x) * y1 + centrifugal * y2 + drag * y1).T
    return roots_of(K, test @ (coriolis * y1 + damping * y).T, test @ (mass * y).T)


def conveying(u: float, beta: float, gamma: float = 0.0, ends: str = "cantilever") -> np.ndarray:
    """Eigenvalues of a pipe with flow, y'''' + [u^2 - gamma (1 - x)] y'' + 2 sqrt(beta) u y_t' + gamma y' +
    y_tt = 0 (Paidoussis, Fluid-Structure Interactions, vol. 1, section 3.1)."""
    return spectral(ends, (gamma, -gamma), u**2, 2 * np.sqrt(beta) * u)
