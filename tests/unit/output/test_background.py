"""Tasks of a thread for files: in order, held back, errors where they are asked for."""

import threading
from pathlib import Path

import pytest

from drillpetsc.output.files.run_writer import WAITING, Background


def test_tasks_are_done_in_order_and_beside_the_caller():
    done, go, background = list[int](), threading.Event(), Background()
    background.submit(go.wait)
    for k in range(WAITING):  # these wait; the caller does not
        background.submit(lambda k=k: done.append(k))
    assert done == []
    go.set()
    background.wait()
    assert done == list(range(WAITING))
    background.close()


def test_closing_does_what_waits():
    done, background = list[int](), Background()
    for k in range(3 * WAITING):
        background.submit(lambda k=k: done.append(k))
    background.close()
    assert done == list(range(3 * WAITING))


def test_an_error_comes_once_and_drops_what_follows(tmp_path: Path):
    done, background = list[int](), Background()
    background.submit(lambda: (tmp_path / "none" / "file").write_text("x"))
    background.submit(lambda: done.append(1))
    with pytest.raises(FileNotFoundError) as error:
        background.wait()
    assert error.value.filename == str(tmp_path / "none" / "file")
    assert done == []
    background.check()
    background.submit(lambda: done.append(2))
    background.close()
    assert done == [2]


def test_without_tasks_there_is_no_thread():
    before, background = threading.active_count(), Background()
    background.wait()
    background.close()
    assert threading.active_count() == before
