"""What differs between petsc4py 3.18 and 3.26, in one place."""

from __future__ import annotations

import ctypes
import sys
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import wraps

import numpy as np
from petsc4py import PETSc

VERSION = PETSc.Sys.getVersion()

#: for each solver that ``own_errors`` surrounds, from the outermost: whether a callback has failed, so that
#: PETSc's error handler is its silent one
_failed: list[bool] = []
#: an object that keeps PETSc's copy of the communicator of all ranks
_kept: list[PETSc.Object] = []


def callback(function: Callable) -> Callable:
    """A function that PETSc calls; it may raise within ``own_errors``.

    petsc4py's error handler formats text while our exception is on its way through PETSc. From Python 3.12 on,
    this may start the garbage collector, which drops the exception: petsc4py 3.22 then ends the process, and
    3.26 raises an error of its own.  The handler that does nothing is used until ``own_errors`` has the exception.
    """

    @wraps(function)
    def called(*arguments: object) -> object:
        try:
            return function(*arguments)
        except BaseException:
            if _failed and not _failed[-1]:
                _silence()
                _failed[-1] = True
            raise

    return called


def _silence() -> None:
    """Push the error handler that returns the code alone; ``popErrorHandler`` ends it."""
    try:
        PETSc.Sys.pushErrorHandler("ignore")
    except ValueError:  # renamed after 3.22
        PETSc.Sys.pushErrorHandler("return")


@contextmanager
def own_errors() -> Iterator[None]:
    """Around a call of a PETSc solver: what our callbacks raise comes out as it was raised.

    From 3.22 on petsc4py answers an exception of a callback with its own PETSc.Error, with ours behind it in
    the chain.
    """
    outer = (
        sys.exception()
    )  # handled while the solver is called: in the chain of what it raises, but no callback's
    _failed.append(False)
    try:
        yield
    except PETSc.Error as error:
        release_frames(error)
        link: BaseException | None = error
        seen: set[int] = set()
        while link is not None and link is not outer and id(link) not in seen:
            seen.add(id(link))
            if not isinstance(link, PETSc.Error):
                raise link from None
            link = link.__cause__ or link.__context__
        raise
    except BaseException as error:
        release_frames(error)
        raise
    finally:
        if _failed.pop():
            PETSc.Sys.popErrorHandler()


def release_frames(error: BaseException) -> None:
    """Free what the finished frames of an exception hold: the PETSc objects that callbacks were called with.

    A script that ends by the exception keeps its traceback to the end.  PETSc then frees a closed solver with a context in Python when the
    interpreter is gone, which is a segmentation fault.
    """
    link: BaseException | None = error
    seen: set[int] = set()
    while link is not None and id(link) not in seen:
        seen.add(id(link))
        traceback.clear_frames(link.__traceback__)
        link = link.__cause__ or link.__context__


def free_dropped(comm: PETSc.Comm) -> None:
    """Free the objects on ``comm`` that Python has dropped; collective.

    Ranks drop them at different times, so petsc4py only lists them, on one rank too. Without this call they stay until the process ends.
    PETSc keeps a copy of the communicator as long as it has objects. One object on all ranks therefore stays: a rank that had dropped
    its last one, as the rank that draws does, would copy the communicator again, and wait for ranks that still have theirs.
    """
    if comm == PETSc.COMM_WORLD and not _kept:
        _kept.append(PETSc.Vec().create(comm=comm))
    PETSc.garbage_cleanup(comm)


def reason_of(error: PETSc.Error) -> str:
    """PETSc's reason for an error: the last line of its trace, without the rank."""
    lines = str(error).splitlines() or ["no reason given"]
    return lines[-1].partition("] ")[2].strip() or lines[-1].strip()


def _library() -> ctypes.CDLL:
    return ctypes.CDLL(PETSc.__file__)


