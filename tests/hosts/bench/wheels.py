"""The locked Python packages as wheels: fetched once through this computer's pip, for a package server on the bench."""

import fcntl
import hashlib
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from packaging.markers import Marker
from tests.hosts.bench.root import cache_folder

LOCK = Path(__file__).resolve().parents[3] / "requirements/run.lock"


def wheel_folder(python: tuple[int, int] = sys.version_info[:2]) -> Path:
    """The cached index of today's lock, made now when it is not there: a folder of wheels for each package's name.

    `python` is the version of the Python that is to install them. Safe against a second process and against being
    killed. Indexes of other locks are removed.
    """
    base = cache_folder()
    cache = base.with_name(f"{base.name}-wheels")
    cache.mkdir(parents=True, exist_ok=True)
    with (cache / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        digest = hashlib.sha256(LOCK.read_bytes()).hexdigest()[:12]
        target = cache / "{}{}-{}".format(*python, digest)
        if target.is_dir():
            return target
        for old in cache.iterdir():
            if old.is_dir() and not old.name.endswith(digest):
                shutil.rmtree(old)
        unfinished = Path(tempfile.mkdtemp(prefix="unfinished.", dir=cache))
        chosen = unfinished / "requirements.txt"
        chosen.write_text(choose_requirements(LOCK.read_text(), python))
        words = ["download", "--require-hashes", "--only-binary", ":all:", "--no-deps", "-r", str(chosen)]
        words += ["--python-version", "{}.{}".format(*python)]
        words += ["--quiet", "--progress-bar", "off", "--dest", str(unfinished)]
        subprocess.run([sys.executable, "-m", "pip", *words], check=True, timeout=800)
        for wheel in unfinished.glob("*.whl"):
            name = re.sub(r"[-_.]+", "-", wheel.name.split("-")[0]).lower()
            (unfinished / name).mkdir(exist_ok=True)
            wheel.rename(unfinished / name / wheel.name)
        chosen.unlink()
        unfinished.chmod(0o755)
        unfinished.rename(target)
        return target


def choose_requirements(lock: str, python: tuple[int, int]) -> str:
    """Choose the lines of a lock for a version of Python: pip evaluates markers for the Python that runs it."""
    version = "{}.{}".format(*python)
    environment = {"python_version": version, "python_full_version": f"{version}.0"}
    lines = []
    for line in lock.replace("\\\n", " ").splitlines():
        requirement, separator, rest = line.partition(" ; ")
        marker, dashes, hashes = rest.partition(" --hash")
        if not separator:
            lines.append(line)
        elif Marker(marker).evaluate(environment):
            lines.append(f"{requirement} {dashes}{hashes}")
    return "\n".join(lines) + "\n"
