"""One job at a time in a run folder: a locked file, which says which process writes there.

The lock is the operating system's (flock), held for as long as the process lives. It ends with the process, however that
ends, and works between containers, which share neither process numbers nor the name of the host.
"""

from __future__ import annotations

import atexit
import fcntl
import json
import os
import socket
import time
from pathlib import Path
from typing import Any, NamedTuple

from drillpetsc.errors import SolveError

NAME = ".lock"
TRIES, PAUSE = 20, 0.01  # to get the lock, which `writer_of` of another process holds for microseconds; [s]


class RunFolderBusy(FileExistsError):
    """Another process writes into the folder."""


class _Held(NamedTuple):
    """Open descriptors of the locked file, and of its folder, which follows a move."""

    lock: int
    folder: int


_held: dict[Path, _Held] = {}
"""What this process holds, by the lock file."""


def take(folder: Path) -> None:
    """Hold the folder for this process; raises RunFolderBusy if another living process holds it.

    The folder of a process that has ended is taken over. If it ran on another machine, it counts as alive,
    because some network file systems lock for one machine only.
    """
    file = (folder / NAME).absolute()
    if file in _held:
        if _is_at(_held[file].lock, file):
            return
        _close(file)  # the folder was moved, and this is another one of its name
    lock, got = _locked(file)
    owner = _read(lock)
    if owner is not None and _is_me(owner) and got is False:  # held by another name of the folder
        os.close(lock)
        return
    if _is_alive(owner, got):
        os.close(lock)
        raise RunFolderBusy(
            f"{folder} is in use by {_named(owner)}: wait for it, or give another --out"
            + (f" (if that run is over, remove {file})" if got is not False and not _is_here(owner) else "")
        )
    me = {
        "host": socket.gethostname(),
        "boot": _boot(),
        "pid": os.getpid(),
        "started": _started(os.getpid()),
        "since": time.strftime("%F %T"),
    }
    os.ftruncate(lock, 0)
    os.pwrite(lock, json.dumps(me).encode(), 0)
    _held[file] = _Held(lock, os.open(folder, os.O_RDONLY | os.O_DIRECTORY))


def release(folder: Path) -> None:
    """Release the folder, if this process holds it."""
    _release((folder / NAME).absolute())


def check_place(path: Path) -> Path | None:
    """The folder that this process holds and ``path`` is in, None outside; raises SolveError if it was moved or removed meanwhile."""
    for file, held in _held.items():
        folder = file.parent
        if folder not in path.absolute().parents:
            continue
        if _is_at(held.folder, folder):
            return folder
        try:
            now = os.readlink(f"/proc/self/fd/{held.folder}")
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


def writer_of(folder: Path) -> str | None:
    """The process that writes into the folder, as text; None if no living one does.  Changes nothing."""
    try:
        lock = os.open(folder / NAME, os.O_RDONLY)
    except OSError:
        return None
    try:
        got = _try_lock(lock, fcntl.LOCK_SH)
        owner = _read(lock)
        return _named(owner) if _is_alive(owner, got) else None
    finally:
        os.close(lock)


def _release(file: Path) -> None:
    if file in _held and _is_at(_held[file].lock, file):
        file.unlink()  # while it is locked: whoever opened it meanwhile finds that it has lost its name
    _close(file)


def _close(file: Path) -> None:
    for number in _held.pop(file, ()):
        os.close(number)


@atexit.register
def _release_all() -> None:
    for file in list(_held):
        try:
            _release(file)
        except OSError:  # the folder is gone
            pass


def _close_all() -> None:
    for file in list(_held):
        _close(file)


os.register_at_fork(after_in_child=_close_all)  # a child that outlives this process must not keep its locks


def _locked(file: Path) -> tuple[int, bool | None]:
    """The open lock file (descriptor), and whether this process has got the lock: see ``_try_lock``."""
    for k in range(TRIES):
        number = os.open(file, os.O_RDWR | os.O_CREAT, 0o644)
        got = _try_lock(number, fcntl.LOCK_EX)
        if k == TRIES - 1 or (got is not False and _is_at(number, file)):
            break
        os.close(number)
        time.sleep(PAUSE if got is False else 0.0)
    return number, got


def _try_lock(number: int, kind: int) -> bool | None:
    """Whether the open file could be locked; None on a network file system that has no locks.

    Without them, two processes that start within a millisecond may both win.
    """
    try:
        fcntl.flock(number, kind | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:
        return None
    return True


def _is_at(number: int, file: Path) -> bool:
    """Whether the open file or folder still has its name."""
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


def _named(owner: dict[str, Any] | None) -> str:
    if owner is None:
        return "another process"
    return f"process {owner['pid']} on {owner['host']} since {owner['since']}"


def _is_me(owner: dict[str, Any]) -> bool:
    return _is_here(owner) and (owner["pid"], owner.get("started")) == (os.getpid(), _started(os.getpid()))


def _is_here(owner: dict[str, Any] | None) -> bool:
    """Whether the owner is a process of this host by name."""
    return owner is None or owner["host"] == socket.gethostname()


def _is_alive(owner: dict[str, Any] | None, got: bool | None) -> bool:
    """Whether a process that wrote ``owner`` may live.  got: whether its lock could be had, ``_try_lock``."""
    if got is False:
        return True
    if owner is None or _is_me(owner):
        return False
    if got and owner.get("boot") is not None and owner["boot"] == _boot():
        return False  # it held the lock on this very machine, in whichever container
    if not _is_here(owner):
        return True
    try:
        os.kill(owner["pid"], 0)
    except (ProcessLookupError, OverflowError):
        return False
    except PermissionError:  # somebody else's process
        pass
    if _state(owner["pid"])[:1] in (["Z"], ["X"]):  # it has ended, but its exit status has not been collected
        return False
    # else its number has gone to another process
    return owner.get("started") in (None, _started(owner["pid"]))


def _boot() -> str | None:
    """A name of this machine's kernel since its start, the same in all containers; None if the system has none."""
    try:
        return Path("/proc/sys/kernel/random/boot_id").read_text(encoding="ascii").strip()
    except OSError:
        return None


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
