"""`ur sync`: two workspaces over a real network, with conflicts, deletions, and links that break on the way."""

import pytest
from tests.hosts.bench import UR, Bench, Done, wait_until
from tests.hosts.test_doctor import pair
from tests.hosts.test_robot_setup import PASSWORD

__all__ = ["pair"]
TREE = "cd catkin_ws/src && find . -type f -exec md5sum {} + | sort -k 2; find . -type l -printf '%p %l\\n'"
# Slow enough to strike while it is under way.
SLOW_RSYNC = '#!/bin/sh\nexec /usr/bin/rsync --bwlimit=4m "$@"\n'


def sync(pair: Bench, *words: str, deadline: float = 120) -> Done:
    return pair["laptop"].run(f"{UR} sync bob {' '.join(words)}", user="pat", timeout=deadline)


def here(pair: Bench, script: str) -> str:
    return pair["laptop"].run(f"cd catkin_ws/src && {script}", user="pat").check().out


def there(pair: Bench, script: str) -> str:
    return pair["robot"].run(f"cd catkin_ws/src && {script}", user="ros").check().out


def trees(pair: Bench) -> tuple[str, str]:
    return pair["laptop"].run(TREE, user="pat").check().out, pair["robot"].run(TREE, user="ros").check().out


@pytest.fixture
def synced(pair: Bench) -> Bench:
    """Both workspaces hold one package with three files, and know it."""
    for run in (here, there):
        run(pair, "rm -rf ./* ./.[!.]* ../.ur_sync")
    here(
        pair,
        "mkdir -p p/launch p/include && echo 1 >p/launch/a.launch && echo 1 >p/b.py && ln -s b.py p/c",
    )
    assert "done: 4 of 4" in sync(pair, "--yes").check().out
    return pair


def test_workspaces_are_alike_after_changes_on_both_sides(synced: Bench) -> None:
    here(synced, "echo 2 >p/b.py && mkdir -p q && echo new >'q/odd name $x'")
    there(synced, "echo 2 >p/launch/a.launch && rm p/c && mkdir -p r/.git r/build && touch r/.git/x r/build/x r/f")
    shown = sync(synced, "--dry-run").check().out
    assert "2 changes to bob, 3 changes from bob" in shown
    before = trees(synced)
    assert before[0] != before[1]
    assert "5 of 5" in sync(synced, "--yes").check().out
    there(synced, "rm -r r/.git r/build")
    mine, yours = trees(synced)
    assert mine == yours
    assert "odd name $x" in yours
    assert "p/c" not in mine
    assert sync(synced, "--yes").check().out == "in step with bob\n"


def test_conflict_is_named_left_alone_and_decided(synced: Bench) -> None:
    here(synced, "echo mine >p/b.py")
    there(synced, "echo the other >p/b.py; echo more >p/new")
    done = sync(synced, "--yes")
    assert done.code == 1
    assert "p/b.py: changed on both sides" in done.out
    assert "here: 5 B, changed 20" in done.out
    assert "bob: 10 B, changed 20" in done.out
    assert (here(synced, "cat p/b.py"), there(synced, "cat p/b.py")) == ("mine\n", "the other\n")
    assert here(synced, "cat p/new") == "more\n"  # what is no conflict was carried
    sync(synced, "p/b.py --take there --yes").check()
    assert here(synced, "cat p/b.py; cat ../.ur_sync/kept/*/p/b.py") == "the other\nmine\n"
    assert sync(synced, "--yes").check().out == "in step with bob\n"


def test_deletion_against_a_change_is_a_conflict(synced: Bench) -> None:
    here(synced, "rm p/b.py")
    there(synced, "echo changed >p/b.py")
    done = sync(synced, "--yes")
    assert done.code == 1
    assert "deleted on the other" in done.out
    assert there(synced, "cat p/b.py") == "changed\n"


def test_emptied_workspace_comes_back(synced: Bench) -> None:
    there(synced, "rm -rf ./*")
    assert "nothing is deleted" in sync(synced, "--yes").check().out
    mine, yours = trees(synced)
    assert mine == yours != ""


def test_one_direction_leaves_the_other_for_later(synced: Bench) -> None:
    here(synced, "echo 2 >p/b.py")
    there(synced, "echo 2 >p/launch/a.launch")
    assert "1 change in the other direction" in sync(synced, "--to --yes").check().out
    assert (there(synced, "cat p/b.py"), here(synced, "cat p/launch/a.launch")) == ("2\n", "1\n")
    assert "1 change from bob" in sync(synced, "--from --yes").check().out
    assert trees(synced)[0] == trees(synced)[1]


def test_without_a_terminal_nothing_is_changed_unasked(synced: Bench) -> None:
    here(synced, "echo 2 >p/b.py")
    done = sync(synced)
    assert done.code == 2
    assert "--yes" in done.err
    assert there(synced, "cat p/b.py") == "1\n"


@pytest.mark.parametrize("strike", ["kill", "cut"])
def test_interrupted_transfer_loses_nothing_and_is_finished_later(synced: Bench, strike: str) -> None:
    laptop, robot = synced["laptop"], synced["robot"]
    here(synced, "head -c 40M /dev/urandom >p/large && echo small >p/b.py")
    there(synced, "echo theirs >p/launch/a.launch")
    laptop.write("/usr/local/bin/rsync", SLOW_RSYNC, mode=0o755)
    process = laptop.spawn(f"echo $$; exec {UR} sync bob --yes", user="pat")
    assert process.stdout
    number = int(process.stdout.readline())
    robot.wait_for("[ -n \"$(find catkin_ws/.ur_sync -name '.large.*' -size +1M)\" ]", user="ros", deadline=60)
    if strike == "kill":
        laptop.run(f"kill -KILL {number}; pkill -KILL -u pat rsync; pkill -KILL -u pat ssh")
    else:
        robot.cut()
    with process.stdout:
        said = process.stdout.read()
    wait_until(lambda: process.poll() is not None, "the sync ends", 120)
    laptop.run("rm /usr/local/bin/rsync").check()
    assert "Traceback" not in said
    assert there(synced, "cat p/b.py; ls p") == "1\nb.py\nc\ninclude\nlaunch\n"
    robot.restore()
    laptop.wait_for("ping -c 1 -W 1 bob.local", deadline=60)
    if strike == "cut":
        assert "the connection has ended" in said
    assert "3 of 3" in sync(synced, "--yes").check().out
    assert trees(synced)[0] == trees(synced)[1]
    assert here(synced, "ls -A ..").split() == ["src"]
    assert PASSWORD not in said


def test_mounted_workspace_is_refused(synced: Bench) -> None:
    laptop = synced["laptop"]
    laptop.run(f"{UR} mount bob --over", user="pat").check()
    done = sync(synced, "--yes")
    laptop.run(f"{UR} mount --undo bob", user="pat").check()
    assert done.code == 2
    assert "is a mounted folder of ros@bob.local" in done.err


def test_path_that_is_nowhere_is_named(synced: Bench) -> None:
    done = sync(synced, "p/nothing --yes")
    assert done.code == 2
    assert "p/nothing: nothing of this name" in done.err
