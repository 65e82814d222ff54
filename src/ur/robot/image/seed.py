"""The files of a seed, which configure a robot's first boot: their text, hashes of passwords, host key, and removal."""

import getpass
import hashlib
import json
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

import yaml

from ur.robot.image.layout import SEED_FOLDER, Layout, Scheme, find_layout
from ur.robot.image.volume import Volume, run_tool
from ur.robot.robot_file import ROBOT_FILE
from ur.robot.setup.change import Change
from ur.robot.setup.engine import apply_states
from ur.robot.setup.facts import ComputerFacts, FactsRequest
from ur.robot.setup.keys import known_host
from ur.robot.setup.robot_states import KEEP_NAME, WantedRobot, announcement, robot_file
from ur.robot.setup.wanted import Wanted, WantedFolder
from ur.robot.ssh.guard import private_folder
from ur.robot.ssh.host_key import parse_public_key
from ur.robot.ssh.secret import Secret
from ur.robot.ssh.shell import LocalShell, quote
from ur.source.diagnostic import user_error
from ur.source.foreign.yaml_text import load_yaml

MARK = "# Written by ur image prepare.\n"
_HIDDEN = "(private key, not shown)"
_GROUPS = ("adm", "sudo", "dialout", "video", "plugdev", "input")
_UNIT = "/etc/systemd/system/ubiquity-names.service"
# Replaces cloud-init's `packages`: it does not delay a first boot without internet, and retries until there is one.
_NAMES = """\
# Written by ur image prepare: makes the robot answer to its name, as soon as it has internet to fetch what that needs.
[Unit]
Description=Install what the robot answers to its name with
ConditionPathExists=|!/usr/sbin/avahi-daemon
ConditionPathExists=|!/usr/sbin/sshd
After=network.target

[Service]
Environment=DEBIAN_FRONTEND=noninteractive
ExecStartPre=-/usr/bin/apt-get -q -o DPkg::Lock::Timeout=600 update
ExecStart=/usr/bin/apt-get -q -y --no-install-recommends -o DPkg::Lock::Timeout=600 \\
  install avahi-daemon libnss-mdns openssh-server
TimeoutStartSec=infinity
Restart=on-failure
RestartSec=30

[Install]
WantedBy=multi-user.target
"""


@dataclass(frozen=True, slots=True)
class SeedNetwork:
    """A wireless network: its name, its key as 64 hexadecimal digits ('' for an open one), and its country."""

    network: str
    key: str
    country: str


@dataclass(frozen=True, slots=True)
class HostKeyPair:
    """An ssh host key of type ed25519: the text of its private file, and "ssh-ed25519 AAAA..."."""

    private: str = field(repr=False)
    public: str


@dataclass(frozen=True, slots=True)
class SeedOptions:
    """The desired state of a robot after its first boot.

    `password` is a hash of crypt(3); '' for a user without a password, who may use sudo without one: the ssh key then
    gives root access. With a password, sudo asks for it. `host_key` is the robot's future host key; None: the robot
    generates one itself.
    """

    robot: WantedRobot
    user: str
    keys: tuple[str, ...]
    password: str = ""
    wifi: SeedNetwork | None = None
    timezone: str = ""
    host_key: HostKeyPair | None = None


@dataclass(frozen=True, slots=True)
class SeedFile:
    """A file of the seed: its file system in the image, its path there without a leading slash, and its text."""

    volume: Literal["boot", "root"]
    path: str
    text: str


def make_seed(options: SeedOptions, layout: Layout) -> tuple[SeedFile, ...]:
    """Return the files for an image. Raises UserError if the image does not support the options."""
    if layout.scheme is Scheme.CUSTOM_TOML:
        return (
            SeedFile("boot", "custom.toml", custom_toml(options)),
            SeedFile("root", str(ROBOT_FILE).lstrip("/"), robot_file(options.robot)),
        )
    if options.wifi:
        _check_netplan(layout.netplan, options.wifi.country)
    user_data = user_data_text(options, raspberry=layout.raspberry)
    network = network_text(options.wifi) if options.wifi else ""
    texts = {"user-data": user_data, "meta-data": meta_data_text(user_data + network)}
    if network:
        texts["network-config"] = network
    if layout.scheme is Scheme.ROOT_SEED:
        return tuple(SeedFile("root", f"{SEED_FOLDER}/{name}", text) for name, text in texts.items())
    if layout.raspberry:
        texts["ssh"] = MARK  # its existence starts the ssh server
    return tuple(SeedFile("boot", name, text) for name, text in texts.items())


