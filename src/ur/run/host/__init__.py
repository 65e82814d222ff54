"""The process host: a small separate program that owns every process of a run, so that all end with the run.

ur launch (supervisor) -- ur-guard -- ur-host -- nodes

The supervisor starts it first and sends it requests for starts and signals; it reports events. It is the parent of all
processes, and a *subreaper*: orphans of a node (a double fork, a daemon in a separate session) become its children, so
that no process escapes. Supervisor and guard are subreapers too. Any two of the three may be killed with SIGKILL, even
at once:

- the supervisor dies: its socket closes, the host ends everything within a second and exits;
- the host dies: nodes get SIGKILL as parent-death signal, and their orphans become children of the guard, which kills
  them;
- the guard dies: the host goes on, and the supervisor inherits orphans instead.

Where a cgroup may be created (`ur.run.host.cgroup`), host and nodes run in a separate one, which the guard kills as a
whole: no process leaves it, not even one that runs as another user.

Each has its own process group and its own command line, so that neither `kill -9 -GROUP` nor `pkill -9 -f 'ur launch'`
takes all at once. The host leaves the terminal's session, and nodes have no terminal, unless one of them has to own it:
that can only be started there.

Runs with `python -I -S`: nothing but the standard library and this package, for a start in a few milliseconds.
"""

from ur.run.host.terminal import restore_terminal, set_foreground

__all__ = ["restore_terminal", "set_foreground"]
