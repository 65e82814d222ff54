"""Fixtures of nodes that keep something between their runs."""

from __future__ import annotations

from pathlib import Path

import pytest


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder in which the mux of a robot keeps the lease."""
    monkeypatch.setenv("ROS_HOME", str(tmp_path))
    monkeypatch.setenv("ROS_MASTER_URI", "http://robot:1")
    return tmp_path
