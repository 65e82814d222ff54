"""`ur mcp list`, `end`, `log` and refusals of grants, with the files of servers that run."""

import os
from pathlib import Path

import pytest

from ur.cli.main import main
from ur.mcp.grants import GrantFiles, Request, ServerRecord, grant_files, make_area, make_grant


@pytest.fixture
def files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> GrantFiles:
    """Two assistants: `one` asks to drive, `two` may drive outside of the kitchen."""
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    found = grant_files()
    found.note_server("one", ServerRecord(os.getpid(), "Ada's helper", Request(reason="to look at the door")))
    found.note_server("two", ServerRecord(os.getpid(), "Bob's helper"))
    found.give("two", make_grant(5.0, 0.2, (), (make_area(2.0, 1.0, 5.0, 4.0, "kitchen"),)))
    return found


@pytest.mark.usefixtures("files")
def test_assistants_are_listed_with_what_they_may_and_want(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["mcp", "list"]) == 0
    first, second = capsys.readouterr().out.splitlines()
    assert first == "one  Ada's helper: may look; asks to drive: to look at the door"
    assert second.startswith("two  Bob's helper: ")
    assert "not kitchen" in second
    assert second.endswith("5 min left")


def test_grants_are_taken_back_and_the_log_names_who_did(files: GrantFiles, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["mcp", "log"]) == 0
    assert "no assistant has asked" in capsys.readouterr().err
    assert main(["mcp", "end"]) == 0
    assert capsys.readouterr().out == "1 grant was taken back\n"
    assert files.find("two") is None
    assert main(["mcp", "end", "--of", "one"]) == 0
    assert capsys.readouterr().out == "0 grants were taken back\n"
    assert main(["mcp", "log"]) == 0
    assert "taken back in a terminal, by " in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["end", "--of", "three"], "unknown server 'three'"),
        (["grant", "--to", "one"], "standard input is no terminal, expected a person who gives the grant"),
        (["grant", "--minutes", "0"], "0"),
    ],
)
def test_wrong_words_and_grants_without_a_person_are_refused(
    files: GrantFiles, words: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["mcp", *words]) == 2
    assert message in capsys.readouterr().err
    assert files.find("one") is None
