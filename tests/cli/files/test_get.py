"""`ur get` as people run it, with stand-ins for apt: interrupted, without room, without a network."""

import os
import signal
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest
from tests.forking import run_ur

# Packages are words in the file `installed`. An installation unpacks the library first, then `fault` happens.
PROGRAMS = {
    "apt-get": """
case "$*" in
*--simulate*install*) printf 'Inst libmade-up (1)\\nInst ros-made-up-sensor (1)\\n' ;;
*--simulate*remove*) shift 3; for name in "$@"; do echo "Remv $name [1]"; done ;;
*" remove "*) for name in "$@"; do sed -i "/^$name$/d" "$here/installed"; done ;;
*" update"*) echo "W: Some index files failed to download." ;;
*" install "*) . "$here/fault"; echo ros-made-up-sensor >>"$here/installed" ;;
*) echo "E: no network"; exit 100 ;;
esac
""",
    "apt-cache": """
for name in "$@"; do
  [ "$name" != ros-made-up-sensor ] || printf 'Package: %s\\nFilename: a.deb\\n\\n' "$name"
done
""",
    "dpkg-query": """
for name in "$@"; do ! grep -qx -- "$name" "$here/installed" || echo "$name installed"; done
""",
    "sudo": """
[ "$1" != -n ] || shift
exec "$@"
""",
}
NO_ROOM = """echo "E: You don't have enough free space in /var/cache/apt/archives/."; exit 100\n"""
NO_NETWORK = """echo "Err:1 a.deb"; echo "E: Failed to fetch a.deb  Temporary failure resolving"; exit 100\n"""
HALF_DONE = """echo libmade-up >>"$here/installed"; echo half >"$here/reached"; exec sleep 600\n"""


@dataclass(frozen=True)
class ComputerWithPackages:
    """A computer with apt's programs of its own, and an unreachable network."""

    folder: Path

    @property
    def environment(self) -> dict[str, str]:
        return {name: value for name, value in os.environ.items() if not name.startswith(("ROS", "XDG"))} | {
            "PATH": f"{self.folder}/bin:/usr/bin:/bin",
            "HOME": str(self.folder / "home"),
            "ROS_PACKAGE_PATH": str(self.folder / "home"),
            "PIP_RETRIES": "0",
            "PIP_NO_CACHE_DIR": "1",
            **dict.fromkeys(("http_proxy", "https_proxy"), "http://127.0.0.1:9"),  # nothing listens there
        }

    def start(self, *words: str) -> subprocess.Popen[str]:
        pipe = subprocess.PIPE
        command = [sys.executable, "-I", "-m", "ur", "get", *words]
        return subprocess.Popen(
            command, env=self.environment, stdout=pipe, stderr=pipe, text=True, start_new_session=True
        )

    def run(self, *words: str) -> tuple[int, str]:
        """The exit code, and all that was printed."""
        done = run_ur("get", *words, environment=self.environment)
        assert "Traceback" not in done.stdout + done.stderr
        assert "internal error" not in done.stderr
        return done.returncode, done.stdout + done.stderr

    def installed(self) -> list[str]:
        return (self.folder / "installed").read_text().split()

    def files(self) -> list[str]:
        """What is in the home folder."""
        home = self.folder / "home"
        return sorted(path.relative_to(home).as_posix() for path in home.rglob("*") if path.is_file())


@pytest.fixture
def computer(tmp_path: Path) -> ComputerWithPackages:
    (tmp_path / "home").mkdir()
    (tmp_path / "bin").mkdir()
    for name, text in PROGRAMS.items():
        (tmp_path / "bin" / name).write_text(f"#!/bin/sh\nhere={tmp_path}{text}")
        (tmp_path / "bin" / name).chmod(0o755)
    (tmp_path / "installed").write_text("base\n")
    (tmp_path / "fault").write_text("")
    return ComputerWithPackages(tmp_path)


