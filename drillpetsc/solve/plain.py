"""The whole first-order system, assembled: for other integrators and solvers than the condensed default (studies, oracles).

Rows of a second-order unknown: x' - y = 0 (for a spin angle phi' - omega + c(v).w = 0) and the dynamic row in place of y'.
"""

from __future__ import annotations

import numpy as np
from petsc4py import PETSc

from drillpetsc import petsc_compat
from drillpetsc.assembly import spin_derivatives
from drillpetsc.model import Model


class PlainSystem:
    """TS callbacks on the state vector."""

    def __init__(self, model: Model):
        self.model, self.jacobians = model, 0
        layout, asm = model.layout, model.assembly
        self._rated = layout.y_local >= 0
        self._row = np.where(self._rated, layout.y_local, layout.x_local)  # where a condensed row goes in the local state
        n = layout.size
        spin = asm.spin_at
        tangent = spin[:, 1:2] + np.arange(3)
        self._local = model.layout.state_dm.createLocalVec()
        self._condensed = model.new_condensed()
        # entries: kinematic rows (x'-y), their spin coupling (c_v.w by v, c by w), then the blocks by x and by y
        every = np.flatnonzero(self._rated)
        rows = [layout.x_local[every], layout.x_local[every], np.repeat(layout.x_local[spin[:, 0]], 3), np.repeat(layout.x_local[spin[:, 0]], 3)]
        columns = [layout.x_local[every], layout.y_local[every], layout.x_local[tangent].ravel(), layout.y_local[tangent].ravel()]
        owned = model.owned_place >= 0
        mask = [owned[every], owned[every], np.repeat(owned[spin[:, 0]], 3), np.repeat(owned[spin[:, 0]], 3)]
        self._every, self._spin_nodes = every, spin[:, 0]
        br, bc = asm.rows, asm.columns
        fine = (br >= 0) & (bc >= 0)
        block_rows = np.where(fine, self._row[np.clip(br, 0, n - 1)], -1)
        rows += [block_rows, block_rows]
        columns += [np.where(fine, layout.x_local[np.clip(bc, 0, n - 1)], -1),
                    np.where(fine & self._rated[np.clip(bc, 0, n - 1)], layout.y_local[np.clip(bc, 0, n - 1)], -1)]
        mask += [fine, fine]
        # prescribed vertices: velocity rows D y = rate
        fixed = [f for f in asm.fixed if f.owned]
        for f in fixed:
            rows.append(np.repeat(layout.y_local[f.rows], 7))
            columns.append(np.tile(layout.y_local[f.rows], 7))
            mask.append(np.ones(49, dtype=bool))
        self._fixed = fixed
        lgm = layout.state_dm.getLGMap().getIndices()

        def to_global(index, keep):
            index = np.where(keep, index, -1)
            return np.where(index >= 0, lgm[np.maximum(index, 0)], -1)

        keep = np.concatenate(mask)
        self.matrix = layout.state_dm.createMat()
        petsc_compat.preallocate_coo(self.matrix, to_global(np.concatenate(rows), keep), to_global(np.concatenate(columns), keep))
        self._values = np.zeros(len(keep))

    # ------------------------------------------------------------------ callbacks
    def function(self, ts, t, state, rate, f) -> None:
        model, layout, asm = self.model, self.model.layout, self.model.assembly
        model.load_state(state, rate)
        asm.x[-1], asm.y[-1], asm.a[-1] = 1.0, 0.0, 0.0
        model.sum_residual(t, self._condensed)
        out, r, s, v = f.getArray(), self._condensed.getArray(readonly=1), state.getArray(readonly=1), rate.getArray(readonly=1)
        has = layout.y_owned >= 0
        out[np.where(has, layout.y_owned, layout.x_owned)] = r
        kinematic = v[layout.x_owned[has]] - s[layout.y_owned[has]]
        out[layout.x_owned[has]] = kinematic
        spin_owned = model.owned_place[self._spin_nodes]
        mine = spin_owned >= 0
        out[layout.x_owned[spin_owned[mine]]] += asm.transport()[mine]
        for c in self._fixed:
            place = model.owned_place[c.rows]
            xs, ys = layout.x_owned[place], layout.y_owned[place]
            # position error stands in the kinematic row, velocity error in the dynamic row
            position = c.D @ asm.x[c.rows] - c.condition.value(t)
            speed = c.D @ asm.y[c.rows] - c.condition.rate(t)
            out[xs] = c.keep @ out[xs] + c.D.T @ position
            out[ys] = c.keep @ out[ys] + c.D.T @ speed

    def jacobian(self, ts, t, state, rate, shift, J, P) -> None:
        model, layout, asm = self.model, self.model.layout, self.model.assembly
        model.load_state(state, rate)
        self.jacobians += 1
        values, every = self._values, self._every
        k, m = len(every), 3 * len(self._spin_nodes)
        values[:k], values[k : 2 * k] = shift, -1.0
        by_v, by_w = spin_derivatives(asm)
        values[2 * k : 2 * k + m], values[2 * k + m : 2 * k + 2 * m] = by_v.ravel(), by_w.ravel()
        start = 2 * k + 2 * m
        size = len(asm.values)
        asm.jacobian(t, (1.0, 0.0, 0.0), condensed=False)
        values[start : start + size] = asm.values
        self._zero_fixed(values[start : start + size])
        asm.jacobian(t, (0.0, 1.0, shift), condensed=False)
        values[start + size : start + 2 * size] = asm.values
        self._zero_fixed(values[start + size : start + 2 * size])
        where = start + 2 * size
        for c in self._fixed:
            values[where : where + 49] = (c.D.T @ c.D).ravel()
            where += 49
        petsc_compat.set_values_coo(self.matrix, values)
        self._replace_kinematic_rows(shift)
        if J != self.matrix:
            self.matrix.copy(J)

    def _zero_fixed(self, values: np.ndarray) -> None:
        n = 49 * len(self._fixed)
        if n:
            values[len(values) - n :] = 0.0

    def _replace_kinematic_rows(self, shift: float) -> None:
        """Kinematic rows of prescribed components: D x = value instead of D (x' - y) = 0."""
        layout, asm = self.model.layout, self.model.assembly
        touched = False
        for c in self._fixed:
            lgm = layout.state_dm.getLGMap().getIndices()
            rows = lgm[layout.x_local[c.rows]].astype(PETSc.IntType)
            rates = lgm[layout.y_local[c.rows]].astype(PETSc.IntType)
            remove = c.D.T @ c.D
            # before: shift I by x, -I by y (and the spin coupling, which prescribed spins replace as a whole)
            kin_x, kin_y = shift * np.eye(7), -np.eye(7)
            j = int(np.flatnonzero(self._spin_nodes == c.rows[6])[0])
            by_v, by_w = spin_derivatives(asm)
            kin_x[6, 3:6] += by_v[j]
            kin_y[6, 3:6] += by_w[j]
            self.matrix.setValues(rows, rows, c.keep @ kin_x + remove, addv=PETSc.InsertMode.INSERT_VALUES)
            self.matrix.setValues(rows, rates, c.keep @ kin_y, addv=PETSc.InsertMode.INSERT_VALUES)
            touched = True
        if touched or self.model.comm.size > 1:
            self.matrix.assemble()

    def accept(self, ts) -> None:
        """Bring the assembly to the accepted state; accelerations from the last evaluation."""
        self.model.load_state(ts.getSolution())
