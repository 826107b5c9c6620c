"""The mud's viscous force across the hole at the frequency of a mode, `fluid.added_mass: stokes` (manual: sec-eigen-nonlinear)."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
import scipy.sparse as sparse

from drillpetsc.analysis.linear.linearised_model import linearise_model
from drillpetsc.analysis.statics.placement import hole_at_string
from drillpetsc.arrays import FloatArray
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.model.fluid import lateral_viscosity
from drillpetsc.parallel import total
from drillpetsc.physics.fluid.added_mass import stokes_coefficients, stokes_force
from drillpetsc.solvers.linear.linearization import Linearised, unknowns_of
from drillpetsc.solvers.linear.nonlinear_eigenvalue import refine
from drillpetsc.solvers.linear.quadratic_eigenproblem import Eigenvalues

DIGITS = 6  # significant digits by which diameters and viscosities differ
SAME_SHAPE = 0.5  # squared cosine between the shapes before and after below which another mode was reached
SAME_MODE = 0.999  # the same between two modes above which they are one


def present(model: DrillingModel) -> bool:
    """Whether the mud's force across the hole depends on the frequency."""
    fluid = model.case.fluid
    return (
        fluid is not None
        and fluid.added_mass == "stokes"
        and model.annulus is not None
        and not model.case.hold_string
    )


@dataclass
class StokesForces:
    """Coefficients of the force by kinds of elements: those of one diameter, hole and viscosity.

    radius: (k,) of the string [m]; ratio: (k,) hole over string diameter [-]; viscosity: (k,) kinematic [m2/s].
    swirl: (k,) of the mud about the string [rad/s], in the present state.
    kind: (nc,) kind of each local element.
    density: [kg/m3]; given: damping of the case [N s/m2], None: from the viscous flow.
    reference: frequency of runs [rad/s].
    """

    model: DrillingModel
    radius: FloatArray = field(init=False)
    ratio: FloatArray = field(init=False)
    viscosity: FloatArray = field(init=False)
    swirl: FloatArray = field(init=False)
    kind: np.ndarray = field(init=False)

    def __post_init__(self) -> None:
        """Tell the elements apart; collective."""
        model, f = self.model, self.model.case.fluid
        assert f is not None and model.annulus is not None
        self.density, self.reference = f.density, f.lateral_damping_speed
        self.given = None if f.lateral_damping == "stokes" else float(f.lateral_damping)
        sizes = model.annulus.lateral_sizes()
        viscosity = lateral_viscosity(model.case, sizes[:, 0], sizes[:, 1]) / f.density
        own = _rounded(np.column_stack([sizes, viscosity, model.annulus.parameter("swirl")]))
        comm = model.system.comm
        whole = own if comm.size == 1 else np.concatenate(comm.tompi4py().allgather(own))
        kinds = np.unique(whole, axis=0)
        self.radius, self.ratio = 0.5 * kinds[:, 0], kinds[:, 1] / kinds[:, 0]
        self.viscosity, self.swirl = kinds[:, 2], kinds[:, 3]
        self.kind = np.array([int(np.flatnonzero((kinds == row).all(axis=1))[0]) for row in own], dtype=int)

    @property
    def displaced(self) -> FloatArray:
        """(k,) displaced mass per length [kg/m]."""
        return self.density * np.pi * self.radius**2

    def coefficients(self, s: complex, direction: float = 0.0) -> tuple[FloatArray, FloatArray]:
        """Compute added mass (k,) [-] and damping (k,) [N s/m2] whose force is that of a motion exp(s t), Im s > 0.

        s' chi + k_v/m_d = s' H(s') with the rate s' relative to the mud: s less the swirl for a motion that goes round the hole
        forward (direction 1), s plus the swirl backward (-1), s across still mud (0) (manual: eq-eigen-stokes).
        """
        if direction and self.swirl.any():
            return self._coefficients(_upper(s - 1j * direction * self.swirl))
        return self._coefficients(np.full(len(self.swirl), complex(s)))

    def _coefficients(self, s: np.ndarray) -> tuple[FloatArray, FloatArray]:
        """The same at rates (k,) relative to the mud of each kind."""
        chi = (self.ratio**2 + 1) / (self.ratio**2 - 1)
        damping = np.zeros(len(chi)) if self.given is None else np.full(len(chi), self.given)
        viscous = self.viscosity > 0
        if not viscous.any():
            return chi, damping
        radius, ratio, nu = self.radius[viscous], self.ratio[viscous], self.viscosity[viscous]
        s = s[viscous]
        if self.given is not None:
            chi[viscous] = stokes_coefficients(s.imag * radius**2 / nu, ratio)[0]
            return chi, damping
        force = s * stokes_force(s, radius, nu, ratio)
        chi[viscous] = force.imag / s.imag
        damping[viscous] = self.displaced[viscous] * (force.real - s.real * chi[viscous])
        return chi, damping

    def set(self, chi: FloatArray, damping: FloatArray) -> None:
        """Give the elements the coefficients (k,) of their kinds."""
        assert self.model.annulus is not None
        self.model.annulus.set_lateral(chi[self.kind], damping[self.kind])

    def set_frequency(self, omega: float, direction: float = 0.0) -> None:
        """Give the elements the coefficients at a frequency [rad/s]; direction as in ``coefficients``."""
        self.set(*self.coefficients(1j * omega, direction))

    def stokes_number(self, omega: FloatArray, weight: FloatArray) -> FloatArray:
        """Stokes numbers (m,) of modes at frequencies (m,) [rad/s], inf without viscosity.

        weight: (m, k) share of each kind of element in the lateral motion.
        """
        with np.errstate(divide="ignore"):
            number = omega[:, None] * (self.radius**2 / self.viscosity)[None]
        return np.asarray(np.sum(np.where(weight > 0, number * weight, 0.0), axis=1))


