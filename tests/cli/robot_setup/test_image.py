import lzma
import os
import shutil
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest
import yaml
from tests.forking import python_of_ur
from tests.robot.image.images import (
    CLOUD_ROOT,
    KEY,
    PATHS,
    list_fat,
    make_cloud,
    make_ubuntu,
    needs_tools,
    read_ext,
    read_fat,
)

from ur.robot.discovery.record import RobotRecord, load_records
from ur.robot.ssh.host_key import HostKey

pytestmark = needs_tools
REPOSITORY = Path(__file__).parents[3]
UR = (sys.executable, "-m", "ur", "image", "prepare")


class Place:
    """A folder with an image, a key, and a home folder for what `ur` remembers."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.image = make_ubuntu(folder / "ubuntu.img")
        (folder / "key.pub").write_text(f"{KEY}\n")
        (folder / "home").mkdir()

    def run(self, *words: str, stdin: str = "\n\n", code: int = 0, user: tuple[str, ...] = ()) -> tuple[str, str]:
        environment = {"HOME": str(self.folder / "home"), "PATH": os.environ.get("PATH", PATHS), "LC_ALL": "C.UTF-8"}
        given, arguments = stdin.encode(), ("image", "prepare", *words)
        if user:
            command = (*user, *UR, *words)
            done = subprocess.run(
                command, cwd=self.folder, env=environment, input=given, capture_output=True, check=False, timeout=120
            )
        else:
            done = python_of_ur().run("ur", *arguments, folder=self.folder, environment=environment, given=given)
        out, errors = done.stdout.decode(), done.stderr.decode()
        assert done.returncode == code, (out, errors)
        assert "Traceback" not in errors
        return out, errors

    def prepare(self, *words: str, stdin: str = "\n\n", code: int = 0, user: tuple[str, ...] = ()) -> tuple[str, str]:
        who = ("--name", "bob", "--base", "magni", "--key", "key.pub", "--passwords-from", "0")
        return self.run(*who, *words, stdin=stdin, code=code, user=user)

    @property
    def names(self) -> set[str]:
        return {each.name for each in self.folder.iterdir()} - {"key.pub", "home"}


@pytest.fixture
def place(tmp_path: Path) -> Place:
    return Place(tmp_path)


def test_image_is_prepared_and_its_robot_is_remembered(place: Place) -> None:
    out, _ = place.prepare("ubuntu.img", "--ssid", "home", "--country", "de", stdin="secret\nwifi-secret\n")
    assert "ubuntu.img: Ubuntu 22.04.5 LTS\n" in out
    assert "then: ur robot setup ros@bob.local --name bob --base magni" in out
    data = yaml.safe_load(read_fat(place.image, "user-data"))
    assert data["users"][0]["ssh_authorized_keys"] == [KEY]
    assert load_records(place.folder / "home/.config/ubiquity_launches/robots") == [RobotRecord("bob", "ros", "magni")]
    assert place.names == {"ubuntu.img"}
    public = data["ssh_keys"]["ed25519_public"]
    assert (place.folder / "home/.ssh/known_hosts").read_text() == f"bob.local,bob {public}\n"
    assert f"its host key is {HostKey(public).fingerprint}" in out
    assert "only you can read this file: it holds the robot's host key and hashes of its passwords\n" in out
    assert place.image.stat().st_mode & 0o777 == 0o600
    before = place.image.stat().st_mtime_ns
    place.image.chmod(0o644)  # as earlier versions left it
    out, _ = place.prepare("ubuntu.img", "--ssid", "home", "--country", "de", stdin="secret\nwifi-secret\n")
    assert "nothing to do: it is prepared for bob\n" in out
    assert place.image.stat().st_mtime_ns == before
    assert place.image.stat().st_mode & 0o777 == 0o600


def test_passwords_are_nowhere_but_hashed(place: Place) -> None:
    """Neither in what other programs are started with, nor in the image, nor on the screen, nor in the home folder."""
    shims, log = place.folder / "home/bin", place.folder / "home/log"
    shims.mkdir()
    for tool in ("openssl", "mcopy", "mdir", "mdel", "mren", "debugfs"):
        real = shutil.which(tool, path=PATHS)
        (shims / tool).write_text(f'#!/bin/sh\necho "$0 $*" >>{log}\nenv >>{log}\nexec {real} "$@"\n')
        (shims / tool).chmod(0o755)
    before = os.environ["PATH"]
    os.environ["PATH"] = f"{shims}:{before}"
    try:
        words = ("ubuntu.img", "--ssid", "home", "--country", "DE")
        said = [
            *place.prepare(*words, stdin="my-secret-1\nmy-secret-2\n"),
            *place.prepare(*words, "--dry-run", stdin="my-secret-3\nmy-secret-4\n"),
        ]
    finally:
        os.environ["PATH"] = before
    assert "openssl passwd" in log.read_text()
    assert "my-secret" not in "".join(said) + log.read_text()
    assert "PRIVATE KEY-----" not in "".join(said) + log.read_text()
    assert "/user-data: another password (not shown)" in said[2]
    for path in place.folder.rglob("*"):
        assert not path.is_file() or b"my-secret" not in path.read_bytes()


def test_dry_run_shows_differences_and_changes_nothing(place: Place) -> None:
    content = place.image.read_bytes()
    out, _ = place.prepare("ubuntu.img", "--dry-run")
    assert "-password: (not shown)" in out
    assert "+hostname: bob" in out
    assert place.image.read_bytes() == content
    assert not (place.folder / "home/.config").exists()


def test_undo_takes_the_seed_away(place: Place) -> None:
    place.prepare("ubuntu.img")
    out, _ = place.run("ubuntu.img", "--undo")
    assert "reverted" in out
    assert read_fat(place.image, "user-data") == "#cloud-config\npassword: ubuntu\n"
    assert list_fat(place.image) == {"user-data", "meta-data", "network-config", "cmdline.txt", "config.txt"}


def test_compressed_image_needs_a_place_and_stays_as_it_is(place: Place) -> None:
    packed = place.folder / "ubuntu.img.xz"
    packed.write_bytes(lzma.compress(place.image.read_bytes(), preset=0))
    content = packed.read_bytes()
    place.image.unlink()
    _, err = place.prepare("ubuntu.img.xz", code=2)
    assert "help: add --output ubuntu.img\n" in err
    assert place.names == {"ubuntu.img.xz"}
    place.prepare("ubuntu.img.xz", "--output", "ubuntu.img")
    assert "hostname: bob\n" in read_fat(place.image, "user-data")
    assert packed.read_bytes() == content
    _, err = place.prepare("ubuntu.img.xz", "--output", "ubuntu.img", code=2)
    assert "is there already" in err


def test_one_image_makes_several_robots(place: Place) -> None:
    robots = "".join(f"- {{name: {name}, base: magni, output: {name}.img}}\n" for name in ("bob", "eve"))
    (place.folder / "home/robots.yaml").write_text(f"robots:\n{robots}")
    place.run("ubuntu.img", "--from", "home/robots.yaml", "--key", "key.pub", "--passwords-from", "0")
    for name in ("bob", "eve"):
        assert f"hostname: {name}\n" in read_fat(place.folder / f"{name}.img", "user-data")
    assert read_fat(place.image, "user-data") == "#cloud-config\npassword: ubuntu\n"


def test_link_to_an_image_stays_a_link(place: Place) -> None:
    (place.folder / "latest.img").symlink_to("ubuntu.img")
    place.prepare("latest.img")
    assert (place.folder / "latest.img").is_symlink()
    assert "hostname: bob\n" in read_fat(place.image, "user-data")


@pytest.mark.parametrize("point", ["find_layout", "write_all", "fsync"])
def test_killed_anywhere_the_image_is_as_it_was(place: Place, point: str) -> None:
    """Killed while it is looked into, before it is written, and when the written copy is to take its place."""
    content = place.image.read_bytes()
    where = {"find_layout": "ur.cli.robot_setup.image", "write_all": "ur.cli.robot_setup.image", "fsync": "os"}[point]
    program = (
        f"import os, signal, sys, {where}; {where}.{point} = lambda *_: os.kill(os.getpid(), signal.SIGKILL); "
        "from ur.cli.main import main; main(sys.argv[1:])"
    )
    words = ("image", "prepare", "ubuntu.img", "--name", "bob", "--base", "magni", "--key", "key.pub")
    environment = {"HOME": str(place.folder / "home"), "PATH": os.environ["PATH"]}
    done = subprocess.run(
        [sys.executable, "-c", program, *words],
        cwd=place.folder,
        env=environment,
        check=False,
        stdin=subprocess.DEVNULL,
    )
    assert done.returncode == -signal.SIGKILL
    assert place.image.read_bytes() == content
    place.prepare("ubuntu.img")
    assert place.names == {"ubuntu.img"}


@pytest.fixture
def shared() -> Iterator[Path]:
    """A folder that belongs to nobody, the user."""
    folder = Path(tempfile.mkdtemp(prefix="ur-", dir="/tmp"))
    yield folder
    shutil.rmtree(folder)


@pytest.mark.skipif(os.geteuid() != 0, reason="only root can become an ordinary user")
def test_ordinary_user_prepares_images_of_both_kinds(shared: Path) -> None:
    place = Place(shared)
    make_cloud(shared / "cloud.img")
    for path in (shared, *shared.rglob("*")):
        shutil.chown(path, "nobody")
    if subprocess.run(["runuser", "-u", "nobody", "--", *UR, "--help"], capture_output=True, check=False).returncode:
        pytest.skip("this repository is for root alone")
    for name in ("ubuntu.img", "cloud.img"):
        place.prepare(name, user=("runuser", "-u", "nobody", "--", "env", f"HOME={shared}/home"))
    assert "hostname: bob\n" in read_fat(place.image, "user-data")
    seed = read_ext(shared / "cloud.img", "var/lib/cloud/seed/nocloud/user-data", CLOUD_ROOT)
    assert "hostname: bob\n" in seed
    assert (shared / "cloud.img").owner() == "nobody"


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("nothing.img",), "nothing.img: not found"),
        (("noble.img",), "noble.img: Ubuntu 24.04.3 LTS does not package ROS 1, expected Debian 12 or 13"),
        (("key.pub",), "key.pub: a text, expected an image of Ubuntu"),
        (("ubuntu.img", "--name", "Bob!"), "'Bob!' cannot be the robot's name"),
        (("ubuntu.img", "--base", "magna"), "magna"),
        (("ubuntu.img", "--user", "root"), "'root' cannot be its user"),
        (("ubuntu.img", "--key", "nothing.pub"), "nothing.pub: cannot be read: no such file or directory"),
        (("ubuntu.img", "--key", "home/private"), "home/private is a private key, expected the public half"),
        (("ubuntu.img", "--ssid", "home"), "country"),
        (("ubuntu.img", "--ssid", "home", "--country", "Germany"), "'GERMANY' is not a country"),
        (("ubuntu.img", "--ssid", "x" * 33, "--country", "DE"), "cannot be the name of a WiFi network"),
        (("ubuntu.img", "--timezone", "Mars"), "'Mars' is not a time zone"),
        (("ubuntu.img", "--undo"), "--undo"),
        (("ubuntu.img", "--output", "nowhere/x.img"), "cannot be written"),
    ],
)
def test_wrong_input_is_one_line_and_leaves_the_image_alone(place: Place, words: tuple[str, ...], said: str) -> None:
    if "noble.img" in words:
        make_ubuntu(place.folder / "noble.img", name="Ubuntu 24.04.3 LTS")
    (place.folder / "home/private").write_text("-----BEGIN OPENSSH PRIVATE KEY-----\n")
    content = place.image.read_bytes()
    out, err = place.prepare(*words, code=2)
    assert said in err
    assert err.count("error: ") == 1
    assert "prepared" not in out
    assert place.image.read_bytes() == content
    assert place.names - {"noble.img"} == {"ubuntu.img"}


def test_short_wifi_password_is_refused(place: Place) -> None:
    _, err = place.prepare("ubuntu.img", "--ssid", "home", "--country", "DE", stdin="\nshort\n", code=2)
    assert "cannot be the password of home, expected 8 to 63" in err
    assert "short" not in err


def test_what_is_missing_is_named_where_nobody_can_be_asked(place: Place) -> None:
    _, err = place.run("ubuntu.img", "--key", "key.pub", code=2)
    assert "give --name" in err
    who = ("--name", "bob", "--base", "magni", "--key", "key.pub", "--ssid", "home")
    _, err = place.run("ubuntu.img", *who, code=2)
    assert "give --country" in err
    _, err = place.run("ubuntu.img", *who, "--country", "DE", code=2)
    assert "give --passwords-from FD" in err


@pytest.fixture
def card(place: Place) -> Iterator[str]:
    """A device that holds the image, as a card in a reader does."""
    done = subprocess.run(
        ["losetup", "--find", "--show", str(place.image)], capture_output=True, text=True, check=False
    )
    if done.returncode:
        pytest.skip(f"no loop device: {done.stderr.strip()}")
    device = done.stdout.strip()
    yield device
    subprocess.run(["losetup", "--detach", device], check=True)


@pytest.mark.skipif(os.geteuid() != 0, reason="only root makes loop devices")
def test_device_is_written_in_place_and_only_when_that_is_wished(place: Place, card: str) -> None:
    content = place.image.read_bytes()
    _, err = place.prepare(card, code=2)
    assert f"write 4 files onto {card} (no model name, 0.0 GB)?" in err
    assert "give --yes" in err
    assert place.image.read_bytes() == content
    place.prepare(card, "--yes")
    assert "hostname: bob\n" in read_fat(place.image, "user-data")
    out, _ = place.prepare(card)
    assert "nothing to do" in out
    place.run(card, "--undo", "--yes")
    assert read_fat(place.image, "user-data") == "#cloud-config\npassword: ubuntu\n"


def test_tab_offers_what_there_is_and_files() -> None:
    for line, offered in (("ur image ", "prepare"), ("ur image prepare READ", "README.md")):
        done = subprocess.run(
            [sys.executable, "-m", "ur", "__complete", "bash", line],
            cwd=REPOSITORY,
            capture_output=True,
            text=True,
            check=True,
        )
        assert offered in done.stdout
