"""Compile the C++ kernels to one shared library in ``_build``, beside the sources.

The file name carries a digest of all sources, the flags and the processor, so a library never serves other
sources or another machine.  This module uses the standard library only: ``scripts/setup`` runs it before anything is
installed.
"""

from __future__ import annotations

import fcntl
import hashlib
import os
import platform
import re
import shutil
import stat
import sys
import time
from collections.abc import Sequence
from pathlib import Path

SOURCES = Path(__file__).resolve().parent
# -march=native: the library is built on the machine that runs it; -fno-math-errno lets sqrt vectorise.
FLAGS = ("-O3", "-march=native", "-std=c++17", "-fno-math-errno", "-fno-trapping-math", "-fPIC")
KEPT = 30 * 24 * 3600.0  # libraries older than this are removed at the next build [s]


class UntrustedLibrary(RuntimeError):
    """A library, or its folder, that another user could have written."""


def build_folder() -> Path:
    """Folder of the library: inside the package, wherever that is installed."""
    return SOURCES / "_build"


def library_path(folder: Path | None = None) -> Path:
    """Path of the library for the present sources, flags and processor; it need not exist."""
    digest = hashlib.sha256(" ".join((*FLAGS, platform.machine(), _processor())).encode())
    for source in sorted([*SOURCES.rglob("*.cpp"), *SOURCES.rglob("*.hpp")]):
        digest.update(source.relative_to(SOURCES).as_posix().encode() + source.read_bytes())
    return (folder or build_folder()) / f"kernels-{digest.hexdigest()[:16]}.so"


def check_trusted(library: Path) -> None:
    """Raise UntrustedLibrary unless only the user, root or the owner of this package can write ``library`` and
    its folder."""
    for path in (library.parent, library):
        status = path.stat()
        if status.st_uid not in {os.getuid(), 0, os.stat(__file__).st_uid}:
            raise UntrustedLibrary(f"{path} belongs to another user (uid {status.st_uid})")
        if status.st_mode & (stat.S_IWGRP | stat.S_IWOTH):
            raise UntrustedLibrary(f"{path} can be written by other users")


