from pathlib import Path

import pytest

from ur_nodes.run import find_package


def test_package_is_found_below_the_prefixes_of_ament(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "b/share/my_robot"
    folder.mkdir(parents=True)
    monkeypatch.setenv("ROS_VERSION", "2")
    monkeypatch.setenv("AMENT_PREFIX_PATH", f"{tmp_path / 'a'}:{tmp_path / 'b'}")
    assert find_package("my_robot") == folder
    assert find_package("another") is None
    assert find_package("../share/my_robot") is None
    assert find_package("") is None
