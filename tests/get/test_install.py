"""Installation and undo of `ur get`, without apt and pip."""

import errno
from collections.abc import Sequence
from pathlib import Path

import pytest

from ur.get.install import InstallActions, install, install_xacro, undo
from ur.get.record import InstallRecord, load_record
from ur.get.steps import GetPlan, InstallStep, Missing
from ur.source.diagnostic import UserError, error

PLAN = GetPlan((InstallStep(Missing("rviz"), "debian", ("rviz",)), InstallStep(Missing("xacro"), "pypi", ("xacro",))))


class Apt:
    """Packages in memory: `rviz` brings `libogre`, and `desktop` needs `rviz` where that is said."""

    def __init__(self, *, fails: BaseException | None = None) -> None:
        self.installed = {"base"}
        self.needs_rviz: set[str] = set()
        self.fails = fails

    def install(self, names: Sequence[str]) -> None:
        self.installed.add("libogre")
        if self.fails:
            raise self.fails
        self.installed.update(names)

    def remove(self, names: Sequence[str]) -> None:
        self.installed.difference_update(names)

    def simulate(self, words: Sequence[str]) -> str:
        if words[0] == "install":
            return "Inst libogre (1)\nInst rviz (1)\nInst base (2)\n"
        return "".join(f"Remv {name} [1]\n" for name in (*words[1:], *self.needs_rviz))

    def actions(self) -> InstallActions:
        missing = lambda names: [name for name in names if name not in self.installed]  # noqa: E731
        return InstallActions(
            self.install, self.remove, self.simulate, missing, lambda folder: install_xacro(folder, pip)
        )


def pip(command: Sequence[str], _missing: str, _settings: str) -> None:
    library = Path(command[command.index("--target") + 1])
    (library / "bin").mkdir(parents=True)
    (library / "bin/xacro").write_text("")


def test_undo_removes_what_was_installed_and_nothing_else(tmp_path: Path) -> None:
    apt, record, packages = Apt(), tmp_path / "get.json", tmp_path / "packages"
    install(PLAN, record, packages, apt.actions())
    assert apt.installed == {"base", "rviz", "libogre"}
    assert sorted(each.name for each in (packages / "xacro").iterdir()) == [
        "lib", "main.py", "package.xml", "xacro", "xacro.py",
    ]  # fmt: skip
    assert not (packages / "xacro/lib/bin").exists()
    assert undo(record, packages, apt.actions()) == InstallRecord(("rviz", "libogre"), ("xacro",))
    assert apt.installed == {"base"}
    assert not list(packages.iterdir())
    assert not record.exists()


def test_interrupted_installation_can_be_undone(tmp_path: Path) -> None:
    apt, record = Apt(fails=KeyboardInterrupt()), tmp_path / "get.json"
    with pytest.raises(KeyboardInterrupt):
        install(PLAN, record, tmp_path / "packages", apt.actions())
    assert apt.installed == {"base", "libogre"}
    undo(record, tmp_path / "packages", apt.actions())
    assert apt.installed == {"base"}


def test_failed_installation_is_recorded_as_far_as_it_came(tmp_path: Path) -> None:
    failure = UserError(error("no network", rule="no-package"))
    apt, record = Apt(fails=failure), tmp_path / "get.json"
    with pytest.raises(UserError, match="no network"):
        install(PLAN, record, tmp_path / "packages", apt.actions())
    assert load_record(record) == InstallRecord(("libogre",))
    apt.installed.add("rviz")  # by somebody else, later
    undo(record, tmp_path / "packages", apt.actions())
    assert apt.installed == {"base", "rviz"}


def test_undo_leaves_packages_that_something_else_needs_by_now(tmp_path: Path) -> None:
    apt, record = Apt(), tmp_path / "get.json"
    install(PLAN, record, tmp_path / "packages", apt.actions())
    apt.needs_rviz = {"desktop"}
    with pytest.raises(UserError, match="desktop would be removed as well"):
        undo(record, tmp_path / "packages", apt.actions())
    assert apt.installed == {"base", "rviz", "libogre"}
    assert load_record(record).pypi == ("xacro",)


def test_nothing_is_installed_when_the_record_cannot_be_written(tmp_path: Path) -> None:
    apt = Apt()
    with pytest.raises(UserError, match="; nothing was changed"):
        install(PLAN, Path("/proc/nowhere/get.json"), tmp_path / "packages", apt.actions())
    assert apt.installed == {"base"}


@pytest.mark.parametrize("problem", [OSError(errno.ENOSPC, "No space left on device"), KeyboardInterrupt()])
def test_full_disk_or_interruption_leaves_no_half_of_xacro(tmp_path: Path, problem: BaseException) -> None:
    def fail(command: Sequence[str], missing: str, settings: str) -> None:
        pip(command, missing, settings)
        raise problem

    with pytest.raises((UserError, KeyboardInterrupt), match=r"no space left|^$"):
        install_xacro(tmp_path, fail)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("text", ["", "[]", '{"debian": ["; rm"], "pypi": []}', '{"debian": [], "pypi": ["../.."]}'])
def test_damaged_record_is_refused(tmp_path: Path, text: str) -> None:
    path = tmp_path / "get.json"
    path.write_text(text)
    with pytest.raises(UserError, match="damaged"):
        load_record(path)
