"""Rheology of the drilling fluid and its wall friction in pipe and annulus (manual: sec-mud-friction).

`Rheology` is plain data; `Rheology.parameters()` is the flat array of kernel arguments.  The wall shear
stress tau is signed and odd in the mean speed w.  It has a continuous derivative through zero flow and
through the transition to turbulence.  The pressure falls by 4 tau / d_h per length, with d_h the bore, or the
hole minus the string diameter.

Models: tau = tau_y + K gamma^n (newtonian, power_law, bingham, herschel_bulkley are its cases), and casson,
sqrt(tau) = sqrt(tau_y) + sqrt(K gamma).  Laws, alpha = 0 pipe, 1 annulus (a slot):

blend   tau_lam = {[(4-alpha)/(3-alpha)]^n tau_y/g_e + K g_e^(n-1)} g,  g = 8 G w/d_h,  g_e^2 = g^2 +
shear_rate_eps^2,
        G = [((3-alpha)n+1)/((4-alpha)n)](1+alpha/2); Re = 8 rho w^2/tau_lam; friction factors f_lam = 16/Re,
        f_tr = 16 Re/(3470-1370n)^2, f_tu = a/Re^b, a = (log10 n + 3.93)/50, b = (1.75 - log10 n)/7;
        f^12 = f_lam^12 + (f_tr^-8 + f_tu^-8)^(-12/8).  Structure and constants of API RP 13D (2006 and
        later), recalled. The explicit laminar stress of a fluid with yield stress is at most 2.2 % off in a
        pipe and 6 % in a slot up to tau_y/tau_w = 0.5, and too high near gelling.  Casson has no explicit
        form: its exact one is used.
api     power law only, Baker Hughes, Drilling Fluids Reference Manual (2006), p. 9-14: Metzner-Reed Reynolds
number, f = 16/Re in a
        pipe, 24/Re in an annulus, a/Re^b above 4270-1370n, a straight line from 3470-1370n; the two kinks are
        rounded within 40 in Re (the values outside do not change).
python  tau_lam of a flow curve that is a function of the user, from its integrated profile; transition and turbulence as blend.
exact   tau_lam from the integrated profile of the pipe (Rabinowitsch, Buckingham) or of the slot; transition
and turbulence as blend.

The flow index n of a Casson fluid is 1.  A gel below its yield stress creeps, since `shear_rate_eps` smooths
the yield.  For any smaller index, the constants a and b are evaluated at n = 0.05.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drillpetsc.kernels import function, pointer
from drillpetsc.kernels.parameters import columns
from drillpetsc.physics.fluid.own_rheology import FlowCurve

Array = NDArray[np.float64]

MODELS = ("newtonian", "bingham", "power_law", "casson", "herschel_bulkley", "python")
LAWS = columns("friction_law").names
_KINDS = columns("rheology_kind")

_size = function("rheology_size", "", int)
_pack = function("rheology_pack", "iiddddp")
_own_curve = function("rheology_own_curve", "pp")
_wall_shear = function("rheology_wall_shear", "pipppppp")


@dataclass(frozen=True)
class Rheology:
    """Flow curve and friction law of a drilling fluid.

    model: one of ``MODELS``; law: one of ``LAWS``.
    consistency: K [Pa s^n]; with n = 1 the viscosity or plastic viscosity [Pa s].
    index: n [-]; yield_stress: [Pa].
    shear_rate_eps: shear rate below which stresses go smoothly to zero [1/s].
    curve: flow curve of the user (``own_rheology.flow_curve``), None for the models with a formula; consistency and index are then
    those of turbulence.

    Raises ValueError for combinations that no kernel can evaluate.
    """

    model: str
    law: str = "blend"
    consistency: float = 0.0
    index: float = 1.0
    yield_stress: float = 0.0
    shear_rate_eps: float = 1.0
    curve: FlowCurve | None = field(default=None, compare=False)
    _parameters: Array = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        """Check the values and fill the packed form."""
        if self.model not in MODELS or self.law not in LAWS:
            raise ValueError(
                f"rheology {self.model!r}, {self.law!r}: models are {', '.join(MODELS)}; laws {', '.join(LAWS)}"
            )
        if not (
            self.consistency >= 0
            and self.yield_stress >= 0
            and self.shear_rate_eps > 0
            and 0 < self.index <= 2
        ):
            raise ValueError(
                "rheology: need consistency and yield_stress not negative, shear_rate_eps above 0, index in (0, 2]"
            )
        if self.index != 1 and self.model in ("newtonian", "bingham", "casson"):
            raise ValueError(f"rheology: a {self.model} fluid has index 1, not {self.index}")
        if self.yield_stress > 0 and (self.law == "api" or self.model in ("newtonian", "power_law")):
            raise ValueError(f"rheology: no yield stress with {self.model}, law {self.law}")
        if self.law == "api" and self.model not in ("newtonian", "power_law"):
            raise ValueError("rheology: the law api is for a power law")
        packed = np.zeros(_size())
        kind = _KINDS[{"casson": "casson", "python": "own"}.get(self.model, "herschel_bulkley")]
        _pack(
            kind,
            LAWS.index(self.law),
            self.consistency,
            self.index,
            self.yield_stress,
            self.shear_rate_eps,
            pointer(packed),
        )
        if self.curve is not None:
            _own_curve(pointer(packed), pointer(self.curve.table))
        packed.setflags(write=False)
        object.__setattr__(self, "_parameters", packed)

    @classmethod
    def newtonian(cls, viscosity: float, law: str = "blend", shear_rate_eps: float = 1.0) -> Rheology:
        """Create a Newtonian fluid; viscosity [Pa s], 0: without friction."""
        return cls("newtonian", law, viscosity, shear_rate_eps=shear_rate_eps)

    @classmethod
    def power_law(
        cls, consistency: float, index: float, law: str = "blend", shear_rate_eps: float = 1.0
    ) -> Rheology:
        """Create a power-law fluid; consistency [Pa s^n], index n [-]."""
        return cls("power_law", law, consistency, index, shear_rate_eps=shear_rate_eps)

    @classmethod
    def bingham(
        cls, plastic_viscosity: float, yield_stress: float, law: str = "blend", shear_rate_eps: float = 1.0
    ) -> Rheology:
        """Create the fluid; plastic viscosity [Pa s], yield stress [Pa]."""
        return cls("bingham", law, plastic_viscosity, 1.0, yield_stress, shear_rate_eps)

    @classmethod
    def casson(
        cls, plastic_viscosity: float, yield_stress: float, law: str = "blend", shear_rate_eps: float = 1.0
    ) -> Rheology:
        """Create the fluid; plastic viscosity [Pa s], yield stress [Pa]."""
        return cls("casson", law, plastic_viscosity, 1.0, yield_stress, shear_rate_eps)

    @classmethod
    def herschel_bulkley(
        cls,
        consistency: float,
        index: float,
        yield_stress: float,
        law: str = "blend",
        shear_rate_eps: float = 1.0,
    ) -> Rheology:
        """Create a Herschel-Bulkley fluid; consistency [Pa s^n], index n [-], yield_stress [Pa]."""
        return cls("herschel_bulkley", law, consistency, index, yield_stress, shear_rate_eps)

    def parameters(self) -> Array:
        """Return the kernels' parameters (RHEOLOGY_SIZE,) in the layout of kernels/fluid/rheology.hpp, read-only."""
        return self._parameters

    def apparent_viscosity(self, shear_rate: ArrayLike) -> Array:
        """Compute stress over shear rate (n,) [Pa s] at shear_rate (n,) [1/s], smoothed below shear_rate_eps."""
        rate = np.hypot(np.asarray(shear_rate, dtype=float), self.shear_rate_eps)
        if self.curve is not None:
            return self.curve.stress(rate) / rate
        if self.model == "casson":
            return (np.sqrt(self.yield_stress / rate) + np.sqrt(self.consistency)) ** 2
        return self.yield_stress / rate + self.consistency * rate ** (self.index - 1)


