"""The same plan as the installed roslaunch, or refused by both: for our corpus and for what Debian ships."""

from pathlib import Path
from typing import Any

import pytest

CORPUS = Path(__file__).parent / "corpus"
GROUPS = sorted(path.name for path in CORPUS.iterdir() if any(path.glob("*.launch")))
SHIPPED = sorted(
    path
    for package in Path("/usr/share").glob("*/package.xml")
    for pattern in ("*.launch", "*.launch.xml", "*.test")
    for path in package.parent.rglob(pattern)
)


@pytest.fixture(autouse=True)
def _needs_roslaunch() -> None:
    if not Path("/usr/lib/python3/dist-packages/roslaunch").exists():
        pytest.skip("python3-roslaunch is not installed")


def test_corpus_is_as_large_as_promised() -> None:
    assert len(list(CORPUS.rglob("*.launch"))) >= 150


@pytest.mark.parametrize("group", GROUPS)
def test_corpus_means_what_roslaunch_says(group: str, compare: Any) -> None:
    found = [line for path in sorted((CORPUS / group).glob("*.launch")) for line in compare(path)]
    assert not found, "\n".join(found)


@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.name)
def test_shipped_files_mean_what_roslaunch_says(path: Path, compare: Any) -> None:
    assert not compare(path)
