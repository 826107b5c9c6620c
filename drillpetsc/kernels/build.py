"""Compile the C++ kernels to one shared library in ``_build`` beside the sources, or in the user's cache where that is not writable.

The file name carries a digest of all sources, the flags and the processor, so a library never serves other
sources or another machine.  DRILLPETSC_KERNELS names another folder.  DRILLPETSC_ARCH names a portable instruction set (x86-64-v3),
for an image or a cluster with several processors: every machine that has it opens this library.
This module uses the standard library only: ``scripts/setup`` runs it before anything is installed.
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
FLAGS = (
    "-O3",
    "-std=c++17",
    "-fno-math-errno",
    "-fno-trapping-math",
    "-fPIC",
)  # -fno-math-errno lets sqrt vectorise
NATIVE = "native"  # for the processor of this machine
#: portable instruction set -> flags of a processor that has it, beyond those of the sets below; the widest first
PORTABLE = {
    "x86-64-v4": "avx512f avx512bw avx512cd avx512dq avx512vl",
    "x86-64-v3": "abm avx avx2 bmi1 bmi2 f16c fma movbe",
    "x86-64-v2": "cx16 lahf_lm popcnt sse4_1 sse4_2 ssse3",
}
KEPT = 30 * 24 * 3600.0  # libraries older than this are removed at the next build [s]


class UntrustedLibrary(RuntimeError):
    """A library, or its folder, that another user could have written."""


def build_folders() -> list[Path]:
    """Folders where a library may lie: DRILLPETSC_KERNELS; or else inside the package, and the user's cache."""
    given = os.environ.get("DRILLPETSC_KERNELS")
    if given:
        return [Path(given).expanduser().absolute()]
    cache = Path(os.environ.get("XDG_CACHE_HOME") or "~/.cache").expanduser()
    return [SOURCES / "_build", cache / "drillpetsc"]


def library_path(folder: Path | None = None) -> Path:
    """Path of the library for the present sources, flags and processor; where it is to be built if there is none.

    Raises RuntimeError if it would have to be built and no folder can be written.
    """
    sources = hashlib.sha256()
    for source in sorted([*SOURCES.rglob("*.cpp"), *SOURCES.rglob("*.hpp")]):
        sources.update(source.relative_to(SOURCES).as_posix().encode() + source.read_bytes())
    names = [
        f"kernels-{hashlib.sha256(f'{sources.hexdigest()} {flags}'.encode()).hexdigest()[:16]}.so"
        for flags in map(_identity, _architectures())
    ]
    folders = build_folders() if folder is None else [folder]
    found = next((path / name for path in folders for name in names if (path / name).exists()), None)
    return found or _writable(folders) / names[0]


def _architectures() -> list[str]:
    """Instruction sets whose library serves this machine: the one asked for, or its own and the portable ones that it has."""
    given = os.environ.get("DRILLPETSC_ARCH")
    if given:
        if given not in (NATIVE, *PORTABLE):
            raise RuntimeError(f"DRILLPETSC_ARCH is {given}; allowed: {', '.join((NATIVE, *PORTABLE))}")
        return [given]
    has, served = set(_processor().split()), []
    for name, needed in reversed(PORTABLE.items()):
        if not has.issuperset(needed.split()):
            break
        served.append(name)
    return [NATIVE, *reversed(served)]


def _identity(architecture: str) -> str:
    """What a library is compiled with and for."""
    own = _processor() if architecture == NATIVE else ""
    return " ".join((*FLAGS, platform.machine(), architecture, own))


def _writable(folders: Sequence[Path]) -> Path:
    """The first folder that this process can write or create."""
    for folder in folders:
        there = next(path for path in (folder, *folder.parents) if path.exists())
        if os.access(there, os.W_OK):
            return folder
    raise RuntimeError(
        f"no folder for the compiled kernels: {', '.join(map(str, folders))} cannot be written (DRILLPETSC_KERNELS names another)"
    )


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

    folder: destination, by default the first of ``build_folders`` that can be written; objects: folder of the object files, which are
    kept so that a changed source compiles alone.  Processes that build at the same time wait for each other.
    Raises RuntimeError with the compiler's message if a source does not compile, or without a compiler.
    """
    target = library_path(folder)
    if target.exists():
        try:
            check_trusted(target)
            return target
        except UntrustedLibrary:
            target.unlink()
            shutil.rmtree(target.parent / "objects", ignore_errors=True)
    objects = objects or target.parent / "objects"
    for private in (target.parent, objects):
        private.mkdir(mode=0o755, parents=True, exist_ok=True)
    with open(objects / "lock", "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not target.exists():
            if folder is None:
                print("compiling the kernels (a minute or two, once)", file=sys.stderr, flush=True)
            _build(target, objects)
    return target


def plug_in_path(folder: Path) -> Path:
    """Path of the library of the C++ sources in ``folder``, a plug-in; it need not exist.

    Its name has a digest of these sources, of the kernels' headers, the flags and the processor.
    """
    digest = hashlib.sha256(_identity(_architectures()[0]).encode())
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
            [
                _compiler(),
                *FLAGS,
                f"-march={_architectures()[0]}",
                *include,
                "-shared",
                *map(str, sources),
                "-o",
                str(new),
            ],
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
    command = [
        compiler,
        *FLAGS,
        f"-march={_architectures()[0]}",
        "-I",
        str(SOURCES),
        "-c",
        str(source),
        "-o",
        str(new),
    ]
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
    digest, waiting, seen = (
        hashlib.sha256(f"{_identity(_architectures()[0])} {compiler}".encode()),
        [source],
        set(),
    )
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
