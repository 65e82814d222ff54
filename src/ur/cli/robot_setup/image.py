"""`ur image`: images whose first boot makes the robot reachable."""

import getpass
import os
import re
import signal
import socket
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass, replace
from pathlib import Path

import click

from ur.cli.changing import show_changes
from ur.cli.output import ask_twice, read_lines
from ur.request.programs import PACKAGE
from ur.robot.base import list_bases, load_base
from ur.robot.discovery.record import DEFAULT_USER, RobotRecord, records_folder, render_record
from ur.robot.image.copy import copied_image, packing_of
from ur.robot.image.device import DiskDevice, check_device, is_device
from ur.robot.image.layout import find_layout
from ur.robot.image.seed import (
    SeedNetwork,
    SeedOptions,
    Write,
    accepts_host_key,
    derive_network_key,
    hash_password,
    hide_secrets,
    is_hash_of,
    know_host_key,
    make_host_key,
    make_seed,
    plan_undo,
    plan_writes,
    present_host_key,
    present_password,
    read_seed,
    write_all,
)
from ur.robot.image.volume import run_tool
from ur.robot.setup.change import Change, show_difference
from ur.robot.setup.robot_states import WantedRobot, is_robot_name
from ur.robot.ssh.host_key import HostKey
from ur.robot.ssh.secret import Secret
from ur.source.diagnostic import UserError, user_error, user_error_about
from ur.source.progress_line import show_progress
from ur.source.replace import check_output, replace_file
from ur.source.section import read_section
from ur.system.releases import check_robot_system

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
        raise user_error_about(path, "no robots, expected a list 'robots'", rule="bad-value")
    values = [str(each.name) for each, _ in found] + [str(output) for _, output in found]
    twice = next((value for value in values if values.count(value) > 1), None)
    if twice is not None:
        raise user_error_about(path, f"{twice} is there twice, expected once", rule="bad-value")
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
    zone = given.timezone
    known = zone is None or re.fullmatch(r"[A-Za-z0-9_+-]+(/[A-Za-z0-9_+-]+)*", zone) is not None
    if not known or (zone and _ZONES.is_dir() and not (_ZONES / zone).is_file()):
        raise _bad(f"{zone!r} is not a time zone", "expected one such as Europe/Berlin (timedatectl list-timezones)")
    return SeedOptions(
        WantedRobot(name, base, variant),
        user,
        _read_keys(given.key),
        wifi=_wifi(given) if given.ssid else None,
        timezone=(zone or ""),
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
        raise user_error_about(path, f"cannot be read: {reason}, expected a key", rule="no-key", help=help) from None
    keys = tuple(line.strip() for line in lines if line.strip() and not line.startswith("#"))
    if any("PRIVATE KEY" in key for key in keys):
        raise user_error(
            f"{path} is a private key, expected the public half",
            rule="no-key",
            help=f"give --key {path}.pub",
            subject=str(path),
        )
    if not keys or not all(_KEY.fullmatch(key) for key in keys):
        raise user_error(
            f"{path} holds no public ssh key, expected one a line", rule="no-key", help=help, subject=str(path)
        )
    return keys


def _ask(option: str, what: str) -> str:
    if not sys.stdin.isatty():
        raise _missing(what, option)
    answer: str = click.prompt(what)
    return answer


def _missing(what: str, option: str) -> UserError:
    return user_error(
        f"{what} is not given, and there is no terminal to ask on", rule="missing-answer", help=f"give --{option}"
    )


def _bad(message: str, expected: str) -> UserError:
    return user_error(f"{message}, {expected}", rule="bad-value")


@click.group("image", invoke_without_command=True)
@click.pass_context
def command(context: click.Context) -> None:
    """Prepare images for the first boot of robots."""
    if context.invoked_subcommand is None:
        from ur.cli.help import show_help

        show_help(["image"])


@command.command("prepare")
@click.argument("image", metavar="IMAGE|DEVICE")
@click.option("--output", help="Write the prepared image here, and leave IMAGE unchanged; needed for compressed ones.")
@click.option("--name", help="The robot's name; it will answer to NAME.local.")
@click.option("--base", help="The base of the robot.")
@click.option("--variant", help="The variant of the base.")
@click.option("--user", help="The user that is created.  [default: ros]")
@click.option("--key", help="The public key that may log in.  [default: ~/.ssh/id_ed25519.pub]")
@click.option("--ssid", help="The WiFi network that it joins; without one, it needs a cable.")
@click.option("--country", help="The country, as two letters: the permitted WiFi channels depend on it.")
@click.option("--timezone", help="For instance Europe/Berlin.  [default: the image's]")
@click.option("--from", "file", help="A file that names robots: one image is written for each.")
@click.option(
    "--passwords-from",
    type=int,
    metavar="FD",
    help="Read the user's password and that of the WiFi, a line each, from this file descriptor.",
)
@click.option("--dry-run", is_flag=True, help="Show what would be written, and write nothing.")
@click.option("--undo", is_flag=True, help="Remove the seed and restore the image's own files.")
@click.option("--yes", is_flag=True, help="Do not ask before writing to a device.")
def prepare(
    image: str,
    output: str | None,
    file: str | None,
    passwords_from: int | None,
    dry_run: bool,
    undo: bool,
    yes: bool,
    **answers: str | None,
) -> int:
    """Write the seed of a robot's first boot into an image, or onto a flashed card.

    Raspberry Pi OS 12 and 13, cloud images of Debian 12 and 13, and Ubuntu 22.04: the robot's system has to package
    ROS 1. After its first boot the robot has its name, its user, your key and the WiFi; then: ur robot setup
    USER@NAME.local.

    Needs no root for image files, and asks for what it needs to know. After an interruption, the image is unchanged.
    """
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    named = output or answers["name"] or answers["base"]
    if undo and (file or named):
        raise click.UsageError("--undo takes what was written away again: expected no other choice beside it")
    if file and named:
        raise click.UsageError("--from FILE names robots and outputs: expected no --output, --name or --base beside it")
    source = Path(image)
    if not source.exists():
        raise user_error_about(image, "not found, expected an image or a device", rule="unreadable-file")
    if undo:
        return _take_back(source, dry_run=dry_run, yes=yes)
    given = Given(**answers)
    wanted = read_robots(Path(file), given) if file else [(given, Path(output) if output else None)]
    passwords: Passwords | None = None
    for each, target in wanted:
        options, passwords = _write_seed(source, target, each, passwords, passwords_from, dry_run=dry_run, yes=yes)
        if not dry_run:
            _remember(options)
            _print_next_step(options)
    return 0


def _write_seed(
    source: Path,
    target: Path | None,
    given: Given,
    passwords: Passwords | None,
    passwords_from: int | None,
    *,
    dry_run: bool,
    yes: bool,
) -> tuple[SeedOptions, Passwords]:
    """Write one robot's seed. Returns its options, and the passwords, which are asked for only once."""
    with _opened(source, target) as (path, commit, device):
        layout = find_layout(path)
        if layout.os:
            check_robot_system(str(source), layout.os)
        click.echo(f"{source}: {layout.system}")
        present = read_seed(layout)
        options = make_options(given)
        passwords = passwords or read_passwords(options, passwords_from)
        texts = [(text or b"").decode(errors="replace") for text in present.values()]
        options = add_passwords(options, passwords, present_password(texts))
        if accepts_host_key(layout):
            name = options.robot.name
            options = replace(options, host_key=present_host_key(texts, name) or make_host_key(name))
        writes = plan_writes(layout, present, make_seed(options, layout))
        if dry_run:
            _show(writes)
        elif not writes and target is None:
            click.echo(f"nothing to do: it is prepared for {options.robot.name}")
            _protect(source, device)
        else:
            _confirm(device, writes, yes=yes)
            with show_progress(f"writing {target or source}"):
                commit(writes)
            click.echo(f"{target or source}: prepared for {options.robot.name}")
            _protect(target or source, device)
    return options, passwords


def _protect(image: Path, device: DiskDevice | None) -> None:
    if device is None:
        image.chmod(0o600)  # also one prepared by an earlier version, with the mode of the download
        click.echo("only you can read this file: it holds the robot's host key and hashes of its passwords")


def _take_back(source: Path, *, dry_run: bool, yes: bool) -> int:
    with _opened(source, None) as (path, commit, device):
        layout = find_layout(path)
        writes = plan_undo(layout, read_seed(layout))
        if not writes:
            click.echo("nothing to take back: there is no seed of ours")
        elif dry_run:
            _show(writes)
        else:
            _confirm(device, writes, yes=yes)
            with show_progress(f"writing {source}"):
                commit(writes)
            click.echo("reverted")
    return 0


Commit = Callable[[Sequence[Write]], None]


@contextmanager
def _opened(source: Path, target: Path | None) -> Iterator[tuple[Path, Commit, DiskDevice | None]]:
    """Yield the path to read, the function that writes to it, and the device if it is one. Raises UserError."""
    if is_device(source):
        if target:
            raise click.UsageError("--output is for images: a device is written itself")
        device = check_device(source)
        yield source, lambda writes: _write_device(source, writes), device
        return
    packing = packing_of(source)
    if packing and target is None:
        plain = source.with_suffix("").name
        raise user_error(
            f"{source} is compressed ({packing}), expected a place for the unpacked image",
            rule="packed-image",
            help=f"add --output {plain if plain.endswith(('.img', '.raw')) else plain + '.img'}",
            subject=str(source),
        )
    if target:
        check_output(target, [source])
    if packing:
        assert target is not None
        with _copied(source, target, f"unpacking {source}") as (beside, finish):

            def keep(writes: Sequence[Write]) -> None:
                write_all(beside, writes)
                finish()

            yield beside, keep, None
    else:
        yield source, lambda writes: _write_copy(source, target or source, writes), None


def _write_copy(source: Path, target: Path, writes: Sequence[Write]) -> None:
    target = target.resolve()  # a symbolic link stays one
    with _copied(source, target, f"copying {source}") as (beside, finish):
        write_all(beside, writes)
        finish()


def _write_device(path: Path, writes: Sequence[Write]) -> None:
    write_all(path, writes)
    with path.open("rb") as device:
        os.fsync(device.fileno())


@contextmanager
def _copied(source: Path, target: Path, title: str) -> Iterator[tuple[Path, Callable[[], None]]]:
    with ExitStack() as stack:
        with show_progress(title) as progress:

            def show(done: int, total: int) -> None:
                progress(f"{title}: {100 * done // max(total, 1)} %")

            copied = stack.enter_context(copied_image(source, target, show))
        yield copied


def _show(writes: Sequence[Write]) -> None:
    changes = [
        Change(
            f"{write.volume} partition",
            show_difference(f"/{write.path}", _text(write.before), _text(write.after))
            or f"/{write.path}: another password (not shown)",
            (),
        )
        for write in writes
    ]
    show_changes(changes)
    if not changes:
        click.echo("nothing to do")


def _text(content: bytes | None) -> str | None:
    return None if content is None else hide_secrets(content.decode(errors="replace"))


def _confirm(device: DiskDevice | None, writes: Sequence[Write], *, yes: bool) -> None:
    if device is None or yes:
        return
    question = f"write {len(writes)} files onto {device}"
    if not sys.stdin.isatty():
        raise user_error(
            f"{question}? there is no terminal to ask on", rule="missing-answer", help="look twice, and give --yes"
        )
    if not click.confirm(f"{question}?", default=False):
        raise click.Abort


def _remember(options: SeedOptions) -> None:
    record = RobotRecord(options.robot.name, options.user, options.robot.base, options.robot.variant)
    path = records_folder(os.environ) / f"{record.name}.yaml"
    try:
        replace_file(path, render_record(record), parents=True)
    except OSError as problem:
        reason = (problem.strerror or str(problem)).lower()
        raise user_error_about(path, f"cannot be written: {reason}", rule="unwritable-file") from None
    if options.host_key:
        know_host_key(options.robot.name, options.host_key)


def _print_next_step(options: SeedOptions) -> None:
    name = options.robot.name
    choices = f"--name {name} --base {options.robot.base}"
    choices += f" --variant {options.robot.variant}" if options.robot.variant else ""
    if options.host_key:
        click.echo(f"its host key is {HostKey(options.host_key.public).fingerprint}, and known to this computer")
        click.echo(f"boot {name} from it, then: ur robot setup {options.user}@{name}.local {choices}")
        return
    with suppress(UserError):  # no ssh on this computer
        if run_tool(["ssh-keygen", "-F", f"{name}.local"]).returncode == 0:  # keys of an earlier robot with this name
            choices += " --new-host-key"
    click.echo(f"boot {name} from it, then: ur robot setup {options.user}@{name}.local {choices}")
