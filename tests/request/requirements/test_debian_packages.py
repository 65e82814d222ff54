from pathlib import Path

import pytest

from ur.request.requirements.preparation import Account, install_debian, list_missing
from ur.source.diagnostic import UserError

# Stand in for the programs of a computer: packages are words in a file, and apt-get knows some after an update only.
DPKG = """#!/bin/sh
for name in "$@"; do grep -qx "$name" {folder}/installed && echo "$name installed"; done; true
"""
APT = """#!/bin/sh
echo "$*" >>{folder}/calls
case "$*" in
  *update*) touch {folder}/lists ;;
  *huge*) echo "E: You don't have enough free space in /var/cache/apt/archives/."; exit 100 ;;
  *broken*) echo "E: Unable to locate package broken"; exit 100 ;;
  *) [ -e {folder}/lists ] || exit 100; for name in "$@"; do echo "$name" >>{folder}/installed; done ;;
esac
"""


@pytest.fixture
def computer(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    for name, text in (("dpkg-query", DPKG), ("apt-get", APT)):
        (tmp_path / name).write_text(text.format(folder=tmp_path))
        (tmp_path / name).chmod(0o755)
    (tmp_path / "installed").write_text("here\n")
    (tmp_path / "calls").write_text("")
    monkeypatch.setenv("PATH", f"{tmp_path}:/usr/bin:/bin")
    return tmp_path


AS_ROOT = Account(uid=lambda: 0)


def calls(computer: Path) -> list[str]:
    return (computer / "calls").read_text().splitlines()


@pytest.mark.parametrize("alternatives", [[["here"]], [["absent"], ["here"]]])
def test_packages_that_are_there_or_that_an_alternative_provides_are_not_installed(
    computer: Path, alternatives: list[list[str]]
) -> None:
    install_debian(alternatives, "something", account=AS_ROOT)
    assert calls(computer) == []


def test_missing_packages_are_installed_with_fresh_lists_where_the_old_ones_lack_them(
    computer: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    install_debian([["here", "absent"]], "something (1 MB)", account=AS_ROOT)
    install, update, again = calls(computer)
    assert install == again
    assert install.endswith("install -y --no-install-recommends absent")
    assert "update" in update
    assert list_missing(["absent"]) == []
    assert "installing something (1 MB): Debian packages absent, once ..." in capsys.readouterr().err


@pytest.mark.usefixtures("computer")
def test_failure_is_told_in_the_words_of_apt() -> None:
    with pytest.raises(UserError, match="broken could not be installed: Unable to locate package broken") as caught:
        install_debian([["broken"]], "something", account=AS_ROOT)
    assert "sudo apt-get install broken" in str(caught.value.diagnostics[0].help)


def test_full_disk_is_reported_at_once_without_fetching_package_lists(computer: Path) -> None:
    with pytest.raises(UserError, match="huge could not be installed: You don't have enough free space") as caught:
        install_debian([["huge"]], "something", account=AS_ROOT)
    assert caught.value.diagnostics[0].help is not None
    assert "make room on the disk" in caught.value.diagnostics[0].help
    assert not [call for call in calls(computer) if "update" in call]


def test_without_sudo_the_command_for_root_is_printed(computer: Path) -> None:
    account = Account(uid=lambda: 1000, sudo=lambda: None)
    with pytest.raises(
        UserError, match="absent are missing and could not be installed: sudo is not installed"
    ) as caught:
        install_debian([["absent"]], "something", account=account)
    assert caught.value.diagnostics[0].help == "as root: apt-get install absent"
    assert calls(computer) == []
