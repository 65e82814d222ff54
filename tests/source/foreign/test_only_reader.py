"""Files of other people are opened by `ur.source.foreign` only; modules that open any other file are listed here."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

SRC = Path(__file__).parents[3] / "src"
READERS = ("ur/source/foreign/",)
OPENERS = {"open", "read_text", "read_bytes", "fromfile", "memmap"}
PARSERS = {
    *(f"yaml.{name}" for name in ("load", "safe_load", "load_all", "safe_load_all", "full_load", "unsafe_load")),
    *(f"{module}.{name}" for module in ("ElementTree", "ET") for name in ("fromstring", "parse", "iterparse", "XML")),
    *("json.load", "np.load", "numpy.load", "tarfile.open", "zipfile.ZipFile", "Image.open", "shutil.unpack_archive"),
}
WORLDS = (
    "world",
    "self.world",
    "self._world",
    "workspace.world",
    "cached",
    "draft.world",
    "self.sources",
    "session.sources",
)  # which read by the reader

OURS = "a file of this project or of an installed package"
STATE = "a file that this program has written into a folder of its user"
KERNEL = "a file of the kernel, or a device"
WRITTEN = "opened to write or to lock"
LOG = "a log that this program has started"
ROBOT = "runs on the robot as one file, without the library"
IMAGE = "an image of a system, several gigabytes; read in blocks of a known size"
RECORDING = "a recording of any size, read piece by piece; see ur.recordings.mcap_file"
MAP = "a file of the store, checked when it came into it; the file object is the reader's"
FOLDER = "a folder; nothing in it is read"
USER = "a file or descriptor that its user has named for secrets, which may be a pipe"

# Module, and why it opens a file by itself.
ALLOWED = {
    "ur_nodes/drivers/lines/motor_guard.py": OURS,
    "ur_nodes/simulator/devices/terminal.py": WRITTEN,
    "ur_nodes/black_box/recording_file.py": WRITTEN,
    "ur/report/archive.py": WRITTEN,
    "ur/report/recording.py": STATE,
    "ur/report/sources.py": STATE,
    "ur/run/record/plan_record.py": WRITTEN,
    "ur_nodes/recorder/split_writer.py": WRITTEN,
    "ur/recordings/datagrams.py": FOLDER,
    "ur/recordings/lock_step.py": WRITTEN,
    "ur/recordings/mcap_file.py": RECORDING,
    "ur_nodes/lock_step/run.py": STATE,
    "ur_nodes/file_facts.py": STATE,
    "ur_nodes/one_process/plan.py": STATE,
    "ur_nodes/ros2/messages/definitions.py": OURS,
    "ur_nodes/ros2/survey.py": ROBOT,
    "ur/check/cache/program.py": OURS,
    "ur/check/cache/store.py": STATE,
    "ur/complete/names.py": OURS,
    "ur/robot/doctor/fix.py": WRITTEN,
    "ur/cli/files/new_things.py": OURS,
    "ur/cli/answers.py": USER,
    "ur/cli/robot_setup/image.py": KERNEL,
    "ur/cli/robot_setup/image_answers.py": USER,
    "ur/cli/workspace/build.py": OURS,
    "ur/cli/workspace/mount.py": KERNEL,
    "ur/cli/robots/shell.py": LOG,
    "ur/robot/sync/paths.py": WRITTEN,
    "ur/cli/robots/wifi.py": WRITTEN,
    "ur/cli/runs/logs.py": LOG,
    "ur/system/debian_root.py": KERNEL,
    "ur/devices/known.py": OURS,
    "ur/devices/probe.py": OURS,
    "ur/devices/probe_program.py": KERNEL,
    "ur/docs/site/render.py": OURS,
    "ur/fleet/logs.py": WRITTEN,
    "ur/get/hints.py": OURS,
    "ur/get/record.py": STATE,
    "ur/installed.py": STATE,
    "ur/cli/robots/mcp.py": LOG,
    "ur/mcp/action_log.py": STATE,
    "ur/mcp/grants.py": KERNEL,
    "ur/mcp/resources.py": OURS,
    "ur/maps/exchange.py": WRITTEN,
    "ur/maps/scan_file.py": MAP,
    "ur/maps/store.py": WRITTEN,
    "ur/maps/editing.py": MAP,
    "ur/tools/new/write.py": WRITTEN,
    "ur/request/requirements/python_packages.py": WRITTEN,
    "ur/robot/commit_confirm/guarded.py": WRITTEN,
    "ur/request/remote/link_guard.py": ROBOT,
    "ur/request/remote/over_ssh.py": OURS,
    "ur/robot/deploy/build_attached.py": ROBOT,
    "ur/robot/deploy/repository.py": OURS,
    "ur/robot/deploy/repository_side.py": ROBOT,
    "ur/robot/discovery/seen.py": STATE,
    "ur/robot/ros2/finder.py": ROBOT,
    "ur/robot/ros2/observe.py": OURS,
    "ur/robot/image/copy.py": IMAGE,
    "ur/robot/image/device.py": KERNEL,
    "ur/robot/image/host_key.py": STATE,
    "ur/robot/image/layout.py": IMAGE,
    "ur/robot/image/volume.py": IMAGE,
    "ur/robot/selection.py": STATE,
    "ur/robot/setup/engine.py": OURS,
    "ur/robot/setup/robot.py": WRITTEN,
    "ur/robot/ssh/host_key.py": STATE,
    "ur/robot/ssh/openssh.py": LOG,
    "ur/robot/sync/memory.py": STATE,
    "ur/robot/sync/side.py": ROBOT,
    "ur/robot/sync/sync.py": OURS,
    "ur/run/clients/client.py": STATE,
    "ur/run/debugger/environment.py": KERNEL,
    "ur/run/debugger/pane.py": KERNEL,
    "ur/run/host/cgroup.py": KERNEL,
    "ur/run/host/descendants.py": KERNEL,
    "ur/run/join/claims.py": STATE,
    "ur/run/join/eviction.py": KERNEL,
    "ur/run/join/lock.py": WRITTEN,
    "ur/run/master/search.py": KERNEL,
    "ur/run/middleware/facts.py": STATE,
    "ur/run/output/log_cut.py": LOG,
    "ur/run/output/node_output.py": LOG,
    "ur/run/output/router.py": LOG,
    "ur/run/paths.py": KERNEL,
    "ur/run/detach.py": WRITTEN,
    "ur/run/process/host_client.py": KERNEL,
    "ur/run/process/missing_package.py": OURS,
    "ur/run/process/stats.py": KERNEL,
    "ur/run/record/computer.py": KERNEL,
    "ur/run/record/ended.py": STATE,
    "ur/run/record/registry.py": STATE,
    "ur/run/remote/clients.py": STATE,
    "ur/run/remote/local_runs.py": KERNEL,
    "ur/run/remote/own_clients.py": WRITTEN,
    "ur/run/remote/signs.py": KERNEL,
    "ur/run/remote/start.py": STATE,
    "ur/run/startup/start_count.py": KERNEL,
    "ur/source/crash.py": WRITTEN,
    "ur/source/printable.py": KERNEL,
    "ur/source/project.py": OURS,
    "ur/source/replace.py": WRITTEN,
    "ur/source/run_users.py": STATE,
    "ur/system/releases.py": OURS,
    "ur/system/ros.py": KERNEL,
    "ur/web/runs/log_lines.py": LOG,
    "ur/web/server/data/three.py": OURS,
    "ur/web/server/link_files.py": STATE,
    "ur/web/server/logins/session_file.py": STATE,
    "ur/web/server/recordings/store.py": WRITTEN,
    "ur/web/server/serve.py": WRITTEN,
    "ur/web/server/static_files.py": OURS,
    "ur_nodes/camera/device_file.py": KERNEL,
    "ur_nodes/camera/finder.py": KERNEL,
    "ur_nodes/motion/joystick/joy_reader.py": KERNEL,
    "ur_nodes/motion/lease/store.py": STATE,
    "ur_nodes/run.py": KERNEL,
    "ur_nodes/teleop/keyboard/link_watch.py": STATE,
    "ur_nodes/teleop/terminal/textual_screen.py": WRITTEN,
    "ur_nodes/web/status/computer_files.py": KERNEL,
}


def find_calls(text: str) -> list[str]:
    """The calls of a module's text that open a file or parse one without limits, each with its line."""
    found = []
    for node in ast.walk(ast.parse(text)):
        if not isinstance(node, ast.Call):
            continue
        whole = ast.unparse(node.func)
        owner, _, name = whole.rpartition(".")
        method = bool(owner) and owner not in WORLDS and name in OPENERS
        opens_nothing = name == "open" and method and not node.args and not node.keywords  # a panel, a connection
        own = (
            owner in ("self", "self._end")
            or "query_one" in owner
            or owner.endswith(("_monitor", "_outputs", "listener"))
        )
        if whole in PARSERS or whole == "open" or (method and not opens_nothing and not own):
            found.append(f"{node.lineno}: {ast.unparse(node)[:80]}")
    return found


MODULES = {path.relative_to(SRC).as_posix(): path for path in sorted(SRC.rglob("*.py"))}


def test_files_are_opened_by_the_reader_only() -> None:
    found = {
        name: calls
        for name, path in MODULES.items()
        if not name.startswith(READERS)
        and name not in ALLOWED
        and (calls := find_calls(path.read_text(encoding="utf-8")))
    }
    assert not found, "read them by ur.source.foreign, or say in ALLOWED why they are not foreign"


@pytest.mark.parametrize("name", ALLOWED)
def test_each_exception_is_needed(name: str) -> None:
    assert find_calls(MODULES[name].read_text(encoding="utf-8"))


@pytest.mark.parametrize(
    "text", ["open(a)", "path.read_text()", "Path(a).open('rb')", "yaml.safe_load(a)", "np.load(a)", "os.open(a, 0)"]
)
def test_calls_that_open_files_are_found(text: str) -> None:
    assert find_calls(text)


@pytest.mark.parametrize(
    "text", ["read_text(a)", "world.read_bytes(a)", "open_file(a)", "json.loads(a)", "finder.open()"]
)
def test_calls_of_the_reader_are_not_found(text: str) -> None:
    assert not find_calls(text)