def wall_shear_and_slope(
    law: Rheology, speed: ArrayLike, diameter: ArrayLike, annulus: ArrayLike, density: ArrayLike
) -> tuple[Array, Array]:
    """Compute the wall shear stress [Pa] and its derivative by the speed [Pa s/m].

    Arguments as in `wall_shear`.
    """
    values = np.broadcast_arrays(speed, diameter, np.asarray(annulus, dtype=bool), density)
    shape = values[0].shape
    flat = [np.ascontiguousarray(v, dtype=float).reshape(-1) for v in values]
    stress, slope = np.empty(flat[0].size), np.empty(flat[0].size)
    packed = law.parameters()
    _wall_shear(pointer(packed), stress.size, *(pointer(v) for v in (*flat, stress, slope)))
    return stress.reshape(shape), slope.reshape(shape)


def wall_shear(
    law: Rheology, speed: ArrayLike, diameter: ArrayLike, annulus: ArrayLike, density: ArrayLike
) -> Array:
    """Compute the signed wall shear stress [Pa] (manual: eq-mud-laminar, eq-mud-blend).

    All arguments broadcast.

    law: rheology; speed: mean speed [m/s].
    diameter: hydraulic diameter [m], the bore, or hole minus string diameter.
    annulus: true for an annulus; density: [kg/m3].
    """
    return wall_shear_and_slope(law, speed, diameter, annulus, density)[0]


def pressure_gradient(
    law: Rheology, speed: ArrayLike, diameter: ArrayLike, annulus: ArrayLike, density: ArrayLike
) -> Array:
    """Compute the frictional pressure loss per length, 4 tau/d_h [Pa/m]; arguments as in `wall_shear`."""
    return 4.0 * wall_shear(law, speed, diameter, annulus, density) / np.asarray(diameter, dtype=float)
