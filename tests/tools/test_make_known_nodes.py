"""Topics of the library's nodes are declared in the heads of their executables, and made tables and pages of that."""

import re
import runpy
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
TOOL = runpy.run_path(str(ROOT / "tools/make_known_nodes.py"))
EXECUTABLES = sorted((ROOT / "ubiquity_launches").glob("n_*/bin/*"))
WITHOUT_TOPICS = {"sleep_forever"}


@pytest.mark.parametrize("place", TOOL["FILES"], ids=lambda place: place.name)
def test_committed_file_is_what_the_tool_makes(place: Path) -> None:
    text = place.read_text(encoding="utf-8")
    assert text == TOOL["FILES"][place](text), "run tools/make_known_nodes.py"


def test_every_node_of_the_library_declares_its_topics() -> None:
    assert {path.name for path in EXECUTABLES} - set(TOOL["read_heads"]()) == WITHOUT_TOPICS


def test_every_source_says_which_node_sends_it() -> None:
    text = TOOL["SOURCES"].read_text(encoding="utf-8")
    topics = text.partition("\nlocks:")[0]
    assert len(re.findall(r"- name: \w+ # sent by ", topics)) == topics.count("- name:")


def test_names_are_read_with_their_notes() -> None:
    head = TOOL["read_head"](
        "#!/bin/bash\n##Publishes: `a` (latched), `b`\n## and `c` (where it has one)\n##Python: `x`\n"
    )
    assert head == {"Publishes": "`a` (latched), `b` and `c` (where it has one)"}
    assert TOOL["list_names"](head["Publishes"], certain=True) == ["a", "b"]
    assert TOOL["list_names"]("`/clock`, `bumper/<name>`, `c` (where)", certain=False) == ["clock", "c"]
