"""Facts about a computer: one shell script, and the parser of its output. Both are pure."""

from __future__ import annotations

import base64
import re
from collections.abc import Mapping
from dataclasses import dataclass, field

from ur.robot.ssh.shell import quote
from ur.source.diagnostic import user_error

_MARK = "\x1e"
# Prints the process that holds a lock of dpkg or apt: proc_locks(5) has its id in column 5, the inode at the end of 6.
APT_USERS = (
    "for i in $(stat -c %i /var/lib/dpkg/lock-frontend /var/lib/dpkg/lock /var/lib/apt/lists/lock 2>/dev/null); do "
    """awk -v i="$i" '{ split($6, a, ":"); if (a[3] == i) print $5 }' /proc/locks; done | """
    "while read -r p; do cat /proc/$p/comm 2>/dev/null; done | head -n 1"
)


@dataclass(frozen=True, slots=True)
class FileState:
    """A file or folder. `text` is None if it does not exist, and '' for a folder; `mode` such as 0o644."""

    text: str | None
    mode: int = 0
    owner: str = ""
    folder: bool = False


ABSENT = FileState(None)


@dataclass(frozen=True, slots=True)
class ServiceState:
    """A systemd unit: systemctl's ActiveState and UnitFileState; '' if there is no such unit."""

    active: str = ""
    enabled: str = ""


@dataclass(frozen=True, slots=True)
class FactsRequest:
    """The facts to read. A path that begins with ~/ lies in the home folder of the user."""

    user: str
    files: frozenset[str] = frozenset()
    packages: frozenset[str] = frozenset()
    services: frozenset[str] = frozenset()

    def __or__(self, other: FactsRequest) -> FactsRequest:
        return FactsRequest(
            self.user, self.files | other.files, self.packages | other.packages, self.services | other.services
        )

    def covers(self, other: FactsRequest) -> bool:
        """Return whether the answer to this request includes all facts of the other one."""
        return (
            self.user == other.user
            and self.files >= other.files
            and self.packages >= other.packages
            and self.services >= other.services
        )


@dataclass(frozen=True, slots=True)
class ComputerFacts:
    """The facts read from a computer.

    `packages` are the versions of installed packages. `system` is the text of os-release. `addresses` are the
    computer's own, of scope global. `boot` is the boot id, which changes with each boot. `apt_user` is the program that
    installs packages at this moment, '' for none.
    """

    user: str
    home: str
    hostname: str
    system: str
    boot: str
    groups: frozenset[str]
    addresses: tuple[str, ...] = ()
    files: Mapping[str, FileState] = field(default_factory=dict)
    packages: Mapping[str, str] = field(default_factory=dict)
    services: Mapping[str, ServiceState] = field(default_factory=dict)
    broken_packages: bool = False
    apt_user: str = ""

    def file(self, path: str) -> FileState:
        """Return the state of a requested file."""
        return self.files[path]

    def resolve(self, path: str) -> str:
        """Return a path with ~/ replaced by the home folder."""
        return self.home + path[1:] if path.startswith("~/") else path


def fact_script(request: FactsRequest) -> str:
    """Return the script that gathers the facts, to be run as root (files of all users) or as the user (own files)."""
    user = quote(request.user)
    parts = [
        f"home=$(getent passwd {user} | cut -d: -f6)",
        f'[ "$(id -un)" != {user} ] || home=$HOME',
        "mark() { printf '\\036%s\\n' \"$1\"; }",
        'mark home; echo "$home"',
        "mark hostname; cat /proc/sys/kernel/hostname",
        "mark system; cat /etc/os-release",
        "mark boot; cat /proc/sys/kernel/random/boot_id",
        f"mark groups; id -nG {user}",
        "mark addresses; ip -brief -4 address show scope global 2>/dev/null",
        'mark broken; dpkg --audit 2>/dev/null; ls /var/lib/dpkg/updates 2>/dev/null | grep "^[0-9]"',
        *(_file_script(path) for path in sorted(request.files)),
    ]
    if request.packages:
        names = quote(*sorted(request.packages))
        parts.append(
            f"mark packages; dpkg-query -W -f='${{db:Status-Status}} ${{Package}} ${{Version}}\\n' {names} 2>/dev/null"
        )
        parts.append(f"mark apt; {APT_USERS}")
    show = "systemctl show -p ActiveState -p UnitFileState"
    parts += [f"mark {quote('service ' + u)}; {show} {quote(u)} 2>/dev/null" for u in sorted(request.services)]
    return "\n".join([*parts, "mark end"])


def _file_script(path: str) -> str:
    place = f'"$home"/{quote(path[2:])}' if path.startswith("~/") else quote(path)
    return (
        f"mark {quote('file ' + path)}; f={place}; "
        'if [ -d "$f" ]; then stat -L -c "%a %U folder" "$f"; '
        'elif [ -e "$f" ]; then stat -L -c "%a %U file" "$f"; base64 -w0 <"$f"; echo; fi'
    )


def parse_facts(request: FactsRequest, output: str) -> ComputerFacts:
    """Parse the output of this request's script. Raises UserError if it is incomplete or invalid."""
    sections: dict[str, str] = {}
    for part in output.split(_MARK)[1:]:
        name, _, text = part.partition("\n")
        sections[name] = text
    try:
        return _read_sections(request, sections)
    except (LookupError, ValueError):
        reported = repr(output.strip()[-80:])
        raise user_error(
            f"the answer of the computer cannot be read, it ends with {reported}; expected facts about it",
            rule="no-facts",
            help="is it the computer that you expect? Run this again; if it persists, report it",
        ) from None


def _read_sections(request: FactsRequest, sections: Mapping[str, str]) -> ComputerFacts:
    if "end" not in sections:
        raise LookupError("end")
    return ComputerFacts(
        user=request.user,
        home=sections["home"].strip(),
        hostname=sections["hostname"].strip(),
        system=sections["system"].strip(),
        boot=sections["boot"].strip(),
        groups=frozenset(sections["groups"].split()),
        addresses=tuple(re.findall(r"\b(\d+\.\d+\.\d+\.\d+)/\d+", sections["addresses"])),
        files={path: _parse_file(sections[f"file {path}"]) for path in request.files},
        packages=dict(_parse_packages(sections.get("packages", ""))),
        services={unit: _parse_service(sections[f"service {unit}"]) for unit in request.services},
        broken_packages=bool(sections["broken"].strip()),
        apt_user=sections.get("apt", "").strip(),
    )


def _parse_file(text: str) -> FileState:
    lines = text.splitlines()
    if not lines:
        return ABSENT
    mode, owner, kind = lines[0].split()
    content = base64.b64decode(lines[1]).decode(errors="surrogateescape") if kind == "file" and len(lines) > 1 else ""
    return FileState(content, int(mode, 8), owner, kind == "folder")


def _parse_packages(text: str) -> list[tuple[str, str]]:
    rows = (line.split() for line in text.splitlines())
    return [(row[1], row[2]) for row in rows if len(row) == 3 and row[0] == "installed"]


def _parse_service(text: str) -> ServiceState:
    pairs = dict(line.split("=", 1) for line in text.splitlines() if "=" in line)
    enabled = pairs.get("UnitFileState", "")
    return ServiceState(pairs.get("ActiveState", "") if enabled else "", enabled)
