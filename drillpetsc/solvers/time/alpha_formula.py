"""Generalised-alpha in end-point form: coefficients, and the history of one run on plain arrays.

Manual: sec-time-alpha.  The equations hold at the end of each step; only accelerations are averaged.

Sources: Chung and Hulbert, J. Appl. Mech. 60 (1993) 371 (coefficients); Arnold and Bruels, Multibody Syst.
Dyn. 18 (2007) 185 (end-point form, with an algorithmic acceleration beside the true one); Jansen, Whiting and
Hulbert, Comput. Methods Appl. Mech. Eng. 190 (2000) 305 (first-order rows).
"""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.kernels import function, pointer
from drillpetsc.kernels.parameters import columns, structure

_AlphaCall = structure("alpha_call")
_alpha_begin = function("alpha_begin", "ppddddppp")
_alpha_error = function("alpha_error", "ppddpppippp")
_alpha_accept = function("alpha_accept", "ppddppp")
_third_difference_weights = function("third_difference_weights", "dpp")

#: arrays of ``AlphaHistory``, in the order of its values
ARRAYS = columns("alpha_history").names
LOSS = 0.01  # of an amplitude in a period, from which on a vibration is called damped


@dataclass(frozen=True)
class AlphaFormula:
    """Coefficients at the spectral radius ``radius`` of infinite frequency, 0 to 1 (manual: eq-time-alpha).

    The averages are weighted in the order of Chung and Hulbert: ``mean_mass`` and ``mean_force`` multiply the
    values at the start of the step.
    """

    radius: float

    def __post_init__(self) -> None:
        if not 0.0 <= self.radius <= 1.0:
            raise ValueError(f"spectral radius {self.radius:g} is not from 0 to 1")

    @cached_property
    def mean_mass(self) -> float:
        """Weight of the earlier algorithmic acceleration."""
        return (2 * self.radius - 1) / (1 + self.radius)

    @cached_property
    def mean_force(self) -> float:
        """Weight of the earlier true acceleration, and of the earlier rate of first-order unknowns."""
        return self.radius / (1 + self.radius)

    @cached_property
    def gamma(self) -> float:
        """Weight of the later acceleration in the velocity; 1/2 + shift of the acceleration gives order 2."""
        return 0.5 - self.mean_mass + self.mean_force

    @cached_property
    def beta(self) -> float:
        """Weight of the later acceleration in the position."""
        return 0.25 * (1 - self.mean_mass + self.mean_force) ** 2

    @cached_property
    def mean_rate(self) -> float:
        """Weight of the earlier algorithmic rate of first-order unknowns."""
        return (3 * self.radius - 1) / (2 * (1 + self.radius))

    @cached_property
    def gamma_rate(self) -> float:
        """Weight of the later algorithmic rate in a first-order unknown."""
        return 0.5 - self.mean_rate + self.mean_force

    @cached_property
    def lead(self) -> float:
        """Time by which an algorithmic acceleration is ahead of its step's end, as a fraction of the step."""
        return self.mean_mass - self.mean_force

    @cached_property
    def lead_rate(self) -> float:
        """The same for the algorithmic rate of first-order unknowns."""
        return self.mean_rate - self.mean_force

    def shifts(self, step: float) -> tuple[float, float]:
        """Return dy/dx and da/dy [1/s] for a ``step`` [s].

        The first is the same for unknowns of first and second order: gamma/beta =
        (1 - mean_rate)/((1 - mean_force) gamma_rate) = (3 - radius)(1 + radius)/2.
        """
        first = self.gamma / (self.beta * step)
        return first, (1 - self.mean_mass) / ((1 - self.mean_force) * self.gamma * step)

    @property
    def error_constants(self) -> tuple[float, float]:
        """Local error of a position over step^3 x''', and of a first-order unknown over step^3 x'''.

        Taylor series, with the algorithmic values ahead of the steps' ends by their leads.
        """
        position = 1 / 6 - self.beta - 0.5 * self.lead
        return abs(position), abs(0.5 * self.lead_rate**2 - 1 / 12)

    def amplification(self, product: float) -> complex:
        """Return the factor of an undamped vibration in a step, at angular frequency times step ``product``.

        Its modulus is the amplitude's factor, its angle the phase of a step: the eigenvalue of the vibration.  The
        third one is real.
        """
        return complex(self._amplifications(np.array([product]))[0])

    def _amplifications(self, products: FloatArray) -> np.ndarray:
        """(n,) factors of vibrations at ``products`` (n,)."""
        g, b, m, f, o = self.gamma, self.beta, self.mean_mass, self.mean_force, products**2
        # unknowns x, h v, h^2 a, h^2 w = -o x; (1 - m) a1 + m a0 = (1 - f) w1 + f w0
        left, right = (np.empty((len(products), 3, 3)) for _ in range(2))
        left[:] = [[1.0, 0.0, -b], [0.0, 1.0, -g], [0.0, 0.0, 1 - m]]
        right[:] = [[1.0, 1.0, 0.5 - b], [0.0, 1.0, 1 - g], [0.0, 0.0, -m]]
        left[:, 2, 0], right[:, 2, 0] = (1 - f) * o, -f * o
        values = np.linalg.eigvals(np.linalg.solve(left, right))
        return np.take_along_axis(values, values.imag.argmax(axis=1)[:, None], axis=1)[:, 0]

    @property
    def phase_error(self) -> float:
        """Relative error of the frequency of a vibration, over (angular frequency times step) squared.

        Manual: eq-time-alpha-phase.  The constant of first-order unknowns is smaller.
        """
        return 1 / 12 + 0.375 * ((1 - self.radius) / (1 + self.radius)) ** 2

    @cached_property
    def damped_product(self) -> float | None:
        """Angular frequency times step above which a period takes more than ``LOSS`` of the amplitude.

        None if no frequency loses as much.
        """
        products = np.geomspace(1e-2, 1e2, 800)
        factors = self._amplifications(products)
        kept = np.abs(factors) ** (2 * np.pi / np.maximum(np.abs(np.angle(factors)), 1e-9))
        found = np.flatnonzero(kept < 1 - LOSS)
        return float(products[found[0]]) if len(found) else None


