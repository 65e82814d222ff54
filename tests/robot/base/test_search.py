from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from ur.request.environment import PACKAGE
from ur.robot.base.search import find_base_package, list_base_packages


@pytest.fixture
def prefix(tmp_path: Path) -> Path:
    """A workspace that adds the base `added` to the launch package."""
    shutil.copytree(PACKAGE / "bases" / "stage", tmp_path / "share" / PACKAGE.name / "bases" / "added")
    (tmp_path / ".catkin").touch()
    return tmp_path


def test_base_that_a_workspace_adds_is_found_there(prefix: Path) -> None:
    environment = {"CMAKE_PREFIX_PATH": f"/nowhere:{prefix}"}
    assert find_base_package(PACKAGE, "added", environment) == prefix / "share" / PACKAGE.name
    assert list_base_packages(PACKAGE, environment) == (PACKAGE, prefix / "share" / PACKAGE.name)


def test_base_of_the_package_and_unknown_ones_lead_to_the_package(prefix: Path) -> None:
    environment = {"CMAKE_PREFIX_PATH": str(prefix)}
    assert find_base_package(PACKAGE, "stage", environment) == PACKAGE
    assert find_base_package(PACKAGE, "adde", environment) == PACKAGE
    assert find_base_package(PACKAGE, "", environment) == PACKAGE


def test_folder_that_is_no_workspace_adds_nothing(prefix: Path) -> None:
    (prefix / ".catkin").unlink()
    assert list_base_packages(PACKAGE, {"CMAKE_PREFIX_PATH": str(prefix)}) == (PACKAGE,)
    assert list_base_packages(PACKAGE, {}) == (PACKAGE,)