#: least share of a rate that oscillates relative to the mud: coefficients of a motion that does not are not two numbers
LEAST_OSCILLATION = 1e-3


def _upper(s: np.ndarray) -> np.ndarray:
    """The rates, or their conjugates, whose coefficients are the same, above the real axis."""
    return s.real + 1j * np.maximum(np.maximum(np.abs(s.imag), LEAST_OSCILLATION * np.abs(s)), 1e-9)


def _rounded(values: FloatArray) -> FloatArray:
    """Values with ``DIGITS`` significant digits."""
    size = 10.0 ** (DIGITS - 1 - np.floor(np.log10(np.maximum(np.abs(values), 1e-300))))
    return np.asarray(np.where(values == 0, 0.0, np.round(values * size) / size))


@dataclass
class FrequencyDependent:
    """The linearised system as a function of s, in the free motions; on the rank that has it.

    base: without the force across the hole; by_mass, by_damping: per kind of element, for coefficients of 1.
    """

    forces: StokesForces
    base: Linearised
    by_mass: list[tuple[sparse.csr_matrix, ...]]
    by_damping: list[tuple[sparse.csr_matrix, ...]]
    element_kind: np.ndarray
    turned: sparse.csr_matrix | None = None  # J u of the unknowns u across the hole, where the mud swirls

    def matrix(self, s: complex) -> sparse.csr_matrix:
        """K + s C + s^2 M with the mud's force at s, columns scaled."""
        factors = [np.ones(1)]
        for direction in self._directions:
            factors += self.forces.coefficients(s, direction)
        values = (self._values @ np.concatenate(factors)).reshape(3, -1)
        n = len(self.scale)
        pattern = self._columns, self._starts
        return sparse.csr_matrix((values[0] + s * values[1] + s**2 * values[2], *pattern), shape=(n, n))

    def __post_init__(self) -> None:
        T = self.base.motions
        parent = unknowns_of(T)
        self.scale = self.base.scale[parent]
        columns = T @ sparse.diags(self.scale)
        # a motion is the sum of one that goes round the hole forward, (u - i J u)/2, and one backward (manual: eq-eigen-swirl)
        ways: list[tuple[float, sparse.csr_matrix]] = [(0.0, columns)]
        if self.turned is not None:
            ways = [(way, 0.5 * (columns - 1j * way * (self.turned @ columns))) for way in (1.0, -1.0)]
        self._directions = [way for way, _ in ways]
        parts = [((self.base.K, self.base.C, self.base.M), columns)]
        parts += [(part, own) for _, own in ways for part in (*self.by_mass, *self.by_damping)]
        self._set_pattern([[sparse.coo_matrix(T.T @ A @ own) for A in part] for part, own in parts])

    def _set_pattern(self, parts: list[list[sparse.coo_matrix]]) -> None:
        """Give all parts one pattern of columns by row, once for all s: an entry is a sum over the parts that have it.

        parts: K, C, M (n, n) of each.
        """
        n = len(self.scale)
        keys = [[A.row.astype(np.int64) * n + A.col for A in part] for part in parts]
        places = np.unique(np.concatenate([key for part in keys for key in part]))
        self._columns = places % n
        self._starts = np.searchsorted(places, n * np.arange(n + 1, dtype=np.int64))
        entries = [
            (k * len(places) + np.searchsorted(places, keys[number][k]), np.full(A.nnz, number), A.data)
            for number, part in enumerate(parts)
            for k, A in enumerate(part)
        ]
        rows, columns, data = (np.concatenate(q) for q in zip(*entries, strict=True))
        self._values = sparse.csr_matrix((data, (rows, columns)), shape=(3 * len(places), len(parts)))


