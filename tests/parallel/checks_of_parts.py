"""Checks of parts on all ranks: the exchange at shared nodes, sums over the ranks, other integrators, the quaternion string.

`run_checks.py` calls them.
"""

from __future__ import annotations

import numpy as np
from petsc4py import PETSc

from drillpetsc import petsc_compat
from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
from drillpetsc.analysis.statics.placement import find_reactions, move_rigidly, release
from drillpetsc.case import Case
from drillpetsc.kernels import pointer
from drillpetsc.model.drilling_model import DrillingModel, build_model
from drillpetsc.parallel import all_true, largest, total
from tests.helpers.component_models import KINDS, SHIFT, build
from tests.helpers.motion import beam, fixed, integrate, straight
from tests.verification.test_quaternion_contact import lying
from tests.verification.test_quaternion_scenes import JOINT, MUD, scene


def exchange(folder, patch) -> None:
    """The exchange at shared nodes against PETSc's scatters of whole vectors, and the residual of a step by its parts, to the bit."""
    one_call = [together(kind) for kind in KINDS]
    assert any(one_call)


def fill(vector: PETSc.Vec, seed: int) -> None:
    """Numbers of the whole vector, the same on any number of ranks."""
    first, last = vector.getOwnershipRange()
    vector.getArray()[:] = 0.1 * np.random.default_rng(seed).standard_normal(vector.getSize())[first:last]


def together(kind: str) -> bool:
    """True where the residual is one call."""
    system = build(kind)
    layout, asm, n = system.layout, system.assembly, system.layout.size
    q, state, rate = system.new_condensed(), system.new_state(), system.new_state()
    fill(q, 1), fill(state, 2), fill(rate, 3)
    local_q, local_state, local_rate = (
        dm.createLocalVec() for dm in (layout.condensed_dm, layout.state_dm, layout.state_dm)
    )
    layout.condensed_dm.globalToLocal(q, local_q)
    layout.state_dm.globalToLocal(state, local_state)
    layout.state_dm.globalToLocal(rate, local_rate)
    system.load_unknowns(q)
    assert np.array_equal(asm.x[:n], local_q.getArray())
    s, v = local_state.getArray(), local_rate.getArray()
    rates = layout.y_local >= 0
    system.load_state(state, rate)
    assert np.array_equal(asm.x[:n], s[layout.x_local])
    assert np.array_equal(asm.y[:n][rates], s[layout.y_local[rates]])
    assert np.array_equal(asm.y[:n][~rates], v[layout.x_local[~rates]])
    assert np.array_equal(asm.a[:n][rates], v[layout.y_local[rates]])
    shift = 3.0
    system.load_step(state, rate, shift)
    assert np.array_equal(asm.x[:n], s[layout.x_local])
    assert np.array_equal(asm.y[:n][rates], s[layout.y_local[rates]])
    assert np.allclose(asm.v0, (v - shift * s)[layout.x_local], rtol=0, atol=1e-14)
    assert np.allclose(asm.v1[rates], (v - shift * s)[layout.y_local[rates]], rtol=0, atol=1e-14)
    # the sum of both ranks' rows
    asm.x[:n] = local_q.getArray()
    r, summed = PETSc.Vec().createSeq(n, comm=PETSc.COMM_SELF), system.new_condensed()
    asm.residual(0.4)
    r.getArray()[:] = asm.r[:n]
    layout.condensed_dm.localToGlobal(r, summed, addv=PETSc.InsertMode.ADD_VALUES)
    if system.ends is not None:
        rows = asm.r[layout.local_of_owned].copy()
        system.ends.add(asm.r, rows)
        assert np.array_equal(rows, summed.getArray())
    # one call, with the messages between its parts
    second, expected, rows = 1.3 * SHIFT, system.new_condensed(), system.new_condensed()
    for _ in range(2):
        system.load_unknowns(q)
        asm.condense(SHIFT, second)
        asm.apply_prescribed_rates(0.4, second)
        system.sum_residual(0.4, expected)
    kept = [a.copy() for a in (asm.x, asm.y, asm.a)]
    for a in (asm.x, asm.y, asm.a):
        a[:n] = np.nan
    at = pointer(q.getArray()), pointer(rows.getArray())
    done = asm.step_rows(0.4, SHIFT, second, at, system.ends, rows.getArray())
    assert done == (not asm.stabilized)
    if done:
        assert np.array_equal(rows.getArray(), expected.getArray())
        assert all(np.array_equal(a, b) for a, b in zip((asm.x, asm.y, asm.a), kept, strict=True))
    return done