OTHERS = """
for name in "$@"; do
  case "$name" in ros-made-up-sensor|openssh-server) printf 'Package: %s\\nFilename: a.deb\\n\\n' "$name" ;; esac
done
"""


@pytest.mark.parametrize("words", [["--yes"], ["--yes", "--others"]])
def test_packages_that_are_not_of_ros_need_a_word_of_their_own(
    computer: ComputerWithPackages, words: list[str]
) -> None:
    (computer.folder / "bin" / "apt-cache").write_text(f"#!/bin/sh{OTHERS}")
    (computer.folder / "bin" / "apt-get").write_text(
        f'#!/bin/sh\ncase "$*" in *" install "*) echo "$*" >>{computer.folder}/apt ;; esac\n'
    )
    folder = computer.folder / "work"
    folder.mkdir()
    depends = "<depend>made_up_sensor</depend><depend>openssh-server</depend>"
    (folder / "package.xml").write_text(f"<package><name>p</name>{depends}</package>")
    _, text = computer.run("--missing", str(folder), *words)
    assert "other Debian packages, which are not of ROS:\n  openssh-server: openssh-server\n" in text
    installed = (computer.folder / "apt").read_text()
    assert "ros-made-up-sensor" in installed
    assert ("openssh-server" in installed) == ("--others" in words)


def test_package_is_installed_with_what_it_needs(computer: ComputerWithPackages) -> None:
    (computer.folder / "fault").write_text('echo libmade-up >>"$here/installed"\n')
    code, text = computer.run("made_up_sensor", "--yes")
    assert "ros-made-up-sensor" in text
    assert code == 1  # apt's stand-in brings no package that ROS finds
    assert computer.installed() == ["base", "libmade-up", "ros-made-up-sensor"]


@pytest.mark.parametrize(
    ("fault", "reason", "help_"),
    [
        (NO_ROOM, "You don't have enough free space", "make room on the disk"),
        (NO_NETWORK, "Failed to fetch a.deb", "check the network and apt's sources, or try it by hand: sudo apt-get"),
    ],
    ids=["no room", "no network"],
)
def test_failure_of_apt_changes_nothing_and_says_what_to_do(
    computer: ComputerWithPackages, fault: str, reason: str, help_: str
) -> None:
    (computer.folder / "fault").write_text(fault)
    code, text = computer.run("made_up_sensor", "--yes")
    assert code == 2
    assert f"ros-made-up-sensor could not be installed: {reason}" in text
    assert f"help: {help_}" in text
    assert computer.installed() == ["base"]


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGKILL], ids=["Ctrl-C", "killed"])
def test_interrupted_installation_is_continued_by_the_next_run(
    computer: ComputerWithPackages, number: signal.Signals
) -> None:
    os.mkfifo(computer.folder / "reached")
    (computer.folder / "fault").write_text(HALF_DONE)
    process = computer.start("made_up_sensor", "--yes")
    with (computer.folder / "reached").open() as reached:
        assert reached.read() == "half\n"
    os.killpg(process.pid, number)  # as a terminal does
    process.communicate(timeout=60)
    assert process.returncode == (130 if number == signal.SIGINT else -number)
    assert computer.installed() == ["base", "libmade-up"]
    (computer.folder / "fault").write_text("true\n")
    computer.run("made_up_sensor", "--yes")
    assert computer.installed() == ["base", "libmade-up", "ros-made-up-sensor"]


def test_without_a_network_xacro_of_pypi_is_left_out_completely(computer: ComputerWithPackages) -> None:
    code, text = computer.run("xacro", "--yes")
    assert code == 2
    assert "xacro could not be installed" in text
    assert "help: check the network and pip's settings" in text
    assert computer.files() == []


def test_without_a_network_a_plan_names_the_index_that_could_not_be_fetched(computer: ComputerWithPackages) -> None:
    code, text = computer.run("nobody_has_this", "--dry-run")
    assert code == 1
    assert "cannot be fetched" in text
    assert "--index FILE reads one" in text
    assert computer.files() == []
