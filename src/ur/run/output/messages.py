"""Messages of a run for the user, as text. Pure."""

import re
import signal
from collections.abc import Sequence

from ur.run.supervisor.actions import ReportDeath
from ur.run.supervisor.state import ExitStatus
from ur.source.data_classes import dataclass
from ur.source.script import convert_help, is_python_two


@dataclass(frozen=True, slots=True)
class Crash:
    """A node that died: its exit status, its last output, and the reason if it could not be started ('' otherwise).

    `fault` is what its file shows, as `ur.source.script.explain_script` returns it.
    """

    name: str
    status: ExitStatus
    lines: Sequence[str] = ()
    reason: str = ""
    fault: str = ""


def advise(crash: Crash) -> str:
    """Return the first thing to try, one line without a full stop; '' if the log is the best source."""
    if crash.fault:
        return crash.fault
    if crash.reason:
        if "permission denied" in crash.reason:
            return f"chmod +x {crash.reason.partition(':')[0]}"
        if "no such file" in crash.reason:
            return "does the program exist, and the interpreter that its first line (#!) names?"
        return ""
    text = "\n".join(re.sub("\x1b\\[[0-9;]*m", "", line) for line in crash.lines)
    syntax = _SYNTAX_ERROR.search(text)
    if syntax and is_python_two(syntax[4], syntax[3]):
        help_ = convert_help(syntax[1], syntax[4])
        return f"line {syntax[2]} of {syntax[1]} is Python 2, which Python 3 does not read: {help_}"
    for pattern, advice in _BY_TEXT:
        found = re.search(pattern, text, re.MULTILINE)
        if found:
            return advice.format(*found.groups(), name=crash.name)
    if crash.status.signal is not None:
        return _BY_SIGNAL.get(crash.status.signal, "").format(name=crash.name)
    if "Traceback (most recent call last)" in text:
        return f"ur launch --debug {crash.name}=pudb ... steps through it"
    return _BY_CODE.get(crash.status.code or 0, "").format(name=crash.name)


_SYNTAX_ERROR = re.compile(
    r'^ *File "([^"\n]+)", line (\d+)\n(.*)\n(?: *[\^~]*\n)?(?:SyntaxError|TabError): (.*)', re.MULTILINE
)
_DEBUG_GDB = "ur launch --debug {name}=gdb ... shows where"

# The most specific text first; {0} is the match of the pattern.
_BY_TEXT: tuple[tuple[str, str], ...] = (
    (r"(?:ModuleNotFoundError|ImportError): No module named '?([\w.]+)", "install the Python package that has {0!r}: "
     "apt-cache search python3-{0}; a ROS package may need its workspace sourced"),
    (r"ImportError: cannot import name '?(\w+)'? from '?([\w.]+)", "another version of {1!r} is installed than it "
     "expects: it has no {0!r}"),
    (r"error while loading shared libraries: ([^\s:]+)", "install the package that has {0}: apt-file search {0}, "
     "or source the workspace that built it"),
    (r"symbol lookup error: ", "it was built for another version of a library: build its workspace again"),
    (r"(?:\[rospack\] Error: package|ResourceNotFound: |PackageNotFound: ?)\s*'?([\w-]+)", "install package {0!r}, or "
     "source its workspace"),
    (r"(?:Address already in use|Errno 98)", "something else has its port: is another run still there? ur ps"),
    (r"(/dev/[\w./-]+)[^\n]*Permission denied|Permission denied[^\n]*?(/dev/[\w./-]+)", "you may not use the device: "
     "sudo usermod -aG dialout,video $USER, then log in again"),
    (r"(?:No such file or directory|could not open port|[Cc]annot open)[^\n]*?(/dev/[\w./-]+)", "is {0} plugged in? "
     "ur devices lists what is there"),
    (r"KeyError: '?([~/][\w/~]+)'?$", "the parameter {0!r} is not set: ur launch --dump-params shows those that are"),
    (r"(?:[Uu]nable to contact my own server|[Cc]ouldn't find an AF_INET address|Unable to register with master)",
     "the network names are wrong: look at ROS_HOSTNAME, ROS_IP and ROS_MASTER_URI (ur env)"),
    (r"shutdown request: \[?/?[\w/]*\]? ?Reason: new node registered", "two nodes have this name: rosnode list; give "
     "one of them another name"),
    (r"(?:could not connect to display|[Cc]annot open display|no Qt platform plugin)", "it needs a display, and there "
     "is none here: echo $DISPLAY"),
    (r"No space left on device", "the disk is full: df -h; rosclean purge removes old logs"),
    (r"(?:std::bad_alloc|MemoryError)", "it ran out of memory: free -h"),
    (r"ParserError|expat.ExpatError|could not parse|XML parsing error", "a file that it reads is not well-formed: the "
     "lines above name it"),
)  # fmt: skip

