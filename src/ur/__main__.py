"""`python -m ur`: the `ur` command."""

from __future__ import annotations

import sys

from ur.cli.main import main

if __name__ == "__main__":
    sys.exit(main())
