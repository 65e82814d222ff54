"""The terminal, lent to one node and restored afterwards."""

import array
import fcntl
import os
import signal
import termios

from ur.run.host.terminal import restore_terminal, set_foreground


class Terminal:
    """The terminal behind a descriptor, with its present modes. Created by `find_terminal`."""

    def __init__(self, descriptor: int) -> None:
        self.descriptor = descriptor
        self._attributes: list[object] = termios.tcgetattr(descriptor)
        self._lent = False

    def in_foreground(self) -> bool:
        """True while this process group may read from the terminal."""
        try:
            return os.tcgetpgrp(self.descriptor) == os.getpgrp()
        except OSError:
            return False

    def is_unused(self, group: int) -> bool:
        """True while a process group has the terminal, its modes are unchanged, and no whole line was typed."""
        typed = array.array("i", [0])
        try:
            fcntl.ioctl(self.descriptor, termios.FIONREAD, typed)
            modes = termios.tcgetattr(self.descriptor)
            return os.tcgetpgrp(self.descriptor) == group and modes == self._attributes and not typed[0]
        except (OSError, termios.error):
            return False

    def mark_lent(self) -> None:
        """Record that another process group is, or is about to be, the foreground group."""
        self._lent = True

    def lend(self, group: int) -> None:
        """Make a process group the foreground group."""
        self.mark_lent()
        set_foreground(self.descriptor, group)

    def reclaim(self, *, reset: bool) -> None:
        """Become the foreground group again and restore the modes; `reset` also clears output of a killed program."""
        if self._lent:
            set_foreground(self.descriptor, os.getpgrp())
            self._lent = False
        restore_terminal(self.descriptor, self._attributes, reset=reset)

    def wait_suspended(self) -> None:
        """Stop this process as the node was stopped (Ctrl-Z), until the shell continues the job."""
        os.kill(os.getpid(), signal.SIGSTOP)


def find_terminal() -> Terminal | None:
    """Return the terminal on standard input; None if that is something else."""
    try:
        return Terminal(0) if os.isatty(0) else None
    except (OSError, termios.error):
        return None


def ignore_background_write() -> None:
    """Ignore SIGTTOU, which would stop this process when it changes the foreground group from the background."""
    signal.signal(signal.SIGTTOU, signal.SIG_IGN)
