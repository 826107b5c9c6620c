"""The assembled first-order system, for other integrators and solvers than the condensed default.

Manual: sec-time-first-order, eq-time-system.  A second-order unknown has two rows: the kinematic row x' - y =
0 (for a spin angle phi' - omega + c(v).w = 0) and the dynamic row in place of y'.  Each kind has seven rows
at a prescribed vertex; rows along D become D x = value and D y = rate, so the index is 1 (manual:
eq-time-first-order-prescribed).
"""

from __future__ import annotations

from typing import Any

import numpy as np
from petsc4py import PETSc

from drillpetsc import petsc_compat
from drillpetsc.errors import CaseError, OptionError
from drillpetsc.fem.assembly import spin_derivatives
from drillpetsc.fem.discrete_system import DiscreteSystem
from drillpetsc.solvers.petsc_options import INTEGRATORS

#: integrators for implicit first-order systems with algebraic rows; a run refuses rosw (petsc_options.REFUSED_INTEGRATORS)
IMPLICIT = ("bdf", "beuler", "cn", "theta", "alpha", "arkimex", "dirk", "rosw")
#: integrators that keep their order with constraints at position level (Brenan, Campbell and Petzold,
#: Numerical Solution of IVPs in DAEs, section 3.2)
HIGH_INDEX = ("bdf", "beuler")


def refuse_integrator(kind: str, multipliers: bool = False) -> None:
    """Raise OptionError for an integrator that cannot treat the system.

    kind: PETSc's name of the integrator.  It must treat an implicit system with algebraic (prescribed) rows.
    multipliers: constraints have multipliers (index 3), which further integrators cannot treat.
    """
    if multipliers and kind not in HIGH_INDEX:
        raise OptionError(
            at="petsc.ts_type",
            got=kind,
            want=" | ".join(HIGH_INDEX),
            hint="joints and the quaternion element have constraints (index 3 or 2), for which other integrators "
            "lose their order or fail",
        )
    if kind not in IMPLICIT:
        raise OptionError(
            at="petsc.ts_type",
            got=kind,
            want=INTEGRATORS,
            hint="prescribed motions are algebraic rows and the mass matrix is not diagonal: the integrator must be implicit "
            "and made for first-order systems",
        )
    try:
        PETSc.TS().create(comm=PETSc.COMM_SELF).setType(kind)
    except PETSc.Error:
        version = ".".join(map(str, PETSc.Sys.getVersion()))
        raise OptionError(
            at="petsc.ts_type",
            got=kind,
            want=INTEGRATORS,
            hint=f"the installed PETSc {version} has no integrator of this name",
        ) from None


