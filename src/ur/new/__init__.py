"""New launch directories, programs, bases and packages in house style."""

from __future__ import annotations
