"""Build, try and sign off a release: release.py VERSION [OPTION ...]. Uploads nothing.

1. Checks that the clone has no changes, that VERSION follows the last one, and that CHANGELOG.md has something to say.
2. In a clone of its own, sets the version in pyproject.toml, and in the package.xml that ROS reads, closes the
   changelog's section and commits all three.
3. Looks every locked Python package up in the database of known vulnerabilities (tools/audit_locks.bash).
4. Builds sdist and wheel of that commit, installs the wheel without a clone and asks every command for its help.
5. Runs ./test, and the long tests of the wheel.
6. Writes the files and SHA256SUMS into FOLDER, takes the commit over, and tags it vVERSION with the changelog's section
   as its message; the tag is signed if git has a key (user.signingkey).

With --dry-run it stops before step 6, and this clone is as it was.
"""

import argparse
import hashlib
import re
import shutil
import subprocess
import sys
import tempfile
import zipfile
from datetime import datetime, timezone
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from tools.build import build  # noqa: E402 - found by the line above

_VERSION = re.compile(r'^(version = "|  <version>)([^"<]*)', re.MULTILINE)
_PLACES = ("pyproject.toml", "ubiquity_launches/package.xml")  # a test compares them
_UNRELEASED = "## Unreleased"
_NEVER_RELEASED = re.compile(r"^## \d+\.\d+\.\d+, not yet released\n", re.MULTILINE)
_SECTIONS = ("", *(f"### {name}" for name in ("Added", "Changed", "Deprecated", "Removed", "Fixed", "Security")))
_TRY = """\
import subprocess, sys
from ur.cli.verbs import VERBS
for verb in VERBS:
    subprocess.run([sys.argv[1], verb, "--help"], stdout=subprocess.DEVNULL, check=True)
print(len(VERBS))
"""


class ReleaseError(Exception):
    """A release that cannot be made, and what to do about it."""


def read_version(text: str) -> str:
    """The version in the text of pyproject.toml or package.xml."""
    match = _VERSION.search(text)
    if match is None:
        raise ReleaseError("pyproject.toml or package.xml has no version")
    return match[2]


def set_version(text: str, version: str) -> str:
    """The text of pyproject.toml or package.xml with another version."""
    return _VERSION.sub(rf"\g<1>{version}", text, count=1)


def check_version(version: str, present: str, tags: list[str]) -> None:
    """Refuse a version that is none, that was released, or that comes before the present one."""
    if not re.fullmatch(r"\d+\.\d+\.\d+", version):
        raise ReleaseError(f"{version!r} is not a version, expected MAJOR.MINOR.PATCH")
    if f"v{version}" in tags:
        raise ReleaseError(f"{version} was released: there is a tag v{version}")
    if _numbers(version) < _numbers(present):
        raise ReleaseError(f"{version} comes before {present}, expected a later version")


def close_changelog(text: str, version: str, date: str) -> tuple[str, str]:
    """Close the changelog's unreleased section: the text with its changes under a version and date, and those changes.

    A section `## VERSION, not yet released` was never released: its changes come first in this release. A section of
    this version that has a date already stays as it is, while nothing is unreleased.
    """
    text, never_released = _take_never_released(text)
    dated = re.search(
        rf"^## {re.escape(version)} - \d{{4}}-\d\d-\d\d\n(.*?)(?=^## |\Z)", text, re.MULTILINE | re.DOTALL
    )
    unreleased = text.partition(f"{_UNRELEASED}\n")[2].partition("\n## ")[0]
    if dated and not never_released and not re.search(r"^- ", unreleased, re.MULTILINE):
        return text, dated[1].strip()
    if re.search(rf"^## {re.escape(version)}\b", text, re.MULTILINE):
        raise ReleaseError(f"CHANGELOG.md has a section {version}, expected its changes under '## Unreleased'")
    before, heading, rest = text.partition(f"{_UNRELEASED}\n")
    changes, separator, older = rest.partition("\n## ")
    if not heading or not re.search(r"^- ", changes, re.MULTILINE):
        raise ReleaseError("CHANGELOG.md has no changes under '## Unreleased', expected what this release changes")
    changes = _merge_sections(never_released, changes.strip())
    closed = f"{before}{_UNRELEASED}\n\n## {version} - {date}\n\n{changes}\n{separator}{older}"
    return closed, changes


