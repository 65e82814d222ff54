import random
from pathlib import Path

import pytest

from ur.web.runs.watcher import ReadBack


class Node:
    """A node that prints into its log file, and a run that sends its lines some time later."""

    def __init__(self, folder: Path) -> None:
        self.path = folder / "talk.log"
        self.path.touch()
        self.shown: list[str] = []
        self.read_back = ReadBack(lambda _node, _severity, text: self.shown.append(text))
        self.printed: list[str] = []

    @property
    def logs(self) -> dict[str, str]:
        return {"/talk": str(self.path)}

    def print(self, count: int) -> None:
        with self.path.open("a") as file:
            for _ in range(count):
                self.printed.append(f"line {len(self.printed)}")
                file.write(self.printed[-1] + "\n")

    def send(self, first: int, last: int) -> None:
        for text in self.printed[first:last]:
            self.read_back.process("/talk", "", text)


@pytest.mark.parametrize("seed", range(50))
def test_each_line_is_shown_once_whenever_it_is_printed_and_sent(seed: int, tmp_path: Path) -> None:
    chance = random.Random(seed)
    node = Node(tmp_path)
    node.print(chance.randrange(4))
    node.read_back.begin(node.logs)
    node.print(chance.randrange(4))
    first = sent = len(node.printed)  # from here on the run sends lines
    node.print(chance.randrange(4))
    sent = chance.randint(sent, len(node.printed))
    node.send(first, sent)
    node.print(chance.randrange(4))
    node.read_back.confirm(node.logs)
    node.print(chance.randrange(4))
    node.send(sent, len(node.printed))
    assert node.shown == node.printed


def test_lines_that_are_equal_are_shown_as_often_as_they_are_sent_later(tmp_path: Path) -> None:
    node = Node(tmp_path)
    node.print(1)
    node.read_back.begin(node.logs)
    node.read_back.confirm(node.logs)
    for _ in range(3):
        node.read_back.process("/talk", "", "line 0")
    assert node.shown == ["line 0"] * 4


def test_second_confirmation_reads_nothing(tmp_path: Path) -> None:
    node = Node(tmp_path)
    node.read_back.begin(node.logs)
    node.read_back.confirm(node.logs)
    node.print(1)
    node.read_back.confirm(node.logs)
    node.send(0, 1)
    assert node.shown == ["line 0"]
