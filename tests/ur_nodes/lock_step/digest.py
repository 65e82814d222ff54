"""Digests of values: equal where values are the same to the last bit."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from dataclasses import fields, is_dataclass

import numpy as np


def fingerprint(values: Iterable[object]) -> str:
    """A digest that two lists of values share if they are the same to the last bit."""
    digest = hashlib.sha256()
    for value in values:
        _add(digest, value)
    return digest.hexdigest()


def _add(digest: hashlib._Hash, value: object) -> None:
    if isinstance(value, np.ndarray):
        digest.update(repr((value.dtype.str, value.shape)).encode() + value.tobytes())
    elif is_dataclass(value):
        digest.update(type(value).__name__.encode())
        for each in fields(value):
            _add(digest, getattr(value, each.name))
    elif isinstance(value, (tuple, list)):
        digest.update(f"{len(value)}:".encode())
        for each in value:
            _add(digest, each)
    else:
        digest.update(repr(value).encode() + b";")
