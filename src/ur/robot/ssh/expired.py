"""Password change at the first login, as Ubuntu's images require it: a dialogue with passwd on the remote computer."""

import os
import re
import select
import subprocess
import time
from collections.abc import Sequence
from contextlib import suppress

from ur.robot.ssh.address import Address
from ur.robot.ssh.askpass import answer_password
from ur.robot.ssh.failures import lost_connection
from ur.robot.ssh.guard import private_folder
from ur.robot.ssh.openssh import password_options
from ur.robot.ssh.secret import Secret
from ur.source.diagnostic import UserError, user_error_about

PATIENCE = 60.0
MOST_BYTES = 1 << 16  # of the output of such a dialogue, which has some lines
# passwd asks once for the present password, and twice for the new one; in these words since PAM 1.1, in the C locale.
_QUESTION = re.compile(rb"password: ?$", re.IGNORECASE)
_NEW = re.compile(rb"\bnew\b[^\r\n]{0,200}password: ?$", re.IGNORECASE)
_ALONE = [word for name in ("ForwardAgent", "ForwardX11", "PermitLocalCommand") for word in ("-o", f"{name}=no")]
_DONE = "password updated successfully"


def renew_password(address: Address, current: Secret, new: Secret, options: Sequence[str]) -> None:
    """Log in with the present password and set the new one, which sshd then requests.

    `options` are arguments for ssh. Raises UserError if the connection breaks, or the new password is refused, with
    passwd's reason.
    """
    with private_folder() as folder, answer_password(folder, current.reveal()) as environment:
        # A remote terminal, which passwd requires; the local ends are pipes.
        process = subprocess.Popen(
            ["ssh", "-tt", *password_options(), *_ALONE, *options, "--", str(address)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            env=environment,
            start_new_session=True,
        )
        try:
            reported = _converse(process, current, [new, new])
        finally:
            process.kill()
            process.communicate()
    if _DONE not in reported:
        raise _explain(address, reported)


def _converse(process: subprocess.Popen[bytes], current: Secret, answers: Sequence[Secret]) -> str:
    """Answer each password prompt; return all output.

    The present password is given once. A second prompt for it means that it was refused, and the new one is not given.
    """
    assert process.stdin
    assert process.stdout
    waiting, old = list(answers), [current]
    reported = part = b""
    end = time.monotonic() + PATIENCE
    while (left := end - time.monotonic()) > 0 and _DONE.encode() not in reported:
        ready, _, _ = select.select([process.stdout], [], [], left)
        more = os.read(process.stdout.fileno(), 4096) if ready else b""
        if not more or len(reported) > MOST_BYTES:
            break
        reported, part = reported + more, part + more
        if _QUESTION.search(part):
            wanted = waiting if _NEW.search(part) else old
            if not wanted or (wanted is waiting and old):  # it refuses the password, or did not ask for the present one
                break
            with suppress(BrokenPipeError):
                process.stdin.write(wanted.pop(0).reveal().encode() + b"\n")
                process.stdin.flush()
            part, end = b"", time.monotonic() + PATIENCE
    return reported.decode(errors="replace")


def _explain(address: Address, reported: str) -> UserError:
    lines = [line.strip() for line in reported.replace("\r", "\n").splitlines()]
    lines = [
        line for line in lines if line and not re.search(r"(?i)password:$|^warning|^changing password|now and", line)
    ]
    if not lines:
        return lost_connection(str(address), "")
    return user_error_about(
        str(address),
        f"the new password is refused: {lines[0].removeprefix('passwd: ')}",
        rule="refused-password",
        help="its password has to be changed at the first login: run this again with another new one",
    )
