"""Types for which code is installed."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from ur_nodes.ros1.topics import has_generated


def test_only_packages_with_generated_code_are_found_and_none_is_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for package in ("demo_msgs", "demo_tools"):
        (tmp_path / package / "msg").mkdir(parents=True)
        (tmp_path / package / "__init__.py").write_text("raise AssertionError('was run')")
    (tmp_path / "demo_msgs" / "msg" / "_Thing.py").write_text("")
    monkeypatch.syspath_prepend(str(tmp_path))
    assert has_generated("demo_msgs/Thing")
    for kind in ("demo_msgs/Other", "demo_tools/Thing", "os/path", "sys/x", "missing/Thing", "demo_msgs", "../x/y", ""):
        assert not has_generated(kind), kind
    assert not {"demo_msgs", "demo_tools"} & sys.modules.keys()
