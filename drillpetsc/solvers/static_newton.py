"""Static equilibrium: Newton on the potential energy, kept downhill by a shift where the tangent is not
positive definite.

The frictionless problem has an energy; its minima are the stable states.  Each step solves with K + sigma M,
sigma raised until no pivot is negative (Sylvester), and is shortened by the slope along it, so a straight
buckled string cannot be returned unless nothing disturbs it - then a small persistent side load is added.
Friction in the imposed sliding direction follows, by plain Newton.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.errors import SolveError
from drillpetsc.fem.assembly import ROW_SCALE
from drillpetsc.fem.discrete_system import DiscreteSystem
from drillpetsc.solvers.chain_lu import ZeroPivot
from drillpetsc.solvers.newton import chain_factor

CONVERGED = 2.0e-9  # increment relative to the fields' scales
STALLED = 1.0e-5  # good enough when rounding stops the descent
ITERATIONS = 600
FREE_ITERATIONS = 40
# full Newton steps without a smaller increment before they are given up (contacts that open and close for
# ever)
STALL_WINDOW = 8
TURN = 0.4  # largest change of a node's slope in one step


@dataclass
class Equilibrium:
    """What a static solve reports; forces in N, lengths in m."""

    iterations: int = 0
    negative_pivots: int = 0
    residual: float = 0.0
    increment: float = 0.0
    imperfection: float = 0.0
    converged: bool = False
    history: list[float] = field(default_factory=list)


class StaticNewton:
    """Static solver of one model; the state is the assembly's x, rates are zero.

    energy: the loads have a potential, so inertia and descent are meaningful; clearance: smallest radial
    clearance [m] (None: no well). weight_on_bit: (target [N], unit) where ``unit(model)`` gives (present
    depth of the bit below the hole's end [m], its gradient by the local unknowns (n,), depth that gives the
    target [m]); the top's axial position then follows.
    """

    def __init__(
        self, system: DiscreteSystem, energy: bool = True, clearance: float | None = None, t: float = 0.0
    ):
        self.system, self.energy, self.t = system, energy, t
        self.limit = 0.5 * clearance if clearance else 0.2 * float(system.mesh.node_depth[-1])
        self.factor = chain_factor(system)
        self.f = system.new_condensed()
        self.depth: Callable[[DiscreteSystem], tuple[float, FloatArray, float]] | None = None
        self.move_top: Callable[[float], None] | None = None
        self.rates: FloatArray | None = None  # (n+1,) of a steady motion; at rest without it
        self._mine = system.owned_index >= 0
        self._entries = self._shift_entries()
        self._top_rows = next(
            (f for f in system.assembly.row_replacements if f.owned and f.condition.vertex == 0), None
        )

    def _shift_entries(self) -> list[tuple[np.ndarray, np.ndarray]]:
        """Where the shift M goes: for position and slope, (vertices (k,), places (k, 3, 3) of a diagonal
        block in the values).

        Only owned vertices, each once; M = h (I - t t^T) for positions and h^3/100 (I - t t^T) for slopes:
        side springs.
        """
        system, asm = self.system, self.system.assembly
        chain = system.chain
        wanted = {}
        for name in ("string.position", "string.tangent"):
            first = system.layout.dofs[name][:, 0]
            wanted[name] = {int(p): v for v, p in enumerate(first) if p >= 0 and chain.owned[v]}
        out = []
        for name in wanted:
            found: dict[int, np.ndarray] = {}
            for item in asm.bound_blocks:
                for e in range(item.count):
                    for slot in _slots(item.index[e], wanted[name]):
                        vertex = wanted[name][int(item.index[e, slot])]
                        if vertex not in found:
                            k = slot + np.arange(3)
                            found[vertex] = item.span.start + e * item.width**2 + k[:, None] * item.width + k
            out.append(
                (
                    np.array(list(found), dtype=int),
                    np.array(list(found.values()), dtype=int).reshape(-1, 3, 3),
                )
            )
        return out

    def _node_size(self) -> FloatArray:
        mesh = self.system.mesh
        size = np.zeros(mesh.nodes)
        np.add.at(size, np.arange(mesh.nodes - 1), 0.5 * mesh.length)
        np.add.at(size, np.arange(1, mesh.nodes), 0.5 * mesh.length)
        return size[self.system.chain.vertices]

    # ------------------------------------------------------------------ pieces
    def sum(self, value: float) -> float:
        return value if self.system.comm.size == 1 else float(self.system.comm.tompi4py().allreduce(value))

    def largest(self, value: float) -> float:
        from mpi4py import MPI

        return (
            value
            if self.system.comm.size == 1
            else float(self.system.comm.tompi4py().allreduce(value, op=MPI.MAX))
        )

    def rows(self) -> FloatArray:
        """Residual at rest (or in the steady motion ``rates``), summed, as a ghosted local array valid at
        owned unknowns."""
        system, asm = self.system, self.system.assembly
        asm.y[:], asm.a[:] = 0.0 if self.rates is None else self.rates, 0.0
        asm.invalidate_prescribed_values()
        system.sum_residual(self.t, self.f)
        local = np.zeros(system.layout.size)
        local[system.layout.local_of_owned] = self.f.getArray(readonly=1)
        return local

    def _gradient(self, rows: FloatArray) -> FloatArray:
        """Derivative of the energy by (r, v, phi): rows of v get back what the spin coordinate takes;
        prescribed rows are zero."""
        asm, g = self.system.assembly, rows.copy()
        for f in asm.row_replacements:
            g[f.rows] = f.complement @ g[f.rows]
        phi, v = asm.spin_at[:, 0], asm.spin_at[:, 1:2] + np.arange(3)
        g[v] += self._spin_potential() * g[phi][:, None]
        return g

    def _spin_potential(self) -> FloatArray:
        asm = self.system.assembly
        v = asm.x[asm.spin_at[:, 1:2] + np.arange(3)]
        n = np.linalg.norm(v, axis=1, keepdims=True)
        return np.cross(v, asm.reference) / (n * (n + np.sum(v * asm.reference, axis=1, keepdims=True)))

    def _tangent(self) -> None:
        """Stiffness at x into the assembly's values, symmetric where the rooms are conservative."""
        asm = self.system.assembly
        asm.jacobian(self.t, (1.0, 0.0, 0.0), condensed=False)
        self._by_top = np.zeros(self.system.layout.size + 1)  # force on the free rows when the top moves down
        for f in asm.row_replacements:  # prescribed components do not move: their columns go, too
            for item, e, slots in f.elements:
                K = asm.values[item.span].reshape(item.count, item.width, item.width)[e]
                if f is self._top_rows:
                    np.add.at(self._by_top, item.index[e], K[:, slots] @ f.D[0])
                K[:, slots] = K[:, slots] @ f.complement
        c = self._spin_potential()
        slot = np.full(self.system.layout.size + 1, -1)
        slot[asm.spin_at[:, 0]] = np.arange(len(asm.spin_at))
        for item in asm.bound_blocks:
            if not item.count:
                continue
            K = asm.values[item.span].reshape(item.count, item.width, item.width)
            for s in range(item.width):
                node = slot[item.index[:, s]]
                if item.width < 7 or (node < 0).all():
                    continue
                K[:, s - 3 : s, :] += c[node][:, :, None] * K[:, s : s + 1, :]

    def _factor(self, sigma: float) -> int:
        """Factor K + sigma M; number of negative pivots (a missing pivot counts as one)."""
        values = self.system.assembly.values.copy()
        if sigma:
            v = self.system.field("string.tangent")
            across = np.eye(3) - v[:, :, None] * v[:, None, :] / np.sum(v * v, axis=1)[:, None, None]
            h = self._node_size()
            for (vertices, places), scale in zip(self._entries, (h, h**3 / 100), strict=True):
                values[places] += sigma * scale[vertices, None, None] * across[vertices]
        try:
            if self.energy:  # each multiplier is a negative eigenvalue, whatever the state (saddle point)
                return self.factor.negative_pivots(values) - self.system.multipliers
            self.factor.factor(values)
            return 0
        except ZeroPivot:
            return -1

    def _positive_factor(self, sigma: float) -> float:
        """Smallest shift on a coarse scale that leaves no negative pivot; the factor is ready."""
        mesh = self.system.mesh
        first = 1e-3 * self.largest(float(np.max((mesh.bending_stiffness / mesh.divisor**4)[~mesh.is_joint])))
        trial = sigma / 8 if sigma > 8 * first else 0.0
        for _ in range(60):
            if self._factor(trial) == 0:
                return trial
            trial = max(4 * trial, first)
        raise SolveError(
            "the static tangent could not be made positive definite",
            hint="is the string held anywhere?",
            **self.system.locate_largest_residual(self.t),
        )

    # ------------------------------------------------------------------ iteration
    def _step_limit(self, p: FloatArray) -> float:
        """Multiple of ``p`` that keeps side movement and turning of every node within bounds."""
        system = self.system
        r, v = p[system.layout.dofs["string.position"]], p[system.layout.dofs["string.tangent"]]
        t = system.field("string.tangent")
        t = t / np.linalg.norm(t, axis=1, keepdims=True)
        side = np.linalg.norm(r - t * np.sum(r * t, axis=1, keepdims=True), axis=1).max(initial=0.0)
        turn = np.linalg.norm(v, axis=1).max(initial=0.0)
        return min(self.limit / max(self.largest(side), 1e-300), TURN / max(self.largest(turn), 1e-300))

    def _search(self, x0: FloatArray, p: FloatArray, slope0: float, alpha: float, most: float) -> float:
        """Length of the step: shorter while the energy rises again beyond it, up to ``most`` while it still
        falls steeply."""
        good, shrunk = 0.0, False
        for _ in range(12):
            slope = self._slope_at(x0, p, alpha)
            if np.isfinite(slope) and slope <= 0.8 * abs(slope0):
                good = alpha
                if shrunk or slope > 0.5 * slope0 or alpha >= most:
                    break
                alpha = min(most, 3 * alpha)
                continue
            if good:
                break
            shrunk = True
            alpha *= (
                min(0.7, max(0.1, slope0 / (slope0 - slope))) if np.isfinite(slope) and slope > 0 else 0.3
            )
        return good or alpha

    def _slope_at(self, x0: FloatArray, p: FloatArray, alpha: float) -> float:
        """Slope of the energy along ``p`` at x0 + alpha p."""
        self.system.assembly.x[: self.system.layout.size] = x0 + alpha * p
        return self.sum(float(self._gradient(self.rows())[self._mine] @ p[self._mine]))

    def _bring_to_depth(self, p: FloatArray) -> float:
        """Add to ``p`` the motion of the top that brings the bit to its depth; returns the top's move [m]."""
        system, n = self.system, self.system.layout.size
        s = np.zeros(n)
        self.factor.solve(-self._gradient(system.sum_local(self._by_top)), s)
        if self._top_rows is not None:
            s[self._top_rows.rows] += self._top_rows.D[0]
        depth, gradient, target = self.depth(system)  # type: ignore[misc]
        here = self.sum(float(gradient[self._mine] @ p[self._mine]))
        by_top = self.sum(float(gradient[self._mine] @ s[self._mine]))
        if abs(by_top) < 1e-12:
            raise SolveError(
                "the top's position does not reach the bit",
                hint="wob needs a top with a prescribed axial position",
            )
        move = (target - self.sum(depth) - here) / by_top
        p += move * s
        return move

    def _newton(
        self, shifted: bool, report: Equilibrium, search: bool = True, most: int = ITERATIONS
    ) -> None:
        asm, n = self.system.assembly, self.system.layout.size
        sigma, best, weight = 0.0, np.inf, 1.0 / self.system.scale
        quiet, begun = 0, len(report.history)
        for _ in range(most):
            rows = self.rows()
            g = self._gradient(rows)
            self._tangent()
            if shifted:
                sigma = self._positive_factor(sigma)
            elif self._factor(0.0) < 0:
                raise SolveError(
                    "the static tangent is singular", **self.system.locate_largest_residual(self.t)
                )
            p = np.zeros(n)
            self.factor.solve(-self._with_constraints(g), p)
            move = self._bring_to_depth(p) if self.depth else 0.0
            x0 = asm.x[:n].copy()
            longest = self._step_limit(p)
            alpha = min(1.0, longest)
            slope0 = self.sum(float(g[self._mine] @ p[self._mine]))
            if search and shifted and abs(move) < 1e-9 and slope0 < 0:
                alpha = self._search(x0, p, slope0, alpha, longest if sigma else alpha)
            asm.x[:n] = x0 + alpha * p
            if self.depth and self.move_top:
                self.move_top(alpha * move)
            size = self.largest(float(np.max(np.abs(alpha * p) * weight, initial=0.0)))
            report.iterations += 1
            report.history.append(size)
            report.increment = size
            if not np.isfinite(size):
                raise SolveError(
                    "the static solution ran away", **self.system.locate_largest_residual(self.t)
                )
            quiet += size < STALLED and size > 0.8 * best  # rounding: small, and no longer falling
            if (
                alpha == 1.0
                and sigma == 0.0
                and (size < CONVERGED or quiet >= 3)
                or (quiet >= 8 and size < CONVERGED)
            ):
                report.converged = True
                return
            best = min(best, size)
            if not shifted and self._chatters(report.history[begun:], alpha):
                break
        raise SolveError(
            f"statics did not converge in {len(report.history) - begun} iterations "
            f"(last increment {size:.1e} of the fields' scales)",
            hint="a stronger initial.imperfection or a finer mesh may help",
            **self.system.locate_largest_residual(self.t),
        )

    @staticmethod
    def _chatters(sizes: list[float], alpha: float) -> bool:
        """Full steps that have not become smaller for a while."""
        if alpha < 1.0 or len(sizes) <= 2 * STALL_WINDOW:
            return False
        return min(sizes[-STALL_WINDOW:]) > 0.5 * min(sizes[:-STALL_WINDOW])

    def _with_constraints(self, g: FloatArray) -> FloatArray:
        """Right-hand side: prescribed rows ask for no motion beyond what brings them to their value."""
        out = g.copy()
        asm = self.system.assembly
        for f in asm.row_replacements:
            if f.owned:
                error = f.D @ asm.x[f.rows] - f.condition.value(self.t)
                out[f.rows] += f.D.T @ (ROW_SCALE * error)
        return out

    # ------------------------------------------------------------------ use
    def settle(self, report: Equilibrium | None = None) -> Equilibrium:
        """Find the equilibrium from the assembly's x; friction as the rooms have it set (off or imposed).

        With an energy the state is stable or ``negative_pivots`` says it is not.
        """
        report = report or Equilibrium()
        start = self.system.assembly.x.copy()
        try:
            self.newton_free(report)
        except SolveError:
            if not self.energy:
                raise
            self.system.assembly.x[:] = start
            self.minimise_energy(report)
        return report

    def newton_free(self, report: Equilibrium) -> None:
        """Full Newton steps, the quickest way where they work; SolveError where they do not converge to a
        stable state."""
        self._begin(report)
        self._newton(False, report, search=False, most=FREE_ITERATIONS)
        self._end(report)
        if self.energy and self.negative_pivots():
            raise SolveError("the static state is unstable", **self.system.locate_largest_residual(self.t))

    def minimise_energy(self, report: Equilibrium, most: int = ITERATIONS) -> None:
        """Down the energy, by steps with a positive definite tangent; ends in a stable state, or on a saddle
        when started there."""
        self._begin(report)
        self._newton(self.energy, report, most=most)
        self._end(report)

    def _begin(self, report: Equilibrium) -> None:
        report.converged = False
        x = self.system.assembly.x
        for f in self.system.assembly.row_replacements:
            x[f.rows] += f.D.T @ (f.condition.value(self.t) - f.D @ x[f.rows])

    def _end(self, report: Equilibrium) -> None:
        report.residual = self.largest(
            float(np.max(np.abs(self._gradient(self.rows())[self._mine]), initial=0.0))
        )

    def newton_damped(self, report: Equilibrium) -> None:
        """Newton without a potential (friction) from a state close by; raises SolveError when it does not
        converge."""
        energy, self.energy = self.energy, False
        try:
            self.newton_free(report)
        finally:
            self.energy = energy

    def negative_pivots(self) -> int:
        """Of the tangent at x; meaningful without friction."""
        self._tangent()
        return self._factor(0.0)

    def push_aside(self, fraction: float, weight: FloatArray, seed: int = 1) -> None:
        """Persistent random side loads of standard deviation ``fraction`` times ``weight`` (n_nodes,) [N] at
        the nodes."""
        system, asm = self.system, self.system.assembly
        rng = np.random.default_rng(seed)
        loads = fraction * weight[:, None] * rng.standard_normal((system.mesh.nodes, 2))
        t = system.frames.reference
        second = system.frames.second
        force = loads[:, :1] * second + loads[:, 1:] * np.cross(t, second)
        dead = np.zeros(system.layout.size)
        place = system.layout.dofs["string.position"]
        owned = system.chain.owned
        dead[place[owned]] = force[system.chain.vertices[owned]]
        asm.dead_load = dead


def _slots(row: np.ndarray, wanted: dict[int, int]) -> list[int]:
    return [s for s, place in enumerate(row) if int(place) in wanted]
