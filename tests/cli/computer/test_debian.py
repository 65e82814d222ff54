import os
import subprocess
from pathlib import Path

import pytest

from ur.cli.main import main
from ur.request.environment import environment_changes
from ur.request.requirements.preparation import Account, install_debian
from ur.robot.selection import parse_selection
from ur.source.diagnostic import UserError
from ur.source.project import project_folder
from ur.system.debian_root import DebianRoot, install_command

SCRIPT = project_folder() / "tools" / "debian_root.bash"


def run_script(*words: str, data: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        ["bash", SCRIPT, *words],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "XDG_DATA_HOME": str(data)},
    )


@pytest.mark.parametrize("words", [["install", "gdb"], ["update"], ["remove"]])
def test_changing_the_root_from_inside_is_refused_with_the_command_to_use(
    words: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "mark").touch()
    monkeypatch.setattr("ur.cli.computer.set_up.MARK", str(tmp_path / "mark"))
    assert main(["setup", "debian", *words]) == 2
    said = capsys.readouterr().err
    assert "cannot run inside the Debian root" in said
    assert f"/ur setup debian {' '.join(words)}" in said


def test_missing_packages_are_refused_inside_with_the_command_that_installs_them(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "dpkg-query").write_text("#!/bin/sh\n")
    (tmp_path / "dpkg-query").chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}:/usr/bin:/bin")
    with pytest.raises(UserError) as caught:
        install_debian([["gdb"]], "a debugger", account=Account(root=lambda _: DebianRoot("/data", "13")))
    assert caught.value.diagnostics[0].help == install_command(["gdb"])


def test_shells_find_the_programs_of_the_root_after_those_of_the_project() -> None:
    root = DebianRoot("/data", "13")
    package = Path("/project/ubiquity_launches")
    changes = environment_changes(
        parse_selection("sim:stage"), {"PATH": "/usr/bin"}, package=package, find=lambda _: root
    )
    assert changes["PATH"] == "/project/ubiquity_launches/bin:/data/bin:/usr/bin"
    again = environment_changes(
        parse_selection("sim:stage"), {"PATH": changes["PATH"]}, package=package, find=lambda _: root
    )
    assert again["PATH"] == changes["PATH"]


def test_status_without_a_root_says_so(tmp_path: Path) -> None:
    done = run_script("status", data=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith("no Debian root")


def test_both_spellings_reach_the_root_without_a_set_up_and_the_old_one_warns(tmp_path: Path) -> None:
    environment = {**os.environ, "XDG_DATA_HOME": str(tmp_path)}
    told = []
    for words in (["setup", "debian"], ["debian"]):
        command = [str(project_folder() / "ur"), *words, "status"]
        done = subprocess.run(command, capture_output=True, text=True, check=False, env=environment)
        assert (done.returncode, done.stdout[:14]) == (0, "no Debian root")
        told.append(done.stderr)
    assert told == ["", "warning: 'ur debian' is now 'ur setup debian'; the old spelling ends with the next release\n"]


def test_unknown_command_is_refused_with_the_known_ones(tmp_path: Path) -> None:
    done = run_script("remvoe", data=tmp_path)
    assert done.returncode == 2
    assert done.stderr.startswith("error: unknown command 'remvoe'")
    assert "remove" in done.stderr


def test_entering_without_a_root_names_the_command_that_makes_it(tmp_path: Path) -> None:
    done = run_script("enter", "true", data=tmp_path)
    assert done.returncode == 2
    assert "does not exist" in done.stderr
    assert "help: " in done.stderr


def test_remove_deletes_the_folder_and_keeps_what_others_have_in_the_one_above(tmp_path: Path) -> None:
    data = tmp_path / "ubiquity_launches/debian-13"
    (data / "partial").mkdir(parents=True)
    (data.parent / "waypoints").touch()
    done = run_script("remove", data=tmp_path)
    assert done.returncode == 0, done.stderr
    assert [each.name for each in data.parent.iterdir()] == ["waypoints"]


def test_folder_with_a_mount_in_it_is_neither_deleted_nor_given_away(tmp_path: Path) -> None:
    line = f'. {SCRIPT}; is_free / || echo mounted; is_free "$1" && echo free'
    done = subprocess.run(["bash", "-c", line, "bash", tmp_path], capture_output=True, text=True, check=False)
    assert done.stdout == "mounted\nfree\n"


@pytest.mark.parametrize("kind", ["plain", "link", "link in the middle", "blank", "backslash"])
@pytest.mark.parametrize("call", ['delete "$1"', 'delete "$1/host-etc"', 'give 4242 4242 "$1"'])
def test_what_is_mounted_in_the_root_keeps_its_files_and_owner(tmp_path: Path, kind: str, call: str) -> None:
    if os.geteuid() != 0:
        pytest.skip("only root can mount a folder")
    names = {"blank": "the data", "backslash": "the\\040data\n2"}
    real = tmp_path / names.get(kind, "data") / "below"
    etc = tmp_path / "etc"
    etc.mkdir()
    (etc / "passwd").write_text("root\n")
    (real / "host-etc").mkdir(parents=True)
    (tmp_path / "link").symlink_to(real if kind == "link" else real.parent)
    data = {"link": tmp_path / "link", "link in the middle": tmp_path / "link" / "below"}.get(kind, real)
    line = f'mount --bind "$2" "$1/host-etc" && . {SCRIPT} && {call}'
    done = subprocess.run(
        ["unshare", "--mount", "--propagation", "private", "bash", "-c", line, "bash", data, etc],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 1
    assert "is mounted in" in done.stderr
    assert (etc / "passwd").read_text() == "root\n"
    assert etc.stat().st_uid == real.stat().st_uid == 0


def test_root_behind_a_link_is_deleted_with_the_link(tmp_path: Path) -> None:
    (tmp_path / "disk" / "root").mkdir(parents=True)
    (tmp_path / "data").symlink_to(tmp_path / "disk")
    line = f'. {SCRIPT} && delete "$1"'
    subprocess.run(["bash", "-c", line, "bash", tmp_path / "data"], check=True)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", ["var/lib/apt/lists", "etc/apt/apt.conf.d", "etc/apt/auth.conf.d", "host-etc", "dev"])
def test_link_in_the_place_of_a_folder_of_the_root_is_not_followed(tmp_path: Path, name: str) -> None:
    root, victim = tmp_path / "root", tmp_path / "victim"
    for each in ("host-etc", "run", "dev", "proc", "etc/apt/apt.conf.d", "etc/apt/auth.conf.d", "var/lib/apt/lists"):
        (root / each).mkdir(parents=True)
    victim.mkdir()
    (victim / "precious").touch()
    (root / name).rmdir()
    (root / name).symlink_to(victim)
    stubs = "mount() { :; }; cp() { :; }; apt-config() { :; }; chroot() { :; }"
    line = f'. {SCRIPT}; {stubs}; change "$1" 0 0 install x'
    done = subprocess.run(["bash", "-c", line, "bash", tmp_path], capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert f"'{root}/{name}' is not a folder, or leads out of '{root}'" in done.stderr
    assert [each.name for each in victim.iterdir()] == ["precious"]
