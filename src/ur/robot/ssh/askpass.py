"""Password input for ssh: the program that ssh starts as SSH_ASKPASS, and the socket that answers it.

ssh closes all descriptors but the first three, so a socket in a private folder of the user provides the password. It
answers that user's processes, one password prompt per permission, and nothing else: a prompt about a host key is never
answered. Run as a program: python -I askpass.py PROMPT, with the socket's path in UR_ASKPASS.
"""

import os
import shlex
import socket
import struct
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


def main() -> int:
    """Ask the socket for the answer to the prompt and print it."""
    prompt = sys.argv[1] if len(sys.argv) > 1 else ""
    with socket.socket(socket.AF_UNIX) as link:
        link.settimeout(10)
        link.connect(os.environ["UR_ASKPASS"])
        link.sendall(prompt.encode())
        link.shutdown(socket.SHUT_WR)
        answer = b"".join(iter(lambda: link.recv(4096), b""))
    sys.stdout.buffer.write(answer)
    return 0 if answer else 1


@contextmanager
def answer_password(folder: Path, password: str, script: str = __file__) -> Iterator[dict[str, str]]:
    """Yield an environment for ssh, which gets the password once while the context lasts.

    `folder` is a private one (mode 0700) that exists; `script` is this module, in any clone. Files in it hold no secret
    and are removed.
    """
    place = folder / "askpass.socket"
    program = folder / "askpass"
    program.write_text(f'#!/bin/sh\nexec {shlex.join([sys.executable, "-I", script])} "$@"\n')
    program.chmod(0o700)
    with socket.socket(socket.AF_UNIX) as server:
        server.bind(str(place))
        server.listen(4)
        thread = threading.Thread(target=_serve, args=(server, password), daemon=True)
        thread.start()
        try:
            yield {
                **os.environ,
                "UR_ASKPASS": str(place),
                "SSH_ASKPASS": str(program),
                "SSH_ASKPASS_REQUIRE": "force",
                "DISPLAY": os.environ.get("DISPLAY", ":"),  # ssh before 8.4 starts no askpass program without it
                "LC_ALL": "C",
            }
        finally:
            server.shutdown(socket.SHUT_RDWR)
            thread.join(5)
            place.unlink(missing_ok=True)
            program.unlink(missing_ok=True)


def _serve(server: socket.socket, password: str) -> None:
    given = False
    while True:
        try:
            link, _ = server.accept()
        except OSError:  # shut down
            return
        with link:
            link.settimeout(5)
            try:
                _, user, _ = struct.unpack("3i", link.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, 12))
                prompt = b"".join(iter(lambda: link.recv(4096), b"")).decode(errors="replace")  # noqa: B023 - used at once
                if user == os.getuid() and not given and prompt.rstrip().lower().endswith("password:"):
                    link.sendall(password.encode() + b"\n")
                    given = True
            except OSError:
                continue


if __name__ == "__main__":
    sys.exit(main())
