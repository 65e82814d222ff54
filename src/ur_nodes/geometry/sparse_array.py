"""Arrays for large maps of which only parts are ever written to."""

import math
import mmap
import os
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray


def sparse_zeros(shape: tuple[int, ...], dtype: DTypeLike) -> NDArray[Any]:
    """Return zeros that take memory only where they were written to, by pages of 4 KB.

    `numpy.zeros` promises less: it may get memory that was used before, or pages of 2 MB.
    """
    kind = np.dtype(dtype)
    size = math.prod(shape) * kind.itemsize
    if not size:
        return np.zeros(shape, kind)
    memory = mmap.mmap(-1, size, flags=mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS)
    if hasattr(mmap, "MADV_NOHUGEPAGE"):
        memory.madvise(mmap.MADV_NOHUGEPAGE)
    return np.frombuffer(memory, kind).reshape(shape)


def sparse_twins(array: NDArray[Any]) -> tuple[NDArray[Any], NDArray[Any]]:
    """Return two arrays with the values of a third: a read-only one, and a writable one.

    They share memory, by pages of 4 KB, where the second was not written to. If the system has no such memory, both
    are copies.
    """
    values = np.ascontiguousarray(array)
    if not values.nbytes or not hasattr(os, "memfd_create"):
        first, second = values.copy(), values.copy()
    else:
        file = os.memfd_create("array", os.MFD_CLOEXEC)
        try:
            os.truncate(file, values.nbytes)
            with mmap.mmap(file, values.nbytes) as whole:  # a write() to the file may take only a part
                whole[:] = values.data.cast("B")
            first = _map_file(file, values, mmap.PROT_READ, mmap.MAP_SHARED)
            second = _map_file(file, values, mmap.PROT_READ | mmap.PROT_WRITE, mmap.MAP_PRIVATE)
        finally:
            os.close(file)
    first.flags.writeable = False
    return first, second


def _map_file(file: int, like: NDArray[Any], protection: int, flags: int) -> NDArray[Any]:
    memory = mmap.mmap(file, like.nbytes, flags=flags, prot=protection)
    return np.frombuffer(memory, like.dtype).reshape(like.shape)
