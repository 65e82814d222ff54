"""Compare the table of releases with the package lists of a release: check_releases.py [--sources FILE] [RELEASE ...].

RELEASE is a codename of src/ur/system/releases.tsv, such as trixie; without one, every release of this computer's
distribution that has a date there is looked up. The lists are fetched into a temporary folder; this computer's apt is
left alone. Its sources serve, with the other codename in place of its own; FILE names others, for a distribution that
is not this computer's.

Exit codes: 0 the table agrees, 1 it differs, 2 the lists could not be fetched.
"""

import argparse
import re
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Sequence
from pathlib import Path

from ur.system.releases import Release, System, load_releases, load_ros_packages, parse_os_release

APT = Path("/etc/apt")
OS_RELEASE = Path("/etc/os-release")
SECONDS = 300


class CheckError(Exception):
    """The look-up failed: a message, and what helps."""

    def __init__(self, message: str, help: str = "") -> None:
        super().__init__(message)
        self.help = help


def choose_releases(names: Sequence[str], own: System, *, sources: bool) -> list[Release]:
    """The rows to be looked up. Raises CheckError for an unknown codename, or one of another distribution."""
    rows = {row.codename: row for row in reversed(load_releases()) if row.codename}
    unknown = [name for name in names if name not in rows]
    if unknown:
        raise CheckError(f"unknown release '{unknown[0]}', expected one of {', '.join(sorted(rows))}")
    chosen = [rows[name] for name in names] or [row for row in rows.values() if row.id == own.id and row.lists]
    for row in chosen:
        if row.id != own.id and not sources:
            raise CheckError(
                f"{row.name}: its lists are not those of this computer's distribution ({own.name})",
                "name a file with its apt sources: --sources FILE",
            )
    return sorted(chosen, key=lambda row: row.version)


def rewrite_sources(text: str, own: str, codename: str) -> str:
    """The sources of one release as those of another: its codename in place of the own one. '' leaves them alone."""
    # Not within a path, such as that of a key.
    return re.sub(rf"(?<![\w/.-]){re.escape(own)}\b", codename, text) if own else text


def parse_candidates(text: str) -> dict[str, str]:
    """Read the output of `apt-cache policy`: the candidate version of each package that has one."""
    found: dict[str, str] = {}
    name = ""
    for line in text.splitlines():
        if not line.startswith(" "):
            name = line.removesuffix(":")
        elif line.startswith("  Candidate: ") and not line.endswith("(none)"):
            found[name] = line.removeprefix("  Candidate: ")
    return found


def list_missing(entries: Iterable[str], candidates: Iterable[str]) -> tuple[str, ...]:
    """Which entries have no alternative among the candidates, then rviz, as the table's column `missing` has it."""
    known = set(candidates)
    wanted = list(entries)
    missing = [entry.split("|")[0] for entry in wanted if known.isdisjoint(entry.split("|"))]
    names = ["all"] if missing and len(missing) == len(wanted) else sorted(missing)
    return (*names, *([] if "rviz" in known else ["rviz"]))


def fetch_candidates(folder: Path, sources: str, names: Sequence[str]) -> dict[str, str]:
    """Fetch package lists into a folder and look packages up. Raises CheckError."""
    for each in ("lists/partial", "cache"):
        (folder / each).mkdir(parents=True)
    file = folder / ("x.sources" if "URIs:" in sources else "x.list")
    file.write_text(sources)
    options = {
        "Dir::State": folder,
        "Dir::State::status": "/dev/null",
        "Dir::Cache": folder / "cache",
        "Dir::Etc::sourcelist": file,
        "Dir::Etc::sourceparts": "/dev/null",
        "Acquire::Languages": "none",
        "APT::Sandbox::User": "root",  # the folder is nobody else's
    }
    words = [word for key, value in options.items() for word in ("-o", f"{key}={value}")]
    update = subprocess.run(
        ["apt-get", *words, "-q", "update", "--error-on=any"],
        capture_output=True,
        text=True,
        check=False,
        timeout=SECONDS,
    )
    if update.returncode:
        said = [line for line in update.stderr.splitlines() if line.startswith("E:")] or ["apt-get update failed"]
        raise CheckError(said[0].removeprefix("E: "), "check the network and the sources in /etc/apt")
    policy = ["apt-cache", *words, "policy", *names]
    return parse_candidates(subprocess.run(policy, capture_output=True, text=True, check=True, timeout=SECONDS).stdout)


def read_sources(file: Path | None) -> str:
    """The text of a sources file, or of this computer's. Raises CheckError."""
    files = [file] if file else [APT / "sources.list.d" / f"{name}.sources" for name in ("debian", "ubuntu")]
    if file is None:
        files.append(APT / "sources.list")
    for each in files:
        if each.is_file():
            return each.read_text(encoding="utf-8")
    raise CheckError(f"no apt sources found, expected {' or '.join(map(str, files))}")


def check(row: Release, sources: str) -> bool:
    """Look one release up and print what it has. Returns whether the table says the same."""
    entries = load_ros_packages()
    names = [*(name for entry in entries for name in entry.split("|")), "rviz"]
    with tempfile.TemporaryDirectory(prefix="ur-releases.") as folder:
        candidates = fetch_candidates(Path(folder), sources, names)
    missing = list_missing(entries, candidates)
    has = len(entries) if "all" not in missing else 0
    has -= len([name for name in missing if name not in ("all", "rviz")])
    agrees = missing == row.missing
    shown = f"{row.name}: {has} of {len(entries)} ROS packages, RViz {candidates.get('rviz', 'none')}"
    print(shown + ("" if agrees else f"; the table differs: missing is {','.join(row.missing) or '-'}"))
    if not agrees:
        print(f"  expected {','.join(missing) or '-'}")
    return agrees


def main(arguments: Sequence[str] | None = None) -> int:
    """Look releases up. Returns the exit code."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n", 1)[0])
    parser.add_argument("releases", nargs="*", metavar="RELEASE", help="codenames, such as trixie")
    parser.add_argument("--sources", type=Path, metavar="FILE", help="apt sources to use as they are")
    given = parser.parse_args(arguments)
    try:
        own = parse_os_release(OS_RELEASE.read_text(encoding="utf-8"))
        rows = choose_releases(given.releases, own, sources=given.sources is not None)
        text = read_sources(given.sources)
        codename = "" if given.sources else own.codename
        agree = [check(row, rewrite_sources(text, codename, row.codename)) for row in rows]
        return 0 if all(agree) else 1
    except CheckError as problem:
        print(f"error: {problem}", file=sys.stderr)
        if problem.help:
            print(f"  help: {problem.help}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main())
