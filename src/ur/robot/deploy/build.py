"""Building a catkin workspace: the required facts about its computer, and the build command. Pure."""

import re
from collections.abc import Sequence
from dataclasses import dataclass

from ur.robot.ssh.shell import quote
from ur.source.diagnostic import UserError, error
from ur.source.foreign.numbers import parse_integer

WORKSPACE = "catkin_ws"
# g++ -O2 takes 333 MB for a node of five lines with ros/ros.h (Debian 12, 64 bits); larger ones take more. With
# less memory than its compilers need, a small computer swaps, and a build of minutes takes hours.
MB_PER_JOB = 512
TOOLS = ("catkin_make", "catkin", "cmake", "g++", "make")
FACTS = f"""\
cd "$HOME" || exit
for tool in {" ".join(TOOLS)}; do command -v $tool >/dev/null && echo "tool $tool"; done
[ -d {WORKSPACE}/src ] && echo "source $(find -L {WORKSPACE}/src -name package.xml -not -path '*/.*' | wc -l)"
[ -d {WORKSPACE}/.catkin_tools ] && echo "tools yes"
echo "processors $(nproc)"
sed -n 's/^MemAvailable: *\\([0-9]*\\) kB/memory \\1/p' /proc/meminfo
"""


@dataclass(frozen=True, slots=True)
class Builder:
    """A computer that builds.

    `memory` is free memory in MB; `packages` is the number of packages, None without a workspace.
    """

    tools: frozenset[str]
    processors: int
    memory: int
    packages: int | None
    catkin_tools: bool = False  # whether the workspace was built by `catkin build`


def parse_builder(text: str) -> Builder:
    """Parse the output of FACTS, which ran in a login shell."""

    def number(word: str) -> int | None:
        found = re.search(rf"^{word} (\d+)$", text, re.MULTILINE)
        return parse_integer(found[1]) if found else None

    memory = number("memory")
    return Builder(
        frozenset(re.findall(r"^tool (\S+)$", text, re.MULTILINE)),
        number("processors") or 1,
        (memory or 0) // 1024,
        number("source"),
        "tools yes" in text.splitlines(),
    )


def choose_jobs(builder: Builder, wanted: int | None) -> tuple[int, str]:
    """Choose the number of parallel compilers, with a line that explains a number below that of the processors.

    The number that the user wants is used; the line then warns if it is more than the memory allows.
    """
    bound = max(1, builder.memory // MB_PER_JOB)
    have = f"{builder.memory} MB of memory are free, and a compiler takes up to {MB_PER_JOB} MB"
    if wanted is not None:
        return wanted, f"warning: -j {wanted}: {have}: it may get very slow" if wanted > bound else ""
    if bound < builder.processors:
        return bound, f"-j {bound} on {builder.processors} processors: {have}"
    return builder.processors, ""


def check_builder(builder: Builder, destination: str, *, here: bool) -> None:
    """Raise UserError if a build tool is missing, or the workspace has no packages to build."""
    again = "ur setup" if here else "ur robot setup"
    if builder.packages is None:
        raise _problem(f"{destination}: no workspace, expected ~/{WORKSPACE}/src", f"run: {again}")
    if not builder.packages:
        raise _problem(
            f"{destination}: ~/{WORKSPACE}/src holds no package, expected at least one",
            "put one there: ur new package" if here else "bring yours: ur sync",
        )
    command, package = ("catkin", "catkin-tools") if builder.catkin_tools else ("catkin_make", "catkin")
    missing = [package] if command not in builder.tools else []
    missing += [tool for tool in ("cmake", "g++", "make") if tool not in builder.tools]
    if missing:
        names = " ".join(missing)
        raise _problem(f"{destination}: {names} not installed, needed to build", f"there: sudo apt-get install {names}")


def build_command(builder: Builder, packages: Sequence[str], jobs: int) -> str:
    """Return the login-shell command that builds the workspace, or only these packages of it."""
    if builder.catkin_tools:
        argv = ["catkin", "build", "--no-status", "-p", "1", "-j", str(jobs), "--mem-limit", "90%", *packages]
        argv += ["--no-color"]
    else:
        argv = ["catkin_make", f"-j{jobs}", "--no-color", *(["--pkg", *packages] if packages else [])]
    return f"cd ~/{WORKSPACE} && exec env PYTHONUNBUFFERED=1 {quote(*argv)}"


def _problem(message: str, help: str) -> UserError:
    return UserError(error(message, rule="no-build", help=help))