def user_data_text(options: SeedOptions, *, raspberry: bool = False) -> str:
    """Return cloud-init's user-data: the permitted logins, the host name, and the robot file."""
    name = options.robot.name
    user: dict[str, object] = {
        "name": options.user,
        "gecos": f"User of {name}",
        "groups": list(_GROUPS),
        "shell": "/bin/bash",
        "lock_passwd": not options.password,
        **({"passwd": options.password} if options.password else {"sudo": "ALL=(ALL) NOPASSWD:ALL"}),
        "ssh_authorized_keys": list(options.keys),
    }
    files = (
        (str(ROBOT_FILE), robot_file(options.robot)),
        ("/etc/avahi/services/ubiquity.service", announcement(options.robot, options.user)),
        ("/etc/cloud/cloud.cfg.d/99-ubiquity.cfg", KEEP_NAME),
        (_UNIT, _NAMES),
    )
    pair = options.host_key
    data: dict[str, object] = {
        "hostname": name,
        "preserve_hostname": False,  # for this boot only; the file below keeps the name afterwards
        "manage_etc_hosts": False,
        "ssh_pwauth": False,
        "users": [user],
        **({"ssh_keys": {"ed25519_private": pair.private, "ed25519_public": pair.public}} if pair else {}),
        "write_files": [{"path": path, "content": text, "permissions": "0644"} for path, text in files],
        **({"timezone": options.timezone} if options.timezone else {}),
        "runcmd": [["sh", "-c", line] for line in _first_commands(options, raspberry=raspberry)],
    }
    return f"#cloud-config\n{MARK}{_dump(data)}"


def _first_commands(options: SeedOptions, *, raspberry: bool) -> list[str]:
    name = options.robot.name
    lines = [
        f"sed -i '/^127\\.0\\.1\\.1[[:space:]]/d' /etc/hosts; printf '127.0.1.1\\t%s\\n' {name} >>/etc/hosts",
        "systemctl daemon-reload; systemctl enable --now --no-block ubiquity-names",
        "systemctl enable --now --no-block ssh; systemctl --no-block try-restart avahi-daemon",
    ]
    if raspberry and options.wifi:  # the radio is off until its country is set; NetworkManager does not set it
        country = quote(options.wifi.country)
        lines.append(f"raspi-config nonint do_wifi_country {country}; rfkill unblock wifi; nmcli radio wifi on")
    return lines


def network_text(wifi: SeedNetwork) -> str:
    """Return cloud-init's network-config, version 2, which is netplan's: any wired network, and this wireless one."""
    point = {"password": wifi.key} if wifi.key else {}
    data = {
        "version": 2,
        "ethernets": {"wired": {"match": {"name": "e*"}, "dhcp4": True, "optional": True}},
        "wifis": {
            "wlan0": {
                "dhcp4": True,
                "optional": True,
                "regulatory-domain": wifi.country,
                "access-points": {wifi.network: point},
            }
        },
    }
    return f"{MARK}{_dump(data)}"


def meta_data_text(rest: str) -> str:
    """Return cloud-init's meta-data.

    Another seed is another instance, which a booted robot applies at its next boot.
    """
    identity = hashlib.sha256(rest.encode()).hexdigest()[:16]
    return f"{MARK}dsmode: local\ninstance-id: ur-{identity}\n"


def custom_toml(options: SeedOptions) -> str:
    """Return the file that Raspberry Pi OS 12 reads at its first boot (its init_config). The created user has sudo."""
    sections: list[tuple[str, dict[str, object]]] = [
        ("system", {"hostname": options.robot.name}),
        (
            "user",
            {
                "name": options.user,
                **({"password": options.password, "password_encrypted": True} if options.password else {}),
            },
        ),
        ("ssh", {"enabled": True, "password_authentication": False, "authorized_keys": list(options.keys)}),
    ]
    if options.wifi:
        key = {"password": options.wifi.key, "password_encrypted": True} if options.wifi.key else {}
        sections.append(("wlan", {"ssid": options.wifi.network, **key, "country": options.wifi.country}))
    if options.timezone:
        sections.append(("locale", {"timezone": options.timezone}))
    # Strings, lists and booleans have the same syntax in TOML and JSON.
    parts = (
        f"\n[{name}]\n" + "".join(f"{key} = {json.dumps(value)}\n" for key, value in rows.items())
        for name, rows in sections
    )
    return f"{MARK}config_version = 1\n" + "".join(parts)