_BY_SIGNAL: dict[int, str] = {
    signal.SIGSEGV: _DEBUG_GDB,
    signal.SIGABRT: "the last lines name the cause; " + _DEBUG_GDB,
    signal.SIGFPE: _DEBUG_GDB,
    signal.SIGBUS: "is the disk or /dev/shm full? df -h; " + _DEBUG_GDB,
    signal.SIGILL: "it was built for another processor: build it here",
    signal.SIGTRAP: _DEBUG_GDB,
    signal.SIGKILL: "it was killed; if the kernel did, for want of memory: journalctl -k | grep -i oom",
    signal.SIGTERM: "it was stopped: by rosnode kill, another node with its name, or the system",
    signal.SIGINT: "it was stopped: by rosnode kill, another node with its name, or the system",
    signal.SIGHUP: "its terminal was closed: ur launch --detach keeps a run",
    signal.SIGPIPE: "the reader of its output has ended",
    signal.SIGXCPU: "it used more processor time than it may: ulimit -t",
    signal.SIGXFSZ: "it wrote a larger file than it may: ulimit -f",
}
_BY_CODE: dict[int, str] = {
    2: "it was given something it cannot use: the last lines say what",
    126: "a command that it calls may not be executed, and the last lines name it: chmod +x",
    127: "a command that it calls is not installed, or not on PATH: the last lines name it",
    134: _DEBUG_GDB,
    137: "it was killed; if the kernel did, for want of memory: journalctl -k | grep -i oom",
    139: _DEBUG_GDB,
}


def describe_status(status: ExitStatus) -> str:
    """Describe the end of a process: `exit code 3`, `signal SIGSEGV (segmentation fault)`."""
    if status.signal is not None:
        try:
            known = signal.Signals(status.signal)
        except ValueError:
            return f"signal {status.signal}"
        meaning = signal.strsignal(known)
        return f"signal {known.name}" + (f" ({meaning.lower()})" if meaning else "")
    return "not started" if status.code is None else f"exit code {status.code}"


def describe_death(death: ReportDeath, lines: Sequence[str] | None, log: str | None, fault: str = "") -> list[str]:
    """Describe the end of a unit: its status, its last lines (None: already on the screen), and its log file.

    `fault` is what the unit's file shows of the reason, as in `Crash`.
    """
    follow = ""
    if death.restart_in is not None:
        follow = f", starts again in {death.restart_in:.3g} s" if death.restart_in > 0 else ", starts again"
    elif death.deaths:
        follow = f", {death.deaths} times in a row soon after its start: it is not started again"
    elif death.ends_run:
        follow = ", which ends the run"
    if death.evicted_by:
        return [f"{death.name} was ended by {death.evicted_by}, which started another node of this name{follow}"]
    if death.status.clean:
        return [f"{death.name} has finished{follow}"]
    if death.reason is not None:
        advice = advise(Crash(death.name, death.status, (), death.reason, fault))
        reported = [f"{death.name} could not be started: {death.reason}{follow}"]
        return [*reported, f"  try: {advice}"] if advice else reported
    reported = [f"{death.name} died: {describe_status(death.status)}{follow}"]
    reported += [f"  | {line}" for line in lines or ()]
    if log is not None:
        reported.append(f"  log: {log}" if lines or lines is None else f"  log: {log} (it printed nothing)")
    advice = _advise(death, lines or (), fault)
    return [*reported, f"  try: {advice}"] if advice else reported


def describe_link(robot: str, seconds: float, *, lost: bool) -> str:
    """Describe the link to a robot: `no word from bob for 1.2 s`, `bob answers again after 12.3 s`."""
    return f"no word from {robot} for {seconds:.1f} s" if lost else f"{robot} answers again after {seconds:.1f} s"


class LossLines:
    """Selects the reports of a lost link that become separate lines: the first, then each after twice the time."""

    def __init__(self) -> None:
        self._next = 0.0

    def is_due(self, seconds: float, *, lost: bool) -> bool:
        """Return whether this change of the connection is to be printed."""
        if not lost:
            self._next = 0.0
            return True
        due = seconds >= self._next
        if due:
            self._next = 2.0 * seconds
        return due


def _advise(death: ReportDeath, lines: Sequence[str], fault: str) -> str:
    again = f"'ur restart {death.name}' starts it once more"
    if death.deaths and death.status.code == 2:
        return f"exit code 2 is about what it was given: correct that, then 'ur restart {death.name}'"
    return advise(Crash(death.name, death.status, lines, fault=fault)) or (again if death.deaths else "")
