"""For all tests: generated examples are the same every time, and none fails because the computer is slow."""

from __future__ import annotations

from hypothesis import settings

settings.register_profile("project", deadline=None, derandomize=True, database=None)
settings.load_profile("project")