@dataclass(frozen=True)
class AlphaOutputErrors:
    """Local errors of generalised-alpha in outputs; see ``OutputErrors`` (manual: sec-time-output-error).

    formula: the coefficients.
    """

    formula: AlphaFormula

    @property
    def earlier(self) -> int:
        """Number of earlier values that a local error needs, for a third difference."""
        return 3

    @property
    def accumulation(self) -> float:
        """The local errors contain all later effects."""
        return 1.0

    @property
    def method(self) -> str:
        """Name of the estimate in the summary."""
        return f"third differences, generalised-alpha of radius {self.formula.radius:g}"

    def local_errors(self, times: FloatArray, values: FloatArray) -> FloatArray:
        """Compute ``phase_error`` times step^3 times the third derivative, (m - 3, n).

        times: (m,) ascending [s], with m > 3; values: (m, n) [SI of each output].
        """
        third = values
        for j in range(1, 4):
            third = j * np.diff(third, axis=0) / (times[j:] - times[:-j])[:, None]
        return self.formula.phase_error * np.diff(times)[2:, None] ** 3 * third

    @property
    def coefficients(self) -> tuple[int, float]:
        """No order of BDF, and the factor of step^3 times the third derivative."""
        return 0, self.formula.phase_error

    def weights(self, times: list[float]) -> FloatArray:
        """Weights (4,) of the states at ``times`` (4,), ascending [s], in the local error of the last one: the weights of ``local_errors``."""
        ascending, weights = np.array(times, dtype=float), np.empty(4)
        _third_difference_weights(self.formula.phase_error, pointer(ascending), pointer(weights))
        return weights


