"""What a command has reported as done is there after a power cut, and nothing that it replaces is lost half-way."""

from pathlib import Path
from typing import NamedTuple

import pytest
from tests.power_cut import can_cut_power, cut_power

pytestmark = pytest.mark.skipif(not can_cut_power(), reason="only root may mount a disk")

SET_UP = """\
import getpass
from ur.robot.setup.engine import apply_change
from ur.robot.setup.facts import fact_script, parse_facts
from ur.robot.setup.keys import WantedKeyPair
from ur.robot.setup.wanted import WantedFile, WantedLine
from ur.robot.ssh.shell import LocalShell
shell, item = LocalShell(), {item}
request = item.request(getpass.getuser())
apply_change(shell, item.plan(parse_facts(request, shell.run(fact_script(request)).out)))
"""
PACKAGE = """\
mkdir p; cat >p/package.xml <<END
<package format="2"><name>p</name><version>1.0.0</version><description>d</description>
<maintainer email="a@b.c">m</maintainer><license>BSD</license></package>
END
echo '<launch><node name="a"   pkg="p" type="t"/></launch>' >p/a.launch; echo '# old' >p/launches.md
"""


class Case(NamedTuple):
    """What was on the disk (a shell script), what is done (Python), and what a file then has to hold."""

    before: str
    action: str
    path: str
    text: str


def run_ur(*words: str) -> str:
    return f"import sys\nfrom ur.cli.main import main\nsys.exit(main({list(words)!r}))"


def set_up(item: str) -> str:
    return SET_UP.format(item=item)


CASES = {
    "ur use": Case(":", run_ur("use", "sim:magni"), ".config/ubiquity_launches/selection", "sim:magni"),
    "ur format": Case(PACKAGE, run_ur("format", "p"), "p/a.launch", '<node name="a" '),
    "ur docs": Case(PACKAGE, run_ur("docs", "p", "--output", "p/launches.md"), "p/launches.md", "a.launch"),
    "check --package": Case(PACKAGE, run_ur("check", "--package", "--fix", "p"), "p/CMakeLists.txt", "catkin_package"),
    "new files": Case(
        ":",
        "from pathlib import Path\nfrom ur.tools.new.parts import NewFile\nfrom ur.tools.new.parts import write_files\n"
        "write_files(Path(), [NewFile('n_a/launch/a', 'new'), NewFile('b', 'new')])",
        "n_a/launch/a",
        "new",
    ),
    "waypoints": Case(
        "mkdir w; echo 'old: [1.0, 2.0, 3.0]' >w/map.yaml",
        "from pathlib import Path\nfrom ur_nodes.client.snapshot import Pose2\n"
        "from ur_nodes.client.waypoints import WaypointStore\n"
        "WaypointStore(Path('w/map.yaml')).remember('desk', Pose2(1.0, 2.0, 3.0))",
        "w/map.yaml",
        "desk",
    ),
    "map of fiducials": Case(
        "echo >map",
        "import numpy as np\nfrom ur_nodes.vision.fiducial_map import MapEntry, write_map\n"
        "write_map('map', [MapEntry(7, np.eye(4), np.eye(6))])",
        "map",
        "#covariance 7",
    ),
    "memory of a sync": Case(
        ":",
        "from pathlib import Path\nfrom ur.robot.sync.steps import SyncMemory, WorkspacePair, store_memory\n"
        "store_memory(Path('s/bob.json'), SyncMemory(WorkspacePair('a', 'b', 'c'), {}))",
        "s/bob.json",
        "agreed",
    ),
    "file of a set-up": Case(
        "mkdir .config; echo old >.config/a", set_up("WantedFile('t', '~/.config/a', 'new')"), ".config/a", "new"
    ),
    "file that a set-up keeps": Case(
        "mkdir .config; echo old >.config/a",
        set_up("WantedFile('t', '~/.config/a', 'new')"),
        ".local/state/ubiquity_launches/setup/before%.config%a",
        "old",
    ),
    "file of a set-up in new folders": Case(":", set_up("WantedFile('t', '~/.a/b/c/d', 'new')"), ".a/b/c/d", "new"),
    "line of a set-up": Case("echo old >.bashrc", set_up("WantedLine('t', '~/.bashrc', 'new')"), ".bashrc", "old\nnew"),
    "key": Case(":", set_up("WantedKeyPair('t', '~/.ssh/id_ed25519', 'c')"), ".ssh/id_ed25519", "PRIVATE KEY"),
    "copy on the robot": Case(
        "mkdir r; echo old >r/a",
        "import base64\nfrom pathlib import Path\nfrom ur.robot.deploy.repository_side import put\n"
        "put(Path('r'), 'd', {'a': (0o644, base64.b64encode(b'new').decode())})",
        "r/a",
        "new",
    ),
}


@pytest.mark.parametrize("others_flush", [False, True], ids=["alone", "others flush"])
@pytest.mark.parametrize("name", CASES)
def test_what_was_written_outlives_a_power_cut(tmp_path: Path, name: str, others_flush: bool) -> None:
    case = CASES[name]
    after = cut_power(tmp_path, case.action, prepare=case.before, others_flush=others_flush)
    assert case.text in (after / case.path).read_text()
    assert not [path for path in after.rglob("*") if path.name.endswith((".new", ".ur-new"))]
