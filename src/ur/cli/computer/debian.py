"""`ur debian`: the Debian root for ROS, where this computer's release has no ROS packages."""

from __future__ import annotations

import os

import click

from ur.request.environment import REPOSITORY
from ur.source.diagnostic import UserError, error
from ur.system.debian_root import MARK


@click.group("debian", invoke_without_command=True)
@click.pass_context
def command(context: click.Context) -> None:
    """Inspect, change or remove the Debian root that ROS runs in.

    It exists if this computer's release has no ROS 1. The first start of ur creates it. Commands of ur and programs of
    ROS run in it automatically.
    """
    if context.invoked_subcommand is None:
        _run_script("status")


@command.command("status")
def status() -> None:
    """Print the location, version and size of the Debian root."""
    _run_script("status")


@command.command("shell", context_settings={"ignore_unknown_options": True, "allow_interspersed_args": False})
@click.argument("words", nargs=-1, type=click.UNPROCESSED, metavar="[PROGRAM ...]")
def shell(words: tuple[str, ...]) -> None:
    """Open a shell in the Debian root, or run one program there."""
    _run_script("shell", *words)


@command.command("install")
@click.argument("packages", nargs=-1, required=True, metavar="PACKAGE ...")
def install(packages: tuple[str, ...]) -> None:
    """Install Debian packages in the Debian root. sudo may ask for your password."""
    _change("install", *packages)


@command.command("update")
def update() -> None:
    """Install newer versions of the packages in the Debian root. sudo may ask for your password.

    Where AppArmor keeps bwrap from making user namespaces, this allows it again.
    """
    _change("update")


@command.command("remove")
def remove() -> None:
    """Delete the Debian root. The next start of ur creates it again; packages of this computer are kept."""
    _change("remove")


def _change(*words: str) -> None:
    """Run a command of the script that changes the root. Raises UserError inside the root."""
    if os.path.exists(MARK):  # noqa: PTH110 - as in ur.system.debian_root
        raise UserError(
            error(
                f"'ur debian {words[0]}' cannot run inside the Debian root, expected a shell of this computer",
                rule="inside-root",
                help=f"in another terminal: {REPOSITORY}/ur debian {' '.join(words)}",
                subject=words[0],
            )
        )
    _run_script(*words)


def _run_script(*words: str) -> None:
    script = str(REPOSITORY / "tools" / "debian_root.bash")
    os.execv("/bin/bash", ["bash", script, *words])  # noqa: S606 - the script takes the place of this process
