"""A model about its steady state as x' = A x + B u, y = C x + D u (manual: sec-linear).

Matrices of the string come from ``solvers.linear.linearization``.  Effects of inputs on the equations, and of the state on outputs,
are central differences of the residual and of the outputs. So every input of a session and every column of history.csv can be used.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sparse

from drillpetsc.analysis.linear.linearised_model import linearise_model
from drillpetsc.analysis.linear.modal import prepare_state, reference_rate
from drillpetsc.analysis.linear.state_differences import NOISE, StateDifferences, of_motion
from drillpetsc.analysis.motion.session.live_outputs import LiveOutputs
from drillpetsc.analysis.statics.equilibrium import StaticState
from drillpetsc.analysis.statics.placement import start_of
from drillpetsc.arrays import FloatArray
from drillpetsc.case.quantities import largest
from drillpetsc.errors import CaseError
from drillpetsc.fem.component import DRIVE
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.output.recorder import Recorder
from drillpetsc.output.table_rows import TableColumn
from drillpetsc.parallel import first_rank_gives
from drillpetsc.physics.interfaces import Drive
from drillpetsc.solvers.linear.linearization import Linearised, unknowns_of
from drillpetsc.solvers.linear.model_reduction import LARGEST_DENSE
from drillpetsc.solvers.linear.state_space import Exchange, StateSpace, Unknowns, connected, eliminate

#: usual sizes of the inputs, by which differences are taken and models are reduced [SI]
USUAL = {
    "top.rotation": 10.0,
    "top.lowering": 0.01,
    "top.force": 1e5,
    "top.torque": 1e4,
    "top.autodriller.wob": 1e5,
    "top.autodriller.rop": 0.005,
    "top.autodriller.torque": 1e4,
    "top.autodriller.differential_pressure": 2e6,
    "fluid.flow_rate": 0.03,
    "fluid.pump_pressure": 1e7,
    "fluid.outlet_pressure": 1e6,
}
STEP = 1e-3  # differences by inputs, in usual sizes


class DisturbedInput:
    """An input over time with an offset of its integral, its value and its rate."""

    def __init__(self, given: Any) -> None:
        self.given, self.offset = given, [0.0, 0.0, 0.0]

    def value(self, t: float, before: bool = False) -> float:
        return float(self.given.value(t, before)) + self.offset[1]

    def rate(self, t: float, before: bool = False) -> float:
        return float(self.given.rate(t, before)) + self.offset[2]

    def integral(self, t: float) -> float:
        return float(self.given.integral(t)) + self.offset[0]

    @property
    def values(self) -> tuple[float, ...]:
        """Largest magnitude of the input, from which a mesh of automatic lengths is chosen."""
        return (largest(self.given),)

    def breaks(self) -> tuple[float, ...]:
        return tuple(self.given.breaks())

    def jumps(self) -> tuple[float, ...]:
        return tuple(self.given.jumps())


@dataclass(frozen=True)
class LinearModel:
    """The model with all its states, on the rank that has it.

    system: the state space; linearised: the equations; used: (n,) unknowns of these that inputs move and outputs read.
    constant: outputs that no input changes.
    """

    system: StateSpace
    linearised: Linearised
    used: np.ndarray
    constant: tuple[int, ...]

    def shapes(self, states: np.ndarray) -> np.ndarray:
        """Unknowns of the linearised system (n, k) in states (order, k)."""
        assert self.system.motions is not None
        q = np.zeros((self.linearised.T.shape[1], states.shape[1]), dtype=complex)
        q[np.flatnonzero(self.used)] = self.system.motions @ states
        return np.asarray(self.linearised.T @ q)


def steady_state(model: DrillingModel) -> StaticState:
    """Set the model to its steady state (``modal.prepare_state``), with a drive that inputs act on; collective."""
    state = prepare_state(model)
    for drive in model.parts(Drive):
        drive.begin_motion(model.system.assembly, start_of(model))
    return state


class _Differences(StateDifferences):
    """Central differences of the equations and of outputs about the present state; every call is collective."""

    def __init__(
        self,
        model: DrillingModel,
        inputs: Sequence[DisturbedInput],
        sizes: FloatArray,
        outputs: Sequence[str],
    ) -> None:
        self.inputs, self.sizes = inputs, sizes
        self.live = LiveOutputs(Recorder(model))
        self.columns: list[TableColumn] = self.live.find(outputs)
        super().__init__(model, self._outputs)

    def _outputs(self) -> FloatArray:
        self.live.changed()
        return np.array(self.live.read(self.columns, 0.0))

    def by_input(self, j: int, part: int) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Residual (n,), prescribed displacement (n,) and outputs (p,) by an input's integral, value or rate."""
        h, offset = STEP * self.sizes[j], self.inputs[j].offset
        found = []
        for sign in (1.0, -1.0):
            offset[part] = sign * h
            rows, values = self.owned_rows(), self.read()
            found.append((rows, values, self._prescribed()))
        offset[part] = 0.0
        (r1, y1, p1), (r0, y0, p0) = found
        y = np.where(np.abs(y1 - y0) > self.noise, y1 - y0, 0.0)
        return self.whole(r1 - r0) / (2 * h), self.whole(p1 - p0) / (2 * h), y / (2 * h)

    def _prescribed(self) -> FloatArray:
        """Displacement of the owned unknowns that the prescribed values require."""
        local = np.zeros(self.layout.size)
        for f in self.asm.row_replacements:
            if f.owned:
                f.evaluate(0.0, self.asm.x)
                local[f.rows] = np.linalg.pinv(f.D) @ (f.value - f.D @ self.asm.x[f.rows])
        return local[self.layout.local_of_owned]


