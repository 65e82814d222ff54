"""Small images of the systems that robots run, made and read with the tools of others."""

import re
import shutil
import subprocess
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

import pytest

TOOLS = ("sfdisk", "mkfs.vfat", "mke2fs", "mcopy", "debugfs", "openssl")
MIB = 1 << 20
PATHS = "/usr/local/sbin:/usr/sbin:/sbin:/usr/local/bin:/usr/bin:/bin"
FIRST_BOOT = "console=tty1 root=PARTUUID=4d3f-02 rootwait quiet init=/usr/lib/raspberrypi-sys-mods/firstboot\n"
KEY = "ssh-ed25519 AAAAC3NzaC1lZDI1NTE5AAAAIDpb7pYKzLBSFmtYTHLyB+0ZjI1Zp3q0wcTPFVrfwzI+ pat@laptop"

missing = [tool for tool in TOOLS if shutil.which(tool, path=PATHS) is None]
needs_tools = pytest.mark.skipif(bool(missing), reason=f"not installed: {', '.join(missing)}; run ./test once")


@dataclass(frozen=True)
class Part:
    """A partition of a test image."""

    kind: Literal["fat", "ext", "none"]
    label: str = ""
    files: Mapping[str, str] = field(default_factory=dict)
    size: int = 8


def run(*words: str, stdin: str = "") -> str:
    done = subprocess.run(
        words, input=stdin, capture_output=True, text=True, check=False, env={"PATH": PATHS, "LC_ALL": "C"}
    )
    assert done.returncode == 0, (words, done.stdout, done.stderr)
    return done.stdout


def make_image(path: Path, parts: Sequence[Part], table: Literal["dos", "gpt"] = "dos") -> Path:
    """An image with these partitions, each at least one MiB from the next."""
    start = 1
    rows, offsets = [f"label: {table}\n"], []
    for part in parts:
        kind = {"dos": {"fat": "c", "ext": "83", "none": "83"}, "gpt": {"fat": "U", "ext": "L", "none": "L"}}
        rows.append(f"start={start}MiB, size={part.size}MiB, type={kind[table][part.kind]}\n")
        offsets.append(start)
        start += part.size
    with path.open("wb") as file:
        file.truncate((start + 1) * MIB)
    run("sfdisk", "--quiet", str(path), stdin="".join(rows))
    for offset, part in zip(offsets, parts, strict=True):
        if part.kind != "none":
            content = make_filesystem(path.with_suffix(".part"), part)
            run(
                "dd",
                f"if={content}",
                f"of={path}",
                "bs=64K",
                f"seek={offset * 16}",
                "conv=notrunc,sparse",
                "status=none",
            )
            content.unlink()
    return path


def make_filesystem(path: Path, part: Part) -> Path:
    with path.open("wb") as file:
        file.truncate(part.size * MIB)
    if part.kind == "fat":
        run("mkfs.vfat", "-n", part.label, str(path))
        for name, text in part.files.items():
            run("mcopy", "-i", str(path), "-", f"::/{name}", stdin=text)
        return path
    folder = path.with_suffix(".folder")
    for name, text in part.files.items():
        place = folder / name
        place.parent.mkdir(parents=True, exist_ok=True)
        place.write_text(text)
    folder.mkdir(exist_ok=True)
    run("mke2fs", "-q", "-F", "-t", "ext4", "-L", part.label, "-d", str(folder), str(path))
    shutil.rmtree(folder)
    return path


def os_release(name: str, netplan: str = "") -> dict[str, str]:
    found = re.match(r"(\w+)\D* (\d+(?:\.\d\d)?)", name)
    identity = f'ID={found[1].lower()}\nVERSION_ID="{found[2]}"\n' if found else "ID=x\n"
    files = {"usr/lib/os-release": f'NAME="x"\nPRETTY_NAME="{name}"\n{identity}', "etc/hostname": "old\n"}
    if netplan:
        row = f"Status: install ok installed\nPriority: important\nMaintainer: A B\n <a@b>\nVersion: {netplan}\n"
        files["var/lib/dpkg/status"] = f"Package: bash\nVersion: 5.2\n\nPackage: netplan.io\n{row}\n"
    return files


def make_ubuntu(path: Path, netplan: str = "1.0-2ubuntu1", name: str = "Ubuntu 22.04.5 LTS") -> Path:
    """Ubuntu Server for the Raspberry Pi: its seed is on system-boot."""
    boot = {"user-data": "#cloud-config\npassword: ubuntu\n", "meta-data": "instance_id: cloud-image\n"}
    boot |= {"network-config": "version: 2\n", "cmdline.txt": "root=LABEL=writable\n", "config.txt": "[all]\n"}
    root = os_release(name, netplan)
    return make_image(path, [Part("fat", "system-boot", boot), Part("ext", "writable", root)])


def make_raspberry(path: Path) -> Path:
    """Raspberry Pi OS 13, with cloud-init."""
    boot = {"user-data": "# nothing\n", "meta-data": "instance_id: rpios-image\n", "network-config": "# nothing\n"}
    boot |= {"cmdline.txt": "console=tty1 resize\n", "config.txt": "[all]\n", "issue.txt": "Raspberry Pi reference\n"}
    return make_image(
        path, [Part("fat", "bootfs", boot), Part("ext", "rootfs", os_release("Debian GNU/Linux 13 (trixie)"))]
    )


def make_old_raspberry(path: Path, command: str = FIRST_BOOT) -> Path:
    """Raspberry Pi OS 12."""
    boot = {"cmdline.txt": command, "config.txt": "[all]\n", "issue.txt": "Raspberry Pi reference\n"}
    return make_image(
        path, [Part("fat", "bootfs", boot), Part("ext", "rootfs", os_release("Debian GNU/Linux 12 (bookworm)"))]
    )


def make_cloud(path: Path) -> Path:
    """A cloud image, as raw disk: boots by UEFI, the system is its first partition and lies behind others."""
    root = os_release("Debian GNU/Linux 12 (bookworm)") | {"etc/cloud/cloud.cfg": "datasource_list: [NoCloud]\n"}
    parts = [Part("none", size=1), Part("fat", "UEFI", {"startup.nsh": "x\n"}), Part("ext", "root", root, 16)]
    return make_image(path, parts, "gpt")


BOOT, CLOUD_ROOT, PI_ROOT = 1, 10, 9
"""Where partitions of these images begin, in MiB."""


def read_fat(path: Path, name: str) -> str:
    return run("mtype", "-i", f"{path}@@{BOOT}M", f"::/{name}")


def list_fat(path: Path) -> set[str]:
    return {line.removeprefix("::/") for line in run("mdir", "-b", "-i", f"{path}@@{BOOT}M", "::/").split()}


def read_ext(path: Path, name: str, start: int) -> str:
    return run("debugfs", "-R", f"cat /{name}", f"{path}?offset={start * MIB}")


def check_filesystems(path: Path, ext_start: int, ext_size: int) -> None:
    """Both kinds of file system are sound, say their own checkers."""
    copy = path.with_suffix(".check")
    with path.open("rb") as file:
        file.seek(ext_start * MIB)
        copy.write_bytes(file.read(ext_size * MIB))
    run("e2fsck", "-f", "-n", str(copy))
    copy.unlink()


def check_fat(path: Path, size: int = 8) -> None:
    copy = path.with_suffix(".check")
    with path.open("rb") as file:
        file.seek(BOOT * MIB)
        copy.write_bytes(file.read(size * MIB))
    run("fsck.vfat", "-n", str(copy))
    copy.unlink()
