"""The root file systems that computers of the bench share: made once, kept in a cache, never written to again."""

import fcntl
import hashlib
import os
import platform
import re
import shutil
import subprocess
import tempfile
from pathlib import Path

HERE = Path(__file__).parent
PACKAGES, PROGRAMS = "packages.txt", "programs.txt"
RECIPE = (PACKAGES, "offered.txt", "customize.bash", "root.py")
TOOLS = ("mmdebstrap", "systemd-nspawn", "nsenter", "ip", "dpkg-deb", "mount")


def find_obstacle() -> str | None:
    """Why computers cannot be booted here, in one line; None when they can."""
    if os.geteuid() != 0:
        return "booting computers needs root"
    missing = [tool for tool in TOOLS if shutil.which(tool) is None]
    if missing:
        return f"{', '.join(missing)} missing: apt-get install mmdebstrap systemd-container"
    if not _sources().is_file():
        return "no apt sources of Debian or Ubuntu found to make a root file system from"
    return None


def find_root(cache: Path, *, programs: bool = False, suite: str = "") -> Path | None:
    """The cached root for today's recipe, or None when it has not been made."""
    root = cache / _key(programs=programs, suite=suite)
    return root if root.is_dir() else None


def make_root(cache: Path, *, programs: bool = False, suite: str = "") -> Path:
    """The cached root for today's recipe, made now when it is not there (a minute or two, needs the package mirror).

    With `programs` it also has what robot programs need. `suite` is the codename of a release of this computer's
    distribution, else its own. All are kept side by side; of each only today's is.
    Safe against a second process and against being killed: the unfinished has another name and is removed next time.
    """
    cache.mkdir(parents=True, exist_ok=True)
    with (cache / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        found = find_root(cache, programs=programs, suite=suite)
        if found:
            return found
        used = Path("/proc/self/mounts").read_text()
        kept = (_digest(programs=True), _digest(programs=False))
        for old in cache.iterdir():
            if old.is_dir() and not old.name.endswith(kept) and f"lowerdir={old}," not in used:
                shutil.rmtree(old)
        unfinished = Path(tempfile.mkdtemp(prefix="unfinished.", dir=cache))
        _bootstrap(unfinished / "root", cache / "mmdebstrap.log", _packages(programs=programs), suite or codename())
        target = cache / _key(programs=programs, suite=suite)
        (unfinished / "root").rename(target)
        unfinished.rmdir()
        return target


def cache_folder() -> Path:
    """Where roots are kept: outside the repository, for root on this computer."""
    base = os.environ.get("XDG_CACHE_HOME")
    return Path(base) / "ur-hosts" if base else Path("/var/cache/ur-hosts")


def _packages(*, programs: bool) -> list[str]:
    lines = [line for name in (PACKAGES, PROGRAMS)[: 1 + programs] for line in (HERE / name).read_text().splitlines()]
    return [line for line in lines if line and not line.startswith("#")]


def _bootstrap(target: Path, log: Path, names: list[str], suite: str) -> None:
    command = [
        "mmdebstrap",
        "--mode=root",
        "--variant=minbase",
        f"--include={','.join(names)}",
        '--aptopt=APT::Install-Recommends "false"',
        f'--customize-hook={HERE}/customize.bash "$1" {HERE}/offered.txt',
        suite,
        str(target),
        "-",
    ]
    sources = re.sub(rf"\b{codename()}\b", suite, _sources().read_text())
    with log.open("w") as output:
        done = subprocess.run(command, input=sources, text=True, stdout=output, stderr=subprocess.STDOUT, check=False)
    if done.returncode:
        tail = "\n".join(log.read_text().splitlines()[-15:])
        raise RuntimeError(f"mmdebstrap failed ({done.returncode}); the end of {log}:\n{tail}")


def _key(*, programs: bool, suite: str) -> str:
    return f"{suite or codename()}-{platform.machine()}-{_digest(programs=programs)}"


def _digest(*, programs: bool) -> str:
    digest = hashlib.sha256()
    for name in (*RECIPE, PROGRAMS)[: len(RECIPE) + programs]:
        digest.update((HERE / name).read_bytes())
    return digest.hexdigest()[:12]


def codename() -> str:
    """Return the codename of this computer's release."""
    return platform.freedesktop_os_release().get("VERSION_CODENAME", "")


def _sources() -> Path:
    folder = Path("/etc/apt/sources.list.d")
    for name in ("debian.sources", "ubuntu.sources"):
        if (folder / name).is_file():
            return folder / name
    return Path("/etc/apt/sources.list")
