"""`python -I -m ur`: the `ur` command. The script `ur`, boot units and remote runs all start this, isolated."""

import os
import signal
import sys
from collections.abc import Sequence


def main(arguments: Sequence[str]) -> int:
    """Run `ur` with its arguments and return the exit code."""
    os.umask(os.umask(0o077) | 0o002)  # no file is writable for all users, independent of the shell's umask
    if arguments[:1] == ["__complete"]:
        import gc

        gc.disable()  # garbage collection is useless in such a short process
        from ur.cli.computer.completing import answer_completion

        os._exit(answer_completion(arguments[1:]))  # tearing down takes long
    if os.path.isdir(f"{os.path.dirname(__file__)}/_project"):  # noqa: PTH112, PTH120 - pathlib doubles the start-up time
        from ur.installed import enter_environment

        code = enter_environment(arguments)
        if code is not None:
            return code
    from ur.cli.main import main as run_command

    return run_command(arguments)


if __name__ == "__main__":
    try:
        signal.pthread_sigmask(signal.SIG_UNBLOCK, (signal.SIGINT,))  # see the script `ur`
        code = main(sys.argv[1:])
        if code == 0 and sys.argv[1:2] == ["launch"]:  # all is written, and Python's clean-up would take the longest
            os._exit(code)
        sys.exit(code)
    except KeyboardInterrupt:  # while modules are still being imported
        sys.exit(130)
