"""Rows of a table (tests.helpers.tables): all are run, and those that fail are named."""

from __future__ import annotations

import pytest

from tests.helpers.tables import each_row


def test_every_row_that_fails_is_named(tmp_path):
    """Rows of two tables, multiplied; what fails does not end the others."""
    seen = []

    @each_row("a", [1, 2, 3], ids=["one", "two", "three"])
    @each_row(("b", "c"), [(4, 5), (6, 7)])
    def product(a, b, c, tmp_path):
        seen.append((a, b, c))
        (tmp_path / "file").mkdir()  # fails if a row gets the folder of another
        if a == 2:
            pytest.fail("never two")
        assert a * b != 18

    with pytest.raises(BaseExceptionGroup) as caught:
        product(tmp_path=tmp_path)
    assert seen == [(a, *bc) for a in (1, 2, 3) for bc in ((4, 5), (6, 7))]
    assert caught.value.message.splitlines() == ["2 of 3 rows fail", "  2: two", "  3: three"]
    two, three = caught.value.exceptions
    assert two.message.startswith("2 of 2 rows fail") and three.message.splitlines()[1:] == ["  2: 6, 7"]
    assert three.exceptions[0].__notes__ == ["in row 2: 6, 7"]


def test_fixtures_of_a_row_are_its_own(monkeypatch, capsys):
    @each_row("value", ["a", "b"])
    def patched(value, monkeypatch, capsys):
        assert not hasattr(each_row, "patch")
        monkeypatch.setattr(each_row, "patch", value, raising=False)
        print(value)
        assert capsys.readouterr().out == f"{value}\n"
        print("left")

    patched(monkeypatch=monkeypatch, capsys=capsys)
    assert not hasattr(each_row, "patch")


def test_a_row_that_skips_fails():
    @each_row("a", [1, 2])
    def skipping(a):
        pytest.skip("not here")

    with pytest.raises(BaseExceptionGroup, match="2 of 2 rows fail"):
        skipping()


def test_no_rows_are_an_error():
    with pytest.raises(AssertionError, match="no rows"):
        each_row("a", [])