def build(folder: Path | None = None, objects: Path | None = None) -> Path:
    """Build the library if it is missing or may have been written by others, and return its path.

    folder: destination, ``_build`` in the package by default; objects: folder of the object files, which are
    kept so that a changed source compiles alone.  Processes that build at the same time wait for each other.
    Raises RuntimeError with the compiler's message if a source does not compile, or without a compiler.
    """
    target = library_path(folder)
    if target.exists():
        try:
            check_trusted(target)
            return target
        except UntrustedLibrary:
            shutil.rmtree(target.parent)
    objects = objects or target.parent / "objects"
    for private in (target.parent, objects):
        private.mkdir(mode=0o755, parents=True, exist_ok=True)
    with open(objects / "lock", "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not target.exists():
            _build(target, objects)
    return target


def plug_in_path(folder: Path) -> Path:
    """Path of the library of the C++ sources in ``folder``, a plug-in; it need not exist.

    Its name has a digest of these sources, of the kernels' headers, the flags and the processor.
    """
    digest = hashlib.sha256(" ".join((*FLAGS, platform.machine(), _processor())).encode())
    for source in [*_plug_in_sources(folder), *sorted(folder.glob("*.hpp")), *sorted(SOURCES.rglob("*.hpp"))]:
        digest.update(source.name.encode() + source.read_bytes())
    return folder / "_build" / f"plug-in-{digest.hexdigest()[:16]}.so"


def build_plug_in(folder: Path) -> Path:
    """Build the library of the C++ sources in ``folder`` if it is missing, and return its path.

    Raises RuntimeError with the compiler's message if a source does not compile, or if there is none.
    """
    sources, target = _plug_in_sources(folder), plug_in_path(folder)
    if not sources:
        raise RuntimeError(f"no .cpp file in {folder}")
    if not target.exists():
        target.parent.mkdir(mode=0o755, exist_ok=True)
        new = target.with_suffix(f".{os.getpid()}")
        include = ["-I", str(SOURCES), "-I", str(folder)]
        _call(
            [_compiler(), *FLAGS, *include, "-shared", *map(str, sources), "-o", str(new)],
            f"compiling {folder}",
        )
        os.replace(new, target)
        for old in target.parent.glob("plug-in-*.so"):
            if old != target and time.time() - old.stat().st_mtime > KEPT:
                old.unlink()
    check_trusted(target)
    return target


def _plug_in_sources(folder: Path) -> list[Path]:
    return sorted(folder.glob("*.cpp"))


def main(folders: Sequence[str] = ()) -> None:
    """Build the kernels, or the plug-ins in ``folders``, if needed, and print the libraries' paths.

    ``python build.py`` needs no installed package.
    """
    for folder in folders:
        print(build_plug_in(Path(folder).resolve()))
    if folders:
        return
    if not library_path().exists():
        print("compiling the kernels (a minute or two)", file=sys.stderr, flush=True)
    path = build()
    check_trusted(path)
    print(path)


def _build(target: Path, objects: Path) -> None:
    from concurrent.futures import ThreadPoolExecutor  # here: an import of the package needs none of it

    compiler = _compiler()
    version = _call([compiler, "--version"], "asking the compiler for its version")
    sources = sorted(SOURCES.rglob("*.cpp"), key=lambda p: p.stat().st_size, reverse=True)
    outputs = [objects / f"{source.stem}-{_object_digest(source, version)}.o" for source in sources]
    missing = [(s, o) for s, o in zip(sources, outputs, strict=True) if not o.exists()]
    with ThreadPoolExecutor(len(os.sched_getaffinity(0))) as pool:
        list(pool.map(lambda pair: _compile(compiler, *pair), missing))
    new = target.with_suffix(f".{os.getpid()}")
    _call([compiler, "-shared", *map(str, sorted(outputs)), "-o", str(new)], "linking the kernels")
    os.replace(new, target)  # atomic: another process sees the whole file or none
    for old in objects.iterdir():
        if old not in outputs and old.name != "lock":
            old.unlink()
    for library in target.parent.glob("kernels-*.so"):  # a run may still have a younger one open
        if time.time() - library.stat().st_mtime > KEPT:
            library.unlink()


def _compile(compiler: str, source: Path, output: Path) -> None:
    new = output.with_suffix(f".{os.getpid()}")
    command = [compiler, *FLAGS, "-I", str(SOURCES), "-c", str(source), "-o", str(new)]
    _call(command, f"compiling {source.name}")
    os.replace(new, output)


def _call(command: list[str], what: str) -> str:
    import subprocess

    done = subprocess.run(command, capture_output=True, text=True, umask=0o022)  # nobody else may write it
    if done.returncode:
        raise RuntimeError(f"{what} failed:\n{done.stderr}")
    return done.stdout


def _object_digest(source: Path, compiler: str) -> str:
    """Digest of a source with all headers that it includes, the flags, the compiler and the processor."""
    digest, waiting, seen = hashlib.sha256(f"{FLAGS} {compiler} {_processor()}".encode()), [source], set()
    while waiting:
        path = waiting.pop()
        if path not in seen:
            seen.add(path)
            text = path.read_text()
            digest.update(text.encode())
            waiting += [SOURCES / name for name in re.findall(r'^#include "(.+)"', text, re.MULTILINE)]
    return digest.hexdigest()[:16]


def _compiler() -> str:
    for name in (os.environ.get("CXX"), "c++", "g++", "clang++"):
        if name and shutil.which(name):
            return name
    raise RuntimeError("no C++ compiler found: install g++ (scripts/setup does), or set CXX")


def _processor() -> str:
    """Instruction sets of the processor: machines that share the folder may differ."""
    try:
        with open("/proc/cpuinfo") as lines:  # the first processor's lines are enough
            return next((line for line in lines if line.startswith(("flags", "Features"))), "")
    except OSError:
        return platform.processor()


if __name__ == "__main__":
    main()
