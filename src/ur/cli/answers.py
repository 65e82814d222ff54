"""Input that several commands share: names of robots, passwords from a file descriptor."""

import getpass
import socket
import sys

from ur.source.diagnostic import UserError, error


def read_lines(descriptor: int | None, option: str, count: int, *, close: bool = True) -> list[str]:
    """Read the first lines of a file descriptor, '' for missing ones. Raises UserError.

    With `close` false it stays open: otherwise a file opened later may get number 0.
    """
    if descriptor is None:
        return [""] * count
    try:
        with open(descriptor, encoding="utf-8", closefd=close) as stream:
            return [*stream.read().split("\n"), *[""] * count][:count]
    except (OSError, UnicodeDecodeError) as problem:
        raise UserError(
            error(f"{option} {descriptor}: cannot be read: {problem}", rule="bad-descriptor", subject=option)
        ) from None


def ask_twice(what: str) -> str:
    """Ask for a new password, without echo, until it is typed twice; '' for none."""
    while True:
        new = getpass.getpass(f"{what}: ")
        if new == "" or getpass.getpass("the same again: ") == new:
            return new
        sys.stdout.write("the two differ; once more\n")


def check_name(name: str) -> None:
    """Raise UserError if a name is not a valid robot name, or is that of this computer."""
    from ur.robot.setup.robot_states import is_robot_name

    if not is_robot_name(name):
        raise UserError(
            error(
                f"{name!r} is not a valid host name, expected up to 63 lower-case letters, digits and -",
                rule="bad-name",
                subject=name,
            )
        )
    if name in (socket.gethostname().split(".")[0], "localhost", "sim"):
        raise taken_error(name)


def taken_error(name: str) -> UserError:
    """Return the error about a name that another computer has."""
    return UserError(error(f"name {name!r} is taken, expected a name of its own for each computer", rule="taken-name"))
