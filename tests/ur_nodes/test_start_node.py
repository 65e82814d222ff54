from __future__ import annotations

import pytest

from ur_nodes import start_node


def test_missing_libraries_are_named_with_the_command_that_installs_them(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(start_node, "find_spec", lambda name: None if name == "gtsam" else object())
    assert start_node.main(["fiducial_slam"]) == 2
    errors = capsys.readouterr().err
    assert errors.startswith("error: fiducial_slam: gtsam not installed, expected in ")
    assert "pip install --require-hashes -r " in errors


def test_unknown_node_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert start_node.main(["fiducials"]) == 2
    assert "expected one of calibrate_camera, fiducial_detect, fiducial_slam, slam_gmapping" in capsys.readouterr().err