def radius_of(alpha_m: float, alpha_f: float, gamma: float | None = None, beta: float | None = None) -> float:
    """Return the spectral radius of PETSc's parameters, whose averages multiply the later values.

    alpha_m = (2 - radius)/(1 + radius), alpha_f = 1/(1 + radius), gamma = 1/2 + alpha_m - alpha_f, beta =
    (1 + alpha_m - alpha_f)^2/4.  Raises ValueError, with the reason, for values off this family.
    """
    if not 0.5 <= alpha_f <= 1.0:
        raise ValueError(
            f"alpha_f = {alpha_f:g} does not correspond to a spectral radius from 0 to 1 (0.5 to 1 does)"
        )
    radius = 1 / alpha_f - 1
    wanted = (2 - radius) / (1 + radius)
    if abs(alpha_m - wanted) > 1e-6:
        raise ValueError(
            f"alpha_m = {alpha_m:g} does not belong to alpha_f = {alpha_f:g}: it must be {wanted:.9g}"
        )
    if gamma is not None and abs(gamma - (0.5 + alpha_m - alpha_f)) > 1e-6:
        raise ValueError(f"gamma = {gamma:g} gives order 1; order 2 needs {0.5 + alpha_m - alpha_f:.9g}")
    if beta is not None and abs(beta - 0.25 * (1 + alpha_m - alpha_f) ** 2) > 1e-6:
        raise ValueError(
            f"beta = {beta:g} does not belong to them: it must be {0.25 * (1 + alpha_m - alpha_f) ** 2:.9g}"
        )
    return radius


class ControlledUnknowns:
    """Unknowns whose local errors control the step.  rows: (m,) of the unknowns; tolerance: (m,) of each [SI].

    shares: (m,) local errors over the tolerances in the step that was tried last [-].
    """

    def __init__(self, rows: np.ndarray, tolerance: FloatArray) -> None:
        self._rows, self._tolerance = (
            np.ascontiguousarray(rows, dtype=np.int32),
            np.ascontiguousarray(tolerance),
        )
        self.shares = np.zeros(len(rows))
        #: their number, and the addresses of rows, tolerances and shares
        self.at = len(rows), pointer(self._rows), pointer(self._tolerance), pointer(self.shares)


NONE_CONTROLLED = ControlledUnknowns(np.zeros(0, dtype=int), np.zeros(0))


