"""Signals for guard and host: the module below `signal`, without enums, which would add 1 MB to these programs."""

TYPE_CHECKING = False
if TYPE_CHECKING:
    import signal
else:
    import _signal as signal

__all__ = ["IGNORED", "signal"]

IGNORED = tuple(  # ignored by guard and host, and restored for nodes
    getattr(signal, name)
    for name in ("SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT", "SIGTSTP", "SIGTTIN", "SIGTTOU", "SIGPIPE")
)
