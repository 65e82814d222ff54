"""`ur new base --from` in a hostile repository: nothing of it runs, and nothing outside of it is read."""

import io
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from tests.robot.description.urdfs import SMALL

from ur.cli.main import main
from ur.robot.description.expansion import xacro

PROJECT = Path(__file__).parents[3]
PLAIN = re.sub(r"<\?xml.*?\?>\s*", "", SMALL)
FIGURES = ["--velocity", "0.5", "--angular-velocity", "1.5", "--no-lidar"]
genuine = pytest.mark.skipif(xacro.find_own() is None, reason="xacro is not installed: requirements/dev.lock")


class Repository:
    """A repository with a description, and hostile programs and libraries that are called xacro."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.mark = folder.parent / "ran"
        self.write("bot/package.xml", "<package><name>bot</name></package>")
        self.robot = self.write("bot/urdf/robot.urdf.xacro", PLAIN)

    def write(self, name: str, text: str, mode: int = 0o644) -> Path:
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
        path.chmod(mode)
        return path

    def add_program(self, folder: str) -> None:
        self.write(f"{folder}/xacro", f"#!/bin/sh\ntouch {self.mark}\ncat {self.robot}\n", 0o755)

    def add_library(self, folder: str) -> None:
        self.write(f"{folder}/xacro/__init__.py", f"open({str(self.mark)!r}, 'w')\ndef main(): print('<robot/>')\n")

    def add_package(self, folder: str) -> None:
        self.write(f"{folder}/package.xml", "<package><name>xacro</name></package>")
        self.add_program(folder)
        self.add_library(f"{folder}/lib")

    def add_all(self) -> None:
        self.add_program("bot")
        for folder in ("bot/urdf", "xacro"):
            self.add_package(folder)


def beside(place: Repository) -> None:
    place.add_package("xacro")


def above(place: Repository) -> None:
    (place.folder / "bot/package.xml").unlink()
    place.add_package(".")


def own_package(place: Repository) -> None:
    place.add_package("bot")


def folder_of_the_file(place: Repository) -> None:
    place.add_package("bot/urdf")


def folder_of_path(place: Repository) -> None:
    place.add_program("bin")
    os.environ["PATH"] = f"{place.folder}/bin:{os.environ['PATH']}"


def link_on_path(place: Repository) -> None:
    place.add_program("bin")
    (place.folder.parent / "links").mkdir()
    (place.folder.parent / "links/xacro").symlink_to(place.folder / "bin/xacro")
    os.environ["PATH"] = f"{place.folder.parent}/links:{os.environ['PATH']}"


def relative_folder_of_path(place: Repository) -> None:
    place.add_program("bin")
    os.environ["PATH"] = f"bin:.:{os.environ['PATH']}"
    os.chdir(place.folder)


def empty_folder_of_path(place: Repository) -> None:
    place.add_program(".")
    os.environ["PATH"] = f":{os.environ['PATH']}"
    os.chdir(place.folder)


def python_path(place: Repository) -> None:
    place.add_library("lib")
    os.environ["PYTHONPATH"] = f"{place.folder}/lib"


def package_path(place: Repository) -> None:
    place.add_package("src/xacro")
    os.environ["ROS_PACKAGE_PATH"] = f"{place.folder}/src"


def made_packages(place: Repository) -> None:
    place.add_package("data/ubiquity_launches/packages/xacro")
    os.environ["XDG_DATA_HOME"] = f"{place.folder}/data"
    (place.folder / ".git").mkdir()


PLACES = [
    *(beside, above, own_package, folder_of_the_file, folder_of_path, link_on_path, relative_folder_of_path),
    *(empty_folder_of_path, python_path, package_path, made_packages),
]


class Yes(io.StringIO):
    """A terminal on which each question is answered with yes."""

    def isatty(self) -> bool:
        return True


@pytest.fixture
def repository(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Repository:
    for name in ("PATH", "ROS_PACKAGE_PATH", "PYTHONPATH"):
        monkeypatch.setenv(name, "/usr/bin:/bin" if name == "PATH" else "")
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    monkeypatch.chdir(tmp_path)
    return Repository(tmp_path / "repository")


def make_base(place: Repository, file: Path) -> int:
    return main(
        ["new", "base", "rover", "--from", str(file), "--workspace", str(place.folder.parent / "own"), *FIGURES]
    )


@pytest.mark.parametrize("add", PLACES)
def test_xacro_of_the_repository_is_not_run(
    repository: Repository,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    add: Callable[[Repository], None],
) -> None:
    monkeypatch.setattr(xacro, "find_own", lambda: None)
    monkeypatch.setattr("sys.stdin", Yes("y\n" * 20))
    add(repository)
    assert make_base(repository, repository.robot) == 2
    assert "there is no xacro on this computer" in capsys.readouterr().err
    assert not repository.mark.exists()


@genuine
@pytest.mark.parametrize("add", PLACES)
def test_xacro_of_the_repository_does_not_precede_our_own(
    repository: Repository, add: Callable[[Repository], None]
) -> None:
    add(repository)
    assert make_base(repository, repository.robot) == 0
    assert not repository.mark.exists()


@pytest.mark.parametrize("add", PLACES)
def test_urdf_needs_no_xacro(repository: Repository, add: Callable[[Repository], None]) -> None:
    add(repository)
    text = PLAIN.replace("<robot", "<!-- <xacro:include> xmlns:xacro= --><robot", 1)
    assert make_base(repository, repository.write("bot/urdf/robot.urdf", text)) == 0
    assert not repository.mark.exists()


@pytest.fixture
def shared() -> Iterator[Path]:
    """A folder like /tmp."""
    folder = Path(tempfile.mkdtemp(prefix="ur-", dir="/tmp"))
    folder.chmod(0o1777)
    yield folder
    shutil.rmtree(folder)


@genuine
@pytest.mark.skipif(os.geteuid() != 0, reason="only root can become other users")
def test_package_of_another_user_in_a_folder_for_all_is_not_found(shared: Path) -> None:
    theirs = Repository(shared)
    theirs.mark = shared / "mine/ran"
    theirs.add_package(".")
    theirs.write("part.xacro", "<robot><link name='theirs'/></robot>")
    text = PLAIN.replace("</robot>", '<xacro:include filename="$(find xacro)/part.xacro"/></robot>')
    text = text.replace("<robot", '<robot xmlns:xacro="http://www.ros.org/wiki/xacro"', 1)
    mine = theirs.write("mine/robot.urdf.xacro", text)
    for path in shared.rglob("*"):
        shutil.chown(path, "daemon")
    for path in (mine.parent, mine):
        shutil.chown(path, "nobody")
    user = [
        "runuser",
        "-u",
        "nobody",
        "--",
        "env",
        "-u",
        "XDG_DATA_HOME",
        "-C",
        str(mine.parent),
        f"HOME={shared}/mine",
    ]
    ur = [*user, sys.executable, "-I", "-m", "ur"]
    if subprocess.run([*ur, "--version"], capture_output=True, check=False).returncode:
        pytest.skip("this repository is for root alone")
    done = subprocess.run(
        [*ur, "new", "base", "rover", "--from", str(mine), "--workspace", f"{shared}/mine/own", *FIGURES],
        capture_output=True,
        text=True,
        check=False,
    )
    assert "left out, since their packages are not here: files of xacro" in done.stderr
    assert done.returncode == 0
    assert not theirs.mark.exists()


# A call with a path, as strace prints it: name, path, and the result.
CALL = re.compile(r'\b(openat|open|execve|execveat|creat)\((?:AT_FDCWD, |\d+, )?"([^"]*)".*\) = (-?\d+)')
SOCKET = re.compile(r"\b(socket|connect|sendto|sendmsg)\(")


def trace(place: Repository, file: Path) -> tuple[str, list[tuple[str, str, int]]]:
    """Run `ur new base --from` on a file; its errors with the calls on paths of all its processes, and its sockets."""
    log = place.folder.parent / "strace"
    home = place.folder.parent / "home"
    home.mkdir()
    environment = {"HOME": str(home), "TMPDIR": str(home), "PATH": "/usr/bin:/bin", "LC_ALL": "C.UTF-8"}
    command = ["strace", "-f", "-qq", "-s", "4096", "-e", "trace=%file,%network", "-o", str(log)]
    ur = [sys.executable, "-I", "-m", "ur", "new", "base", "rover", "--from", str(file)]
    done = subprocess.run(
        [*command, *ur, "--workspace", str(home / "own"), *FIGURES],
        cwd=place.folder,
        env=environment,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        check=False,
    )
    text = log.read_text(errors="replace")
    if not text or "PTRACE" in done.stderr:
        pytest.skip(f"strace cannot trace here: {done.stderr.strip()}")
    calls = [(name, path, int(code)) for name, path, code in CALL.findall(text)]
    calls += [(name, "", 0) for name in SOCKET.findall(text)]
    return done.stderr, calls


@genuine
@pytest.mark.skipif(shutil.which("strace") is None, reason="strace is not installed")
@pytest.mark.parametrize("kind", ["urdf", "include", "load_yaml", "pattern", "escape"])
def test_hostile_repository_is_read_and_nothing_else(repository: Repository, kind: str) -> None:
    out = repository.folder.parent / "out"
    out.mkdir()
    for name in ("part.xacro", "secret.yaml", "secret.stl"):
        (out / name).write_text("<robot/>", encoding="utf-8")
    repository.add_all()
    repository.write("bot/meshes/part.stl", "solid")
    (repository.folder / "bot/link.stl").symlink_to(out / "secret.stl")
    (repository.folder / "bot/folder").symlink_to(out)
    (repository.folder / "linked").mkdir()
    (repository.folder / "linked/package.xml").symlink_to(out / "secret.yaml")
    names: tuple[str, ...] = (
        f"file://{out}/secret.stl",
        "../link.stl",
        "../folder/secret.stl",
        "package://bot/link.stl",
    )
    names += ("package://xacro/../../out/secret.stl", f"{out}/secret.stl", "package://bot/meshes/part.stl")
    mesh = "".join(f'<visual><geometry><mesh filename="{name}"/></geometry></visual>' for name in names)
    parts = {
        "urdf": "",
        "include": f'<xacro:include filename="{out}/part.xacro"/>',
        "load_yaml": f"<link name=\"${{xacro.load_yaml('{out}/secret.yaml')}}\"/>",
        "pattern": f'<xacro:include filename="{out}/*.xacro"/>',
        "escape": "<link name=\"${(lambda: xacro.load_yaml.__globals__['os'].system('touch ran'))()}\"/>",
    }
    text = PLAIN.replace("<robot", '<robot xmlns:xacro="http://www.ros.org/wiki/xacro"', 1)
    joint = '<joint name="j" type="fixed"><parent link="base_link"/><child link="more"/></joint>'
    text = text.replace("</robot>", f'<link name="more">{mesh}</link>{joint}{parts[kind]}</robot>')
    suffix = "urdf" if kind == "urdf" else "urdf.xacro"
    told, calls = trace(repository, repository.write(f"bot/urdf/{kind}.{suffix}", text))
    assert "internal error" not in told
    assert kind != "urdf" or told.count("/secret.stl") >= 3
    assert calls
    own: tuple[str, ...] = (sys.prefix, sys.base_prefix, str(PROJECT), str(repository.folder.parent / "own"))
    own += (str(repository.folder.parent / "home"), os.path.realpath(sys.executable))
    system = ("/usr/", "/lib", "/etc/", "/proc/", "/sys/", "/dev/", "/bin", "/opt/ros", "/run/")
    for name, path, code in calls:
        whole = os.path.normpath(repository.folder / path)
        inside = Path(whole).is_relative_to(repository.folder)
        if name.startswith("execve"):
            assert not inside, f"runs {path}"
        elif name in ("socket", "connect", "sendto", "sendmsg"):
            pytest.fail("opens a socket")
        elif code >= 0:
            assert inside or whole.startswith((*own, *system)), f"opens {path}"
            assert not os.path.realpath(whole).startswith(str(out)), f"opens {path}"
    assert not repository.mark.exists()
    assert not (repository.folder / "ran").exists()
