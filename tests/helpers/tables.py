"""Tables of quick tests: one test walks through all rows and names each that fails.

An item of pytest costs about 5 ms, and is collected again in every worker: more than most rows do.
"""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import pytest

#: what fails a row: a skip as well, which would hide the rows after it; the group is that of a second table
FAILURES = (Exception, pytest.fail.Exception, pytest.skip.Exception, BaseExceptionGroup)


def each_row(
    names: str | Sequence[str], table: Iterable, ids: Iterable[str] | Callable | None = None
) -> Callable:
    """Decorate a test that is called once for each row; the arguments are those of ``pytest.mark.parametrize``.

    For rows below about 50 ms.  Every row has its own ``tmp_path``, ``monkeypatch`` and ``capsys``; a row that skips fails.
    Several tables over one test are multiplied.
    """
    names = [n.strip() for n in names.split(",")] if isinstance(names, str) else list(names)
    bound = [_row(values, len(names)) for values in table]
    assert bound, f"no rows of {names}"
    if ids is None or callable(ids):
        labels = [", ".join(str((ids or repr)(v)) for v in row) for row in bound]
    else:
        labels = [str(label) for label in ids]

    def decorate(test: Callable) -> Callable:
        signature = inspect.signature(test)

        @functools.wraps(test)
        def all_rows(**fixtures: Any) -> None:
            failed = {}
            for k, (row, label) in enumerate(zip(bound, labels, strict=True)):
                try:
                    _call(test, dict(zip(names, row, strict=True)), fixtures, k)
                except FAILURES as failure:
                    failure.add_note(f"in row {k + 1}: {label}")
                    failed[f"{k + 1}: {label:.80}"] = failure
            if failed:
                words = "\n  ".join([f"{len(failed)} of {len(bound)} rows fail", *failed])
                raise BaseExceptionGroup(words, list(failed.values()))

        left = [p for name, p in signature.parameters.items() if name not in names]
        all_rows.__signature__ = signature.replace(parameters=left)  # type: ignore[attr-defined]
        return all_rows

    return decorate


def _row(values: Any, width: int) -> tuple:
    """Values of a row: one name takes the value as it stands."""
    row = (values,) if width == 1 else tuple(values)
    assert len(row) == width, f"{row}: want {width} values"
    return row


def _call(test: Callable, row: dict[str, Any], fixtures: dict[str, Any], k: int) -> None:
    """Call a row with fixtures as fresh as those of a test of its own."""
    own = dict(fixtures)
    if "tmp_path" in own:
        own["tmp_path"] = own["tmp_path"] / f"row{k}"
        own["tmp_path"].mkdir()
    if "capsys" in own:
        own["capsys"].readouterr()
    if "monkeypatch" in own:
        with own["monkeypatch"].context() as own["monkeypatch"]:
            test(**row, **own)
    else:
        test(**row, **own)
