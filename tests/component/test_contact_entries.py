"""Entries of the contacts computed anew in a Jacobian whose other entries stay (manual: sec-time-contact-entries)."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc import load_case, run
from drillpetsc.analysis.motion.session.session import Session
from drillpetsc.fem.contact_entries import ContactEntries
from drillpetsc.solvers.time.newton import CondensedNewton, shared_factor
from tests.helpers.component_models import KINDS, SHIFT, build
from tests.helpers.tables import each_row

WEIGHTS = (1.0, SHIFT, SHIFT**2)
TURNING = """
well:
  survey: {{md: [0 m, 60 m], inclination: [{inclination}], azimuth: [0 deg, 0 deg]}}
  sections: [{{to: 60 m, kind: casing, diameter: 215.9 mm, friction: 0.2}}]
string:
  - {{kind: pipe, length: 30 m, od: 127 mm, id: 108.6 mm, element_length: 10 m}}
  - {{kind: pipe, length: 20 m, od: 171.5 mm, id: 71.4 mm, element_length: 10 m, eccentricity: 3 mm}}
top: {{kind: top_drive, rotation: 160 rpm, lowering: 0.1 m/s}}
bottom: free
time: {{end: 1 s}}
"""


def with_contact():
    return [kind for kind in KINDS if build(kind).has_contact]


@each_row("kind", with_contact())
def test_only_contacts_change_and_from_the_node_that_is_told(kind):
    """At another state the contacts have the entries of a whole Jacobian there, to the last bit, and all others stay."""
    system = build(kind)
    asm = system.assembly
    entries = ContactEntries(system)
    asm.residual(0.2)
    asm.jacobian(0.2, WEIGHTS, condensed=True)
    before = asm.values.copy()
    assert entries.update(0.2, WEIGHTS) == entries.nodes  # the same state: nothing changes
    n = system.layout.size
    asm.x[:n] += 1e-4 * np.random.default_rng(5).standard_normal(n)
    asm.y[:n] += 1e-2 * np.random.default_rng(6).standard_normal(n)
    first = entries.update(0.2, WEIGHTS)
    got = asm.values.copy()
    asm.jacobian(0.2, WEIGHTS, condensed=True)
    rows = asm.places()[0]
    for b, owner in zip(asm.bound_blocks, system.component_of, strict=True):
        expected = asm.values if owner.has_contact else before
        # prescribed rows are projected once more, which is rounding
        assert np.allclose(got[b.span], expected[b.span], rtol=1e-13, atol=1e-13 * abs(before).max())
    changed = np.abs(got - before) > 1e-10 * abs(before).max()
    if changed.any():
        assert first <= system.layout.vertex_of[rows[changed]].min()


@each_row("kind", with_contact())
def test_factors_of_the_tail_are_those_of_the_whole(kind):
    """Elimination from the first changed node on gives the factors of all of it, to the last bit."""
    system = build(kind)
    asm, entries = system.assembly, ContactEntries(system)
    factor = shared_factor(system)
    asm.jacobian(0.2, WEIGHTS, condensed=True)
    factor.factor(asm.values)
    asm.x[: system.layout.size] += 1e-5 * np.random.default_rng(7).standard_normal(system.layout.size)
    first = entries.update(0.2, WEIGHTS)
    if first < entries.nodes:
        factor.factor(asm.values, first)
    tail = factor.piece.store.tobytes()
    factor.factor(asm.values)
    assert factor.piece.store.tobytes() == tail


def test_whirl_needs_few_whole_jacobians():
    """From one state of a whirling string: the same motion as by whole Jacobians within the tolerance, with a fifth of them."""
    case = load_case("cases/vertical-2000m-dry.yaml", ["petsc.ts_adapt_type=none", "petsc.ts_dt=0.005"])
    ends, counts = [], []
    with Session(case) as s:
        s.step(1.5)
        start, newton, system = s.state(), s._integrator.newton, s._integrator.system
        for contacts in (newton.iteration.contacts, None):
            s.set_state(start)
            newton.iteration.contacts, before = contacts, newton.jacobians
            s.step(0.05)
            ends.append(system.assembly.x[: system.layout.size] / system.scale)
            counts.append(newton.jacobians - before)
    assert np.abs(ends[0] - ends[1]).max() < 1e-4
    assert counts[1] >= 10
    assert counts[0] <= 0.2 * counts[1]


@pytest.mark.parametrize("inclination", ["40 deg, 70 deg", "3 deg, 3 deg"])
def test_the_factorisation_is_that_of_the_entries(inclination, tmp_path, monkeypatch):
    """After every step whose last matrix took contacts alone: what a checkpoint holds gives the same factors, to the bit, also
    where a top that is moved along an inclined or curved hole turns the rows of its motion."""
    solve, compared = CondensedNewton.solve, []

    def and_factor(self, *arguments):
        updates, reason = self.contact_updates, solve(self, *arguments)
        if self.contact_updates > updates and self.iteration.record.good and self.iteration.has_factor:
            piece = self.factor.piece
            before = [a.copy() for a in (piece.store, piece.inverse, piece.pivot)]
            piece.factor(self.system.assembly.values, self.factor.pivot_tolerance)
            for a, b in zip(before, (piece.store, piece.inverse, piece.pivot), strict=True):
                np.testing.assert_array_equal(a, b)
            compared.append(self.t)
        return reason

    monkeypatch.setattr(CondensedNewton, "solve", and_factor)
    (tmp_path / "case.yaml").write_text(TURNING.format(inclination=inclination))
    run(load_case(tmp_path / "case.yaml"), tmp_path / "run", progress="silent")
    assert compared