class FirstOrderSystem:
    """TS callbacks on the state vector.

    jacobians: counter of Jacobians; matrix: the Jacobian.
    Raises CaseError if a component has constraints that need the condensed integrator.
    """

    def __init__(self, system: DiscreteSystem):
        self.system, self.jacobians = system, 0
        if any(component.restores_constraints for component in system.components):
            raise CaseError(
                at="beam.constraint",
                got="stabilized",
                want="index3 or index2",
                hint="ts_type or snes_type in petsc select the first-order system, which has no projection of solutions "
                "onto the constraints",
            )
        if system.assembly.stabilized:
            raise CaseError(
                at="joints",
                got="constraint: stabilised",
                want="constraint: position",
                hint="ts_type or snes_type in petsc select the first-order system, which has no corrected velocities",
            )
        self._t = 0.0  # time of the last evaluation [s]
        #: place of the first rows that were not finite; valid while the steps shrink towards that time
        self._not_finite: dict[str, Any] = {}
        self._not_finite_until = 0.0  # [s]
        layout, asm = system.layout, system.assembly
        self._has_rate = layout.y_local >= 0
        self._condensed = system.new_condensed()
        self._second_order = np.flatnonzero(self._has_rate)
        self._spin_nodes = asm.spin_at[:, 0]
        self._prescribed = [f for f in asm.row_replacements if f.owned]
        rows, columns = self._entry_dofs()
        lgm = layout.state_dm.getLGMap().getIndices()
        self.matrix = petsc_compat.square_matrix(system.new_state())
        petsc_compat.preallocate_coo(
            self.matrix, *(np.where(i >= 0, lgm[np.maximum(i, 0)], -1) for i in (rows, columns))
        )
        self._values = np.zeros(len(rows))
        columns = asm.places()[1]
        self._first_order = np.flatnonzero((columns >= 0) & ~self._has_rate[np.maximum(columns, 0)])
        prescribed = np.zeros(layout.size, dtype=bool)
        for f in self._prescribed:
            prescribed[f.rows] = True
        # kinematic rows and spin rows without prescribed motion
        self._free = ~prescribed[self._second_order], ~prescribed[self._spin_nodes]

    def _entry_dofs(self) -> tuple[np.ndarray, np.ndarray]:
        """Compute local rows and columns of all matrix entries, -1 if left out.

        Manual: eq-time-first-order-jacobian.

        In this order: the kinematic rows by x and y, their spin terms by v and w, all blocks by x and by y,
        and three 7x7 blocks for each prescribed vertex.
        """
        system, layout, asm, every = self.system, self.system.layout, self.system.assembly, self._second_order
        owned = system.owned_index >= 0
        x, y = layout.x_local, layout.y_local
        kinematic = np.where(owned[every], x[every], -1)
        spin = np.repeat(np.where(owned[self._spin_nodes], x[self._spin_nodes], -1), 3)
        tangent = (asm.spin_at[:, 1:2] + np.arange(3)).ravel()
        rows, columns = [kinematic, kinematic, spin, spin], [x[every], y[every], x[tangent], y[tangent]]
        dynamic = np.where(self._has_rate, y, x)  # index in the local state of each condensed row
        entry_rows, entry_columns = asm.places()
        block_rows = np.where(entry_rows >= 0, dynamic[np.maximum(entry_rows, 0)], -1)
        rows += [block_rows, block_rows]
        # a first-order unknown and its rate have the same column
        columns += [
            np.where(entry_columns >= 0, index[np.maximum(entry_columns, 0)], -1) for index in (x, dynamic)
        ]
        for f in self._prescribed:
            for row, column in ((x, x), (x, y), (y, y)):
                rows.append(np.repeat(row[f.rows], 7))
                columns.append(np.tile(column[f.rows], 7))
        return np.concatenate(rows), np.concatenate(columns)

    def default_solver(self, options: PETSc.Options) -> None:
        """Set options of a direct solver, unless ``options`` select another one.

        The rows of a stiff string differ too much in size for ILU.
        """
        defaults = {"ksp_type": "preonly", "pc_type": "lu"}
        # PETSc's own LU does not pivot, and a multiplier has no diagonal entry
        if self.system.comm.size > 1 or self.system.constrained:
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
            # the first step of arkimex is another TS with a dense matrix, for which there is no LU
            if options.getString("ts_type", "") == "arkimex":
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
        """Compute the residual of the first-order system (TS IFunction) (manual: eq-time-system)."""
        system, layout, asm = self.system, self.system.layout, self.system.assembly
        self._t = t
        system.load_state(state, rate)
        system.sum_residual(t, self._condensed)
        # only the first place counts: with steps of 1e-40 s all rows overflow later
        if not np.isfinite(self._condensed.norm()) and not self._not_finite:
            self._not_finite, self._not_finite_until = system.locate_largest_residual(t), t + 1e-9
        out, r, s, v = (
            f.getArray(),
            self._condensed.getArray(readonly=1),
            state.getArray(readonly=1),
            rate.getArray(readonly=1),
        )
        has_rate = layout.y_owned >= 0
        out[np.where(has_rate, layout.y_owned, layout.x_owned)] = r
        out[layout.x_owned[has_rate]] = v[layout.x_owned[has_rate]] - s[layout.y_owned[has_rate]]
        spin_index = system.owned_index[self._spin_nodes]
        owned = spin_index >= 0
        out[layout.x_owned[spin_index[owned]]] += asm.transport()[owned]
        for c in self._prescribed:
            node_index = system.owned_index[c.rows]
            xs, ys = layout.x_owned[node_index], layout.y_owned[node_index]
            c.evaluate(t, asm.x, asm.y)
            out[xs] = c.complement @ out[xs] + c.D.T @ (c.D @ asm.x[c.rows] - c.value)
            if c.leans:
                c.lean_at(asm.x)
            out[ys] = c.row_complement @ out[ys] + c.D.T @ (c.rate_directions @ asm.y[c.rows] - c.rate)

    def jacobian(self, ts, t, state, rate, shift, J, P) -> None:
        """Assemble the Jacobian (TS IJacobian) at ``shift`` [1/s] (manual: eq-time-first-order-jacobian)."""
        system, asm = self.system, self.system.assembly
        system.load_state(state, rate)
        self.jacobians += 1
        by_v, by_w = spin_derivatives(asm)
        parts = [
            shift * self._free[0],
            -1.0 * self._free[0],
            by_v * self._free[1][:, None],
            by_w * self._free[1][:, None],
        ]
        for weights in ((1.0, 0.0, 0.0), (0.0, 1.0, shift)):
            asm.jacobian(t, weights, condensed=False)
            parts.append(self._without_prescribed_rows(asm.values))
        parts[-1][self._first_order] *= shift
        for c in self._prescribed:
            projector = c.D.T @ c.D
            kin_x, kin_y = shift * np.eye(7), -np.eye(7)
            node = int(np.flatnonzero(self._spin_nodes == c.rows[6])[0])
            kin_x[6, 3:6], kin_y[6, 3:6] = by_v[node], by_w[node]
            parts += [c.complement @ kin_x + projector, c.complement @ kin_y, c.D.T @ c.rate_directions]
        np.concatenate([p.ravel() for p in parts], out=self._values)
        petsc_compat.set_values_coo(self.matrix, self._values)
        if P != self.matrix:
            self.matrix.copy(P)
        if J not in (P, self.matrix):
            J.assemble()

    def _without_prescribed_rows(self, values: np.ndarray) -> np.ndarray:
        """Copy ``values`` and set the entries to zero by which the condensed system prescribes positions."""
        out, n = values.copy(), 49 * len(self._prescribed)
        out[len(out) - n :] = 0.0
        return out

    def locate_largest_residual(self) -> dict[str, Any]:
        """Find the place of rows that were not finite shortly before, otherwise the place of the largest residual.

        Collective.
        """
        return self._not_finite or self.system.locate_largest_residual(self._t)

    def accept(self, ts) -> None:
        """Load the accepted state into the assembly.

        Accelerations, reactions and rates of first-order unknowns are from the last evaluation.
        """
        if ts.getTime() > self._not_finite_until:
            self._not_finite = {}
        asm, first_order = self.system.assembly, np.flatnonzero(~self._has_rate)
        rates = asm.y[first_order].copy()  # the state has no rates of first-order unknowns
        self.system.load_state(ts.getSolution())
        asm.y[first_order] = rates
