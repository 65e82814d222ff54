"""`ur robot setup` of several robots: one process for each, side by side, after all questions are answered."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence

from ur.cli.robot_setup.questions import PLAIN
from ur.cli.robots.fleet import run_for_each
from ur.robot.setup.login import Task
from ur.robot.ssh.secret import Secret


def set_up_each(tasks: Sequence[Task], make: Callable[[Task], list[str]], passwords: Secret) -> int:
    """Set up several robots; return the highest exit code.

    `make` returns the arguments of `ur` for one of them. `passwords` are the present and the new one, a line each,
    which go to the standard input of each process. Raises KeyboardInterrupt after all of them were ended.
    """
    by_name = {task.robot.name: task for task in tasks}
    try:
        return run_for_each(
            "robot setup",
            tuple(by_name),
            lambda name: make(by_name[name]),
            passwords=dict.fromkeys(by_name, passwords),
        )
    except KeyboardInterrupt:
        sys.stderr.write("interrupted; the same command continues where it stopped\n")
        raise


def make_argv(task: Task, *, master: bool, programs: bool, new_host_key: bool, between: bool = False) -> list[str]:
    """Return the arguments of `ur` that set up this robot alone, with all answers for it.

    A host key that the user has confirmed is given by its fingerprint: the process accepts no other one.
    """
    robot = task.robot
    argv = ["robot", "setup", str(task.address), "--one-of-several", "--passwords-from", "0"]
    argv += ["--name", robot.name, "--base", robot.base, "--variant", robot.variant or PLAIN]
    argv += ["--host-key", task.host_key.fingerprint] if task.host_key else []
    argv += ["--robot-login" if task.robot_login else "--no-robot-login"]
    unwanted = (
        ("--no-master", not (master and robot.master)),
        ("--no-programs", not (programs and robot.programs)),
        ("--new-host-key", new_host_key),
        ("--take-over", between),
    )
    return argv + [option for option, given in unwanted if given]
