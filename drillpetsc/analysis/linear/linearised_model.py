"""Linearised model: the discrete system's matrices, with a bottom of the hole that gives no work and with measured loops.

What moves with the string's angle has its mean over a turn.  Manual: sec-eigen-bottom, sec-eigen-state, sec-autodriller-linear.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import scipy.sparse as sparse

from drillpetsc.analysis.linear.state_differences import StateDifferences, of_motion
from drillpetsc.arrays import FloatArray
from drillpetsc.case.blocks.formation import level_bottom
from drillpetsc.case.blocks.items.steering import PushSteering, RotarySteerable
from drillpetsc.case.blocks.items.string import Item
from drillpetsc.case.case import Case
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.parallel import total
from drillpetsc.physics.top.hoist import Hoist
from drillpetsc.solvers.linear.linearization import Linearised, linearise

MEASURED_AT = 3  # nodes at each end of the string on whose unknowns a measurement may depend
MEASURED_STEP = {"wob": 1e2, "torque": 1e1, "differential_pressure": 1e3}  # [N], [N m], [Pa]


def settle(model: DrillingModel) -> list[str]:
    """Prepare the model, which is in motion, for linearising; returns notes for the user.  Collective.

    Agitator valves and motor unbalance are left out: they excite the string and do not change its linear response.  The
    autodriller's loop is closed.
    """
    notes: list[str] = []
    for component in model.components:
        note = component.balance(model.system.assembly)
        notes += [note] if note and note not in notes else []
    for component in model.components:
        component.settle(0.0, model.system.assembly)
    return notes


def linearise_model(model: DrillingModel) -> Linearised | None:
    """Linearise the model at its present state; the result is on rank 0, None elsewhere; collective.

    A bit on the bottom does not displace mud there, but the mud's pressure acts on its whole face. The rock would
    supply the difference as work and make undamped modes grow.  In a small motion, the forces on rock and
    bit are equal, so only the face that displaces mud remains.
    """
    linearised = linearise(model.system)
    fed = _fed_back(model, linearised)
    closed = _closed_face(model)
    if linearised is None:
        return None
    if fed is not None:
        K, C, M = (
            sparse.csr_matrix(A + B)
            for A, B in zip((linearised.K, linearised.C, linearised.M), fed, strict=True)
        )
        linearised = replace(linearised, K=K, C=C, M=M)
    if not closed.any():
        return linearised
    names, last = [f.name for f in model.system.layout.fields], model.mesh.nodes - 1
    position, pressure = (
        np.flatnonzero((linearised.field == names.index(name)) & (linearised.node == last))
        for name in ("string.position", "annulus.pressure")
    )
    force = closed[linearised.component[position]]
    columns = np.full(len(position), pressure[0])
    change = sparse.csr_matrix((force, (position, columns)), shape=linearised.K.shape)
    return replace(linearised, K=sparse.csr_matrix(linearised.K - change))


def _fed_back(model: DrillingModel, q: Linearised | None) -> list[sparse.csr_matrix] | None:
    """Contribution of a measurement of the autodriller to K, C and M, on rank 0; None without one.  Collective.

    In a run the measurement follows each step.  Here it is a function of the state, whose derivatives are differences.
    """
    hoist = model.part(Hoist)
    kind = hoist.sensed_loop() if hoist is not None else None
    if hoist is None or kind is None:
        return None
    comm, asm, sensor = model.system.comm, model.system.assembly, hoist.sensors[kind]
    d = StateDifferences(model, lambda: np.array([total(comm, sensor(0.0, asm))]))
    ends: np.ndarray = np.zeros(0, dtype=int)
    if q is not None:
        ends = np.flatnonzero((q.node < MEASURED_AT) | (q.node >= model.mesh.nodes - MEASURED_AT))
    chosen = ends if comm.size == 1 else comm.tompi4py().bcast(ends)
    of_state = d.by_state(chosen)
    step, before = MEASURED_STEP[kind], hoist.set_measured(kind, 0.0)
    rows = []
    for sign in (1.0, -1.0):
        hoist.set_measured(kind, before + sign * step)
        rows.append(d.owned_rows())
    hoist.set_measured(kind, before)
    d.read()
    column = d.whole(rows[0] - rows[1]) / (2 * step)
    if q is None:
        return None
    left = sparse.csr_matrix(column[:, None])
    return [left @ sparse.csr_matrix(A) for A in of_motion(q, *of_state)]


def _closed_face(model: DrillingModel) -> FloatArray:
    """Area of the bit's face that does not displace mud, times the hole's direction (3,) [m2], on all ranks."""
    bit = None if model.fluid is None else model.fluid.bit
    if bit is None:
        return np.zeros(3)
    return np.asarray(total(model.system.comm, bit.closed_face(model.system.assembly)))


def mean_over_turn(case: Case) -> Case:
    """The case with the mean bottom under a roller cone, and the mean force of pads that turn with the string.

    A case without either is returned as it is.
    """
    string = tuple(_steady(item) for item in case.string)
    formation = level_bottom(case.formation)
    if formation is case.formation and all(a is b for a, b in zip(string, case.string, strict=True)):
        return case
    return case.model_copy(update={"formation": formation, "string": string})


def _steady(item: Item) -> Item:
    """The item with pads on a sleeve."""
    if (
        not isinstance(item, RotarySteerable)
        or not isinstance(item.rss, PushSteering)
        or item.rss.pads == "sleeve"
    ):
        return item
    return item.model_copy(update={"rss": item.rss.model_copy(update={"pads": "sleeve"})})
