"""The whole first-order system, assembled: for other integrators and solvers than the condensed default
(studies, oracles).

Rows of a second-order unknown: x' - y = 0 (for a spin angle phi' - omega + c(v).w = 0) and the dynamic row in
place of y'. Of the seven rows of either kind at a prescribed vertex, those along D become D x = value and D y
= rate (index 1).
"""

from __future__ import annotations

from typing import Any

import numpy as np
from petsc4py import PETSc

from drillpetsc import petsc_compat
from drillpetsc.errors import CaseError
from drillpetsc.fem.assembly import spin_derivatives
from drillpetsc.fem.discrete_system import DiscreteSystem

#: integrators for implicit first-order systems with algebraic rows
IMPLICIT = ("bdf", "beuler", "cn", "theta", "alpha", "arkimex", "dirk", "rosw")
#: those that keep their order with constraints on places (Brenan, Campbell and Petzold, Numerical Solution of
#: IVPs in DAEs, section 3.2)
HIGH_INDEX = ("bdf", "beuler")


def refuse_integrator(kind: str, multipliers: bool = False) -> None:
    """Raise CaseError for an integrator that cannot treat an implicit system with algebraic (prescribed)
    rows, or one whose constraints have multipliers (index 3)."""
    if multipliers and kind not in HIGH_INDEX:
        raise CaseError(
            at="petsc.ts_type",
            got=kind,
            want=" | ".join(HIGH_INDEX),
            hint="joints and the quaternion element keep constraints (index 3 or 2): stages of other integrators lose their "
            "order or fail there",
        )
    if kind not in IMPLICIT:
        raise CaseError(
            at="petsc.ts_type",
            got=kind,
            want=" | ".join(IMPLICIT),
            hint="prescribed motions are algebraic rows and the mass matrix is not diagonal: the integrator must be implicit "
            "and made for first-order systems",
        )
    try:
        PETSc.TS().create(comm=PETSc.COMM_SELF).setType(kind)
    except PETSc.Error:
        version = ".".join(map(str, PETSc.Sys.getVersion()))
        raise CaseError(
            at="petsc.ts_type",
            got=kind,
            want=" | ".join(k for k in IMPLICIT if k != kind),
            hint=f"PETSc {version}, which is in use here, has no integrator of this name",
        ) from None


