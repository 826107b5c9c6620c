"""Numbers below 2e-308 treated as zero during a computation (manual: speed)."""

from __future__ import annotations

import ctypes
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np

from drillpetsc.kernels import function


@contextmanager
def flushed_denormals() -> Iterator[None]:
    """Treat denormal numbers as zero in this thread, around a block or, as a decorator, around a function.

    Ahead of a wave the motion decreases with the distance, down to the smallest floating-point numbers.  Processors
    take a hundred times as long for these, and no output depends on them.
    """
    flush = function("flush_denormals", "i", ctypes.c_int)
    for kind in (np.float32, np.float64):
        np.finfo(kind).smallest_subnormal  # noqa: B018  numpy keeps its limits from the first use on, and warns if they are zero
    before = flush(1)
    try:
        yield
    finally:
        flush(before)
