"""The location of this project on a robot, and the request for the robot's share of a run over ssh."""

from ur.robot.boot.units import LIBRARIES
from ur.robot.ssh.shell import Shell, ShellResult, quote
from ur.source.diagnostic import UserError, user_error

MODULE = "ur.run.remote.share"
NOT_THERE, NOT_READY = 97, 98
_SCRIPT = f"""\
code={NOT_THERE}
for d in {" ".join(f'"$HOME"/{place}' for place in LIBRARIES)}; do
  [ ! -d "$d" ] || code={NOT_READY}
  [ ! -r "$d/.venv/ready-run" ] || exec "$d/.venv/bin/python" -I -m {MODULE}
done
exit $code"""


def ask_part(shell: Shell, request: str, timeout: float) -> str:
    """Send a request (JSON) to the project on a robot and return its answer. Raises UserError if it is not ready."""
    # A login shell, so that nodes get the environment of the robot's user.
    done = shell.run(quote("bash", "-lc", _SCRIPT), stdin=request, timeout=timeout)
    lines = done.out.splitlines()
    if done.code or not lines:
        raise explain_failure(shell.destination, done)
    return lines[-1]


def explain_failure(destination: str, done: ShellResult) -> UserError:
    """Explain a robot's failure to answer the request."""
    name = destination.rpartition("@")[2].removesuffix(".local")
    reported = (done.err.strip().splitlines() or [f"exit code {done.code}"])[-1]
    if done.code == NOT_THERE:
        message = f"{name}: ubiquity_launches is not there, expected it in ~/{LIBRARIES[1]} to start the robot's nodes"
        help_ = f"ur robot setup {name} installs it"
    elif done.code == NOT_READY:
        message = f"{name}: ubiquity_launches is not set up there, so the robot's nodes cannot start"
        help_ = f"ur robot setup {name} completes it"
    elif "No module named" in reported:
        message = f"{name}: ubiquity_launches there is older than here, expected the same: {reported}"
        help_ = f"ur robot setup {name} renews a copy; in a clone: git pull"
    else:
        message, help_ = f"{name}: its nodes cannot be started: {reported}", f"ur doctor {name}"
    return user_error(message, rule="robot-part", help=help_)
