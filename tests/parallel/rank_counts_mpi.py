"""Messages of a run on this rank against those of the model: rank_counts_mpi.py OUT."""

import sys

import petsc4py

petsc4py.init([])

from petsc4py import PETSc  # noqa: E402

from drillpetsc import parallel  # noqa: E402
from drillpetsc.analysis.commands import rank_model  # noqa: E402
from drillpetsc.analysis.motion.transient import TransientRun, run  # noqa: E402
from drillpetsc.case import load_case  # noqa: E402
from drillpetsc.fem import end_exchange  # noqa: E402
from drillpetsc.solvers.chain import chain_lu  # noqa: E402
from drillpetsc.solvers.time.newton_iteration import NewtonIteration  # noqa: E402

CASE = "cases/benchmark/coupled-2000m.yaml"
calls = {"sum": 0, "exchange": 0}
sizes: dict[str, list[int]] = {"exchange": [], "gather": []}
_reduced, _pass, _exchange = parallel._reduced, end_exchange.EndExchange._pass, chain_lu._Message.exchange


def reduced(comm, *rest):
    calls["sum"] += comm.size > 1
    return _reduced(comm, *rest)


def over_ranks(self, *rest):
    calls["sum"] += 1
    return _over_ranks(self, *rest)


def passed(self, to, sent, of, received):
    calls["exchange"] += 1
    sizes["exchange"] += [a.nbytes for a in (*sent, *received)]
    return _pass(self, to, sent, of, received)


def exchanged(self, comm):
    sizes["gather"].append(self.received.nbytes)
    return _exchange(self, comm)


_over_ranks, NewtonIteration._over_ranks = NewtonIteration._over_ranks, over_ranks
parallel._reduced, end_exchange.EndExchange._pass, chain_lu._Message.exchange = reduced, passed, exchanged
_move = TransientRun._move
found = {}


def move(self):
    begun = dict(calls)
    asm, integrator, factor = self.model.system.assembly, self.integrator, self.integrator.newton.factor
    before = asm.evaluations, factor.factorisations
    for kept in sizes.values():
        kept.clear()
    _move(self)
    found.update({name: calls[name] - begun[name] for name in calls})
    counters = integrator.counters
    found.update(
        steps=counters.steps,
        solves=counters.steps + counters.rejected,
        iterations=integrator.newton.iterations,
        residuals=asm.evaluations - before[0],
        factorisations=factor.factorisations - before[1],
        operations=factor.factor_flops,
        counts=rank_model.step_counts(self.model),
    )


TransientRun._move = move
case = load_case(CASE, ["time.end=0.2 s", "string[0].element_length=45 m", "string[1].element_length=33 m"])
run(case, sys.argv[1], progress="silent")
comm = PETSc.COMM_WORLD
ranks, counts = comm.size, found["counts"]
model = counts.messages(ranks)
if ranks == 1:
    assert found["sum"] == found["exchange"] == 0 and not sizes["gather"]
else:
    per_step = rank_model.SUMS[0] * found["solves"] + rank_model.SUMS[1] * found["iterations"]
    assert abs(found["sum"] / per_step - 1) < 0.15, (found, per_step)
    exchanges = rank_model.EXCHANGES[0] * found["solves"] + rank_model.EXCHANGES[1] * found["residuals"]
    assert abs(found["exchange"] / exchanges - 1) < 0.05, (found, exchanges)
    gathers = found["factorisations"] + found["iterations"]
    assert abs(len(sizes["gather"]) / gathers - 1) < 0.05, (found, len(sizes["gather"]))
    for kind, size in (("blocks", max(sizes["gather"])), ("right-hand side", min(sizes["gather"]))):
        assert abs(model[kind][1] / size - 1) < 0.1, (kind, model[kind], size)
    assert min(sizes["exchange"]) == model["exchange"][1], (min(sizes["exchange"]), model)
# operations of the busiest rank
most = max(comm.tompi4py().allgather(found["operations"]))
expected = counts.operations(ranks)[0] * counts.elements / ranks
assert abs(expected / most - 1) < 0.15, (expected, most)
if comm.rank == 0:
    print("counts agree on", ranks, "ranks:", found)