def linear_model(
    model: DrillingModel, inputs: dict[str, DisturbedInput], outputs: Sequence[str]
) -> LinearModel | None:
    """Form the linear model at the present state of ``model``; None on all ranks but the first.  Collective.

    model: built with the ``inputs``, in the state of ``modal.prepare_state``.
    outputs: names of columns of history.csv.

    Raises LookupError for an unknown output, CaseError for too many states and SolveError if there is no state space.
    """
    sizes = np.array([USUAL[name] for name in inputs])
    d = _Differences(model, list(inputs.values()), sizes, outputs)
    rate = reference_rate(model)
    linearised = linearise_model(model)
    m = len(inputs)
    parts = [[d.by_input(j, part) for j in range(m)] for part in range(3)]
    by_rows = [np.column_stack([q[0] for q in part]) for part in parts]
    p = np.column_stack([q[1] for q in parts[0]])
    direct = [np.column_stack([q[2] for q in part]) for part in parts]
    chosen = first_rank_gives(model.system.comm.tompi4py(), lambda: _driven(linearised, by_rows, p, rate))
    Y = d.by_state(chosen)
    d.read()
    if linearised is None:
        first_rank_gives(model.system.comm.tompi4py(), lambda: None)
        return None
    found: list[LinearModel] = []

    def form() -> None:
        found.append(_form(model, linearised, by_rows, p, direct, Y, rate))

    first_rank_gives(model.system.comm.tompi4py(), form)
    return found[0]


def _forcing(q: Linearised, by_rows: list[FloatArray], p: FloatArray) -> list[FloatArray]:
    """Rows of the free motions by integrals, values and rates of the inputs; p: (n, m) prescribed displacement."""
    return [q.T.T @ (A @ p + f) for A, f in zip((q.K, q.C, q.M), by_rows, strict=True)]


def _cleaned(f: list[FloatArray]) -> list[FloatArray]:
    """Without entries that are rounding of the largest of their input."""
    return [np.where(np.abs(A) > NOISE * np.abs(A).max(axis=0, initial=0.0), A, 0.0) for A in f]