def set_section(dm: PETSc.DM, section: PETSc.Section) -> None:
    """Make ``section`` the local section of ``dm``."""
    (dm.setLocalSection if hasattr(dm, "setLocalSection") else dm.setSection)(section)


def get_section(dm: PETSc.DM) -> PETSc.Section:
    """The local section of ``dm``."""
    return (dm.getLocalSection if hasattr(dm, "getLocalSection") else dm.getSection)()


def square_matrix(vector: PETSc.Vec) -> PETSc.Mat:
    """An empty matrix for vectors like this one; what DM.createMat makes besides, the pattern of cell
    closures, is not needed (its places come by ``preallocate_coo``) and fails in 3.18 for a section with
    fields on part of the vertices."""
    matrix = PETSc.Mat().create(comm=vector.comm)
    matrix.setSizes((vector.getSizes(), vector.getSizes()))
    matrix.setType(PETSc.Mat.Type.AIJ)
    matrix.setFromOptions()
    return matrix


def preallocate_coo(matrix: PETSc.Mat, rows: np.ndarray, columns: np.ndarray) -> None:
    """Tell ``matrix`` where its values will go; rows, columns: global numbers, negative ones are left out."""
    rows, columns = (
        np.array(rows, dtype=PETSc.IntType),
        np.array(columns, dtype=PETSc.IntType),
    )  # PETSc overwrites them
    if hasattr(matrix, "setPreallocationCOO"):
        matrix.setPreallocationCOO(rows, columns)
        return
    call = _library().MatSetPreallocationCOO  # in the C library of 3.18, not in its petsc4py
    call.argtypes = [ctypes.c_void_p, ctypes.c_ssize_t, ctypes.c_void_p, ctypes.c_void_p]
    code = call(matrix.handle, len(rows), rows.ctypes.data, columns.ctypes.data)
    if code:
        raise PETSc.Error(code)


def set_values_coo(matrix: PETSc.Mat, values: np.ndarray) -> None:
    """Replace the values of ``matrix``; duplicates of a place add up."""
    if hasattr(matrix, "setValuesCOO"):
        matrix.setValuesCOO(values, PETSc.InsertMode.INSERT_VALUES)
        return
    call = _library().MatSetValuesCOO
    call.argtypes = [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_int]
    code = call(matrix.handle, np.ascontiguousarray(values).ctypes.data, int(PETSc.InsertMode.INSERT_VALUES))
    if code:
        raise PETSc.Error(code)


def not_a_number_reason() -> int:
    """Reason of an SNES that met a residual which is not a number; renamed after 3.22."""
    reasons = PETSc.SNES.ConvergedReason
    return (
        reasons.DIVERGED_FNORM_NAN
        if hasattr(reasons, "DIVERGED_FNORM_NAN")
        else reasons.DIVERGED_FUNCTION_NANORINF
    )


def parallel_lu() -> str | None:
    """A direct solver for distributed matrices that this PETSc was built with; None where it has none
    (binaries from PyPI)."""
    if not hasattr(PETSc.Sys, "hasExternalPackage"):
        return "mumps"  # 3.18 has no query for it; distributions build it in
    return next((name for name in ("mumps", "superlu_dist") if PETSc.Sys.hasExternalPackage(name)), None)


def rename_time_step(options: PETSc.Options) -> None:
    """-ts_dt and -ts_time_step are one option, renamed in 3.25: either is understood."""
    old, new = ("ts_dt", "ts_time_step") if VERSION >= (3, 25, 0) else ("ts_time_step", "ts_dt")
    if options.hasName(old):
        options.setValue(new, options.getString(old))
        options.delValue(old)


def time_step_option() -> str:
    return "ts_time_step" if VERSION >= (3, 25, 0) else "ts_dt"


def max_rejections_option() -> str:
    """The option that bounds rejected steps was renamed in 3.25."""
    return "ts_max_step_rejections" if VERSION >= (3, 25, 0) else "ts_max_reject"
