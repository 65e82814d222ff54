"""The host key of a robot that has not booted yet: generated on this computer, and written to the robot's seed."""

import getpass

from ur.robot.image.seed import HostKeyPair
from ur.robot.image.volume import run_tool
from ur.robot.setup.change import Change
from ur.robot.setup.engine import apply_states
from ur.robot.setup.facts import ComputerFacts, FactsRequest
from ur.robot.setup.keys import known_host
from ur.robot.setup.wanted import Wanted, WantedFolder
from ur.robot.ssh.guard import private_folder
from ur.robot.ssh.host_key import parse_public_key
from ur.robot.ssh.shell import LocalShell
from ur.source.diagnostic import UserError, error


def make_host_key(name: str) -> HostKeyPair:
    """Generate a host key for the robot of this name. Raises UserError."""
    with private_folder() as folder:
        path = folder / "key"
        done = run_tool(["ssh-keygen", "-q", "-t", "ed25519", "-N", "", "-C", f"root@{name}", "-f", str(path)])
        if done.returncode:
            raise UserError(error("ssh-keygen cannot make a host key", rule="no-key", help="run: ur setup"))
        public = parse_public_key(path.with_suffix(".pub").read_text())
        return HostKeyPair(path.read_text(), public.key)


def know_host_key(name: str, pair: HostKeyPair) -> None:
    """Add the public key to this user's known_hosts, in place of an earlier key of a robot with this name."""

    def make(_: ComputerFacts) -> list[Wanted]:
        return [WantedFolder("ssh folder", "~/.ssh", mode=0o700), known_host(f"host key of {name}", name, pair.public)]

    def ignore(_: Change) -> None:
        return None

    user = getpass.getuser()
    apply_states(LocalShell(), make, user, FactsRequest(user), root=False, report=ignore)
