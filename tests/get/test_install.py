"""Installation of `ur get`, without apt and pip."""

import errno
from collections.abc import Sequence
from pathlib import Path

import pytest

from ur.get.install import install, install_xacro
from ur.get.steps import GetPlan, InstallStep, Missing
from ur.source.diagnostic import UserError, error

PLAN = GetPlan((InstallStep(Missing("rviz"), "debian", ("rviz",)), InstallStep(Missing("xacro"), "pypi", ("xacro",))))


def pip(command: Sequence[str], _missing: str, _settings: str) -> None:
    library = Path(command[command.index("--target") + 1])
    (library / "bin").mkdir(parents=True)
    (library / "bin/xacro").write_text("")


def test_packages_of_debian_and_of_pypi_are_installed(tmp_path: Path) -> None:
    asked: list[object] = []
    install(PLAN, tmp_path, lambda sets, _title: asked.append(sets), lambda folder: install_xacro(folder, pip))
    assert asked == [[("rviz",)]]
    assert sorted(each.name for each in (tmp_path / "xacro").iterdir()) == [
        "lib", "main.py", "package.xml", "xacro", "xacro.py",
    ]  # fmt: skip
    assert not (tmp_path / "xacro/lib/bin").exists()


def test_nothing_of_pypi_is_installed_after_a_failure_of_debian(tmp_path: Path) -> None:
    def fail(_sets: object, _title: str) -> None:
        raise UserError(error("no network", rule="no-package"))

    with pytest.raises(UserError, match="no network"):
        install(PLAN, tmp_path, fail, lambda folder: install_xacro(folder, pip))
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("problem", [OSError(errno.ENOSPC, "No space left on device"), KeyboardInterrupt()])
def test_full_disk_or_interruption_leaves_no_half_of_xacro(tmp_path: Path, problem: BaseException) -> None:
    def fail(command: Sequence[str], missing: str, settings: str) -> None:
        pip(command, missing, settings)
        raise problem

    with pytest.raises((UserError, KeyboardInterrupt), match=r"no space left|^$"):
        install_xacro(tmp_path, fail)
    assert not list(tmp_path.iterdir())
