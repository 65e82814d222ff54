"""Settings of `ur image prepare`, from options, a file or questions, and their validation."""

import getpass
import re
import socket
import sys
from dataclasses import dataclass, replace
from pathlib import Path

import click

from ur.cli.answers import ask_twice, read_lines
from ur.request.environment import PACKAGE
from ur.robot.base import list_bases, load_base
from ur.robot.discovery.record import DEFAULT_USER
from ur.robot.image.hashes import derive_network_key, hash_password, is_hash_of
from ur.robot.image.seed import SeedNetwork, SeedOptions
from ur.robot.setup.robot_states import WantedRobot, is_robot_name
from ur.robot.ssh.secret import Secret
from ur.source.diagnostic import UserError, error, error_about
from ur.source.section import read_section

_KEY = re.compile(r"(ssh-ed25519|ssh-rsa|ecdsa-sha2-\S+|sk-\S+) [A-Za-z0-9+/]+=*( .*)?")
_USER = re.compile(r"[a-z][a-z0-9-]{0,31}")  # accepted by userconf of Raspberry Pi OS; cloud-init accepts more
_ZONES = Path("/usr/share/zoneinfo")


@dataclass(frozen=True, slots=True)
class Given:
    """The values of options; None for those that are not given."""

    name: str | None
    base: str | None
    variant: str | None
    user: str | None
    key: str | None
    ssid: str | None
    country: str | None
    timezone: str | None


@dataclass(frozen=True, slots=True)
class Passwords:
    """The passwords of the user and of the WiFi; None for none."""

    user: Secret | None
    wifi: Secret | None


def read_robots(path: Path, given: Given) -> list[tuple[Given, Path | None]]:
    """Read the robots of a file, each with the path of its image. Raises UserError."""
    top = read_section(path, "a file of robots")
    found: list[tuple[Given, Path | None]] = []
    for item in top.sections("robots"):
        robot = replace(
            given,
            name=item.text("name"),
            base=item.text("base"),
            variant=item.text("variant", given.variant or ""),
            user=item.text("user", given.user or DEFAULT_USER),
        )
        found.append((robot, Path(item.text("output"))))
        item.finish()
    top.finish()
    if not found:
        raise UserError(error_about(path, "no robots, expected a list 'robots'", rule="bad-value"))
    values = [str(each.name) for each, _ in found] + [str(output) for _, output in found]
    twice = next((value for value in values if values.count(value) > 1), None)
    if twice is not None:
        raise UserError(error_about(path, f"{twice} is there twice, expected once", rule="bad-value"))
    return found


def make_options(given: Given) -> SeedOptions:
    """Return the settings of the robot, without its passwords.

    Asks for name, base and country if they are not given and there is a terminal. Raises UserError.
    """
    name = given.name or _ask("name", "name of the robot")
    user = given.user or DEFAULT_USER
    if not is_robot_name(name) or name in (socket.gethostname().split(".")[0], "localhost", "sim"):
        expected = "expected up to 63 lower case letters, digits and -, and no name of another computer"
        raise _bad(f"{name!r} cannot be the robot's name", expected)
    if not _USER.fullmatch(user) or user == "root":
        raise _bad(f"{user!r} cannot be its user", "expected lower case letters, digits and -, and not root")
    base = given.base or _ask("base", f"base of {name} ({', '.join(list_bases(PACKAGE))})")
    variant = given.variant or ""
    load_base(PACKAGE, base, variant)
    return SeedOptions(
        WantedRobot(name, base, variant),
        user,
        _read_keys(given.key),
        wifi=_wifi(given) if given.ssid else None,
        timezone=_check_zone(given.timezone),
    )


def read_passwords(options: SeedOptions, descriptor: int | None) -> Passwords:
    """Read passwords from a descriptor, or without echo from a terminal. Raises UserError."""
    user = wifi = ""
    if descriptor is not None:
        user, wifi = read_lines(descriptor, "--passwords-from", 2, close=False)
    elif sys.stdin.isatty():
        user = ask_twice(f"password of {options.user} (empty: none, the key alone)")
        if options.wifi:
            wifi = getpass.getpass(f"password of the WiFi {options.wifi.network} (empty: it is open): ")
    elif options.wifi:
        raise _missing(f"the password of {options.wifi.network}", "passwords-from FD")
    return Passwords(Secret(user) if user else None, Secret(wifi) if wifi else None)


def add_passwords(options: SeedOptions, passwords: Passwords, present: str) -> SeedOptions:
    """Return the settings with hashes in place of passwords. Raises UserError for an invalid one.

    `present` is the hash of an earlier seed: kept if it is of the same password, since each new hash differs.
    """
    password, wifi = "", options.wifi
    if passwords.user:
        kept = present and is_hash_of(present, passwords.user)
        password = present if kept else hash_password(passwords.user)
    if wifi and passwords.wifi:
        wifi = replace(wifi, key=derive_network_key(passwords.wifi, wifi.network))
    return replace(options, password=password, wifi=wifi)


def _wifi(given: Given) -> SeedNetwork:
    network = given.ssid or ""
    if len(network.encode()) > 32 or not network.isprintable():
        raise _bad(f"{network!r} cannot be the name of a WiFi network", "expected up to 32 bytes that can be printed")
    country = (given.country or _ask("country", "country, as two letters")).upper()
    if not re.fullmatch(r"[A-Z]{2}", country):
        raise _bad(f"{country!r} is not a country", "expected two letters, for instance DE (ISO 3166-1)")
    return SeedNetwork(network, "", country)


def _read_keys(given: str | None) -> tuple[str, ...]:
    path = Path(given) if given else Path.home() / ".ssh/id_ed25519.pub"
    help = "run: ur setup; or give --key FILE"
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as problem:
        reason = (getattr(problem, "strerror", "") or "not a text").lower()
        raise UserError(
            error_about(path, f"cannot be read: {reason}, expected a key", rule="no-key", help=help)
        ) from None
    keys = tuple(line.strip() for line in lines if line.strip() and not line.startswith("#"))
    if any("PRIVATE KEY" in key for key in keys):
        raise UserError(
            error(
                f"{path} is a private key, expected the public half",
                rule="no-key",
                help=f"give --key {path}.pub",
                subject=str(path),
            )
        )
    if not keys or not all(_KEY.fullmatch(key) for key in keys):
        raise UserError(
            error(f"{path} holds no public ssh key, expected one a line", rule="no-key", help=help, subject=str(path))
        )
    return keys


def _check_zone(zone: str | None) -> str:
    known = zone is None or re.fullmatch(r"[A-Za-z0-9_+-]+(/[A-Za-z0-9_+-]+)*", zone) is not None
    if not known or (zone and _ZONES.is_dir() and not (_ZONES / zone).is_file()):
        raise _bad(f"{zone!r} is not a time zone", "expected one such as Europe/Berlin (timedatectl list-timezones)")
    return zone or ""


def _ask(option: str, what: str) -> str:
    if not sys.stdin.isatty():
        raise _missing(what, option)
    answer: str = click.prompt(what)
    return answer


def _missing(what: str, option: str) -> UserError:
    return UserError(
        error(
            f"{what} is not given, and there is no terminal to ask on", rule="missing-answer", help=f"give --{option}"
        )
    )


def _bad(message: str, expected: str) -> UserError:
    return UserError(error(f"{message}, {expected}", rule="bad-value"))