def totals(folder, patch) -> None:
    """Sums, largest values and conditions: right, and the same bits on every rank."""
    comm = PETSc.COMM_WORLD
    rank, size = comm.rank, comm.size
    values = np.array([[1.0, rank], [0.1, -rank]])
    kept = values.copy()
    for communicator in (comm, comm.tompi4py()):
        summed = np.asarray(total(communicator, values))
        assert summed.shape == (2, 2) and np.array_equal(values, kept)
        assert np.allclose(
            summed, [[size, size * (size - 1) / 2], [0.1 * size, -size * (size - 1) / 2]], rtol=1e-15
        )
        assert total(communicator, rank) == size * (size - 1) / 2
        assert largest(communicator, -float(rank)) == 0.0
        assert all_true(communicator, True) and all_true(communicator, rank != size - 1) is False
        # not a number on one rank only: the same answer on every rank
        answers = comm.tompi4py().allgather(largest(communicator, float("nan") if rank == size - 1 else 1.0))
        assert all(str(a) == str(answers[0]) for a in answers) and not answers[0] <= 1.0, answers
        # the same bits on every rank
        noise = np.random.default_rng(rank).normal(size=1000)
        every = comm.tompi4py().allgather(np.asarray(total(communicator, noise)).tobytes())
        assert len(set(every)) == 1


def other_integrators(folder, patch) -> dict[str, list[float]]:
    """Position and spin of the lower end of a rotating pendulum, by integrator, on rank 0."""
    found = {}
    # arkimex of newer PETSc is of first order with prescribed rows (test_dynamics_integrators.py), and its
    # solves fail in parallel
    for kind in ["bdf", "theta", "rosw"] + ["arkimex"] * (petsc_compat.VERSION < (3, 19, 0)):
        model = straight(
            string=[beam(0.5, 4, 2000.0, 6.667e-4, 1e-3, 0.02, 1.7e-7)],
            top={"kind": "top_drive", "rotation": {"ramp": 0.2, "value": 10.0}},
            gravity=[3.0, 0, 9.81],
            initial={"inclination": 1.0},
        )
        options = {"snes_type": "newtonls"} if kind == "bdf" else {"ts_type": kind}
        integrate(model.system, 0.1, fixed(1e-3, snes_rtol=1e-11, **options), breaks=model.breaks)
        system = model.system
        end = system.gather(np.hstack([system.field("string.position"), system.field("string.spin")]))
        found[kind] = [] if end is None else end[-1].tolist()
    return found


def quaternion_string(folder, patch) -> dict[str, list[float]]:
    """Motion, multipliers, reactions and energies of a quaternion string after fixed steps from its equilibrium, on rank 0."""
    found = {}

    def moved(case: Case, end: float, tolerance: float) -> tuple[DrillingModel, np.ndarray]:
        model = build_model(case)
        find_equilibrium(model)
        release(model)
        move_rigidly(model)
        integrate(model.system, end, fixed(2e-3, q_snes_stol=tolerance), breaks=model.breaks)
        m = model.system
        nodes = m.gather(np.hstack([model.beam.columns(m.assembly), m.field("string.multiplier")]))
        return model, np.zeros((20, 9)) if nodes is None else nodes

    def reactions(model: DrillingModel) -> list[float]:
        return [model.system.reaction(f"top.{name}") for name in ("axial_reaction", "torque_reaction")]

    for constraint in ("index3", "stabilized"):
        top = {"kind": "top_drive", "rotation": {"ramp": 0.02, "value": 6.0}, "lowering": 0.1}
        beam = {"formulation": "quaternion", "constraint": constraint}
        model, nodes = moved(lying("quaternion", top=top, beam=beam), 0.04, 1e-10)
        energies = model.system.energies(0.0)
        found[constraint] = [*nodes[-1], *reactions(model), energies.kinetic, energies.strain]
    for name, more in (
        ("items", {"joints": [JOINT]}),
        ("hermite", {"fluid": MUD | {"formulation": "hermite"}}),
    ):
        model, nodes = moved(scene("quaternion", **more), 0.02, 1e-11)
        model.system.assembly.a[:] = 0.0
        find_reactions(model)
        found[name] = [*nodes[18], *nodes[-1], *reactions(model)]
    return {name: [float(v) for v in values] for name, values in found.items()}
