import signal

import pytest

from ur.run.output.messages import Crash, advise
from ur.run.supervisor.state import ExitStatus


@pytest.mark.parametrize(("status", "lines", "advice"), [
    (ExitStatus(code=127), [], "not on PATH"),
    (ExitStatus(code=126), [], "chmod +x"),
    (ExitStatus(code=2), ["usage: a FILE"], "cannot use"),
    (ExitStatus(signal=signal.SIGSEGV), [], "--debug /a=gdb"),
    (ExitStatus(signal=signal.SIGABRT), [], "--debug /a=gdb"),
    (ExitStatus(code=139), [], "--debug /a=gdb"),
    (ExitStatus(signal=signal.SIGKILL), [], "oom"),
    (ExitStatus(signal=signal.SIGILL), [], "another processor"),
    (ExitStatus(code=1), ["ModuleNotFoundError: No module named 'cv2'"], "'cv2'"),
    (ExitStatus(code=1), ["\x1b[31mImportError: No module named cv2\x1b[0m"], "'cv2'"),
    (ExitStatus(code=1), ["ImportError: cannot import name 'x' from 'y.z' (a)"], "'y.z'"),
    (ExitStatus(code=127), ["a: error while loading shared libraries: libx.so.1: cannot open"], "libx.so.1"),
    (ExitStatus(code=1), ["OSError: [Errno 98] Address already in use"], "ur ps"),
    (ExitStatus(code=1), ["could not open port /dev/ttyUSB0: [Errno 2] No such file"], "/dev/ttyUSB0"),
    (ExitStatus(code=1), ["PermissionError: [Errno 13] Permission denied: '/dev/ttyUSB0'"], "dialout"),
    (ExitStatus(code=1), ["Traceback (most recent call last):", "KeyError: '~rate'"], "'~rate' is not set"),
    (ExitStatus(code=1), ["Traceback (most recent call last):", "ValueError: no"], "--debug /a=pudb"),
    (ExitStatus(signal=signal.SIGABRT), ["terminate called", "what():  std::bad_alloc"], "memory"),
    (ExitStatus(code=1), ["shutdown request: [/a] Reason: new node registered with same name"], "another name"),
    (ExitStatus(code=1), ["could not connect to display"], "DISPLAY"),
    (ExitStatus(code=1), ['  File "/ws/a b.py", line 3', '    print "x"', "    ^^^^^", "SyntaxError: Missing "
     "parentheses in call to 'print'. Did you mean print(...)?"], "line 3 of /ws/a b.py is Python 2"),
    (ExitStatus(code=1), ['  File "/ws/a.py", line 3', "    raise E, 'x'", "           ^",
     "SyntaxError: invalid syntax"], "2to3 -w /ws/a.py"),
    (ExitStatus(signal=signal.SIGSEGV), ["OSError: [Errno 28] No space left on device"], "df -h"),
])  # fmt: skip
def test_advice_suits_the_cause(status: ExitStatus, lines: list[str], advice: str) -> None:
    found = advise(Crash("/a", status, lines))
    assert advice in found
    assert "\n" not in found
    assert not found.endswith(".")


@pytest.mark.parametrize(("reason", "advice"), [
    ("/x/node: permission denied", "chmod +x /x/node"),
    ("/x/node: no such file or directory", "interpreter"),
    ("no process could be made: resource temporarily unavailable", ""),
])  # fmt: skip
def test_advice_for_what_could_not_be_started(reason: str, advice: str) -> None:
    found = advise(Crash("/a", ExitStatus(), (), reason))
    assert advice in found
    assert bool(found) == bool(advice)


def test_nothing_is_advised_where_nothing_is_known() -> None:
    assert advise(Crash("/a", ExitStatus(code=1), ["good bye"])) == ""
    assert advise(Crash("/a", ExitStatus(signal=signal.SIGUSR1))) == ""


def test_braces_in_names_and_output_are_harmless() -> None:
    assert "{0}" in advise(Crash("/{0}", ExitStatus(signal=signal.SIGSEGV), ["{bad} {1}"]))
