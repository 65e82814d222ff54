from pathlib import Path

import pytest

from ur_nodes.file_facts import FileFacts


def test_fact_is_known_to_nodes_that_start_later(tmp_path: Path) -> None:
    file = tmp_path / "run" / "facts.json"
    FileFacts(simulated_time=False, file=file).set("base_name", "magni")
    assert FileFacts(simulated_time=False, file=file).get("base_name") == "magni"


def test_unknown_fact_has_its_default(tmp_path: Path) -> None:
    assert FileFacts(simulated_time=False, file=tmp_path / "facts.json").get("lease", 7) == 7


@pytest.mark.parametrize("text", ["", "{", "[1]", '"word"'])
def test_file_that_holds_no_facts_is_as_an_empty_one(tmp_path: Path, text: str) -> None:
    file = tmp_path / "facts.json"
    file.write_text(text)
    facts = FileFacts(simulated_time=False, file=file)
    assert facts.get("lease") is None
    facts.set("lease", {"owner": "page"})
    assert facts.get("lease") == {"owner": "page"}


def test_others_may_not_read_the_folder_of_facts(tmp_path: Path) -> None:
    file = tmp_path / "run" / "facts.json"
    FileFacts(simulated_time=False, file=file).set("base_name", "magni")
    assert file.parent.stat().st_mode & 0o077 == 0
    assert file.stat().st_mode & 0o077 == 0
