"""A small /sys, /dev and /proc of a robot's computer, for the inspection of devices."""

import os
import shutil
from pathlib import Path

from ur.devices.observe import device_script
from ur.robot.ssh.secret import Secret
from ur.robot.ssh.shell import LocalShell, ShellResult


class Tree:
    """Folders `sys`, `dev` and `proc` below a root, to which devices are added."""

    def __init__(self, root: Path) -> None:
        self.root = root
        for name in ("sys/class/tty", "sys/bus/usb/devices", "dev", "proc"):
            (root / name).mkdir(parents=True)

    def plug(
        self,
        port: str,
        usb: str,
        *,
        serial: str = "",
        product: str = "",
        tty: str = "",
        video: str = "",
        name: str = "",
    ) -> None:
        """Plug in a USB device, which the kernel shows as a serial device or a camera, or as neither."""
        folder = self.root / "sys/devices/usb1" / port
        interface = folder / f"{port}:1.0"
        interface.mkdir(parents=True)
        vendor, _, number = usb.partition(":")
        texts = {"idVendor": vendor, "idProduct": number, "busnum": "1", "devnum": port[-1], "bDeviceClass": "00"}
        for key, text in {**texts, "serial": serial, "product": product}.items():
            if text:
                (folder / key).write_text(f"{text}\n")
        (self.root / "sys/bus/usb/devices" / port).symlink_to(folder)
        if tty:
            self._show(interface, "tty", tty)
            (interface / "driver").symlink_to("/sys/bus/usb/drivers/cp210x")
        if video:
            self._show(interface, "video4linux", video, name=name, index="0")

    def unplug(self, port: str, tty: str) -> None:
        """Unplug a serial device, after its stand-in."""
        (self.root / "sys/class/tty" / tty).unlink()
        (self.root / "sys/bus/usb/devices" / port).unlink()
        shutil.rmtree(self.root / "sys/devices/usb1" / port)

    def add_chip(self, name: str) -> None:
        """Add a GPIO chip of the board itself."""
        folder = self.root / "sys/bus/gpio/devices" / name
        folder.mkdir(parents=True)
        (self.root / "dev" / name).touch()

    def solder(self, tty: str, *, kind: str = "32") -> None:
        """Add a serial port of the board itself."""
        folder = self.root / "sys/devices/platform" / tty
        folder.mkdir(parents=True)
        self._show(folder, "tty", tty, type=kind)

    def link(self, name: str, target: str) -> None:
        """Add another name below dev."""
        path = self.root / "dev" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.symlink_to(os.path.relpath(self.root / "dev" / target, path.parent))

    def open(self, pid: int, program: str, path: str, words: str = "") -> None:
        """Add a process that has a device open ('' for none that can be seen)."""
        folder = self.root / "proc" / str(pid)
        (folder / "fd").mkdir(parents=True)
        (folder / "comm").write_text(f"{program}\n")
        (folder / "cmdline").write_bytes(words.replace(" ", "\0").encode())
        if path:
            (folder / "fd/5").symlink_to(path)

    def _show(self, parent: Path, group: str, node: str, /, **texts: str) -> None:
        folder = parent / group / node
        folder.mkdir(parents=True)
        (folder / "device").symlink_to(parent)
        for key, text in texts.items():
            (folder / key).write_text(f"{text}\n")
        (self.root / "sys/class" / group).mkdir(exist_ok=True)
        (self.root / "sys/class" / group / node).symlink_to(folder)
        (self.root / "dev" / node).write_text("")


class TreeShell:
    """A shell of the computer of a tree: scripts that look at devices or ask them see only those."""

    destination = "the computer of the tree"

    def __init__(self, tree: Tree) -> None:
        self._root = str(tree.root)

    def run(self, script: str, *, root: bool = False, stdin: str | Secret = "", timeout: float = 60.0) -> ShellResult:
        inside = (
            device_script(self._root) if script == device_script() else script.replace('"/dev/', f'"{self._root}/dev/')
        )
        done = LocalShell().run(inside, root=root, stdin=stdin, timeout=timeout)
        return ShellResult(done.code, done.out.replace(self._root, ""), done.err.replace(self._root, ""))