def _merge_sections(first: str, second: str) -> str:
    """The changes of both, those under one heading together; where the first have subjects, the second are one more."""
    sections: dict[str, str] = {}
    for text in (first, second):
        for part in re.split(r"^(?=### )", text, flags=re.MULTILINE):
            title = "" if (heading := re.match("### .*", part)) is None else heading[0]
            before, changes = sections.get(title, ""), part.removeprefix(title).strip("\n")
            subject = "**More**" if before.startswith("**") else ""
            sections[title] = "\n\n".join(filter(None, (before, changes and subject, changes)))
    titles = sorted(sections, key=lambda title: _SECTIONS.index(title) if title in _SECTIONS else len(_SECTIONS))
    return "\n\n".join(filter(None, (text for title in titles if sections[title] for text in (title, sections[title]))))


def _take_never_released(text: str) -> tuple[str, str]:
    """Remove the section of a version that was never released; the text without it, and its changes."""
    heading = _NEVER_RELEASED.search(text)
    if heading is None:
        return text, ""
    following = re.compile(r"^## ", re.MULTILINE).search(text, heading.end())
    end = following.start() if following else len(text)
    before, section = text[: heading.start()].rstrip("\n"), text[heading.end() : end]
    return f"{before}\n" + (f"\n{text[end:]}" if following else ""), section.strip("\n")


def prepare(root: Path, clone: Path, version: str) -> str:
    """Commit the release in a clone of its own; the changelog's section. Raises ReleaseError."""
    if changed := _git(root, "status", "--porcelain"):
        raise ReleaseError(f"the clone has changes, expected none: {changed.splitlines()[0].strip()}")
    _git(root, "clone", "-q", "--no-hardlinks", str(root), str(clone))
    changelog = clone / "CHANGELOG.md"
    check_version(version, read_version((clone / _PLACES[0]).read_text(encoding="utf-8")), _git(root, "tag").split())
    date = datetime.now(timezone.utc).date().isoformat()
    text, changes = close_changelog(changelog.read_text(encoding="utf-8"), version, date)
    changelog.write_text(text, encoding="utf-8")
    for place in _PLACES:
        (clone / place).write_text(set_version((clone / place).read_text(encoding="utf-8"), version), encoding="utf-8")
    name, address = (_git(root, "config", f"user.{key}").strip() for key in ("name", "email"))
    author = ["-c", f"user.name={name}", "-c", f"user.email={address}"]
    _git(clone, *author, "commit", "-q", "-a", "--allow-empty", "-m", f"release: {version}")
    return changes


def audit(root: Path) -> str:
    """Look the locks up in the database of known vulnerabilities; what was found. Raises ReleaseError for any."""
    done = subprocess.run(["bash", root / "tools/audit_locks.bash"], capture_output=True, text=True, check=False)
    if done.returncode == 1:
        raise ReleaseError(f"locked packages have known vulnerabilities:\n{done.stdout.strip()}")
    if done.returncode:
        raise ReleaseError(f"the locks could not be audited; --without-audit leaves it out\n{done.stderr.strip()}")
    return "no known vulnerabilities in the locked packages"


