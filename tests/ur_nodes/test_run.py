import threading
from pathlib import Path

import pytest

from ur_nodes.run import _collect_crashes, find_package


def test_package_is_found_below_the_prefixes_of_ament(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "b/share/my_robot"
    folder.mkdir(parents=True)
    monkeypatch.setenv("ROS_VERSION", "2")
    monkeypatch.setenv("AMENT_PREFIX_PATH", f"{tmp_path / 'a'}:{tmp_path / 'b'}")
    assert find_package("my_robot") == folder
    assert find_package("another") is None
    assert find_package("../share/my_robot") is None
    assert find_package("") is None


@pytest.mark.ros
def test_package_of_ros1_is_found_by_its_index(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_VERSION", "1")
    monkeypatch.setenv("ROS_PACKAGE_PATH", "/usr/share")
    assert find_package("std_msgs") == Path("/usr/share/std_msgs")
    assert find_package("no_such_package") is None


def test_exception_that_ends_a_thread_is_kept_for_the_end() -> None:
    ended, before = threading.Event(), threading.excepthook
    crashes = _collect_crashes(ended)
    try:
        thread = threading.Thread(target=lambda: 1 / 0)
        thread.start()
        thread.join()
    finally:
        threading.excepthook = before
    assert [type(each) for each in crashes] == [ZeroDivisionError]
    assert ended.is_set()