def present_password(texts: Sequence[str]) -> str:
    """Return the password hash in the files of an earlier seed; '' if there is none."""
    found = (re.search(r"\$6\$[./A-Za-z0-9]{1,16}\$[./A-Za-z0-9]{86}", text) for text in texts)
    return next((match[0] for match in found if match), "")


def accepts_host_key(layout: Layout) -> bool:
    """Return whether a system uses the host key of a seed: Raspberry Pi OS 12 generates its own at the first boot."""
    return layout.scheme is not Scheme.CUSTOM_TOML


def present_host_key(texts: Sequence[str], name: str) -> HostKeyPair | None:
    """Return the host key in the files of an earlier seed for the robot of this name; None if there is none."""
    for text in texts:
        if MARK not in text or "ed25519_private" not in text:
            continue
        try:
            data = load_yaml(text)
            if data["hostname"] == name:
                return HostKeyPair(str(data["ssh_keys"]["ed25519_private"]), str(data["ssh_keys"]["ed25519_public"]))
        except (ValueError, LookupError, TypeError):
            continue
    return None


def hide_secrets(text: str) -> str:
    """Return the text without password hashes, network keys and private host keys, for display."""
    text = re.sub(r"-----BEGIN [A-Z ]*PRIVATE KEY-----.*?-----END [A-Z ]*PRIVATE KEY-----", _HIDDEN, text, flags=re.S)
    text = re.sub(r"\$(?:6|5|y|1|2[aby])\$[./A-Za-z0-9$=,]+", "(hash, not shown)", text)
    text = re.sub(r"\b[0-9a-fA-F]{64}\b", "(key, not shown)", text)
    return re.sub(r"((?:plain_text_)?(?:passwd|password):\s*)(?!\(|true|false)\S.*", r"\1(not shown)", text)


def _check_netplan(version: str, country: str) -> None:
    found = re.match(r"(?:\d+:)?(\d+)\.(\d+)", version)
    if found and (int(found[1]), int(found[2])) < (0, 105):
        raise user_error(
            f"its netplan {version} knows no country ({country}) for WiFi, expected 0.105 or later",
            rule="old-image",
            help="take a newer image (Ubuntu 22.04.2 or later), or prepare it without --ssid",
        )


class _Dumper(yaml.SafeDumper):
    """A dumper that writes multi-line texts as blocks, for readability."""

    def represent_str(self, text: str) -> yaml.ScalarNode:
        return self.represent_scalar("tag:yaml.org,2002:str", text, style="|" if "\n" in text else None)


_Dumper.add_representer(str, _Dumper.represent_str)


def _dump(data: object) -> str:
    text: str = yaml.dump(data, Dumper=_Dumper, sort_keys=False, allow_unicode=True, width=1000)
    return text


_SALT = re.compile(r"\$6\$([./A-Za-z0-9]{1,16})\$[./A-Za-z0-9]{86}")


def hash_password(password: Secret, salt: str = "") -> str:
    """Return the SHA-512 crypt(3) hash of a login password, with a random salt unless one is given.

    Raises UserError.
    """
    words = ["openssl", "passwd", "-6", "-stdin", *(["-salt", salt] if salt else [])]
    done = run_tool(words, password.reveal().encode() + b"\n")
    hashed = done.stdout.decode().strip()
    if done.returncode or not _SALT.fullmatch(hashed):
        raise user_error("openssl made no hash of the password", rule="bad-password", help="choose another one")
    return hashed


def is_hash_of(hashed: str, password: Secret) -> bool:
    """Return whether a hash, made by `hash_password`, is that of this password."""
    found = _SALT.fullmatch(hashed)
    return found is not None and hash_password(password, found[1]) == hashed


def derive_network_key(password: Secret, network: str) -> str:
    """Return the 64 hexadecimal digits of the WPA2 key for a network's password; 64 such digits are returned unchanged.

    The formula: IEEE 802.11i-2004, annex H.4 (PBKDF2 with HMAC-SHA1, 4096 rounds); wpa_passphrase computes the same.
    Raises UserError for an invalid password.
    """
    text = password.reveal()
    if re.fullmatch(r"[0-9A-Fa-f]{64}", text):
        return text.lower()
    if not 8 <= len(text) <= 63 or not all(" " <= letter <= "~" for letter in text):
        raise user_error(
            f"that cannot be the password of {network}, expected 8 to 63 letters, digits and signs of ASCII",
            rule="bad-password",
            subject=network,
        )
    return hashlib.pbkdf2_hmac("sha1", text.encode(), network.encode(), 4096, 32).hex()


