from pathlib import Path

from ur.run.middleware.facts import clear_facts, read_facts, write_facts


def test_facts_are_those_that_were_written_last(tmp_path: Path) -> None:
    path = str(tmp_path / "deep/facts-7.json")
    assert read_facts(path) == {}
    write_facts(path, {"run_id": "a"})
    write_facts(path, {"run_id": "b"})
    assert read_facts(path) == {"run_id": "b"}
    assert [each.name for each in Path(path).parent.iterdir()] == ["facts-7.json"]


def test_facts_are_cleared_with_what_nodes_keep_beside_them_and_no_others(tmp_path: Path) -> None:
    for name in ("facts-7.json", "facts-7.mux.json", "facts-7..parameters.json", "facts-70.json", "facts-70.mux.json"):
        (tmp_path / name).write_text("{}")
    clear_facts(str(tmp_path / "facts-7.json"))
    assert sorted(each.name for each in tmp_path.iterdir()) == ["facts-70.json", "facts-70.mux.json"]


def test_damaged_facts_are_none(tmp_path: Path) -> None:
    for text in ("[1]", "{", "\0"):
        (tmp_path / "facts.json").write_text(text)
        assert read_facts(str(tmp_path / "facts.json")) == {}
