"""Local errors of the time formula in a run, summed by unknown (manual: eq-time-local-error).

A step of BDF k solves p'(t_n) = f, where p is the polynomial through x_n and the k states before it.  Let D
be the divided difference of order k + 1 of the last k + 2 states.  Then x'(t_n) - p'(t_n) = D prod_i (t_n -
t_(n-i)), i = 1..k, and x_n has the coefficient sum_i 1/(t_n - t_(n-i)) in p'(t_n).  The local error is their
quotient, e = D prod_i (t_n - t_(n-i)) / sum_i 1/(t_n - t_(n-i)).  At a fixed step h and k = 2 it is 2/9 h^3
x'''.
Source: Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I, III.2.

Sums of e are not the error at the end: the motion may damp or amplify local errors.
"""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.kernels import function, pointer
from drillpetsc.kernels.parameters import structure
from drillpetsc.solvers.time.bdf_history import local, nodal


class OutputErrors(Protocol):
    """Local errors of a time formula in outputs, from their values alone."""

    @property
    def earlier(self) -> int:
        """Number of earlier values that a local error needs."""
        ...

    @property
    def accumulation(self) -> float:
        """Sum of all later effects of a local error in a motion that does not damp, over the error."""
        ...

    def local_errors(self, times: FloatArray, values: FloatArray) -> FloatArray:
        """Compute the local errors (m - earlier, n) of all values that have ``earlier`` values before them.

        times: (m,) ascending [s], with m > earlier; values: (m, n) [SI of each output].
        """
        ...

    @property
    def coefficients(self) -> tuple[int, float]:
        """Order of the BDF whose local errors these are, and for order 0 the factor of step^3 times the third derivative."""
        ...

    @property
    def method(self) -> str:
        """Name of the estimate in the summary."""
        ...


@dataclass(frozen=True)
class BdfOutputErrors:
    """Local errors of BDF of an ``order`` in outputs (manual: sec-time-output-error); see ``OutputErrors``."""

    order: int

    @property
    def earlier(self) -> int:
        """Number of earlier values that a local error needs."""
        return self.order + 1

    @property
    def accumulation(self) -> float:
        """1 + 1/2 + ... + 1/order (manual: eq-time-accumulation)."""
        return float(sum(1.0 / i for i in range(1, self.order + 1)))

    def local_errors(self, times: FloatArray, values: FloatArray) -> FloatArray:
        """Compute the local errors; see ``OutputErrors.local_errors``."""
        return local_errors(times, values, self.order)

    @property
    def coefficients(self) -> tuple[int, float]:
        """The order."""
        return self.order, 0.0

    @property
    def method(self) -> str:
        """Name of the estimate in the summary."""
        return f"divided differences of BDF {self.order}"


_Call = structure("local_error_call")
_keep_state = function("keep_state", "ppd", ctypes.c_int)
_local_error_of_step = function("local_error_of_step", "ppd", ctypes.c_int)
_bdf_error_weights = function("bdf_error_weights", "ipp")

UNITS = {"position": "m", "tangent": "-", "spin": "rad", "ratio": "-", "pressure": "Pa", "flow": "m3/s"}
MEANING = (
    "local errors of the time formula by unknown, largest over the string: of one step; sum: of their sizes over all steps (nothing "
    "cancels); net: of their sum with signs.  Not damped, not amplified by the motion"
)


