"""The shortest times of a model, impacts and waves across one element, and the time steps that resolve them.

The highest frequency of one free element is an upper bound for any mesh of such elements (Irons and Treharne, 1971).
BDF up to order 2 is stable at any step, so these times do not limit a run.  They show which motions a
step can resolve, and the step that an explicit method would need.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import gamma, pi, sqrt

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.doubts.motion import RESOLVED_FRACTION
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.model.fluid import FluidComponents
from drillpetsc.physics.contact import ContactLaw
from drillpetsc.unit_systems import duration

STRICT_FRACTION = (
    0.5  # longest adaptive step with contact.energy_strict, as a fraction of an impact's duration
)
#: omega^2 of the highest mode of a free element, times (L/c)^2 (bending: times L^4 mu/EI).  Axial motion is
#: cubic with consistent mass: the larger root of l^2 - 45 l + 105 = 0 for half the length, times 4.  Bending
#: is cubic.  Torsion, and pressure at the nodes with flow in the element, are linear with the mean of
#: consistent and lumped mass (storage), [5 1; 1 5]/12, which has the least dispersion.
AXIAL, BENDING, TORSIONAL, MUD = 4 * (45 + sqrt(1605)) / 2, 8400.0, 6.0, 6.0


@dataclass(frozen=True)
class TimeScales:
    """Shortest times [s], infinite if the model has no such motion.

    impact: duration of an impact of an element or rigid item on the wall.
    bit: half a period of the bit on the bottom.
    axial, torsional, bending, mud: period of the fastest element.
    """

    impact: float = np.inf
    bit: float = np.inf
    axial: float = np.inf
    torsional: float = np.inf
    bending: float = np.inf
    mud: float = np.inf

    @property
    def explicit_step(self) -> float:
        """Longest step of an explicit method of order 2 (leapfrog), 2/omega [s]."""
        return min(self.axial, self.torsional, self.bending, self.mud, 2 * self.impact) / pi

    def lines(self) -> list[str]:
        """Return lines of text for the user."""
        parts = [
            (self.impact, "impact on the wall"),
            (self.bit, "bit on the bottom"),
            (self.axial, "axial wave"),
            (self.torsional, "torsional wave"),
            (self.bending, "bending wave"),
            (self.mud, "pressure wave"),
        ]
        named = [f"{text} {duration(value)}" for value, text in parts if np.isfinite(value)]
        if not named:
            return []
        out = ["time scales (waves: period of the fastest element): " + ", ".join(named)]
        if np.isfinite(self.impact):
            out.append(
                f"steps: impacts are resolved below {duration(RESOLVED_FRACTION * self.impact)}; contact.energy_strict caps them at "
                f"{duration(STRICT_FRACTION * self.impact)}; an explicit method would need {duration(self.explicit_step)}"
            )
        else:
            out.append(
                f"steps: of any length (BDF 1 and 2); an explicit method would need {duration(self.explicit_step)}"
            )
        return out


def impact_time(law: ContactLaw, mass: FloatArray, length: FloatArray) -> FloatArray:
    """Compute the duration (n,) [s] of undamped impacts at the law's ``restitution_speed`` v.

    Manual: eq-contact-impact-time.

    From m u'' = -k u^p: t = 2 d/v int_0^1 dx / sqrt(1 - x^(p+1)) = 2 d/v sqrt(pi) G(1 + q)/G(1/2 + q), with q
    = 1/(p + 1) and the depth d = ((p + 1) m v^2 / 2k)^q (manual: eq-contact-impact-depth).  It is pi
    sqrt(m/k) at p = 1, and 2.943 d/v at p = 3/2 (Hertz: Timoshenko and Goodier, Theory of Elasticity, 142).

    law: contact law.
    mass: (n,) per length [kg/m]; length: (n,) of the impacting pieces [m].
    """
    p = 1.0 if law.law == "linear" else 1.5
    point_mass = mass * length / law.points if law.law == "hertz_point" else mass
    q, v = 1 / (p + 1), law.restitution_speed
    depth = (0.5 * (p + 1) * point_mass * v**2 / law.stiffness) ** q
    return 2 * depth / v * sqrt(pi) * gamma(1 + q) / gamma(0.5 + q)


def time_scales(model: DrillingModel) -> TimeScales:
    """Compute the time scales of a model.

    Waves and impacts use the mass of steel only (added mud would slow them).
    """
    mesh, scales = model.mesh, {}
    if model.beam.moves:
        e = ~mesh.is_joint
        L, mass = mesh.length[e], mesh.mass[e]
        scales["axial"] = _period(AXIAL * mesh.axial_stiffness[e] / (mass * L**2))
        scales["torsional"] = _period(
            TORSIONAL * mesh.torsional_stiffness[e] / (mesh.polar_inertia[e] * L**2)
        )
        scales["bending"] = _period(BENDING * mesh.bending_stiffness[e] / (mass * L**4))
    if model.contact is not None:
        touching = (mesh.contact_diameter > 0) & ~mesh.is_joint
        masses, lengths = list(mesh.mass[touching]), list(mesh.length[touching])
        for item in mesh.bodies:
            if item.radius > 0 and item.mass > 0 and item.length > 0:
                masses.append(item.mass / item.length)
                lengths.append(item.length)
        if masses:
            scales["impact"] = float(
                impact_time(model.contact.law, np.array(masses), np.array(lengths)).min()
            )
    if model.bit is not None:
        stiffness = model.bit.stiffness
        mass_at_end = (
            sum(b.mass for b in mesh.bodies if b.node == mesh.nodes - 1)
            + 0.5 * mesh.mass[-1] * mesh.length[-1]
        )
        scales["bit"] = pi * sqrt(float(mass_at_end) / stiffness)
    if model.fluid is not None:
        scales["mud"] = _mud(model, model.fluid)
    return TimeScales(**scales)


def _period(squares: FloatArray) -> float:
    """Compute the shortest period [s] from squared angular frequencies (n,) [1/s2]."""
    valid = squares[np.isfinite(squares) & (squares > 0)]
    return 2 * pi / sqrt(float(valid.max())) if valid.size else np.inf


def _mud(model: DrillingModel, fluid: FluidComponents) -> float:
    """Compute the period [s] of the fastest element of both channels.

    Wave speed (rho (1/K + wall))^(-1/2) (Korteweg).
    """
    # a joint has no length and stores next to nothing
    f, L = fluid.constants, np.where(model.mesh.is_joint, np.inf, model.mesh.length)
    walls = [] if fluid.bore is None else [fluid.bore.bore.wall]
    walls += [] if fluid.annulus is None else [fluid.annulus.annulus.wall]
    return min(_period(MUD / (f.density * (1 / f.bulk_modulus + wall) * L**2)) for wall in walls)


def longest_strict_step(model: DrillingModel) -> float:
    """Compute the longest adaptive step [s] with contact.energy_strict; infinite without contact."""
    return STRICT_FRACTION * time_scales(model).impact
