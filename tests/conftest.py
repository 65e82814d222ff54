"""For all tests: the same examples every time, none fails because the computer is slow, and Ctrl-C means Ctrl-C."""

from __future__ import annotations

import signal

from hypothesis import settings

# A shell without job control starts background jobs with these ignored, and programs under test would inherit that.
signal.signal(signal.SIGINT, signal.default_int_handler)
signal.signal(signal.SIGQUIT, signal.SIG_DFL)

settings.register_profile("project", deadline=None, derandomize=True, database=None)
settings.load_profile("project")
