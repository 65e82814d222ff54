import sys

import pytest

from ur_nodes import start_node

MODULES = {
    "calibrate_camera": "ur_nodes.camera.calibration.calibrate_camera_node",
    "fiducial_detect": "ur_nodes.vision.fiducial_detect_node",
    "fiducial_slam": "ur_nodes.vision.fiducial_slam_node",
    "slam_gmapping": "ur_nodes.slam.slam_gmapping_node",
}


@pytest.mark.parametrize("name", MODULES)
def test_node_is_run_as_a_program(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("cv2")
    pytest.importorskip("gtsam")
    started: list[str] = []

    def run(node: str, *_wiring: object) -> int:
        started.append(node)
        return 7

    monkeypatch.setattr("ur_nodes.run.run", run)
    monkeypatch.setattr("ur_nodes.run.run_foreground", run)
    monkeypatch.delitem(sys.modules, MODULES[name], raising=False)
    with pytest.raises(SystemExit) as ended:
        start_node.main([name])
    assert (started, ended.value.code) == ([name], 7)


def test_missing_libraries_are_named_with_the_command_that_installs_them(capsys: pytest.CaptureFixture[str]) -> None:
    assert start_node.main(["fiducial_slam"], lambda name: None if name == "gtsam" else object()) == 2
    errors = capsys.readouterr().err
    assert errors.startswith("error: fiducial_slam: gtsam not installed, expected in ")
    assert "pip install --require-hashes -r " in errors


def test_unknown_node_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert start_node.main(["fiducials"]) == 2
    assert "expected one of calibrate_camera, fiducial_detect, fiducial_slam, slam_gmapping" in capsys.readouterr().err
