import shutil
from pathlib import Path

import pytest

from ur.request.programs import PACKAGE
from ur.robot.base import load_base
from ur.robot.base.files import find_base_package, list_base_packages
from ur.source.diagnostic import UserError
from ur.source.user_folders import MARKER

NO_OTHERS = {"XDG_CONFIG_HOME": "/nowhere"}
"""A user without workspaces."""


@pytest.fixture
def prefix(tmp_path: Path) -> Path:
    """A workspace that adds the base `added` to the launch package."""
    shutil.copytree(PACKAGE / "bases" / "stage", tmp_path / "share" / PACKAGE.name / "bases" / "added")
    (tmp_path / ".catkin").touch()
    return tmp_path


def test_base_that_a_workspace_adds_is_found_there(prefix: Path) -> None:
    environment = {"CMAKE_PREFIX_PATH": f"/nowhere:{prefix}"} | NO_OTHERS
    assert find_base_package(PACKAGE, "added", environment) == prefix / "share" / PACKAGE.name
    assert list_base_packages(PACKAGE, environment) == (PACKAGE, prefix / "share" / PACKAGE.name)


def test_base_of_the_package_and_unknown_ones_lead_to_the_package(prefix: Path) -> None:
    environment = {"CMAKE_PREFIX_PATH": str(prefix)}
    assert find_base_package(PACKAGE, "stage", environment) == PACKAGE
    assert find_base_package(PACKAGE, "adde", environment) == PACKAGE
    assert find_base_package(PACKAGE, "", environment) == PACKAGE


def test_folder_that_is_no_workspace_adds_nothing(prefix: Path) -> None:
    (prefix / ".catkin").unlink()
    assert list_base_packages(PACKAGE, {"CMAKE_PREFIX_PATH": str(prefix)} | NO_OTHERS) == (PACKAGE,)
    assert list_base_packages(PACKAGE, NO_OTHERS) == (PACKAGE,)


@pytest.mark.parametrize("name", ["../../outside", "/outside", "..", ".", "", "in/side", "a\0b"])
def test_path_is_no_name_of_a_base(tmp_path: Path, name: str) -> None:
    package = tmp_path / "package"
    for folder in (package / "bases/in/side", tmp_path / "outside", package, package / "bases"):
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "base.yaml").write_bytes((PACKAGE / "bases/stage/base.yaml").read_bytes())
    with pytest.raises(UserError, match="unknown base"):
        load_base(package, name)
    (tmp_path / MARKER).touch()
    added = tmp_path / "share/package"
    shutil.copytree(package, added)
    assert find_base_package(package, name, {"CMAKE_PREFIX_PATH": str(tmp_path)}) == package
