"""Balances of mass and energy of a string with every downhole tool in mud (manual: verif-two-of-a-kind)."""

from __future__ import annotations

import pytest

from drillpetsc import Case, run
from tests.helpers.whole_string import whole_string


@pytest.mark.parametrize(
    ("two", "cuttings"), [(False, "removed"), (True, "returned")], ids=["one of each", "two of some"]
)
def test_mass_and_energy_close(two, cuttings, tmp_path):
    """The shock sub below the reamer gives way by 6 mm under the weight, so the reamer starts that deep in its shoulder and cuts
    11 mm while the string moves by 1.5 mm: mud fills the difference, at 5 MPa.
    """
    # with generalised-alpha the energy gained between two readings of the hole is 1.03e-3 of the energy exchanged
    case = Case(**whole_string(two, end=0.05, cuttings=cuttings) | {"petsc": {"ts_type": "bdf"}})
    summary = run(case, tmp_path / "run", progress="silent").summary
    assert abs(summary["energy"]["error_share"]) < 1e-3
    assert summary["energy"]["gained_share"] < 1e-3
    # the hole is read anew after 0.2 mm of a reamer, of 0.076 m2 in all
    assert abs(summary["mass"]["error"]) < 0.076 * 2e-4
