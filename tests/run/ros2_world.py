"""A prefix of ROS 2 with a stand-in executable, and `ur` with it: nothing of ROS 2 has to be installed."""

import json
from pathlib import Path
from typing import Any

from tests.ros2_session import free_domain

MANIFEST = "<package><name>demo</name></package>"
SHOW = """#!/usr/bin/python3
import json, os, signal, sys, time
files = {each: open(each).read() for each in sys.argv if each.endswith(".yaml")}
names = ("MINE", "LESS", "OWN")
found = {"argv": sys.argv[1:], "files": files, "cwd": os.getcwd(), "environment": {n: os.environ.get(n) for n in names}}
place = os.path.join(os.environ["SHOW_FOLDER"], str(time.monotonic_ns()))
with open(place + ".part", "w") as file:
    json.dump(found, file)
os.rename(place + ".part", place + ".json")
print("shown", *sys.argv[1:2], flush=True)
for each in sys.argv:
    if each.startswith("exit:"):
        sys.exit(int(each[5:]))
signal.signal(signal.SIGINT, lambda *_: sys.exit(0))
while True:
    signal.pause()
"""


class Ros2World:
    """Files of launches below a folder, and what their stand-in executables were given."""

    def __init__(self, world: Any) -> None:
        self.world = world
        self.folder: Path = world.folder
        self.shown = self.folder / "shown"
        self.share = self.folder / "prefix/share/demo"
        program = self.folder / "prefix/lib/demo/show"
        for each in (self.shown, self.share / "launch", program.parent):
            each.mkdir(parents=True)
        (self.share / "package.xml").write_text(MANIFEST)
        program.write_text(SHOW)
        program.chmod(0o755)
        self.program = str(program)
        world.environment |= {
            "AMENT_PREFIX_PATH": str(self.folder / "prefix"),
            "LESS": "x",
            "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
            "ROS_DISTRO": "kilted",
            "ROS_DOMAIN_ID": free_domain(),
            "ROS_VERSION": "2",
            "SHOW_FOLDER": str(self.shown),
            "UR_ROBOT": "sim --ros 2",
        }

    def write(self, name: str, text: str) -> str:
        """Write a launch file of the package."""
        path = self.share / "launch" / name
        path.write_text(text, encoding="utf-8")
        return str(path)

    def found(self) -> list[dict[str, Any]]:
        """What the executables were given, in the order of their starts, with the texts of files in place of names."""
        values = [json.loads(each.read_text()) for each in sorted(self.shown.glob("*.json"), key=lambda p: int(p.stem))]
        for value in values:
            value["argv"] = [value["files"].get(word, word) for word in value["argv"]]
        return values

    def until_shown(self, run: Any, count: int) -> None:
        """Wait until so many executables have run."""
        while len(list(self.shown.glob("*.json"))) < count:
            assert run.process.poll() is None, run.text
            run.read()

    def argv(self) -> list[list[str]]:
        """The arguments of all executables, sorted."""
        return sorted(value["argv"] for value in self.found())
