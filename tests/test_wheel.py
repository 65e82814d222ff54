"""What is installed by pipx and uv: built from a clone, it holds all that runs, and it runs without one."""

import os
import re
import shutil
import subprocess
import sys
import zipfile
from collections.abc import Iterator
from email.message import Message
from email.parser import Parser
from pathlib import Path

import pytest
from tests.forking import ForkingPython
from tests.ros_session import RosSession
from tools.build import build
from tools.release import set_version

from ur.cli.verbs import VERBS
from ur.robot.deploy.repository import read_programs, read_repository

ROOT = Path(__file__).parents[1]
SITE = Path(f"lib/python{sys.version_info[0]}.{sys.version_info[1]}/site-packages")
DATA = "ur/_project"


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel, built from the unpacked sdist."""
    return build(tmp_path_factory.mktemp("dist"))[1]


def make_environment(folder: Path, *options: str) -> None:
    """An environment of its own that sees the packages of this one, but not this project: nothing is downloaded."""
    subprocess.run(["/usr/bin/python3", "-m", "venv", *options, str(folder)], check=True, timeout=120)
    # A .pth file of a folder that another .pth file names is not read: the clone stays out of sight.
    (folder / SITE / "tests.pth").write_text(f"{ROOT / '.venv' / SITE}\n")


class Installed:
    """The wheel in an environment as pipx makes one, and the home folder of who uses it."""

    def __init__(self, wheel: Path, folder: Path) -> None:
        self.environment = folder / "pipx/venvs/ubiquity-launches"
        self.home = folder / "home"
        self.home.mkdir()
        make_environment(self.environment, "--without-pip")
        self.install(wheel)

    def install(self, wheel: Path) -> None:
        pip = [sys.executable, "-I", "-m", "pip", "--python", str(self.environment / "bin/python"), "install"]
        options = ["-q", "--no-deps", "--no-index", "--force-reinstall", "--disable-pip-version-check"]
        subprocess.run([*pip, *options, str(wheel)], check=True, timeout=120)

    @property
    def made(self) -> Path:
        """The environment that the first use makes."""
        return self.home / ".local/share/ubiquity_launches/.venv"

    def run(self, *command: str, **variables: str) -> subprocess.CompletedProcess[str]:
        """Run a command as a user without any setting; `ur` is the installed script."""
        words = [str(self.environment / "bin/ur") if command[0] == "ur" else command[0], *command[1:]]
        environment = {**self.variables, **variables}
        return subprocess.run(
            words, cwd=self.home, env=environment, capture_output=True, text=True, timeout=300, check=False
        )

    @property
    def variables(self) -> dict[str, str]:
        return {"PATH": "/usr/bin:/bin", "HOME": str(self.home), "TERM": "dumb"}

    def ur(self, *arguments: str) -> str:
        """What a command prints that has to succeed."""
        done = self.run("ur", *arguments)
        assert done.returncode == 0, done
        return done.stdout


@pytest.fixture(scope="module")
def installed(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Installed:
    return Installed(wheel, tmp_path_factory.mktemp("installed"))


def read_metadata(wheel: Path) -> Message:
    with zipfile.ZipFile(wheel) as archive:
        (name,) = (each for each in archive.namelist() if each.endswith(".dist-info/METADATA"))
        return Parser().parsestr(archive.read(name).decode())


def read_requirements(name: str) -> set[str]:
    lines = (line.partition("#")[0].strip() for line in (ROOT / "requirements" / f"{name}.in").read_text().splitlines())
    return {normalise(line) for line in filter(None, lines)}


def normalise(requirement: str) -> str:
    """A requirement with its bounds in one order and one kind of quote."""
    text = requirement.replace(" ", "").replace('"', "'")
    specifier, _, marker = text.partition(";")
    name = re.match(r"[\w.-]+", specifier)
    assert name
    return f"{name[0]}{','.join(sorted(specifier[name.end() :].split(',')))};{marker}"


def test_dependencies_and_extras_are_those_of_the_requirement_files(wheel: Path) -> None:
    metadata = read_metadata(wheel)
    wanted: dict[str, set[str]] = {}
    for line in metadata.get_all("Requires-Dist", []):
        match = re.search(r"(?:and|;)\s*extra == ['\"](\w+)['\"]$", line)
        plain = re.sub(r"\s*(?:and|;)\s*extra == .*$", "", line)
        plain = re.sub(r";\s*\((.*)\)$", r"; \1", plain)  # a marker with `or`, beside that of the extra
        wanted.setdefault(match[1] if match else "ur", set()).add(normalise(plain))
    files = {path.stem for path in (ROOT / "requirements").glob("*.in")} - {
        "build",
        "audit",
        "docs",
        "ros2",
        "ros2-jazzy",
    }
    pins = (ROOT / "requirements/ur.pins").read_text().splitlines()
    assert wanted == {name: read_requirements(name) for name in files} | {"ur": set(map(normalise, pins))}
    assert set(metadata.get_all("Provides-Extra", [])) == files - {"ur"}


def test_wheel_is_installed_with_exactly_the_versions_of_the_lock() -> None:
    locked = re.sub(r" \\\n( +--hash=\S+( \\\n)?)+", "", (ROOT / "requirements/run.lock").read_text()).splitlines()
    pins = (ROOT / "requirements/ur.pins").read_text().splitlines()
    assert [pin for pin in pins if pin not in locked] == []
    named = {normalise(line).partition(";")[0] for line in read_requirements("ur")}
    assert named <= {pin.partition("==")[0] for pin in pins}


def test_every_requirement_is_locked() -> None:
    for lock, names in {
        "run": ("ur", "nodes", "build"),
        "dev": ("dev",),
        "robot": ("robot",),
        "vision": ("vision",),
        "web": ("web",),
        "foxglove": ("foxglove",),
        "three": ("three",),
        "lsp": ("lsp",),
        "recordings": ("recordings",),
        "audit": ("audit",),
    }.items():
        text = (ROOT / "requirements" / f"{lock}.lock").read_text()
        locked = {name.lower() for name in re.findall(r"^([\w.-]+)==", text, re.MULTILINE)}
        for line in set().union(*map(read_requirements, names)):
            match = re.match(r"[\w.-]+", line)
            assert match
            assert match[0].lower() in locked, lock


def test_wheel_holds_the_files_of_the_clone_and_nothing_of_this_computer(wheel: Path) -> None:
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    tracked = {name for name in listed.split("\0") if name and os.path.lexists(ROOT / name)}
    with zipfile.ZipFile(wheel) as archive:
        names = {name for name in archive.namelist() if ".dist-info/" not in name and ".data/" not in name}
        modes = {each.filename: each.external_attr >> 16 for each in archive.infolist()}
        texts = b"".join(archive.read(name) for name in archive.namelist())
    library = {name for name in tracked if name.startswith("ubiquity_launches/")}
    assert {f"{DATA}/{name}" for name in library} <= names
    assert {name.removeprefix("src/") for name in tracked if name.startswith("src/")} <= names
    assert {f"{DATA}/{name}" for name in ("tools/set_up.bash", "requirements/run.lock", "ur")} <= names
    outside = {name for name in names if not name.startswith(("ur/", "ur_nodes/"))}
    assert outside == set()
    assert not [name for name in names if "__pycache__" in name or name.endswith((".pyc", ".orig"))]
    assert {name for name in library if os.access(ROOT / name, os.X_OK)} == {
        name for name in library if modes[f"{DATA}/{name}"] & 0o111
    }
    assert os.fsencode(ROOT) not in texts


def test_same_commit_gives_the_same_wheel(wheel: Path, tmp_path: Path) -> None:
    assert build(tmp_path)[1].read_bytes() == wheel.read_bytes()


def test_robot_gets_the_same_copy_from_a_wheel_as_from_a_clone(installed: Installed) -> None:
    code = "from ur.robot.deploy.repository import *; print(read_repository().digest, read_programs().digest)"
    done = installed.run(str(installed.environment / "bin/python"), "-I", "-c", code)
    assert done.stdout.split() == [read_repository(ROOT).digest, read_programs(ROOT).digest]


def test_commands_that_start_nothing_need_no_set_up(installed: Installed) -> None:
    assert installed.ur("--version").endswith(f"(wheel in {installed.environment})\n")
    assert "Usage: ur use" in installed.ur("use", "--help")
    python = ForkingPython(str(installed.environment / "bin/python"), "-I", modules=("ur.cli.main", "ur.cli.help"))
    for verb in VERBS:
        done = python.run("ur", verb, "--help", folder=installed.home, environment=installed.variables)
        assert (done.returncode, f"Usage: ur {verb}" in done.stdout.decode()) == (0, True), done
    python.close()
    assert "keyboard_navigate" in installed.ur("__complete", "bash", "ur run key")
    assert "keyboard_navigate" in installed.ur("list")
    assert "/move_base" in installed.ur("launch", "--nodes", "ubiquity_launches", "m_keyboard_navigate.launch.xml")
    assert "keyboard_navigate" in installed.ur("docs", "--output", "-", str(installed.environment / SITE / DATA))
    assert installed.run("ur", "check", "ubiquity_launches").returncode in (0, 1)
    assert not installed.made.exists()
    assert str(ROOT) not in installed.ur("env")


def test_node_without_environment_says_what_makes_it(installed: Installed) -> None:
    node = installed.environment / SITE / DATA / "ubiquity_launches/lib/node"
    done = installed.run(str(node), "ur_nodes.mapping.map_server_node")
    assert done.returncode == 2
    assert f"expected {installed.made}/bin/python" in done.stderr
    assert "run 'ur use' once" in done.stderr


def test_script_outside_of_an_environment_says_how_to_install(tmp_path: Path) -> None:
    (tmp_path / "bin").mkdir()
    script = tmp_path / "bin/ur"
    script.write_bytes((ROOT / "ur").read_bytes())
    done = subprocess.run(
        ["bash", str(script)],
        env={"PATH": "/usr/bin:/bin", "HOME": str(tmp_path)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 2
    assert "pipx install ubiquity-launches" in done.stderr


@pytest.fixture
def session(tmp_path: Path) -> Iterator[RosSession]:
    started = RosSession(tmp_path)
    yield started
    started.close()


def build_version(version: str, folder: Path) -> Path:
    """The wheel of this commit under another version."""
    clone = folder / "clone"
    subprocess.run(["git", "clone", "-q", "--shared", str(ROOT), str(clone)], check=True, timeout=120)
    for name in ("pyproject.toml", "ubiquity_launches/package.xml"):
        place = clone / name
        place.write_text(set_version(place.read_text(encoding="utf-8"), version), encoding="utf-8")
    return build(folder / "dist", clone)[1]


def build_first_release(folder: Path) -> Path:
    """The wheel of 0.1.0: of its tag, or, before there is one and in a clone without tags, of this commit."""
    clone = folder / "clone"
    subprocess.run(["git", "clone", "-q", "--shared", str(ROOT), str(clone)], check=True, timeout=120)
    subprocess.run(["git", "-C", str(clone), "checkout", "-q", "v0.1.0"], check=False, capture_output=True)
    return build(folder / "dist", clone)[1]


@pytest.mark.ros
def test_upgrade_from_the_first_release_keeps_state_and_renews_environment_and_caches(tmp_path: Path) -> None:
    installed = Installed(build_first_release(tmp_path / "first"), tmp_path)
    before = ROOT / "tests/data/version_0_1_0"
    for source, folder in (("config", ".config"), ("state", ".local/state"), ("share", ".local/share")):
        shutil.copytree(before / source, installed.home / folder, symlinks=True)
    state = {path: path.read_bytes() for path in installed.home.rglob("*") if path.is_file()}
    make_environment(installed.made, "--system-site-packages")
    assert "bob:magni:lidar" in installed.ur("use")
    assert installed.ur("--version").startswith("ur 0.1.0 ")
    launch = installed.home / "a.launch"
    launch.write_text('<launch><arg name="unused"/></launch>\n')
    found = installed.run("ur", "check", str(launch))
    assert found.stdout == installed.run("ur", "check", str(launch)).stdout  # the second one is from the cache
    maps = installed.ur("maps")
    installed.install(build_version("0.1.1", tmp_path / "later"))
    done = installed.run("ur", "use")
    assert (done.returncode, "setting up this computer" in done.stderr) == (0, True), done
    assert "bob:magni:lidar" in done.stdout
    assert installed.ur("--version").startswith("ur 0.1.1 ")
    assert installed.run("ur", "use").stderr == ""
    again = installed.run("ur", "check", str(launch))
    assert (again.returncode, again.stdout) == (found.returncode, found.stdout)
    assert installed.ur("maps") == maps
    assert {path: path.read_bytes() for path in state} == state
    left = [path.name for path in installed.home.rglob("*.ur-new")]
    assert left == []


@pytest.mark.ros
def test_first_start_makes_an_environment_and_an_upgrade_renews_it(
    wheel: Path, tmp_path: Path, session: RosSession
) -> None:
    installed = Installed(wheel, tmp_path)
    before = ROOT / "tests/data/previous_version"
    for source, folder in (("config", ".config"), ("state", ".local/state"), ("share", ".local/share")):
        shutil.copytree(before / source, installed.home / folder)
    state = {path: path.read_bytes() for path in installed.home.rglob("*") if path.is_file()}
    # The locked packages are there already: the set-up fetches nothing.
    make_environment(installed.made, "--system-site-packages")
    done = installed.run("ur", "use")
    assert (done.returncode, "setting up this computer" in done.stderr) == (0, True), done
    assert "bob:magni:lidar" in done.stdout
    assert installed.ur("--version").endswith(f"(wheel in {installed.made})\n")
    assert installed.run("ur", "use").stderr == ""
    network = {name: session.env[name] for name in ("ROS_MASTER_URI", "ROS_HOSTNAME")}
    for environment in (installed.environment, installed.made):
        node = environment / SITE / DATA / "ubiquity_launches/lib/node"
        assert "no.yaml" in installed.run(str(node), "ur_nodes.mapping.map_server_node", "no.yaml", **network).stderr
    assert installed.run(str(installed.made / SITE / DATA / "ubiquity_launches/bin/ur"), "use").stderr == ""
    installed.install(wheel)
    done = installed.run("ur", "use")
    assert "setting up this computer" in done.stderr
    assert "bob:magni:lidar" in done.stdout
    assert {path: path.read_bytes() for path in state} == state