def frequency_dependent(model: DrillingModel) -> FrequencyDependent | None:
    """Linearise the model as a function of s, where its mud asks for it; None away from rank 0; collective."""
    if not present(model):
        return None
    forces = StokesForces(model)
    count = len(forces.radius)
    nothing = np.zeros(count)

    def matrices(chi: FloatArray, damping: FloatArray) -> Linearised | None:
        forces.set(chi, damping)
        return linearise_model(model)

    base = matrices(nothing, nothing)
    by_mass: list[tuple[sparse.csr_matrix, ...]] = []
    by_damping: list[tuple[sparse.csr_matrix, ...]] = []
    for k in range(count):
        unit = np.zeros(count)
        unit[k] = 1.0
        for chi, damping, parts in ((unit, nothing, by_mass), (nothing, unit, by_damping)):
            one = matrices(chi, damping)
            if one is not None and base is not None:
                parts.append((one.K - base.K, one.C - base.C, one.M - base.M))
    forces.set_frequency(forces.reference)
    tangent, _ = hole_at_string(model)
    if model.system.comm.size > 1 and forces.swirl.any():
        own = np.where(model.system.chain.owned[:, None], tangent[model.system.chain.vertices], 0.0)
        tangent = np.zeros_like(tangent)
        tangent[model.system.chain.vertices] = own
        tangent = np.asarray(total(model.system.comm.tompi4py(), tangent))
    elements = model.system.gather(forces.kind[:, None].astype(float), "cell")
    if base is None or elements is None:
        return None
    names = [f.name for f in model.system.layout.fields]
    turned = _turned(base, names, tangent) if forces.swirl.any() else None
    return FrequencyDependent(forces, base, by_mass, by_damping, elements[:, 0].astype(int), turned)


def _turned(base: Linearised, names: list[str], tangent: FloatArray) -> sparse.csr_matrix:
    """(n, n) J of the places and slopes, t x u with the hole's tangents (nodes, 3)."""
    rows, columns, values = [], [], []
    for name in ("string.position", "string.tangent"):
        own = np.flatnonzero(base.field == names.index(name))
        place = {(int(base.node[i]), int(base.component[i])): int(i) for i in own}
        for i in own:
            node, k = int(base.node[i]), int(base.component[i])
            for j, sign, axis in (
                (k + 1, -1.0, k + 2),
                (k + 2, 1.0, k + 1),
            ):  # (t x u)_k = t_(k+1) u_(k+2) - t_(k+2) u_(k+1)
                rows.append(int(i))
                columns.append(place[node, j % 3])
                values.append(sign * tangent[node, axis % 3])
    n = base.K.shape[0]
    return sparse.csr_matrix((values, (rows, columns)), shape=(n, n))


@dataclass(frozen=True)
class AtOwnFrequency:
    """Modes with the mud's force at their own frequencies: eigenvalues, and how many kept the reference frequency."""

    found: Eigenvalues
    kept: int


def at_own_frequencies(system: FrequencyDependent, found: Eigenvalues, lateral: FloatArray) -> AtOwnFrequency:
    """Refine oscillating eigenvalues that were found at the reference frequency.

    lateral: (m,) share of lateral motion; modes without any are left.
    Modes that do not converge, jump to another shape or meet another mode keep the value at the reference frequency.
    """
    s, u, error = found.s.copy(), found.u.copy(), found.error.copy()
    kept, reached = 0, list[int]()
    for m in range(len(s)):
        if s[m].imag <= 0 or lateral[m] < 1e-6:
            continue
        start = np.asarray(u[:, m] / system.scale, dtype=complex)
        new = refine(system.matrix, complex(s[m]), start)
        same = new.converged and new.s.imag > 0 and _cosine(start, new.u) > SAME_SHAPE
        twice = same and any(
            abs(s[j] - new.s) < 1e-6 * abs(new.s) and _cosine(u[:, j] / system.scale, new.u) > SAME_MODE
            for j in reached
        )
        if not same or twice:
            kept += 1
            continue
        s[m], u[:, m] = new.s, system.scale * new.u
        T = system.matrix(new.s)
        rows = np.asarray(abs(T).max(axis=1).toarray(), dtype=float).ravel()
        rows[rows == 0] = 1.0
        error[m] = float(np.abs((T @ new.u) / rows).max() / np.abs(new.u).max())
        reached.append(m)
    order = np.lexsort((-s.real, s.imag))
    return AtOwnFrequency(replace(found, s=s, u=u, error=error).subset(order), kept)


def _cosine(a: np.ndarray, b: np.ndarray) -> float:
    """Squared cosine between two complex vectors."""
    return float(abs(np.vdot(a, b)) ** 2 / (np.vdot(a, a).real * np.vdot(b, b).real))


def stokes_numbers(system: FrequencyDependent, s: np.ndarray, position: np.ndarray) -> FloatArray:
    """Stokes numbers (m,) of modes; nan for those that do not oscillate.

    position: (m, nodes, 3) shapes across the string and along it.
    """
    motion = np.sum(np.abs(position) ** 2, axis=2)
    each = 0.5 * (motion[:, :-1] + motion[:, 1:])
    count = len(system.forces.radius)
    weight = np.stack([each[:, system.element_kind == k].sum(axis=1) for k in range(count)], axis=1)
    weight = weight / np.maximum(weight.sum(axis=1, keepdims=True), 1e-300)
    number = system.forces.stokes_number(s.imag, weight)
    return np.where(s.imag > 0, number, np.nan)