class FirstOrderSystem:
    """TS callbacks on the state vector."""

    def __init__(self, system: DiscreteSystem):
        self.system, self.jacobians = system, 0
        if any(component.restores_constraints for component in system.components):
            raise CaseError(
                at="beam.constraint",
                got="stabilized",
                want="index3 or index2",
                hint="ts_type or snes_type in petsc ask for the whole system, whose solutions nobody restores",
            )
        if system.assembly.stabilized:
            raise CaseError(
                at="joints",
                got="constraint: stabilised",
                want="constraint: position",
                hint="ts_type or snes_type in petsc ask for the whole system, which knows no corrected velocities",
            )
        self._t = 0.0  # of the last evaluation
        self._wrong: dict[
            str, Any
        ] = {}  # where rows were last not finite, kept while the steps shrink towards that time
        self._wrong_until = 0.0
        layout, asm = system.layout, system.assembly
        self._rated = layout.y_local >= 0
        self._condensed = system.new_condensed()
        self._every = np.flatnonzero(self._rated)
        self._spin_nodes = asm.spin_at[:, 0]
        self._fixed = [f for f in asm.row_replacements if f.owned]
        rows, columns = self._places()
        lgm = layout.state_dm.getLGMap().getIndices()
        self.matrix = petsc_compat.square_matrix(system.new_state())
        petsc_compat.preallocate_coo(
            self.matrix, *(np.where(i >= 0, lgm[np.maximum(i, 0)], -1) for i in (rows, columns))
        )
        self._values = np.zeros(len(rows))
        self._first_order = np.flatnonzero((asm.columns >= 0) & ~self._rated[np.maximum(asm.columns, 0)])
        held = np.zeros(layout.size, dtype=bool)
        for f in self._fixed:
            held[f.rows] = True
        self._moves = ~held[self._every], ~held[self._spin_nodes]  # kinematic rows that keep their usual form

    def _places(self) -> tuple[np.ndarray, np.ndarray]:
        """Local rows and columns of all entries (-1: left out): the kinematic rows by x and y, their spin
        coupling by v and w, all blocks by x and by y, and three 7x7 blocks for each prescribed vertex."""
        system, layout, asm, every = self.system, self.system.layout, self.system.assembly, self._every
        owned = system.owned_index >= 0
        x, y = layout.x_local, layout.y_local
        on_rank = np.where(owned[every], x[every], -1)
        turning = np.repeat(np.where(owned[self._spin_nodes], x[self._spin_nodes], -1), 3)
        tangent = (asm.spin_at[:, 1:2] + np.arange(3)).ravel()
        rows, columns = [on_rank, on_rank, turning, turning], [x[every], y[every], x[tangent], y[tangent]]
        dynamic = np.where(self._rated, y, x)  # where a condensed row goes in the local state
        here = np.where(asm.rows >= 0, dynamic[np.maximum(asm.rows, 0)], -1)
        rows += [here, here]
        # the rate of a first-order unknown is that of the unknown itself, and so is its column
        columns += [
            np.where(asm.columns >= 0, place[np.maximum(asm.columns, 0)], -1) for place in (x, dynamic)
        ]
        for f in self._fixed:
            for row, column in ((x, x), (x, y), (y, y)):
                rows.append(np.repeat(row[f.rows], 7))
                columns.append(np.tile(column[f.rows], 7))
        return np.concatenate(rows), np.concatenate(columns)

    def default_solver(self, options: PETSc.Options) -> None:
        """A direct solver where the options ask for no other: the rows of a stiff string are too far apart in
        size for ILU."""
        defaults = {"ksp_type": "preonly", "pc_type": "lu"}
        if (
            self.system.comm.size > 1 or self.system.constrained
        ):  # PETSc's own LU does not pivot, and a multiplier has no diagonal
            solver = petsc_compat.parallel_lu()
            if solver:
                defaults |= {"pc_factor_mat_solver_type": solver}
            elif self.system.constrained:
                defaults |= {
                    "ksp_type": "gmres",
                    "ksp_rtol": "1e-10",
                    "pc_type": "redundant",
                    "redundant_pc_type": "lu",
                    "redundant_pc_factor_shift_type": "nonzero",
                }
            else:
                defaults |= {"pc_type": "redundant", "redundant_pc_type": "lu"}
            if (
                options.getString("ts_type", "") == "arkimex"
            ):  # its first step is another TS with a dense matrix, for which there is no LU
                defaults = {
                    "ksp_type": "gmres",
                    "ksp_rtol": "1e-10",
                    "pc_type": "bjacobi",
                    "sub_pc_type": "lu",
                }
        if options.hasName("ksp_type") or options.hasName("pc_type"):
            defaults = {}
        defaults["snes_stol"] = "1e-12"
        for name, value in defaults.items():
            if not options.hasName(name):
                options.setValue(name, value)

    # ------------------------------------------------------------------ callbacks
    def function(self, ts, t, state, rate, f) -> None:
        system, layout, asm = self.system, self.system.layout, self.system.assembly
        self._t = t
        system.load_state(state, rate)
        system.sum_residual(t, self._condensed)
        if (
            not np.isfinite(self._condensed.norm()) and not self._wrong
        ):  # steps of 1e-40 s spoil all rows later
            self._wrong, self._wrong_until = system.locate_largest_residual(t), t + 1e-9
        out, r, s, v = (
            f.getArray(),
            self._condensed.getArray(readonly=1),
            state.getArray(readonly=1),
            rate.getArray(readonly=1),
        )
        has = layout.y_owned >= 0
        out[np.where(has, layout.y_owned, layout.x_owned)] = r
        out[layout.x_owned[has]] = v[layout.x_owned[has]] - s[layout.y_owned[has]]
        place = system.owned_index[self._spin_nodes]
        on_rank = place >= 0
        out[layout.x_owned[place[on_rank]]] += asm.transport()[on_rank]
        for c in self._fixed:
            here = system.owned_index[c.rows]
            xs, ys = layout.x_owned[here], layout.y_owned[here]
            c.evaluate(t)
            out[xs] = c.complement @ out[xs] + c.D.T @ (c.D @ asm.x[c.rows] - c.value)
            out[ys] = c.complement @ out[ys] + c.D.T @ (c.D @ asm.y[c.rows] - c.rate)

    def jacobian(self, ts, t, state, rate, shift, J, P) -> None:
        system, asm = self.system, self.system.assembly
        system.load_state(state, rate)
        self.jacobians += 1
        by_v, by_w = spin_derivatives(asm)
        parts = [
            shift * self._moves[0],
            -1.0 * self._moves[0],
            by_v * self._moves[1][:, None],
            by_w * self._moves[1][:, None],
        ]
        for weights in ((1.0, 0.0, 0.0), (0.0, 1.0, shift)):
            asm.jacobian(t, weights, condensed=False)
            parts.append(self._without_fixed(asm.values))
        parts[-1][self._first_order] *= shift
        for c in self._fixed:
            square = c.D.T @ c.D
            kin_x, kin_y = shift * np.eye(7), -np.eye(7)
            node = int(np.flatnonzero(self._spin_nodes == c.rows[6])[0])
            kin_x[6, 3:6], kin_y[6, 3:6] = by_v[node], by_w[node]
            parts += [c.complement @ kin_x + square, c.complement @ kin_y, square]
        np.concatenate([p.ravel() for p in parts], out=self._values)
        petsc_compat.set_values_coo(self.matrix, self._values)
        if P != self.matrix:
            self.matrix.copy(P)
        if J not in (P, self.matrix):
            J.assemble()

    def _without_fixed(self, values: np.ndarray) -> np.ndarray:
        """A copy without the rows by which the condensed system prescribes positions."""
        out, n = values.copy(), 49 * len(self._fixed)
        out[len(out) - n :] = 0.0
        return out

    def locate_largest_residual(self) -> dict[str, Any]:
        """Where the rows were last not finite, if they still are in the way, or else are largest."""
        return self._wrong or self.system.locate_largest_residual(self._t)

    def accept(self, ts) -> None:
        """Bring the assembly to the accepted state; accelerations, reactions and rates of first-order
        unknowns are those of the last evaluation."""
        if ts.getTime() > self._wrong_until:
            self._wrong = {}
        asm, first_order = self.system.assembly, np.flatnonzero(~self._rated)
        rates = asm.y[
            first_order
        ].copy()  # of the last evaluation: the state has none of first-order unknowns
        self.system.load_state(ts.getSolution())
        asm.y[first_order] = rates