def make_host_key(name: str) -> HostKeyPair:
    """Generate a host key for the robot of this name. Raises UserError."""
    with private_folder() as folder:
        path = folder / "key"
        done = run_tool(["ssh-keygen", "-q", "-t", "ed25519", "-N", "", "-C", f"root@{name}", "-f", str(path)])
        if done.returncode:
            raise user_error("ssh-keygen cannot make a host key", rule="no-key", help="run: ur setup")
        public = parse_public_key(path.with_suffix(".pub").read_text())
        return HostKeyPair(path.read_text(), public.key)


def know_host_key(name: str, pair: HostKeyPair) -> None:
    """Add the public key to this user's known_hosts, in place of an earlier key of a robot with this name."""

    def make(_: ComputerFacts) -> list[Wanted]:
        return [WantedFolder("ssh folder", "~/.ssh", mode=0o700), known_host(f"host key of {name}", name, pair.public)]

    def ignore(_: Change) -> None:
        return None

    user = getpass.getuser()
    apply_states(LocalShell(), make, user, FactsRequest(user), root=False, report=ignore)


ORIGINAL = ".orig"
_SEED_FILES = ("network-config", "ssh", "meta-data", "user-data")  # user-data last: a seed without it is ignored


@dataclass(frozen=True, slots=True)
class Write:
    """A file to write into an image: its present and its future content; None if the file does not exist."""

    volume: Literal["boot", "root"]
    path: str
    before: bytes | None
    after: bytes | None


def seed_places(layout: Layout) -> tuple[tuple[Literal["boot", "root"], str], ...]:
    """Return the paths of all files that a seed may have in such an image, in the order of writing."""
    if layout.scheme is Scheme.CUSTOM_TOML:
        return (("root", str(ROBOT_FILE).lstrip("/")), ("boot", "custom.toml"))
    if layout.scheme is Scheme.ROOT_SEED:
        return tuple(("root", f"{SEED_FOLDER}/{name}") for name in _SEED_FILES if name != "ssh")
    return tuple(("boot", name) for name in _SEED_FILES if name != "ssh" or layout.raspberry)


def read_seed(layout: Layout) -> dict[tuple[str, str], bytes | None]:
    """Read the present state: each path of a seed, and the original file that an earlier seed saved beside it."""
    found: dict[tuple[str, str], bytes | None] = {}
    for volume, path in seed_places(layout):
        for name in (path, path + ORIGINAL):
            found[volume, name] = _volume(layout, volume).read(name)
    return found


def plan_writes(layout: Layout, present: dict[tuple[str, str], bytes | None], seed: Iterable[SeedFile]) -> list[Write]:
    """Plan the files to write for this seed; empty if the seed is already there.

    Original files are kept as NAME.orig.
    """
    wanted = {(file.volume, file.path): file.text.encode() for file in seed}
    return list(_plan(layout, present, wanted))


def _plan(
    layout: Layout,
    present: dict[tuple[str, str], bytes | None],
    wanted: dict[tuple[Literal["boot", "root"], str], bytes],
) -> Iterator[Write]:
    for place in seed_places(layout):
        volume, path = place
        before, original = present[volume, path], present[volume, path + ORIGINAL]
        # A file of an earlier seed that this one lacks: restore the image's original.
        after = wanted.get(place, original if _is_ours(path, before) else before)
        if place in wanted and before not in (None, original) and not _is_ours(path, before):
            yield Write(volume, path + ORIGINAL, original, before)
        if after != before:
            yield Write(volume, path, before, after)
        if place not in wanted and original is not None and _is_ours(path, before):
            yield Write(volume, path + ORIGINAL, original, None)


def plan_undo(layout: Layout, present: dict[tuple[str, str], bytes | None]) -> list[Write]:
    """Plan the changes that remove this project's seed and restore the image's original files."""
    return list(_plan(layout, present, {}))


def write_all(path: Path, writes: Sequence[Write]) -> None:
    """Write files into an image or device. Raises UserError if a file cannot be read back afterwards."""
    layout = find_layout(path)
    for write in writes:
        mode = 0o644 if write.path.endswith(ROBOT_FILE.name) else 0o600  # seeds hold hashes and keys
        _volume(layout, write.volume).write(write.path, write.after, mode)


def _is_ours(path: str, content: bytes | None) -> bool:
    if content is None:
        return False
    head = content[:200].decode(errors="replace")
    return MARK in head or (path.endswith(ROBOT_FILE.name) and "Written by ur" in head)


def _volume(layout: Layout, name: Literal["boot", "root"]) -> Volume:
    volume = layout.boot if name == "boot" else layout.root
    assert volume is not None, "a layout whose scheme has no such file system"
    return volume
