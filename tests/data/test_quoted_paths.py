"""Paths with apostrophes and blanks: no launch file of the library lets one of them become a word of a command."""

from __future__ import annotations

import re
import shlex
import shutil
from pathlib import Path

import pytest
from tests.base_contract import PACKAGE

from ur.launchfile.load import load_plan
from ur.launchfile.plan.specs import Plan
from ur.launchfile.world.system import SystemWorld

_PATHS = re.compile(r'<arg name="((?:\w+_)?(?:file|path|folder|config|world|map|map_name|topic|image))"')
_VALUE = '<arg name="(\\w+)"/>'
_NAMES = sorted(
    {
        (file, name)
        for path in PACKAGE.glob("*/launch/*.xml")
        for file in [str(path.relative_to(PACKAGE))]
        for name in _PATHS.findall(path.read_text(encoding="utf-8").partition("<include")[0])
    }
)
_KNOWN = {"robot_base": "magni", "world": "maze"}


def load(library: Path, file: str, values: dict[str, str]) -> Plan:
    text = (library / file).read_text(encoding="utf-8")
    required = {name: _KNOWN.get(name, "1") for name in re.findall(_VALUE, text.partition("<include")[0])}
    words = [f"{name}:={value}" for name, value in (required | values).items()]
    return load_plan([str(library / file)], words, SystemWorld({"ROS_PACKAGE_PATH": str(library)}))


def list_words(plan: Plan) -> list[str]:
    """The words that roslaunch makes of prefixes and arguments, of all nodes."""
    return [word for node in plan.nodes for text in (node.launch_prefix or "", node.args) for word in shlex.split(text)]


@pytest.mark.parametrize(("file", "name"), _NAMES)
def test_value_with_an_apostrophe_adds_no_word_to_a_command(file: str, name: str) -> None:
    words = [
        list_words(load(PACKAGE, file, {name: value})) for value in ("/x/a", "/x/o'brien lab' sh -c 'touch PWN' '")
    ]
    assert len(words[0]) == len(words[1]), words
    assert not any("PWN" in word for word in words[1])


def test_every_launch_file_can_be_split_in_a_library_below_a_folder_with_an_apostrophe(tmp_path: Path) -> None:
    library = tmp_path / "o'brien lab" / PACKAGE.name
    shutil.copytree(PACKAGE, library, ignore=shutil.ignore_patterns("*.png", "*.pgm", "*.stl", "*.dae"))
    files = sorted(str(path.relative_to(library)) for path in library.glob("*/launch/*.xml"))
    assert len(files) > 40
    for file in files:
        assert not [word for word in list_words(load(library, file, {})) if "brien" in word], file