class AlphaHistory:
    """Data that the formula carries from step to step, for n unknowns.

    formula: the coefficients.
    second_order: (n,) mask of unknowns of second order; the others are of first order, or algebraic.

    begun: whether it has a state.
    step: length of the last step [s]; 0 before the first one, when ``ax`` and ``ay`` do not lead.
    error: (n,) local error of the step that ``advance`` tried last (manual: eq-time-alpha-error).
    arrays: views (n,) of the rows of ``values`` by name:
    x, y: unknowns and the rates that the equations contain.
    w: true accelerations.
    rate, second: first and second derivative of x by the formula.  They are y and w, but for spin angles,
    whose rate is only part of the spin rate, and for prescribed and corrected components.
    ax, ay: algorithmic accelerations of x and of y; of a first-order unknown ``ax`` is its algorithmic rate.
    dw, dsecond, du: change of w, of ``second`` and of a first-order unknown's rate over the last step, by its
    length.
    """

    def __init__(self, formula: AlphaFormula, second_order: np.ndarray) -> None:
        self.formula, self.second_order = formula, second_order
        self._mask = np.ascontiguousarray(second_order, dtype=np.int8)
        position, rate = formula.error_constants
        n = len(second_order)
        self._call = _AlphaCall(
            second_order=pointer(self._mask), gamma=formula.gamma, beta=formula.beta, mean_mass=formula.mean_mass,
            mean_force=formula.mean_force, mean_rate=formula.mean_rate, gamma_rate=formula.gamma_rate, lead=formula.lead,
            lead_rate=formula.lead_rate, position_error=position, rate_error=rate, n=n,
        )  # fmt: skip
        self._at = ctypes.addressof(self._call)
        self.begun, self.step, self.error = False, 0.0, np.zeros(n)
        self._error_at = pointer(self.error)
        self.values = np.zeros((len(ARRAYS), n))
        self.arrays: dict[str, FloatArray] = dict(zip(ARRAYS, self.values, strict=True))
        self._values_at = pointer(self.values)
        self._tried: tuple[float, int, int, int] = 0.0, 0, 0, 0  # step [s] and state of ``advance``

    def restore(self, step: float, values: FloatArray) -> None:
        """Continue with the ``values`` (len(ARRAYS), n) of another history, whose last step was ``step`` [s]."""
        self.begun, self.step, self.values[:] = True, step, values

    def start(
        self, x: FloatArray, y: FloatArray, w: FloatArray, rate: FloatArray, second: FloatArray
    ) -> None:
        """Begin at a state (n,), consistent with the equations: y of a first-order unknown is its rate."""
        two, q = self.second_order, self.arrays
        self.begun, self.step, self.values[:] = True, 0.0, 0.0
        q["x"][:], q["y"][:], q["w"][:] = x, y, np.where(two, w, 0.0)
        q["rate"][:], q["second"][:] = np.where(two, rate, 0.0), np.where(two, second, 0.0)
        # without earlier steps there is no derivative by which they could lead; see ``lead_by_trial``
        q["ax"][:], q["ay"][:] = np.where(two, second, y), np.where(two, w, 0.0)

    def begin(self, step: float, v0: int, v1: int, x: int) -> tuple[float, float]:
        """Write v0 and v1 of y = shift x + v0 (without transport) and a = second shift y + v1, and a first guess of x.

        In the guess the true acceleration stays, or the algorithmic rate.  step: [s]; v0, v1, x: addresses of arrays (n,).
        Returns both shifts [1/s].
        """
        shifts = self.formula.shifts(step)
        _alpha_begin(self._at, self._values_at, self.step, step, *shifts, v0, v1, x)
        return shifts

    def advance(
        self, step: float, x: int, y: int, w: int, controlled: ControlledUnknowns = NONE_CONTROLLED
    ) -> None:
        """Try a ``step`` [s] to the state at the addresses x, y, w of arrays (n,): ``error`` is its local error.

        The ``controlled`` unknowns get their shares.  ``accept`` takes the step, and needs the state in the same arrays.
        """
        self.take(step, x, y, w)
        _alpha_error(self._at, self._values_at, self.step, step, x, y, self._error_at, *controlled.at)

    def take(self, step: float, x: int, y: int, w: int) -> None:
        """As ``advance``, without the local error."""
        self._tried = step, x, y, w

    def accept(self) -> None:
        """Go on to the end of the step that was tried last."""
        _alpha_accept(self._at, self._values_at, self.step, *self._tried)
        self.step = self._tried[0]

    def lead_by_trial(self) -> None:
        """Take the derivatives of a first step, which ``advance`` has tried, to a start: the step is then repeated.

        They shift the algorithmic accelerations of the first step to their lead.
        """
        later = self.values.copy()
        _alpha_accept(self._at, pointer(later), self.step, *self._tried)
        for key in ("dw", "dsecond", "du"):
            self.arrays[key][:] = later[ARRAYS.index(key)]

    def jump(self, change: FloatArray, second: FloatArray) -> None:
        """Let true accelerations and rates of first-order unknowns jump by ``change`` (n,), where a force does.

        second: (n,) change of the second derivatives of second-order unknowns.  The history of the motion without the jump is kept,
        so the order stays 2.
        """
        q, two = self.arrays, self.second_order
        for key in ("w", "ay"):
            q[key] += np.where(two, change, 0.0)
        q["second"] += np.where(two, second, 0.0)
        q["ax"] += np.where(two, second, change)
        q["y"] += np.where(two, 0.0, change)
