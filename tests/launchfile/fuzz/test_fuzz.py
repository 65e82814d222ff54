import random
from pathlib import Path

import pytest
from tests.fuzz.mutate import mutate
from tests.launchfile.fuzz.survive import CORPUS, WORDS, check_survives, read_corpus


def test_broken_launch_files_never_raise(tmp_path: Path) -> None:
    chance = random.Random(1)  # the same files every time; other ones: python -m tests.launchfile.fuzz
    corpus = read_corpus()
    path = tmp_path / "a.launch"
    for number in range(1500):
        data = mutate(corpus, WORDS, chance)
        path.write_bytes(data)
        try:
            check_survives(path, {"ROS_PACKAGE_PATH": str(CORPUS), "HOME": "/home/robot"})
        except Exception as problem:
            pytest.fail(f"file {number}, {problem!r}: {data!r}")
