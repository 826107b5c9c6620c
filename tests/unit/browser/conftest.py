"""A finished run, and a server of its page."""

import threading
from collections.abc import Iterator
from pathlib import Path

import pytest

from drillpetsc.browser.run_source import RunSource
from drillpetsc.browser.server import Server, run_server
from tests.helpers.output_samples import make_run


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    run = make_run(tmp_path / "run")
    run.release()
    return run.path


@pytest.fixture
def server(folder: Path) -> Iterator[Server]:
    made = run_server("127.0.0.1", 0, RunSource(folder, "metric"))
    thread = threading.Thread(target=made.serve_forever, args=(0.05,))
    thread.start()
    yield made
    made.shutdown()
    thread.join()
    made.server_close()
