"""`python -I -S PATH DESCRIPTOR`: the guard and the process host, for the supervisor behind a socket."""

import os
import sys

if __name__ == "__main__":
    sys.path.append(os.path.abspath(f"{__file__}/../../../.."))  # noqa: PTH100 - pathlib doubles the start-up time
    from ur.run.host.guard import run_guarded

    run_guarded(int(sys.argv[1]))
