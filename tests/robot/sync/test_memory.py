"""What was agreed at the last sync comes back as it was stored; whatever else lies there counts as nothing."""

from pathlib import Path

import pytest

from ur.robot.sync.steps import (
    Agreed,
    File,
    SyncMemory,
    WorkspacePair,
    known_files,
    load_memory,
    memory_path,
    store_memory,
)

FILE = File("file", 3, 5, True, "abc")
MEMORY = SyncMemory(
    WorkspacePair("/here", "/there", "id"), {"p/odd \udce4": Agreed(FILE, File("file", 3, 6, True, "abc"))}
)


def test_memory_comes_back(tmp_path: Path) -> None:
    path = memory_path("bob", {"XDG_STATE_HOME": str(tmp_path)})
    store_memory(path, MEMORY)
    assert load_memory(path) == MEMORY
    assert [each.name for each in path.parent.iterdir()] == ["bob.json"]


@pytest.mark.parametrize(
    "text", ["", "{}", '{"version": 99}', '{"version": 1, "pair": {}, "agreed": {"a": [1]}}', "[1]"]
)
def test_memory_that_makes_no_sense_counts_as_none(tmp_path: Path, text: str) -> None:
    path = tmp_path / "bob.json"
    path.write_text(text)
    assert load_memory(path) is None


def test_each_side_knows_its_own_times() -> None:
    assert known_files(MEMORY.agreed, "here") == {"p/odd \udce4": (3, 5, "abc")}
    assert known_files(MEMORY.agreed, "there") == {"p/odd \udce4": (3, 6, "abc")}
