"""Guessed repositories of the same owner as a folder's repository, until a server confirms them."""

import os
import re
import subprocess
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import chain, islice
from pathlib import Path

from ur.get.index import make_repository
from ur.get.steps import Missing, SourceRepository
from ur.source.foreign.files import read_text

_REMOTE = re.compile(
    r"(?:https?://(?:[^@/\s]+@)?|(?:ssh://)?git@|git://)"
    r"(github\.com|gitlab\.com|bitbucket\.org)[:/]([A-Za-z0-9][\w.-]*)/[\w.-]+/?"
)
_CONFIG_URL = re.compile(r"^[ \t]*url[ \t]*=[ \t]*(\S{1,500})[ \t]*$", re.MULTILINE)
_MANIFEST_URL = re.compile(
    r"<url\b[^<>]{0,200}\btype\s{0,9}=\s{0,9}[\"']repository[\"'][^<>]{0,200}>\s{0,99}([^<\s]{1,500})\s{0,99}</url>"
)
_ABSENT = ("not found", "could not read username", "authentication failed", "terminal prompts disabled")
_DEFAULT = re.compile(r"^ref: refs/heads/(\S+)\tHEAD$", re.MULTILINE)
_BRANCHES = re.compile(r"^[0-9a-f]+\trefs/heads/(\S+)$", re.MULTILINE)
_MAX_BRANCHES = 1000
_ROS1 = ("noetic", "melodic", "kinetic", "ros1", "indigo")
_MAX_CONFIG = 1024 * 1024  # bytes
_QUESTIONS = 60  # of one command: each takes half a second
_OTHERS = 4  # owners of repositories that a folder only names
_SECONDS = 20.0


def owners_of_config(text: str) -> tuple[str, ...]:
    """Return the addresses of the owners of a repository's remotes ("https://github.com/NAME"), from git's config."""
    return _owners(_CONFIG_URL.findall(text))


def owners_of_manifest(text: str) -> tuple[str, ...]:
    """Return the addresses of the owners of the repository that a package.xml names."""
    return _owners(_MANIFEST_URL.findall(text))


def owners_of_repositories(repositories: Iterable[SourceRepository]) -> tuple[str, ...]:
    """Return the addresses of the owners of the first repositories that files of a folder name."""
    return _owners(each.url for each in repositories)[:_OTHERS]


def addresses_of(folder: Path) -> tuple[str, ...]:
    """Return the addresses of the remotes of the repository at a folder; empty if git's config cannot be read."""
    return tuple(_CONFIG_URL.findall(_read_config(folder)))


def guess_repositories(missing: Missing, owners: Iterable[str] | None = None) -> Iterator[SourceRepository]:
    """Yield repositories with the name of a package, for each of its possible owners."""
    for owner in missing.owners if owners is None else owners:
        for name in dict.fromkeys((missing.package, missing.package.replace("_", "-"))):
            if repository := make_repository(name, {"type": "git", "url": f"{owner}/{name}.git"}):
                yield repository


def list_guesses(missing: Iterable[Missing]) -> tuple[tuple[str, SourceRepository], ...]:
    """Return the repositories that may contain packages, those of the folder's owners first, each with its package."""
    wanted = [each for each in missing if not each.itself]
    own = ((each.package, guess) for each in wanted for guess in guess_repositories(each))
    others = ((each.package, guess) for each in wanted for guess in guess_repositories(each, each.others))
    return tuple(islice(chain(own, others), _QUESTIONS))


def confirm_guesses(
    missing: Iterable[Missing], list_branches: Callable[[str], Sequence[str] | None]
) -> dict[str, SourceRepository | None]:
    """Query which guesses exist; return those by package, and None for a package without an existing guess.

    `list_branches` is `ask_server` or a replacement; the queries end if a server cannot be reached. The version is the
    branch for ROS 1 of a repository that has one beside its default branch.
    """
    found: dict[str, SourceRepository | None] = {}
    for package, guess in list_guesses(missing):
        if found.get(package):
            continue
        branches = list_branches(guess.url)
        if branches is None:
            break
        keys = {"type": "git", "url": guess.url, "version": choose_branch(branches)}
        found[package] = (make_repository(guess.name, keys) or guess) if branches else None
    return found


def choose_branch(branches: Sequence[str]) -> str:
    """Return the newest branch for ROS 1 by its name; "" if the default one, which is first, is it or there is none."""
    for word in _ROS1:
        fitting = sorted((each for each in branches if word in _words(each)), key=lambda each: (len(each), each))
        if branches and branches[0] in fitting:
            return ""
        if fitting:
            return fitting[0]
    return ""


def owners_above(path: Path) -> tuple[str, ...]:
    """Return the owners of the repository that contains a folder or file."""
    for folder in (path, *path.parents):
        if (folder / ".git").exists():
            return read_owners(folder)
    return ()


def read_owners(folder: Path) -> tuple[str, ...]:
    """Return the owners of the repository or submodule at a folder; empty if git's config cannot be read."""
    return owners_of_config(_read_config(folder))


Runner = Callable[[Sequence[str], dict[str, str]], "subprocess.CompletedProcess[str]"]


def ask_server(url: str, run: Runner | None = None) -> tuple[str, ...] | None:
    """Return the branches of the public repository at an address, the default one first; None without an answer.

    The result is empty for a repository that does not exist or is empty.
    """
    # Outside of any repository, whose settings are not the user's, and without questions for a password.
    command = ["git", "-c", "credential.helper=", "ls-remote", "--quiet", "--symref", url, "HEAD", "refs/heads/*"]
    environment = {
        **os.environ,
        "LC_ALL": "C",
        "GIT_TERMINAL_PROMPT": "0",
        "GIT_ASKPASS": "true",
        "SSH_ASKPASS": "true",
    }
    try:
        done = (run or _run)(command, environment)
    except (OSError, subprocess.TimeoutExpired):
        return None
    if done.returncode == 0:
        branches = (*_DEFAULT.findall(done.stdout), *_BRANCHES.findall(done.stdout))
        return tuple(dict.fromkeys(branches))[:_MAX_BRANCHES]
    return () if any(text in done.stderr.lower() for text in _ABSENT) else None


def _words(branch: str) -> list[str]:
    return re.split(r"[^a-z0-9]+", branch.lower())


def _run(command: Sequence[str], environment: dict[str, str]) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        command,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        errors="replace",
        check=False,
        cwd="/",
        env=environment,
        timeout=_SECONDS,
    )


def _read_config(folder: Path) -> str:
    git = folder / ".git"
    try:
        if git.is_file():
            git = folder / read_text(git, _MAX_CONFIG).removeprefix("gitdir:").strip()
        return read_text(git / "config", _MAX_CONFIG)
    except OSError:
        return ""


def _owners(urls: Iterable[str]) -> tuple[str, ...]:
    found = (_REMOTE.fullmatch(url) for url in urls)
    return tuple(dict.fromkeys(f"https://{each[1]}/{each[2]}" for each in found if each))
