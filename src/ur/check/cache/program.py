"""A digest of the checker itself: another version may have other findings in the same files."""

# ruff: noqa: PTH118, PTH123

import hashlib
import os
import sys
from xml.parsers import expat

import yaml

_PACKAGES = ("check", "launchfile", "source")  # all that takes part in a check


def digest_program() -> str:
    """Return a digest of the source of all involved modules, and of the versions of the parsers."""
    top = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))  # noqa: PTH120, PTH100
    digest = hashlib.blake2b(digest_size=20)
    digest.update(repr((sys.version, yaml.__version__, yaml.__with_libyaml__, expat.EXPAT_VERSION)).encode())
    for path in sorted(path for package in _PACKAGES for path in _sources(os.path.join(top, package))):
        with open(path, "rb") as file:
            data = file.read()
        digest.update(f"\n{path.removeprefix(top)} {len(data)}\n".encode("utf-8", "surrogateescape"))
        digest.update(data)
    return digest.hexdigest()


def _sources(folder: str) -> list[str]:
    return [os.path.join(place, name) for place, _, names in os.walk(folder) for name in names if name.endswith(".py")]