def try_wheel(wheel: Path, version: str, folder: Path) -> str:
    """Install a wheel into an environment that sees no clone, and ask it; what was tried. Raises ReleaseError."""
    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
    for needed in ("ur/_project/ubiquity_launches/package.xml", "ur/_project/requirements/run.lock"):
        if needed not in names:
            raise ReleaseError(f"{wheel.name} lacks {needed}")
    subprocess.run([sys.executable, "-I", "-m", "venv", "--without-pip", str(folder)], check=True)
    python = folder / "bin/python"
    # Libraries are those of this environment; a .pth file that leads to this clone is not read from there.
    (site,) = folder.glob("lib/python*/site-packages")
    (site / "libraries.pth").write_text("\n".join(each for each in sys.path if each.endswith("-packages")) + "\n")
    pip = [sys.executable, "-I", "-m", "pip", "--python", str(python), "install", "-q", "--disable-pip-version-check"]
    subprocess.run([*pip, "--no-deps", "--no-index", str(wheel)], check=True)
    ur = str(folder / "bin/ur")
    said = subprocess.run([ur, "--version"], capture_output=True, text=True, check=True).stdout.strip()
    if said.split()[:2] != ["ur", version] or "wheel in" not in said:
        raise ReleaseError(f"the wheel says {said!r}, expected 'ur {version} (wheel in ...)'")
    done = subprocess.run([str(python), "-I", "-c", _TRY, ur], capture_output=True, text=True, check=True)
    return f"{said.partition(' (')[0]}, help of {done.stdout.strip()} commands"


def sign_off(root: Path, clone: Path, version: str, changes: str) -> str:
    """Take the commit over and tag it; what kind of tag it is."""
    _git(root, "pull", "-q", "--ff-only", str(clone), "HEAD")
    key = subprocess.run(["git", "-C", str(root), "config", "user.signingkey"], capture_output=True, check=False)
    kind = "-s" if key.stdout.strip() else "-a"
    _git(root, "tag", kind, f"v{version}", "--cleanup=verbatim", "-m", f"ubiquity_launches {version}\n\n{changes}\n")
    return "signed" if kind == "-s" else "not signed: git config user.signingkey is not set"


def main(arguments: list[str], root: Path = ROOT) -> int:
    """Make a release of the clone `root`; the exit code."""
    assert __doc__
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("version", metavar="VERSION")
    parser.add_argument("--dry-run", action="store_true", help="change nothing in this clone")
    parser.add_argument("--into", type=Path, default=root / "dist", metavar="FOLDER", help="default: dist")
    parser.add_argument("--without-audit", action="store_true", help="the database cannot be reached from here")
    parser.add_argument("--without-tests", action="store_true", help="they have passed for this commit: .ci/run")
    options = parser.parse_args(arguments)
    try:
        with tempfile.TemporaryDirectory(prefix="ur-release-") as name:
            _release(root, Path(name), options)
    except ReleaseError as problem:
        sys.stderr.write(f"error: {problem}\n")
        return 2
    except subprocess.CalledProcessError as problem:
        command = " ".join(map(str, problem.cmd))
        sys.stderr.write(f"error: {command[:200]}: exit code {problem.returncode}\n{problem.stderr or ''}")
        return 2
    return 0


def _release(root: Path, folder: Path, options: argparse.Namespace) -> None:
    version, clone = options.version, folder / "clone"
    changes = prepare(root, clone, version)
    print(f"version {version}, {sum(line.startswith('- ') for line in changes.splitlines())} changes")
    print("locks not audited, as asked" if options.without_audit else audit(root))
    files = build(folder / "dist", clone)
    for path in files:
        print(f"built {path.name}, {path.stat().st_size / 1e6:.1f} MB")
    print(f"tried {try_wheel(files[1], version, folder / 'environment')}")
    if options.without_tests:
        print("tests left out, as asked")
    else:
        subprocess.run([root / "test"], cwd=root, check=True)
        subprocess.run([root / "test", "tests/test_wheel.py", "-m", "slow"], cwd=root, check=True)
    if options.dry_run:
        print("dry run: nothing was written, committed or tagged")
        return
    options.into.mkdir(parents=True, exist_ok=True)
    sums = []
    for path in files:
        shutil.copy(path, options.into)
        sums.append(f"{hashlib.sha256(path.read_bytes()).hexdigest()}  {path.name}\n")
    (options.into / "SHA256SUMS").write_text("".join(sums))
    print(f"tagged v{version}, {sign_off(root, clone, version, changes)}")
    print(f"wrote {options.into}; publish it: git push origin HEAD v{version}, then upload these files")


def _numbers(version: str) -> list[int]:
    return [int(each) for each in re.findall(r"\d+", version)]


def _git(root: Path, *arguments: str) -> str:
    command = ["git", "-C", str(root), *arguments]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
