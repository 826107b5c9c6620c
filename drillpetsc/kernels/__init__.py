"""The compiled kernels: one shared library, built on first use and kept until a source or a flag changes.

``lib`` is the opened library.  Every ``*.cpp`` below this folder is part of it.  The file name carries a hash
of all sources, the compiler and the flags, so a stale library is never used; several processes that start
with a cold cache wait for one to build.
"""

from __future__ import annotations

import ctypes
import fcntl
import hashlib
import os
import platform
import shutil
import subprocess
import tempfile
from pathlib import Path

import numpy as np

_HERE = Path(__file__).parent
# -march=native: the library is built on the machine that runs it; -fno-math-errno lets sqrt vectorise.
FLAGS = ("-O3", "-march=native", "-std=c++17", "-fno-math-errno", "-fno-trapping-math", "-shared", "-fPIC")


def _compiler() -> str:
    for name in (os.environ.get("CXX"), "c++", "g++", "clang++"):
        if name and shutil.which(name):
            return name
    raise RuntimeError("no C++ compiler found: install g++ (scripts/setup does), or set CXX")


def _cpu() -> str:
    """Processor features: the library of one machine is not used on another that shares the folder."""
    try:
        text = Path("/proc/cpuinfo").read_text()
        return next((line for line in text.splitlines() if line.startswith("flags")), "")
    except OSError:
        return platform.processor()


def library_path() -> Path:
    """Where the library for the present sources, compiler, flags and processor lies."""
    digest = hashlib.sha256(
        " ".join((*FLAGS, os.environ.get("CXX", ""), platform.machine(), _cpu())).encode()
    )
    for source in sorted([*_HERE.rglob("*.cpp"), *_HERE.rglob("*.hpp")]):
        digest.update(source.name.encode() + source.read_bytes())
    default = Path(os.environ.get("XDG_CACHE_HOME", str(Path.home() / ".cache"))) / "drillpetsc"
    folder = Path(os.environ.get("DRILLPETSC_CACHE", str(default)))
    return folder / f"kernels-{digest.hexdigest()[:16]}.so"


def _build(target: Path) -> None:
    compiler = _compiler()
    with tempfile.TemporaryDirectory(dir=target.parent) as scratch:
        objects, running = [], []
        for source in sorted(_HERE.rglob("*.cpp")):
            objects.append(str(Path(scratch) / (source.stem + ".o")))
            command = [
                compiler,
                *(f for f in FLAGS if f != "-shared"),
                "-I",
                str(_HERE),
                "-c",
                str(source),
                "-o",
                objects[-1],
            ]
            running.append((source, subprocess.Popen(command, stderr=subprocess.PIPE, text=True)))
        for source, process in running:
            _, message = process.communicate()
            if process.returncode:
                raise RuntimeError(f"compiling {source.name} failed:\n{message}")
        library = Path(scratch) / "kernels.so"
        subprocess.run([compiler, "-shared", *objects, "-o", str(library)], check=True)
        os.replace(library, target)  # atomic: another process sees the whole file or none


def build() -> Path:
    """Build the library if it is missing; returns its path.

    Raises RuntimeError with the compiler's message when a source does not compile.
    """
    target = library_path()
    if target.exists():
        return target
    target.parent.mkdir(parents=True, exist_ok=True)
    with open(target.with_suffix(".lock"), "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)  # ranks of one node build once
        if not target.exists():
            _build(target)
    return target


lib = ctypes.CDLL(str(build()))


def pointer(array: np.ndarray) -> int:
    """Address of a C-contiguous array, to be passed as ``c_void_p``; the caller keeps the array alive."""
    if not array.flags.c_contiguous:
        raise ValueError("kernels take C-contiguous arrays")
    return array.__array_interface__["data"][0]  # a third of the time of array.ctypes.data


def function(name: str, arguments: str, result: type | None = None) -> ctypes._FuncPointer:  # type: ignore[name-defined]
    """Entry point ``name``; ``arguments`` is a letter each: p pointer, i int, d double."""
    entry = getattr(lib, name)
    entry.argtypes = [{"p": ctypes.c_void_p, "i": ctypes.c_int, "d": ctypes.c_double}[c] for c in arguments]
    entry.restype = result
    return entry
