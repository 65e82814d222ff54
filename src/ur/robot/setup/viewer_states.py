"""The wanted state of the viewer, the user's computer."""

from collections.abc import Mapping
from pathlib import Path

from ur.robot.setup.environment import viewer_environment
from ur.robot.setup.facts import ComputerFacts, FactsRequest
from ur.robot.setup.keys import HOST_KEY, own_keys
from ur.robot.setup.made import WantedRecord
from ur.robot.setup.packages import WantedPackages, WantedService
from ur.robot.setup.wanted import Wanted, WantedFile, WantedGroups, WantedLine

PACKAGES = (
    *("openssh-client", "openssh-server", "avahi-daemon", "libnss-mdns", "chrony"),
    *("sshfs", "rsync", "xauth", "x11-apps", "bash-completion", "iw", "catkin", "cmake", "g++", "make"),
    "mtools",  # for ur image prepare
    # For ur launch --debug; some releases lack the last one
    *("gdb", "xterm", "python3-pudb", "python3-debugpy|python3-pudb"),
)
GROUPS = ("dialout", "video", "plugdev", "input")
# Folders that bash-completion and fish search by themselves; zsh needs a setting.
COMPLETIONS = {
    "bash": "~/.local/share/bash-completion/completions/ur",
    "fish": "~/.config/fish/completions/ur.fish",
    "zsh": "~/.local/share/zsh/ur.zsh",
}
ZSH_LINE = '[ ! -r "$HOME/.local/share/zsh/ur.zsh" ] || . "$HOME/.local/share/zsh/ur.zsh" # ubiquity_launches'
TIME_SERVER = """\
# Robots without internet take the time from here. Written by ur setup.
local stratum 10
allow 10.0.0.0/8
allow 172.16.0.0/12
allow 192.168.0.0/16
allow 169.254.0.0/16
allow fe80::/10
"""


def base_request(user: str) -> FactsRequest:
    """Return the facts that `wanted_here` needs."""
    return FactsRequest(user, files=frozenset({HOST_KEY}))


def wanted_here(
    facts: ComputerFacts, repository: Path, *, system: bool = True, completion: Mapping[str, str] | None = None
) -> list[Wanted]:
    """Return the viewer's wanted states in the order of their application.

    Without `system`, only those that need no root. `completion` are the completion scripts of `ur`, by the name of the
    shell.
    """
    items: list[Wanted] = []
    if system:
        items += [
            WantedPackages("packages", PACKAGES),
            WantedService("ssh server", "ssh.service"),
            WantedService("names ending in .local", "avahi-daemon.service"),
            WantedFile(
                "time for robots", "/etc/chrony/conf.d/ubiquity.conf", TIME_SERVER, then="systemctl try-restart chrony"
            ),
            WantedService("time", "chrony.service"),
            WantedGroups("groups", GROUPS),
        ]
    items += [
        WantedRecord(),
        *viewer_environment(repository),
        *own_keys(facts.user, facts.hostname, facts.file(HOST_KEY).text),
    ]
    items += [WantedFile(f"Tab in {shell}", COMPLETIONS[shell], text) for shell, text in (completion or {}).items()]
    if completion and "zsh" in completion:
        items.append(WantedLine("zsh reads it", "~/.zshrc", ZSH_LINE))
    return items
