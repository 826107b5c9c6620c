"""Checks of runs on all ranks: contacts renewed apart, messages and operations, steps evaluated together, local sizes.

`run_checks.py` calls them.
"""

from __future__ import annotations

import numpy as np
from petsc4py import PETSc

from drillpetsc import parallel
from drillpetsc.analysis.commands import rank_model
from drillpetsc.analysis.motion.transient import TransientRun, run
from drillpetsc.case import load_case
from drillpetsc.fem import end_exchange
from drillpetsc.model.drilling_model import build_model
from drillpetsc.output import read_series, read_table, recorder
from drillpetsc.output.files import run_writer
from drillpetsc.solvers.chain import chain_lu
from drillpetsc.solvers.time.newton import chain_factor
from drillpetsc.solvers.time.newton_iteration import NewtonIteration
from tests.helpers.mpi import ROOT

COMM = PETSc.COMM_WORLD
CASE = ROOT / "cases" / "benchmark" / "coupled-2000m.yaml"
SHORT = ["time.end=0.2 s", "string[0].element_length=45 m", "string[1].element_length=33 m"]


TWO_ELEMENTS = """
title: Two elements
string: [{kind: pipe, length: 20 m, od: 127 mm, id: 108.6 mm, element_length: 10 m}]
material: {young: 206 GPa, poisson: 0.3, density: 7850 kg/m3}
top: {kind: top_drive, rotation: {ramp: 2 s, value: 80 rpm}}
bottom: free
gravity: 9.81 m/s2
time: {end: 0.05 s}
output: {history_every: 0.01 s, field_every: 0.02 s}
"""


def two_elements(folder, patch) -> dict | None:
    """A run with frames, on ranks without an element: its hook load and torque."""
    (case := folder.with_suffix(".yaml")).write_text(TWO_ELEMENTS)
    COMM.barrier()
    run(case, folder, progress="silent")
    if COMM.rank:
        return None
    assert len(read_series(folder)) == 3
    history = read_table(folder / "history.csv")
    return {name: history[name].tolist() for name in ("hook_load [N]", "surface_torque [N m]")}


def contacts_apart(folder, patch) -> None:
    """Contacts renewed apart on a rank against a whole factorisation of the same entries, to the last bit.

    On a rank that eliminates a tail, on one that has no changed entry, and on the others (manual: sec-time-contact-entries).
    """
    totals = [0, 0, 0]
    entries, factor = NewtonIteration.compute_entries, NewtonIteration._factor_from
    begin = NewtonIteration.begin
    whole = [False]  # the next factorisation is that of new entries

    def compute_entries(self):
        whole[0] = True
        entries(self)

    def factor_from(self, first):
        factor(self, first)
        if not whole[0]:  # of the contacts alone
            partly, again = np.zeros((2, len(self.rows)))
            self.factor.solve_owned(self.rows, partly)
            self.factor.factor(self.system.assembly.values)
            self.factor.solve_owned(self.rows, again)
            assert np.array_equal(partly, again), abs(partly - again).max()
            last = self.contacts.nodes - 1
            totals[0] += 1
            totals[1] += 0 < first <= last
            totals[2] += first > last
        whole[0] = False

    def in_python(self, *arguments):
        self.compiled = False
        begin(self, *arguments)

    patch.setattr(NewtonIteration, "compute_entries", compute_entries)
    patch.setattr(NewtonIteration, "_factor_from", factor_from)
    patch.setattr(NewtonIteration, "begin", in_python)
    run(load_case(CASE, ["time.end=0.5 s", "initial.wob=60 kN"]), folder, progress="silent")
    every = COMM.tompi4py().allgather(totals)
    assert len({renewed for renewed, *_ in every}) == 1 and every[0][0] > 0, every
    if COMM.size > 1:
        assert any(unchanged for *_, unchanged in every), every
    assert any(tail for _, tail, _ in every), every


def counts(folder, patch) -> None:
    """Calls, bytes and operations of a run of 46 elements with mud against the model behind the line of ``check``.

    Sums within 15 %, exchanges and gathers within 5 %, operations of the busiest rank within 15 %.
    """
    calls = {"sum": 0, "exchange": 0}
    sizes: dict[str, list[int]] = {"exchange": [], "gather": []}
    _reduced, _pass, _exchange = parallel._reduced, end_exchange.EndExchange._pass, chain_lu._Message.exchange
    _over_ranks, _move = NewtonIteration._over_ranks, TransientRun._move

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

    patch.setattr(NewtonIteration, "_over_ranks", over_ranks)
    patch.setattr(parallel, "_reduced", reduced)
    patch.setattr(end_exchange.EndExchange, "_pass", passed)
    patch.setattr(chain_lu._Message, "exchange", exchanged)
    patch.setattr(TransientRun, "_move", move)
    run(load_case(CASE, SHORT), folder, progress="silent")
    ranks, counts = COMM.size, found["counts"]
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
    most = max(COMM.tompi4py().allgather(found["operations"]))
    expected = counts.operations(ranks)[0] * counts.elements / ranks
    assert abs(expected / most - 1) < 0.15, (expected, most)


def steps_together(folder, patch) -> None:
    """Files with few and with many steps evaluated together, and with rows that never wait, are the same to the byte."""
    found, case = [], load_case(CASE, [*SHORT, "output.probes=[600 m, 1900 m]"])
    for count, wait in ((1, 0.5), (5, 0.5), (256, 1e9), (256, 0.0)):
        patch.setattr(recorder, "STEPS_AT_ONCE", count)
        patch.setattr(run_writer, "ROWS_WAIT", wait)
        result = run(case, out := folder / f"{count}-{wait:g}", progress="silent")
        if COMM.rank == 0:
            tables = [(out / f"{name}.csv").read_bytes() for name in ("history", "probes")]
            found.append((*tables, result.summary["energy"], result.summary["mass"]))
    assert all(one == found[0] for one in found)
    assert not found or found[0][0].count(b"\n") == 22, found[0][0]


def no_rank_holds_the_whole_string(folder, patch) -> None:
    """Of the string and of the work of its factorisation two ranks have half each."""
    if COMM.size != 2:
        return
    case = load_case(ROOT / "cases" / "vertical-2000m.yaml")
    part, whole = (build_model(case, comm).system for comm in (COMM, PETSc.COMM_SELF))
    for size in (
        lambda s: s.layout.size,
        lambda s: len(s.chain.cells),
        lambda s: len(s.assembly.values),
        lambda s: chain_factor(s).factor_flops,
    ):
        assert size(part) <= 0.55 * size(whole)
