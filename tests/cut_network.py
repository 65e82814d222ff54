"""Two network namespaces that stand for two computers, joined by a switch whose cable can be pulled. Needs root."""

import contextlib
import os
import shutil
import subprocess
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

ADDRESSES = {"robot": "10.231.7.1", "laptop": "10.231.7.2"}


def can_make_networks() -> bool:
    """Return whether this process may make network namespaces."""
    return os.geteuid() == 0 and all(map(shutil.which, ("ip", "nsenter", "unshare")))


@dataclass(slots=True)
class CutNetwork:
    """Runs programs on either side. `holders` are the processes that keep the namespaces."""

    holders: Mapping[str, subprocess.Popen[bytes]]
    started: list[subprocess.Popen[str]] = field(default_factory=list)

    def start(self, side: str, command: Sequence[str], environment: Mapping[str, str]) -> subprocess.Popen[str]:
        """Start a program on a side, with its output in a pipe."""
        wrapped = ["nsenter", f"--net=/proc/{self.holders[side].pid}/ns/net", "--", *command]
        process = subprocess.Popen(wrapped, env=dict(environment), stdout=subprocess.PIPE, text=True)
        self.started.append(process)
        return process

    def cut(self) -> None:
        """Lose every packet between the sides, without a word to either: as WiFi does."""
        self._on("switch", "ip", "link", "set", "robot", "nomaster")

    def restore(self) -> None:
        """Undo a cut."""
        self._on("switch", "ip", "link", "set", "robot", "master", "switch")

    def close(self) -> None:
        """End everything that runs there."""
        for process in reversed(self.started):
            process.kill()
            process.communicate()
        for holder in self.holders.values():
            holder.kill()
            holder.wait()

    def _on(self, side: str, *command: str) -> None:
        wrapped = ["nsenter", f"--net=/proc/{self.holders[side].pid}/ns/net", "--", *command]
        subprocess.run(wrapped, check=True, capture_output=True, text=True)

    def _join(self, side: str) -> None:
        holder = str(self.holders[side].pid)
        self._on("switch", "ip", "link", "add", side, "type", "veth", "peer", "name", "wlan0", "netns", holder)
        self._on("switch", "ip", "link", "set", side, "master", "switch", "up")
        self._on(side, "ip", "address", "add", f"{ADDRESSES[side]}/24", "dev", "wlan0")
        self._on(side, "ip", "link", "set", "wlan0", "up")
        self._on(side, "ip", "link", "set", "lo", "up")


@contextlib.contextmanager
def cut_network() -> Iterator[CutNetwork]:
    """The two sides, joined."""
    hold = ["unshare", "--net", "--", "sh", "-c", "echo; exec sleep infinity"]
    holders = {side: subprocess.Popen(hold, stdout=subprocess.PIPE) for side in ("switch", *ADDRESSES)}
    network = CutNetwork(holders)
    try:
        for holder in holders.values():
            assert holder.stdout
            holder.stdout.readline()  # it is in its namespace
        network._on("switch", "ip", "link", "add", "switch", "type", "bridge")
        network._on("switch", "ip", "link", "set", "switch", "up")
        for side in ADDRESSES:
            network._join(side)
        yield network
    finally:
        network.close()
