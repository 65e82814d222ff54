"""The page that a robot serves when it boots: installed, opened by links that are good once, and removed."""

import re
import shlex
import shutil
from collections.abc import Iterator
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path

import pytest
from tests.hosts.bench import REPOSITORY, UR, Bench, Done, Machine, boot

pytestmark = [pytest.mark.timeout(600)]
ROBOT = "ros@robot.local"
PAGE = "http://robot.local:8090"
LIBRARY = "/home/ros/ubiquity_launches"
PACKAGES = {
    "click",
    "rich",
    "rich-click",
    "pygments",
    "typing-extensions",
    "numpy",
}  # of run.lock, as far as it is used
# Ask the page as a browser would, with Python alone: METHOD PATH BODY COOKIE. Prints status, cookie and answer.
ASK = f"""\
import sys, urllib.error, urllib.request
method, path, body, cookie = sys.argv[1:]
head = {{"Origin": "{PAGE}", "Content-Type": "application/json", **({{"Cookie": cookie}} if cookie else {{}})}}
asked = urllib.request.Request("{PAGE}" + path, body.encode() or None, head, method=method)
try:
    answer = urllib.request.urlopen(asked, timeout=10)
except urllib.error.HTTPError as problem:
    answer = problem
print(answer.status, (answer.headers["Set-Cookie"] or "").partition(";")[0], answer.read().decode(), sep="\\n")
"""


@pytest.fixture(scope="module")
def pair() -> Iterator[Bench]:
    """A laptop that may log in to a robot; nothing was set up."""
    with boot() as bench:
        laptop, robot = bench["laptop"], bench["robot"]
        laptop.run("ssh-keygen -q -t ed25519 -N '' -f ~/.ssh/id_ed25519", user="pat").check()
        key = laptop.read("/home/pat/.ssh/id_ed25519.pub")
        robot.run("umask 077; mkdir -p ~/.ssh; cat >>~/.ssh/authorized_keys", user="ros", stdin=key).check()
        scan = "ssh-keyscan -T 5 -t ed25519 robot.local >~/.ssh/known_hosts; grep -q ed25519 ~/.ssh/known_hosts"
        laptop.wait_for(scan, user="pat", deadline=60)
        yield bench


def change(pair: Bench, words: str) -> Done:
    """Run a verb of `ur boot` that changes the robot, with the password of its user."""
    verb, _, rest = words.partition(" ")
    line = f"{UR} boot {verb} --robot {ROBOT} --password-from 0 {rest}"
    return pair["laptop"].run(line, user="pat", stdin="ros\n", timeout=240)


def link(pair: Bench, *options: str) -> Done:
    """Have a link to the page printed."""
    return pair["laptop"].run(f"{UR} boot link --robot {ROBOT} {' '.join(options)}", user="pat", timeout=120)


def token_of(done: Done) -> str:
    found = re.search(rf"^open {re.escape(PAGE)}/login#(\S+)$", done.check().out, re.MULTILINE)
    assert found, done.out
    return found[1]


def ask(pair: Bench, method: str, path: str, body: str = "", cookie: str = "") -> list[str]:
    """The status, the cookie and the answer of the page."""
    words = shlex.join(["python3", "-I", "-c", ASK, method, path, body, cookie])
    return pair["laptop"].wait_for(words, user="pat", deadline=90).out.split("\n", 2)


def log_in(pair: Bench, token: str) -> tuple[str, str]:
    """The status and the cookie of a login."""
    status, cookie, _ = ask(pair, "POST", "/login", f'{{"token": "{token}"}}')
    return status, cookie


def files_with(robot: Machine, secret: str) -> list[Path]:
    """The files of the robot that hold a text; read from outside, so that no command line there has it."""
    files = (each for folder in ("home/ros", "etc", "var/log") for each in (robot.root / folder).rglob("*"))
    return [each for each in files if each.is_file() and not each.is_symlink() and secret.encode() in each.read_bytes()]


def set_up_library(robot: Machine) -> None:
    """Make the environment of the copy as `ur robot setup` does with the internet, which the bench has not."""
    make = (
        f"python3 -m venv --system-site-packages --without-pip {LIBRARY}/.venv && ls -d {LIBRARY}/.venv/lib/python3.*"
    )
    site = Path(robot.run(make, user="ros").check().out.strip(), "site-packages")
    inside = robot.root / str(site).lstrip("/")
    for name in PACKAGES | names_of("web.lock"):
        try:
            files = distribution(name).files or []
        except PackageNotFoundError:  # for another Python
            continue
        for file in files:
            if ".." not in file.parts and "__pycache__" not in file.parts:
                (inside / file).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(file.locate(), inside / file)
    robot.write(f"{site}/ubiquity.pth", f"{LIBRARY}/src\n")
    robot.write(f"{LIBRARY}/.venv/ready-run", f"{LIBRARY}\n")


def names_of(lock: str) -> set[str]:
    """The packages that a lock names."""
    text = (REPOSITORY / "requirements" / lock).read_text()
    return set(re.findall(r"^([A-Za-z0-9_.-]+)==", text, re.MULTILINE))


def test_page_of_a_robot_is_installed_opened_by_links_that_are_good_once_and_removed(pair: Bench) -> None:
    robot = pair["robot"]
    nothing = link(pair)
    assert (nothing.code, "serves no page at boot" in nothing.err) == (2, True)
    first = change(pair, "install web")
    assert (first.code, "is there and not set up" in first.err) == (2, True), f"{first.out}\n{first.err}"
    set_up_library(robot)
    done = change(pair, "install web").check()
    assert "another link to its page" in done.out
    assert "login#" not in done.out  # a link is printed on a terminal only
    assert robot.run("systemctl is-enabled ubiquity-web").out == "enabled\n"

    token, looking = token_of(link(pair)), token_of(link(pair, "--look"))
    assert log_in(pair, "x" * len(token))[0] == "403"
    status, cookie = log_in(pair, token)
    assert (status, bool(cookie)) == ("200", True)
    assert log_in(pair, token) == ("403", "")  # it was used
    status, second = log_in(pair, looking)
    assert status == "200"
    for session, role in ((cookie, "drive"), (second, "look")):
        assert f'"role": "{role}"' in ask(pair, "GET", "/api/me", cookie=session)[2]
    assert ask(pair, "GET", "/api/me")[0] == "403"

    robot.run("systemctl restart ubiquity-web").check()
    assert ask(pair, "GET", "/api/me", cookie=cookie)[0] == "200"
    assert "serves the page on port 8090" in robot.run("journalctl -q -u ubiquity-web -o cat").check().out
    journal, commands = robot.journal(), "\n".join(line for _, line in robot.processes())
    for secret in (token, looking, cookie.partition("=")[2]):
        assert secret not in journal
        assert secret not in commands
        assert files_with(robot, secret) == []

    assert "ubiquity-web.service: removed" in change(pair, "remove web").check().out
    assert robot.run("systemctl is-active ubiquity-web").code != 0
    assert robot.run("pgrep -u ros -f '[u]r web'").code != 0
    assert robot.run("ss -Hltn 'sport = :8090'").check().out == ""
    assert link(pair).code == 2
    assert "ubiquity-master.service: removed" in change(pair, "remove").check().out
