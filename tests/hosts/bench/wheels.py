"""The locked Python packages as wheels: fetched once through this computer's pip, for a package server on the bench."""

from __future__ import annotations

import fcntl
import hashlib
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from tests.hosts.bench.root import cache_folder

LOCK = Path(__file__).resolve().parents[3] / "requirements/run.lock"


def wheel_folder() -> Path:
    """The cached index of today's lock, made now when it is not there: a folder of wheels for each package's name.

    Safe against a second process and against being killed. Indexes of other locks are removed.
    """
    base = cache_folder()
    cache = base.with_name(f"{base.name}-wheels")
    cache.mkdir(parents=True, exist_ok=True)
    with (cache / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        version = "{}{}".format(*sys.version_info[:2])
        target = cache / f"{version}-{hashlib.sha256(LOCK.read_bytes()).hexdigest()[:12]}"
        if target.is_dir():
            return target
        for old in cache.iterdir():
            if old.is_dir():
                shutil.rmtree(old)
        unfinished = Path(tempfile.mkdtemp(prefix="unfinished.", dir=cache))
        words = ["download", "--require-hashes", "--only-binary", ":all:", "--no-deps", "-r", str(LOCK)]
        words += ["--quiet", "--progress-bar", "off", "--dest", str(unfinished)]
        subprocess.run([sys.executable, "-m", "pip", *words], check=True, timeout=800)
        for wheel in unfinished.glob("*.whl"):
            name = re.sub(r"[-_.]+", "-", wheel.name.split("-")[0]).lower()
            (unfinished / name).mkdir(exist_ok=True)
            wheel.rename(unfinished / name / wheel.name)
        unfinished.chmod(0o755)
        unfinished.rename(target)
        return target
