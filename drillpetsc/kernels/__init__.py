"""The compiled kernels: one shared library, made at set-up or at first use (drillpetsc/kernels/build.py).

Importing this package compiles nothing.  The library is opened when the first kernel is used, and only if no other user can
have written it.
"""

from __future__ import annotations

import ctypes
import sys
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from drillpetsc.errors import SolveError
from drillpetsc.kernels.build import UntrustedLibrary, check_trusted, library_path, plug_in_path
from drillpetsc.kernels.build import build as build_library

BUILD_COMMAND = "python -m drillpetsc.kernels build"


class KernelsUnavailable(SolveError):
    """There is no library of the present sources, or it must not be opened."""


@cache
def library() -> ctypes.CDLL:
    """The opened library, compiled first if it is missing, of older sources or of another processor.

    Raises KernelsUnavailable if it cannot be built, or if others can write it.
    """
    try:
        path = library_path()
        path = path if path.exists() else build_library()
    except (RuntimeError, OSError) as error:
        raise KernelsUnavailable(
            f"the kernels are not compiled for this processor: {error}",
            hint=f"where a compiler is: {BUILD_COMMAND}; DRILLPETSC_KERNELS names a folder for them, and DRILLPETSC_ARCH=x86-64-v3 serves several "
            "processors",
        ) from None
    try:
        check_trusted(path)
    except UntrustedLibrary as error:
        raise KernelsUnavailable(
            f"the compiled kernels are not opened: {error}", hint=f"build them again: {BUILD_COMMAND}"
        ) from None
    return ctypes.CDLL(str(path))


def plug_in(folder: Path) -> ctypes.CDLL:
    """The opened library of a plug-in: the C++ sources in ``folder``.

    Its kernels are found by their names from now on, after those of the package.
    Raises KernelsUnavailable if it is not built, or if others can write it.
    """
    path, command = plug_in_path(folder), f"{BUILD_COMMAND} {folder}"
    if not path.exists():
        raise KernelsUnavailable(
            f"the plug-in in {folder} is not compiled, or older than its sources or the kernels",
            hint=f"build it: {command}",
        )
    try:
        check_trusted(path)
    except UntrustedLibrary as error:
        raise KernelsUnavailable(
            f"the plug-in is not opened: {error}", hint=f"build it again: {command}"
        ) from None
    if path not in _plug_ins:
        _plug_ins[path] = ctypes.CDLL(str(path))
    return _plug_ins[path]


_plug_ins: dict[Path, ctypes.CDLL] = {}  # that were opened


def _reads_header() -> bool:
    """Whether the first field of an array's object, after Python's own, is the address of its values, as in NumPy's C interface."""
    if sys.implementation.name != "cpython":
        return False
    whole = np.zeros(5)
    return all(
        _word_at(id(a) + _HEADER).value == a.__array_interface__["data"][0] for a in (whole, whole[2:])
    )


_HEADER, _word_at = object.__basicsize__, ctypes.c_size_t.from_address
_HEADER_READ = _reads_header()


def pointer(array: np.ndarray) -> int:
    """Address of a C-contiguous array, to be passed as ``c_void_p``; the caller keeps the array alive."""
    if not array.flags.c_contiguous:
        raise ValueError("kernels take C-contiguous arrays")
    if _HEADER_READ and isinstance(array, np.ndarray):  # a number of numpy has flags, too
        return _word_at(id(array) + _HEADER).value  # a sixth of the time of the way below
    return array.__array_interface__["data"][0]


def address(name: str) -> int | None:
    """Address of the entry point ``name`` of the kernels; None if there is none."""
    entry = getattr(library(), name, None)
    return None if entry is None else ctypes.cast(entry, ctypes.c_void_p).value


def function(name: str, arguments: str, result: type | None = None) -> Any:
    """Entry point ``name``; ``arguments`` is a letter each: p pointer, i int, d double."""
    entry = next(
        (getattr(q, name) for q in (library(), *reversed(_plug_ins.values())) if hasattr(q, name)), None
    )
    if entry is None:
        raise AttributeError(f"there is no kernel function {name}")
    entry.argtypes = [{"p": ctypes.c_void_p, "i": ctypes.c_int, "d": ctypes.c_double}[c] for c in arguments]
    entry.restype = result
    return entry
