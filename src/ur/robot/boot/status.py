"""State of boot services: read from systemd and the journal with one script, and formatted. Pure."""

from collections.abc import Iterator
from dataclasses import dataclass

from ur.robot.boot.units import FOLDER, PREFIX
from ur.source.diagnostic import UserError, error
from ur.source.foreign.numbers import parse_integer

LAST_LINES = 3
_PROPERTIES = (
    "Id,Description,ActiveState,SubState,UnitFileState,NRestarts,ActiveEnterTimestamp,ExecMainStatus,ControlPID"
)
_MARK = "\x1e"
SCRIPT = f"""\
for f in {FOLDER}/{PREFIX}*.service; do
  [ -e "$f" ] || continue
  u=${{f##*/}}; printf '\\036'; systemctl show -p {_PROPERTIES} "$u"
  pause=$(cat "/run/${{u%.service}}/pause" 2>/dev/null); echo "Pause=$pause"
  # For a running service, the output since its start; for others, also that from before they ended.
  only=; systemctl -q is-active "$u" && only=_SYSTEMD_INVOCATION_ID=$(systemctl show -P InvocationID "$u")
  journalctl -q -u "$u" $only -n {LAST_LINES} -o cat --no-pager 2>/dev/null | sed 's/^/Said=/'
done
printf '\\036end\\n'
"""


@dataclass(frozen=True, slots=True)
class ServiceStatus:
    """A boot service: the values of its systemd properties, and the last lines of its log.

    `code` is the last exit code, `pause` the time until the next start (s), 0 if no start is scheduled.
    """

    name: str
    active: str
    sub: str
    enabled: bool
    restarts: int
    since: str
    code: int
    pause: int
    reported: tuple[str, ...]


def parse_status(text: str) -> list[ServiceStatus]:
    """Parse the output of SCRIPT; empty where no boot service is installed. Raises UserError for incomplete output."""
    *parts, last = text.split(_MARK)
    if last.strip() != "end" or not parts:
        raise UserError(
            error(
                f"the answer of the robot cannot be read, it ends with {text.strip()[-80:]!r}; expected boot services",
                rule="no-answer",
                help="check it with 'ur doctor', then run this again",
            )
        )
    return [_parse(part) for part in parts[1:]]


def _parse(part: str) -> ServiceStatus:
    rows = [line.partition("=") for line in part.splitlines()]
    values = {key: value for key, _, value in rows}
    return ServiceStatus(
        name=values.get("Id", "").removeprefix(PREFIX).removesuffix(".service"),
        active=values.get("ActiveState", ""),
        sub=values.get("SubState", ""),
        enabled=values.get("UnitFileState") == "enabled",
        restarts=_number(values.get("NRestarts")),
        since=values.get("ActiveEnterTimestamp", ""),
        code=_number(values.get("ExecMainStatus")),
        pause=_number(values.get("Pause")),
        reported=tuple(value for key, _, value in rows if key == "Said"),
    )


def _number(text: str | None) -> int:
    return max(parse_integer(text or "") or 0, 0)


def describe_status(status: ServiceStatus) -> Iterator[str]:
    """Yield lines that describe a boot service: its state, and the last lines of its log."""
    yield f"{status.name}: {_describe_state(status)}"
    yield from (f"  | {line}" for line in status.reported)


def _describe_state(status: ServiceStatus) -> str:
    again = f", started again {status.restarts} times by itself" if status.restarts else ""
    if status.active == "active":
        text = f"runs since {status.since}{again}"
    elif status.active == "activating" and status.sub == "start-pre":
        pauses = status.restarts and status.pause
        text = f"pauses for {status.pause} s before its next start" if pauses else "waits for the robot's own address"
        text += again
    elif status.active == "activating":
        text = f"ended with code {status.code}; it is started again{again}"
    else:
        text = f"does not run ({status.active or 'unknown'})"
    return text if status.enabled else f"{text}; not enabled, so it will not start when the robot boots"
