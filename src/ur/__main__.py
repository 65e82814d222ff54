"""`python -m ur`: the `ur` command."""

from __future__ import annotations

import os
import sys


def _run() -> int:
    os.umask(os.umask(0o077) | 0o002)  # nothing is writable for everybody, whatever the shell has set
    if sys.argv[1:2] == ["launch"]:
        from ur.cli.fast import answer_fast, launch_fast

        for way in (answer_fast, launch_fast):
            code = way(sys.argv[1:])
            if code is not None:
                return code
    if sys.argv[1:2] == ["__complete"]:
        from ur.cli.computer.completing import answer_completion

        return answer_completion(sys.argv[2:])
    from ur.cli.main import main

    return main()


if __name__ == "__main__":
    try:
        sys.exit(_run())
    except KeyboardInterrupt:  # while modules are still being imported
        sys.exit(130)
