"""Core files: where they are by the rules of core(5), whose they are, and why there is none."""

import os
import resource
import shutil
import subprocess
from pathlib import Path

import pytest

from ur.run.debugger.environment import (
    APPORT,
    CoreNames,
    CoreRules,
    belongs_to,
    explain_no_core,
    find_core_dump,
    plan_search,
    read_core_rules,
    read_node_facts,
)


@pytest.mark.parametrize(("pattern", "uses_pid", "expected"), [
    ("core\n", False, "/ros/core"),
    ("core", True, "/ros/core.*"),
    ("core.%p", True, "/ros/core.*"),
    ("/cores/%e.%p", False, "/cores/talker.*"),
    ("/cores/%E-%t", False, "/cores/!opt!my[[]1]!talker-*"),
    ("/cores/100%%-%h", False, "/cores/100%-*"),
    ("/co[r]es/core", False, "/co[[]r]es/core"),
    ("|/usr/share/apport/apport -p%p", False, f"{APPORT}/core._opt_my[[]1]_talker.*"),
])  # fmt: skip
def test_place_of_core_files(pattern: str, uses_pid: bool, expected: str) -> None:
    found = plan_search(CoreRules(pattern, uses_pid), "/opt/my[1]/talker", "/ros")
    assert (found.keeper, found.patterns) == ("file", (expected,))


def test_long_names_are_cut_as_the_kernel_does() -> None:
    assert plan_search(CoreRules("/c/%e"), "/x/a_name_of_many_letters", "/").patterns == ("/c/a_name_of_many_",)


@pytest.mark.parametrize(("pattern", "keeper"), [
    ("|/usr/lib/systemd/systemd-coredump %P", "coredumpctl"),
    ("|/usr/bin/mine %p", "unknown"),
    ("|", "unknown"),
])  # fmt: skip
def test_handlers_are_known_or_named(pattern: str, keeper: str) -> None:
    assert plan_search(CoreRules(pattern), "/x/a", "/ros").keeper == keeper


@pytest.mark.parametrize(("rules", "told"), [
    (CoreRules("core", limit=0), "ulimit -c unlimited"),
    (CoreRules("|/usr/bin/mine %p"), "/usr/bin/mine"),
    (CoreRules("|/usr/lib/systemd/systemd-coredump"), "coredumpctl"),
    (CoreRules("/cores/%e"), "in /cores"),
    (CoreRules("core"), "in /ros"),
])  # fmt: skip
def test_no_core_file_has_a_reason(rules: CoreRules, told: str) -> None:
    names = plan_search(rules, "/x/a", "/ros")
    assert told in explain_no_core(rules, names, "/ros")
    assert CoreNames("unknown") != names or rules.pattern


@pytest.mark.parametrize(
    "data", [b"", b"\x7fELF", b"\x7fELF" + bytes(60), b"\x7fELF\x02\x01" + b"\xff" * 200, b"text" * 99]
)
def test_what_is_no_core_file_belongs_to_nobody(data: bytes) -> None:
    assert not belongs_to(data, "/x/a")


@pytest.fixture
def crash(tmp_path: Path) -> tuple[Path, Path]:
    """A program of its own that has crashed, and the folder it crashed in. Skips where core files go elsewhere."""
    program, folder = tmp_path / "program", tmp_path / "folder"
    folder.mkdir()
    shutil.copy(shutil.which("sleep") or "/bin/sleep", program)
    hard = resource.getrlimit(resource.RLIMIT_CORE)[1]
    process = subprocess.Popen(
        [str(program), "600"], cwd=folder, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CORE, (hard, hard))
    )
    process.send_signal(11)
    process.wait()
    if not list(folder.iterdir()):
        pytest.skip("this system keeps core files elsewhere")
    return program, folder


def test_core_file_of_a_crash_is_found_and_others_are_not(crash: tuple[Path, Path]) -> None:
    program, folder = crash
    rules = CoreRules(read_core_rules(os.getpid()).pattern, bool(list(folder.glob("core.*"))), None)
    command, why = find_core_dump(str(program), str(folder), rules)
    assert command[:3] == ("gdb", "-q", str(program))
    assert Path(command[3]).parent == folder
    assert not why
    assert find_core_dump("/bin/bash", str(folder), rules) == ((), f"no core file of it in {folder}")


def test_facts_of_a_crashed_node_name_its_core_file(crash: tuple[Path, Path]) -> None:
    program, folder = crash
    facts = read_node_facts("/a", str(program), str(folder), None, os.getpid())
    assert facts.core_dump[2] == str(program)


def test_facts_of_a_running_node_name_the_executable_of_its_process() -> None:
    facts = read_node_facts("/a", "/no/such/script", "/", os.getpid(), os.getpid())
    assert facts.process == str(Path("/proc/self/exe").readlink())
    assert facts.python
    assert read_node_facts("/a", "/bin/sh", "/", 2**22 + 1, os.getpid()).pid is None
