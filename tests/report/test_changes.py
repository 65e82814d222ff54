"""Changes of a workspace are those of git, and nothing that its repository names runs."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

from ur.report.sources import read_changes

pytestmark = pytest.mark.skipif(shutil.which("git") is None, reason="git is not installed")
PLAIN = {
    "PATH": os.defpath,
    "GIT_CONFIG_GLOBAL": os.devnull,
    **{f"GIT_{who}_{what}": "a@b" for who in ("AUTHOR", "COMMITTER") for what in ("NAME", "EMAIL")},
}


def run_git(folder: Path, *words: str) -> None:
    subprocess.run(["git", "-C", str(folder), *words], check=True, env=PLAIN, capture_output=True)


def make_repository(folder: Path) -> Path:
    folder.mkdir()
    run_git(folder, "init", "-q")
    (folder / "a.launch").write_text("one\n")
    run_git(folder, "add", ".")
    run_git(folder, "commit", "-qm", "first")
    (folder / "a.launch").write_text("two\n")
    return folder


def test_changes_are_those_since_the_last_commit_with_both_versions(tmp_path: Path) -> None:
    assert read_changes(tmp_path).text == ""
    folder = make_repository(tmp_path / "ws")
    below = folder / "src"
    below.mkdir()
    changes = read_changes(below)
    assert "-one\n+two\n" in changes.text
    assert changes.text.startswith("commit ")
    assert changes.versions == (("a.launch", "one\n"), ("a.launch", "two\n"))


def test_packed_references_and_other_work_trees_are_read(tmp_path: Path) -> None:
    folder = make_repository(tmp_path / "ws")
    run_git(folder, "pack-refs", "--all")
    assert "+two\n" in read_changes(folder).text
    run_git(folder, "worktree", "add", "-q", "../other")
    (tmp_path / "other/a.launch").write_text("three\n")
    assert "-one\n+three\n" in read_changes(tmp_path / "other").text


def test_repository_is_not_changed(tmp_path: Path) -> None:
    folder = make_repository(tmp_path / "ws")
    before = (folder / ".git/index").read_bytes()
    (folder / "a.launch").touch()
    read_changes(folder)
    assert (folder / ".git/index").read_bytes() == before


def test_nothing_that_the_folder_names_runs(tmp_path: Path) -> None:
    folder = make_repository(tmp_path / "ws")
    run_git(folder, "-c", "protocol.file.allow=always", "submodule", "add", "-q", "./.git", "sub")
    run_git(folder, "commit", "-qm", "submodule")
    ran = tmp_path / "ran"
    program = tmp_path / "evil"
    program.write_text(f"#!/bin/sh\necho $0 $* >>{ran}\ncat\n")
    program.chmod(0o755)
    attributes = "* filter=evil diff=evil merge=evil\n"
    settings = f"""
[core]
  fsmonitor = {program}
  hooksPath = {tmp_path}/hooks
  pager = {program}
  sshCommand = {program}
  attributesFile = {tmp_path}/attributes
[filter "evil"]
  clean = {program}
  smudge = {program}
  process = {program}
  required = true
[diff]
  external = {program}
[diff "evil"]
  command = {program}
  textconv = {program}
[log]
  showSignature = true
[gpg]
  program = {program}
[extensions]
  partialClone = origin
[remote "origin"]
  promisor = true
  url = ext::{program}
[alias]
  diff = !{program}
"""
    hooks = tmp_path / "hooks"
    hooks.mkdir()
    (folder / ".gitattributes").write_text(attributes)
    for place in (folder / ".git", folder / ".git/modules/sub"):
        with (place / "config").open("a") as file:
            file.write(settings)
        (place / "info").mkdir(exist_ok=True)
        (place / "info/attributes").write_text(attributes)
        for hook in ("post-index-change", "fsmonitor-watchman", "pre-commit", "reference-transaction"):
            shutil.copy(program, hooks / hook)
            shutil.copy(program, place / "hooks" / hook)
    (folder / "a.launch").write_text("three\n")
    (folder / "sub/a.launch").write_text("three\n")
    assert "-one\n+three\n" in read_changes(folder).text
    assert not ran.exists()
    subprocess.run(["git", "-C", str(folder), "status"], check=False, env=PLAIN, capture_output=True)
    assert ran.exists()  # as git itself would have run them


@pytest.mark.parametrize("name", ["HEAD", "index", "packed-refs"])
def test_special_files_in_a_repository_end_nothing(name: str, tmp_path: Path) -> None:
    folder = make_repository(tmp_path / "ws")
    (folder / ".git" / name).unlink(missing_ok=True)
    os.mkfifo(folder / ".git" / name)
    (folder / "pipe").symlink_to(folder / ".git" / name)
    read_changes(folder)


@pytest.mark.parametrize("head", ["ref: ../../x", "ref: refs/heads/../../x", "x", "", "ref: refs/heads/none", "\0"])
def test_damaged_head_means_no_changes(head: str, tmp_path: Path) -> None:
    folder = make_repository(tmp_path / "ws")
    (folder / ".git/HEAD").write_text(head)
    assert read_changes(folder).text == ""
