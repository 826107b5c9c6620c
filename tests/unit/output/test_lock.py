"""Two jobs never write into one run folder: the second is refused while the first is alive, wherever it was
killed."""

from __future__ import annotations

import errno
import json
import multiprocessing
import os
import shutil
import signal
import socket
import subprocess
import sys
from pathlib import Path

import pytest

from drillpetsc.errors import SolveError
from drillpetsc.output import RunFolder, RunFolderBusy
from drillpetsc.output.files import lock
from drillpetsc.output.files.atomic import replace_file, replace_text
from tests.helpers.tables import each_row

fork = multiprocessing.get_context("fork")


def holder(folder: Path, *launcher: str) -> subprocess.Popen[str]:
    """A process that holds the folder until it is killed or its input ends.  launcher: command that starts it."""
    code = "import sys; from pathlib import Path; from drillpetsc.output.files import lock; lock.take(Path(sys.argv[1]))"
    code += "; print('held', flush=True); sys.stdin.read()"
    process = subprocess.Popen(
        [*launcher, sys.executable, "-c", code, str(folder)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    assert process.stdout is not None and process.stdout.readline() == "held\n"
    return process


CONTAINER = ["unshare", "--pid", "--uts", "--fork", "--kill-child", "--mount-proc", "--"]


def refused(folder: Path) -> str:
    with pytest.raises(RunFolderBusy) as caught:
        lock.take(folder)
    return str(caught.value)


def test_the_second_is_refused_until_the_first_ends(tmp_path: Path) -> None:
    run = RunFolder.create("a", out=tmp_path / "run")
    run.history.write_text("kept")
    run.release()
    first = holder(run.path)
    reported = refused(run.path)
    assert f"process {first.pid} on {socket.gethostname()}" in reported and str(run.path) in reported
    for way in ({"restart": True}, {"overwrite": True}):
        with pytest.raises(RunFolderBusy):
            RunFolder.create("a", out=run.path, **way)
    assert run.history.read_text() == "kept"  # refused before anything was removed
    first.communicate("")
    RunFolder.create("a", out=run.path, restart=True).release()
    assert sorted(p.name for p in run.path.iterdir()) == ["history.csv"]


def test_the_lock_of_a_killed_process_is_taken_over(tmp_path: Path) -> None:
    first = holder(tmp_path)
    first.send_signal(signal.SIGKILL)
    first.communicate()
    assert (tmp_path / lock.NAME).is_file()
    lock.take(tmp_path)
    assert json.loads((tmp_path / lock.NAME).read_text())["pid"] == os.getpid()
    lock.release(tmp_path)


def test_the_lock_of_a_killed_process_that_nobody_asked_for_is_taken_over(tmp_path: Path) -> None:
    """A rank whose launcher was killed, too, keeps its number until its new parent asks how it ended."""
    first = holder(tmp_path)
    os.kill(first.pid, signal.SIGKILL)
    os.waitid(os.P_PID, first.pid, os.WEXITED | os.WNOWAIT)  # has ended, and still has its number
    lock.take(tmp_path)
    assert json.loads((tmp_path / lock.NAME).read_text())["pid"] == os.getpid()
    lock.release(tmp_path)
    first.communicate()


def test_a_number_that_has_gone_to_another_process_is_not_the_owner(tmp_path: Path) -> None:
    """Process 1 lives as long as the machine, but did not begin at that moment."""
    owner = {"host": socket.gethostname(), "pid": 1, "started": -5, "since": "2001-01-01 10:00:00"}
    (tmp_path / lock.NAME).write_text(json.dumps(owner))
    lock.take(tmp_path)
    lock.release(tmp_path)


def test_nobody_here_knows_whether_a_process_elsewhere_is_alive(tmp_path: Path) -> None:
    owner = {"host": "elsewhere", "pid": 2**22 + 1, "started": 1, "since": "2001-01-01 10:00:00"}
    (tmp_path / lock.NAME).write_text(json.dumps(owner))
    assert "elsewhere" in (reported := refused(tmp_path)) and f"remove {tmp_path / lock.NAME}" in reported
    lock.release(tmp_path)
    assert (tmp_path / lock.NAME).is_file()  # not ours to remove


@pytest.mark.skipif(
    not shutil.which("unshare") or subprocess.run([*CONTAINER, "true"], capture_output=True).returncode != 0,
    reason="no namespaces for this user",
)
@each_row("name", [socket.gethostname(), "container"])
def test_a_process_of_another_container_holds_the_folder_while_it_lives(tmp_path: Path, name: str) -> None:
    """Its number is unknown here or another process's, and its host has another name, or by chance the same."""
    first = holder(tmp_path, *CONTAINER, "sh", "-c", f'hostname {name}; exec "$0" "$@"')
    assert f"on {name}" in refused(tmp_path)
    assert name in (lock.writer_of(tmp_path) or "")
    first.kill()
    first.communicate()
    lock.take(tmp_path)
    assert json.loads((tmp_path / lock.NAME).read_text())["pid"] == os.getpid()
    lock.release(tmp_path)


def test_a_child_that_outlives_the_owner_does_not_hold_the_folder(tmp_path: Path) -> None:
    code = "import os, sys, time; from pathlib import Path; from drillpetsc.output.files import lock; lock.take(Path(sys.argv[1]))"
    code += (
        "\nif os.fork() == 0: print(os.getpid(), flush=True); time.sleep(600)\nelse: os.kill(os.getpid(), 9)"
    )
    parent = subprocess.Popen([sys.executable, "-c", code, str(tmp_path)], stdout=subprocess.PIPE, text=True)
    assert parent.stdout is not None
    child = int(parent.stdout.readline())
    parent.wait()
    try:
        lock.take(tmp_path)
    finally:
        os.kill(child, signal.SIGKILL)
        parent.stdout.close()
    lock.release(tmp_path)


def test_without_locks_of_the_file_system_the_number_of_the_process_tells(
    tmp_path: Path, monkeypatch
) -> None:
    def none(number: int, kind: int) -> None:
        raise OSError(errno.ENOLCK, "No locks available")

    first = holder(tmp_path)
    monkeypatch.setattr(lock.fcntl, "flock", none)
    assert f"process {first.pid}" in refused(tmp_path) and lock.writer_of(tmp_path) is not None
    first.kill()
    first.communicate()
    lock.take(tmp_path)
    lock.release(tmp_path)


@each_row("text", ["", "{", "[]", '{"pid": 1}', '{"host": "x", "pid": "y", "since": ""}', "\x00" * 9])
def test_a_lock_cut_short_is_nobodys(tmp_path: Path, text: str) -> None:
    (tmp_path / lock.NAME).write_text(text)
    lock.take(tmp_path)
    lock.release(tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_one_process_may_run_in_its_folder_again(tmp_path: Path) -> None:
    first = RunFolder.create("a", out=tmp_path / "run")
    RunFolder.create("a", out=first.path, overwrite=True).release()
    first.release()
    assert not (first.path / lock.NAME).exists()


def _try(arguments: tuple[Path, object]) -> bool:
    folder, all_have_tried = arguments
    try:
        lock.take(folder)
    except RunFolderBusy:
        won = False
    else:
        won = True
    all_have_tried.wait(20)  # type: ignore[attr-defined]
    os._exit(10 if won else 11)


def _take_and_end(folder: Path) -> None:
    lock.take(folder)
    os._exit(0)  # without letting go of it, as a process that is killed


@pytest.mark.parametrize("stale", [False, True])
def test_one_of_many_that_start_together_wins(tmp_path: Path, stale: bool) -> None:
    """Also when all find the lock of a process that is dead."""
    for round_ in range(5):
        folder = tmp_path / str(round_)
        folder.mkdir()
        if stale:
            dead = fork.Process(target=_take_and_end, args=(folder,))
            dead.start()
            dead.join()
            assert (folder / lock.NAME).is_file()
        barrier = fork.Barrier(8)
        rivals = [fork.Process(target=_try, args=((folder, barrier),)) for _ in range(8)]
        for rival in rivals:
            rival.start()
        for rival in rivals:
            rival.join()
        assert sorted(rival.exitcode or 0 for rival in rivals) == [10] + [11] * 7


def test_a_run_lets_go_of_its_folder(tmp_path: Path) -> None:
    from drillpetsc import Case
    from drillpetsc.analysis.motion.transient import run

    pipe = {"kind": "pipe", "length": 9, "od": 0.1, "element_length": 9}
    case = Case(top="clamped", string=[pipe], time={"end": 1e-3}, initial={"from": "rest"})
    result = run(case, tmp_path / "run", progress="silent")
    assert not (result.folder / lock.NAME).exists() and (result.folder / "summary.json").is_file()


@each_row("removed", [False, True])
def test_a_folder_that_is_moved_or_removed_is_not_made_again(removed: bool, tmp_path: Path) -> None:
    folder = RunFolder.create("case", tmp_path / "run").path
    replace_text(folder / "one.txt", "1")
    if removed:
        shutil.rmtree(folder)
    else:
        folder.rename(tmp_path / "moved")
    with pytest.raises(SolveError) as caught:
        replace_text(folder / "string" / "two.txt", "2")
    assert ("was removed" if removed else f"was moved to {tmp_path / 'moved'}") in str(caught.value)
    assert not folder.exists()
    lock.release(folder)
    replace_text(folder / "three.txt", "3")  # nobody holds it any more


def test_a_folder_that_is_moved_while_a_file_is_written(tmp_path: Path) -> None:
    folder = RunFolder.create("case", tmp_path / "run").path

    def write(file: Path) -> None:
        folder.rename(tmp_path / "moved")
        file.write_text("1", encoding="utf-8")

    with pytest.raises(SolveError, match="was moved to"):
        replace_file(folder / "one.txt", write)
    assert not folder.exists()
    lock.release(folder)