class LocalErrorEstimate:
    """Sums of local errors of a run with BDF or generalised-alpha, and its number of residuals.

    Other integrators have no estimate.  Generalised-alpha keeps no earlier states: after a restart from a checkpoint its first three
    steps have none either.

    integrator: the ``TimeIntegrator`` of the run; the estimate is updated after each of its steps, and is part of its
    checkpoints.
    """

    def __init__(self, integrator: Any):
        self.system, self.estimated, self.steps = integrator.system, 0, 0
        #: the errors of the formula; None without an estimate
        self.formula: OutputErrors | None = integrator.output_errors()
        earlier = 0 if self.formula is None else self.formula.earlier
        self._residuals = self.system.assembly.evaluations
        layout = self.system.layout
        differential = np.array([f.differential for f in layout.fields])
        owned = np.sort(layout.local_of_owned)
        self._rows = owned[differential[layout.field_of[owned]]]
        self._field = layout.field_of[self._rows]
        n = len(self._rows)
        self._index = self._rows.astype(np.int32)
        self._states, self._times, self._weights = (
            np.zeros(k) for k in ((earlier + 1, n), earlier + 1, earlier + 1)
        )
        self._largest, self._sum, self._net = (np.zeros(n) for _ in range(3))
        order, third = (0, 0.0) if self.formula is None else self.formula.coefficients
        #: the recent states with their times, in the place of the oldest one the next
        self._call = _Call(
            rows=pointer(self._index), states=pointer(self._states), times=pointer(self._times), weights=pointer(self._weights),
            net=pointer(self._net), total=pointer(self._sum), largest=pointer(self._largest), n=n, kept=earlier + 1,
            order=order, third=third,
        )  # fmt: skip
        self._at, self._x_at = ctypes.addressof(self._call), self.system.assembly.state_at[0]
        self._history = integrator.history
        integrator.estimate = self
        self._integrator = integrator
        if self.formula is not None:
            integrator.after_step.append(self.step)

    def step(self, t: float, dt: float) -> None:
        """Add the local error of an accepted step of ``dt`` [s] to ``t`` [s], whose state is in the assembly."""
        self.steps += 1
        if self._integrator.fresh:  # the first one after the formula was restarted
            self._call.count = 0
        self.estimated += _local_error_of_step(self._at, self._x_at, t)

    # ------------------------------------------------------------------ checkpoints
    def get_state(self) -> dict[str, FloatArray]:
        """Return the sums for a checkpoint on rank 0, empty on other ranks; collective.

        local_error: (3,) steps, steps with an estimate, earlier states that the next estimate uses.
        local_error_sums: (nodes, 3, m) largest, sum and net by field.
        """
        if self.formula is None:
            return {}
        columns = []
        for sums in (self._largest, self._sum, self._net):
            values = np.zeros_like(self.system.assembly.x)
            values[self._rows] = sums
            columns.append(nodal(self.system, values))
        gathered = self.system.gather(np.stack(columns, axis=1))
        if gathered is None:
            return {}
        counts = np.array([self.steps, self.estimated, self._call.count], dtype=float)
        return {
            "local_error": counts,
            "local_error_sums": np.reshape(gathered, (len(gathered), len(columns), -1)),
        }

    def set_state(self, state: dict[str, FloatArray]) -> None:
        """Continue from a checkpoint, whose history the integrator has read; one without the sums starts from zero."""
        if self.formula is None or "local_error_sums" not in state:
            return
        self.steps, self.estimated, earlier = (int(n) for n in state["local_error"])
        zero = np.zeros_like(self.system.assembly.x)
        for sums, at_nodes in zip(
            (self._largest, self._sum, self._net), np.moveaxis(state["local_error_sums"], 1, 0), strict=True
        ):
            sums[:] = local(self.system, at_nodes, zero).take(self._rows)
        kept = list(zip(self._history.times, self._history.states, strict=True))
        self._call.count = 0
        for t, (x, _) in kept[max(0, len(kept) - earlier) :] if earlier else []:
            _keep_state(self._at, pointer(x), t)

    def as_dict(self, ended: bool = True) -> dict[str, Any]:
        """Return the entries of summary.json; collective if the run has ``ended`` without an error."""
        calls = {"residuals": self.system.assembly.evaluations - self._residuals}
        return {**calls, "error_estimate": {"time": self._by_unknown()}} if ended else calls

    def _by_unknown(self) -> dict[str, Any] | None:
        """Return the sums by field, largest over the string; None for integrators without an estimate.

        Collective.
        """
        if self.formula is None:
            return None
        sums = {"largest_step": self._largest, "sum": self._sum, "net": np.abs(self._net)}
        comm = self.system.comm.tompi4py() if self.system.comm.size > 1 else None
        unknowns: dict[str, Any] = {}
        for number, f in enumerate(self.system.layout.fields):
            if not f.differential:
                continue
            largest = {key: float(v[self._field == number].max(initial=0.0)) for key, v in sums.items()}
            if comm is not None:
                from mpi4py import MPI

                largest = {key: comm.allreduce(value, op=MPI.MAX) for key, value in largest.items()}
            unknowns[f.name] = {
                "unit": UNITS.get(f.name.split(".")[-1], "SI"),
                "usual_size": f.scale,
                **largest,
            }
        return {
            "method": self.formula.method,
            "meaning": MEANING,
            "steps": self.estimated,
            "steps_without": self.steps - self.estimated,
            "unknowns": unknowns,
        }


def local_error_weights(times: list[float], order: int) -> FloatArray:
    """Compute the weights (order + 2,) of the last states in the local error of a formula (manual: eq-time-local-error).

    times: (order + 2,) of the states, ascending [s].
    """
    ascending, weights = np.array(times, dtype=float), np.empty(order + 2)
    _bdf_error_weights(order, pointer(ascending), pointer(weights))
    return weights


def local_errors(times: FloatArray, states: FloatArray, order: int) -> FloatArray:
    """Compute the local errors (m - order - 1, n) of all states that have ``order + 1`` states before them.

    times: (m,) ascending [s], with m > order + 1; states: (m, n) [SI of each unknown].
    """
    difference = states
    for j in range(1, order + 2):
        difference = np.diff(difference, axis=0) / (times[j:] - times[:-j])[:, None]
    gaps = np.array([times[order + 1 :] - times[order + 1 - i : -i] for i in range(1, order + 1)])
    return difference * (gaps.prod(axis=0) / (1.0 / gaps).sum(axis=0))[:, None]
