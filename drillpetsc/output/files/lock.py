"""One job at a time in a run folder: a file that says which process writes there."""

from __future__ import annotations

import atexit
import fcntl
import json
import os
import socket
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from drillpetsc.errors import SolveError

NAME = ".lock"

_held: dict[Path, tuple[int, int]] = {}
"""Lock files that this process holds: by which process id (a fork is another process), and its open folder, which follows a move."""


class RunFolderBusy(FileExistsError):
    """Another process writes into the folder."""


def take(folder: Path) -> None:
    """Hold the folder for this process; raises RunFolderBusy if another living process holds it.

    A lock of a process that has ended (on this host) is taken over. The state of a process on another host is
    unknown here, so it counts as alive. A lock of the operating system on the file guards reading and writing
    meanwhile, so that only one of two processes can win.
    """
    file = (folder / NAME).absolute()
    with _guarded(file) as number:
        owner = _read(number)
        if owner is not None and not _is_me(owner) and _is_alive(owner):
            reported = (
                f"{folder} is in use by process {owner['pid']} on {owner['host']} since {owner['since']}"
            )
            elsewhere = (
                "" if owner["host"] == socket.gethostname() else f" (if that run is over, remove {file})"
            )
            raise RunFolderBusy(f"{reported}: wait for it, or give another --out{elsewhere}")
        me = {
            "host": socket.gethostname(),
            "pid": os.getpid(),
            "started": _started(os.getpid()),
            "since": time.strftime("%F %T"),
        }
        _write(number, me)
    if file not in _held:
        _held[file] = os.getpid(), os.open(folder, os.O_RDONLY | os.O_DIRECTORY)


def release(folder: Path) -> None:
    """Release the folder, if this process holds it."""
    _release((folder / NAME).absolute())


def check_place(path: Path) -> Path | None:
    """The folder that this process holds and ``path`` is in, None outside; raises SolveError if it was moved or removed meanwhile."""
    for file, (_, number) in _held.items():
        folder = file.parent
        if folder not in path.absolute().parents:
            continue
        if _is_at(number, folder):
            return folder
        try:
            now = os.readlink(f"/proc/self/fd/{number}")
        except OSError:  # not Linux
            now = ""
        if not now or now.endswith("(deleted)"):
            raise SolveError(
                f"the run folder {folder} was removed while the run wrote to it", hint="run it again"
            )
        raise SolveError(
            f"the run folder {folder} was moved to {now} while the run wrote to it",
            hint="what was written is there; --restart with --out and this folder continues",
        )
    return None


def _release(file: Path) -> None:
    pid, number = _held.pop(file, (0, -1))
    if number >= 0:
        os.close(number)
    if pid != os.getpid() or not file.exists():
        return
    with _guarded(file) as number:
        owner = _read(number)
        if owner is not None and _is_me(owner):
            file.unlink(missing_ok=True)


@atexit.register
def _release_all() -> None:
    for file in list(_held):
        try:
            _release(file)
        except OSError:  # the folder is gone
            pass


@contextmanager
def _guarded(file: Path) -> Iterator[int]:
    """The open lock file (descriptor), while no other process reads it."""
    while True:
        number = os.open(file, os.O_RDWR | os.O_CREAT, 0o644)
        try:
            try:
                fcntl.flock(number, fcntl.LOCK_EX)
            except (
                OSError
            ):  # some network file systems have none: then two that start within a millisecond may both win
                pass
            if _is_at(number, file):
                yield number
                return
        finally:
            os.close(number)  # also releases the guard


def _is_at(number: int, file: Path) -> bool:
    """Whether the open file still has its name: its owner may have removed it before this process got the guard."""
    try:
        return os.path.samestat(os.fstat(number), os.stat(file))
    except FileNotFoundError:
        return False


def _read(number: int) -> dict[str, Any] | None:
    """The owner as written; None in a new file, or one that was cut short by a kill."""
    try:
        owner = json.loads(os.pread(number, 4096, 0) or b"null")
        return (
            owner
            if isinstance(owner, dict)
            and {"host", "pid", "since"} <= set(owner)
            and isinstance(owner["pid"], int)
            else None
        )
    except ValueError:
        return None


def _write(number: int, owner: dict[str, Any]) -> None:
    text = json.dumps(owner).encode()
    os.ftruncate(number, 0)
    os.pwrite(number, text, 0)


def _is_me(owner: dict[str, Any]) -> bool:
    return (owner["host"], owner["pid"], owner.get("started")) == (
        socket.gethostname(),
        os.getpid(),
        _started(os.getpid()),
    )


def _is_alive(owner: dict[str, Any]) -> bool:
    if owner["host"] != socket.gethostname():
        return True
    try:
        os.kill(owner["pid"], 0)
    except (ProcessLookupError, OverflowError):
        return False
    except PermissionError:  # somebody else's process
        pass
    if _state(owner["pid"])[:1] in (["Z"], ["X"]):  # it has ended, but its exit status has not been collected
        return False
    return owner.get("started") in (
        None,
        _started(owner["pid"]),
    )  # else its number has gone to another process


def _started(pid: int) -> int | None:
    """Start time of a process, in the system's count; None if it is unknown."""
    try:
        return int(_state(pid)[19])  # field 22 of proc(5)
    except (ValueError, IndexError):
        return None


def _state(pid: int) -> list[str]:
    """Fields of proc(5), stat, from the third on; none if the system does not provide them."""
    try:
        text = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8", errors="replace")
    except OSError:
        return []
    return text.rpartition(")")[2].split()


def writer_of(folder: Path) -> str | None:
    """The process that writes into the folder, as text; None if no living one does.  Changes nothing."""
    try:
        with open(folder / NAME, "rb") as file:
            owner = _read(file.fileno())
    except OSError:
        return None
    return f"process {owner['pid']} on {owner['host']}" if owner is not None and _is_alive(owner) else None
