"""Work on files in a separate thread, in order: the run does not wait for the disk."""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable

WAITING = 4  # tasks that may wait; a run that writes faster than the disk takes it is held back


class Background:
    """A thread that carries out tasks one after the other; it starts with the first one.

    After an error the tasks that follow are dropped, until ``check`` or ``wait`` has raised it.
    """

    def __init__(self) -> None:
        self._tasks: queue.Queue[Callable[[], object] | None] = queue.Queue(WAITING)
        self._error: BaseException | None = None
        self._thread: threading.Thread | None = None

    def submit(self, task: Callable[[], object]) -> None:
        """Carry out ``task`` later; it must not use data that the caller will change."""
        if self._thread is None:
            self._thread = threading.Thread(target=self._work, name="output", daemon=True)
            self._thread.start()
        self._tasks.put(task)

    def check(self) -> None:
        """Raise the error of an earlier task, if there is one, once."""
        error, self._error = self._error, None
        if error is not None:
            raise error

    def wait(self) -> None:
        """Wait for all tasks; raises as ``check``."""
        self._tasks.join()
        self.check()

    def close(self) -> None:
        """Wait for all tasks and end the thread; raises as ``check``."""
        if self._thread is not None:
            self._tasks.put(None)
            self._thread.join()
            self._thread = None
        self.check()

    def _work(self) -> None:
        while (task := self._tasks.get()) is not None:
            if self._error is None:
                try:
                    task()
                except BaseException as error:
                    self._error = error
            self._tasks.task_done()
        self._tasks.task_done()
