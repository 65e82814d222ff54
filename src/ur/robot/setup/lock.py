"""Lock for one set-up of a robot at a time, also from two viewers; the robot releases it when the holder ends."""

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress

from ur.robot.ssh.failures import lost_connection
from ur.robot.ssh.guard import PipeLines
from ur.robot.ssh.openssh import ALIVE_SECONDS, SshShell
from ur.robot.ssh.shell import quote
from ur.source.diagnostic import user_error, user_error_about

LOCK_FILE = "/run/ubiquity-setup.lock"  # for root alone, and removed by a reboot
WAIT_SECONDS = 30.0  # longer than SILENCE_SECONDS: the lock of a disconnected holder is released by then
SILENCE_SECONDS = 12
# The holder sends a line now and then. After a silence the alarm ends this script, which releases the lock.
_HOLD = """\
use strict; use Fcntl qw(:flock); $| = 1;
my ($path, $who, $silence, $wait) = @ARGV;
open(my $file, "+>>", $path) or do { print "failed $!\\n"; exit 1 };
if (!flock($file, LOCK_EX | LOCK_NB)) {
    seek $file, 0, 0; my $other = <$file> // "somebody"; chomp $other; print "held $other\\n";
    alarm $wait; flock($file, LOCK_EX) or exit 1;
}
truncate $file, 0; print {$file} "$who\\n"; $file->flush; print "mine\\n";
do { alarm $silence } while defined(my $line = <STDIN>);
truncate $file, 0;
"""


@contextmanager
def hold_robot(shell: SshShell, who: str, report: Callable[[str], None]) -> Iterator[None]:
    """Hold the lock against other set-ups of this robot while the context lasts.

    `who` is shown to others; sudo has to work. Waits a little for another holder, which may just be ending. Raises
    UserError, which names the holder.
    """
    numbers = [str(SILENCE_SECONDS), str(int(WAIT_SECONDS) + 5)]
    keeper = shell.start("exec " + quote("perl", "-e", _HOLD, LOCK_FILE, who, *numbers), root=True)
    done = threading.Event()
    assert keeper.stdin
    assert keeper.stdout

    def beat() -> None:
        assert keeper.stdin
        with suppress(OSError, ValueError):  # the connection has ended: the next command reports that
            while not done.wait(ALIVE_SECONDS):
                keeper.stdin.write("\n")
                keeper.stdin.flush()

    heart = threading.Thread(target=beat, daemon=True)
    try:
        lines = PipeLines(keeper.stdout.fileno())
        word, _, rest = (lines.read(WAIT_SECONDS) or "").partition(" ")
        if word == "held":
            report(f"{rest} is setting it up: waiting until that is done")
            word = lines.read(WAIT_SECONDS) or word
        if word == "held":
            raise user_error(
                f"{shell.destination} is being set up already, by {rest}, expected one at a time",
                rule="busy-robot",
                help="wait until that is done, then run this again",
                subject=shell.destination,
            )
        if word == "failed":
            raise user_error_about(
                shell.destination,
                f"{LOCK_FILE}: {rest}",
                rule="failed-change",
                help="free space on the robot; df shows what is full",
            )
        if word != "mine":
            raise lost_connection(shell.destination, "")
        heart.start()
        yield
    finally:
        done.set()
        if heart.is_alive():
            heart.join()
        with suppress(OSError):
            keeper.stdin.close()
        keeper.stdout.close()
        with suppress(Exception):
            keeper.wait(5)
        if keeper.poll() is None:
            keeper.kill()
            keeper.wait()