def _driven(q: Linearised | None, by_rows: list[FloatArray], p: FloatArray, rate: float) -> np.ndarray:
    """Unknowns that inputs move, prescribed ones included."""
    assert q is not None
    n = q.T.shape[1]
    K, C, M, scale = _free(q)
    f = _cleaned(_forcing(q, by_rows, p))
    m = p.shape[1]
    none = np.zeros((0, m))
    all_read = np.ones((1, n))
    everywhere = Exchange(f[0], f[1], f[2], all_read, all_read, all_read, none, none, none)
    mask = connected(K, C, M, scale, everywhere)
    moved = np.asarray(abs(q.T) @ mask.astype(float)).ravel() > 0
    return np.flatnonzero(moved | (p != 0).any(axis=1))


def _free(q: Linearised):
    """K, C, M and usual sizes in the free motions."""
    K, C, M = (sparse.csr_matrix(q.T.T @ A @ q.T) for A in (q.K, q.C, q.M))
    return K, C, M, q.scale[unknowns_of(q.T)]


def _form(model, q: Linearised, by_rows, p, direct, Y, rate: float) -> LinearModel:
    K, C, M, scale = _free(q)
    parents = unknowns_of(q.T)
    by_position, by_rate, by_acceleration = of_motion(q, *Y)
    ex = Exchange(
        *_cleaned(_forcing(q, by_rows, p)),
        *(np.asarray(A @ q.T) for A in (by_position, by_rate, by_acceleration)),
        *(A @ p + d for A, d in zip((by_position, by_rate, by_acceleration), direct, strict=True)),
    )
    used = connected(K, C, M, scale, ex)
    fields = [f.name for f in model.system.layout.fields]
    # corrections of the kinematic equation are zero in the exact motion (manual: eq-joint-ggl)
    used &= np.array([fields[k] != "joint.correction" for k in q.field[parents]], dtype=bool)
    order = int(used.sum() + (used & q.second_order[parents]).sum())
    if order > LARGEST_DENSE:
        raise CaseError(
            at="linearise",
            got=f"{order} states",
            want=f"at most {LARGEST_DENSE}, whose matrices are dense",
            hint="longer elements (string[..].element_length) have fewer states",
        )
    names = [_name(fields[q.field[i]], q.node[i], q.component[i], model) for i in parents[used]]
    at = np.flatnonzero(used)
    system = eliminate(
        K[at][:, at],
        C[at][:, at],
        M[at][:, at],
        Unknowns(q.second_order[parents][at], scale[at], names),
        rate,
        ex.of_unknowns(at),
    )
    constant = np.flatnonzero(
        ~(np.any([(A != 0).any(axis=1) for A in (system.C, system.D, system.F)], axis=0))
    )
    return LinearModel(system, q, used, tuple(int(i) for i in constant))


def _name(field: str, node: int, component: int, model: DrillingModel) -> str:
    """Name of an unknown: field, node from the top, component."""
    size = next(f.size for f in model.system.layout.fields if f.name == field)
    return f"{field}[{node}]" if size == 1 else f"{field}[{node},{component}]"


def kind_of(model: DrillingModel, linear: LinearModel, state: np.ndarray) -> str:
    """Word for the motion of a state vector (order,): lateral, axial, torsional, control, fluid or hole (rock)."""
    q = linear.linearised
    u = linear.shapes(state[:, None])
    share = np.zeros(6)
    for i, field in enumerate(model.system.layout.fields):
        at = np.flatnonzero(q.field == i)
        weight = np.abs(u[at, 0]) / q.scale[at]
        if field.name in ("string.position", "string.tangent"):
            values = q.field_values(i, u, model.mesh.nodes, 3)[0]
            along = np.abs(np.sum(values * model.tangent, axis=1))
            across = np.linalg.norm(
                values - np.sum(values * model.tangent, axis=1)[:, None] * model.tangent, axis=1
            )
            share[0] += float((across**2).sum()) / q.scale[at[0]] ** 2 if len(at) else 0.0
            share[1] += float((along**2).sum()) / q.scale[at[0]] ** 2 if len(at) else 0.0
        elif field.name.startswith("string."):
            share[2] += float((weight**2).sum())
        else:
            share[{DRIVE: 3, "rock": 5}.get(field.physics, 4)] += float((weight**2).sum())
    if not share.any():
        return "of the input"
    return ("lateral", "axial", "torsional", "control", "fluid", "hole")[int(share.argmax())]
