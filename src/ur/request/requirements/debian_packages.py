"""Debian packages that only some programs need, installed when such a program is first started."""

import os
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from ur.request.requirements.python_packages import DiskFullError, run_installer
from ur.source.diagnostic import UserError, error
from ur.system.debian_root import DebianRoot, find_root, install_command

_APT = ("apt-get", "-q", "-o", "DPkg::Lock::Timeout=300")


@dataclass(frozen=True, slots=True)
class Account:
    """The account that requests packages: its user id, the program sudo, and the Debian root that it is in."""

    uid: Callable[[], int] = os.geteuid
    sudo: Callable[[], str | None] = lambda: _find_program("sudo")
    root: Callable[[Mapping[str, str]], DebianRoot | None] = find_root


_ACCOUNT = Account()


def _find_program(name: str) -> str | None:
    import shutil  # only where a program needs packages

    return shutil.which(name)


def install_debian(
    alternatives: Sequence[Sequence[str]], title: str, *, ask: bool = True, account: Account = _ACCOUNT
) -> None:
    """Install the first set of Debian packages unless one of the sets is installed already.

    `title` describes the installation for the user. With `ask` sudo may ask for a password on the terminal. A system
    without dpkg is not changed. Raises UserError if the packages cannot be installed, or the user may not.
    """
    if _find_program("dpkg-query") is None or any(not list_missing(names) for names in alternatives):
        return
    missing = list_missing(alternatives[0])
    command = "apt-get install " + " ".join(missing)
    root = _root_prefix(missing, command, ask=ask, account=account)
    sys.stderr.write(f"installing {title}: Debian packages {' '.join(missing)}, once ...\n")
    install = [*root, *_APT, "install", "-y", "--no-install-recommends", *missing]
    settings = f"apt's sources, or try it by hand: sudo {command}"
    try:
        run_installer(install, " ".join(missing), settings)
    except DiskFullError:  # new package lists need room, too
        raise
    except UserError:  # the package lists may be old, or missing
        sys.stderr.write("fetching new package lists ...\n")
        run_installer([*root, *_APT, "update"], "new package lists", settings)
        run_installer(install, " ".join(missing), settings)


def list_missing(names: Sequence[str]) -> list[str]:
    """Return the Debian packages, of these, that are not installed."""
    import subprocess  # only where a program needs packages

    query = ["dpkg-query", "--show", "--showformat=${Package} ${db:Status-Status}\n", *names]
    done = subprocess.run(query, stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False)
    installed = {line.removesuffix(" installed") for line in done.stdout.splitlines() if line.endswith(" installed")}
    return [name for name in names if name not in installed]


def _root_prefix(
    missing: Sequence[str],
    command: str,
    *,
    ask: bool,
    account: Account = _ACCOUNT,
) -> list[str]:
    """Return the arguments in front of a command that needs root. Raises UserError if the user cannot become root."""
    import subprocess

    if account.root(os.environ) is not None:
        raise _refusal(missing, "this Debian root is changed from outside only", install_command(missing))
    environment = ["env", "DEBIAN_FRONTEND=noninteractive"]
    if account.uid() == 0:
        return environment
    sudo = account.sudo()
    if sudo is None:
        raise _refusal(missing, "sudo is not installed", f"as root: {command}")
    if subprocess.run([sudo, "-n", "true"], stdin=subprocess.DEVNULL, capture_output=True, check=False).returncode:
        if not ask or not sys.stdin.isatty():
            raise _refusal(missing, "sudo asks for a password and there is no terminal", f"sudo {command}")
        sys.stderr.write(f"Debian packages are missing ({' '.join(missing)}): sudo asks for your password\n")
        if subprocess.run([sudo, "-v"], check=False).returncode:
            raise _refusal(missing, "sudo was refused", f"ask an administrator to run: {command}")
    return [sudo, *environment]


def _refusal(missing: Sequence[str], reason: str, help_: str) -> UserError:
    message = f"Debian packages {' '.join(missing)} are missing and could not be installed: {reason}"
    return UserError(error(message, rule="no-package", help=help_))
