"""Wanted states of ssh: key pairs, and authorized keys."""

from dataclasses import dataclass

from ur.robot.setup.change import Change, ChangeScript
from ur.robot.setup.facts import ComputerFacts, FactsRequest
from ur.robot.setup.made import RECORD, note_script
from ur.robot.setup.wanted import Wanted, WantedFolder, WantedLine
from ur.robot.ssh.host_key import PublicKey, parse_public_key
from ur.robot.ssh.shell import REPLACE, quote
from ur.source.diagnostic import user_error_about

KEY = "~/.ssh/id_ed25519"
AUTHORIZED = "~/.ssh/authorized_keys"
KNOWN_HOSTS = "~/.ssh/known_hosts"
HOST_KEY = "/etc/ssh/ssh_host_ed25519_key.pub"

_NEEDS_KEYGEN = (
    "command -v ssh-keygen >/dev/null || "
    "{ echo 'ssh-keygen is missing; to install it: sudo apt-get install openssh-client' >&2; exit 1; }; "
)


@dataclass(frozen=True, slots=True)
class WantedKeyPair:
    """An ssh key pair of the user, without a pass phrase, so that programs can log in."""

    title: str
    path: str
    comment: str

    def request(self, user: str) -> FactsRequest:
        """Request both key files."""
        return FactsRequest(user, files=frozenset({self.path, self.path + ".pub"}))

    def plan(self, facts: ComputerFacts) -> Change | None:
        """Generate the key pair if it is missing; restore the public key if only that is missing."""
        private, public = facts.file(self.path), facts.file(self.path + ".pub")
        path = quote(facts.resolve(self.path))
        if private.text is None:
            script = (
                f"set -e; {_NEEDS_KEYGEN}{REPLACE}mkdir -p -m 700 $(dirname {path}); "
                f"d=$(mktemp -d {path}.XXXXXX); trap 'rm -rf \"$d\"' EXIT; "
                f'ssh-keygen -q -t ed25519 -N "" -C {quote(self.comment)} -f "$d/key"; '
                f'replace "$d/key.pub" {path}.pub; replace "$d/key" {path}'
            )
            return Change(self.title, f"{self.path}: new key pair ({self.comment})", (ChangeScript(script),))
        if public.text is None:
            again = f"ssh-keygen -y -f {path} >{path}.pub.new && replace {path}.pub.new {path}.pub"
            script = f"{_NEEDS_KEYGEN}{REPLACE}{again}"
            return Change(self.title, f"{self.path}.pub: made again from the private key", (ChangeScript(script),))
        if private.mode & 0o077:
            change = f"{self.path}: mode {private.mode:o} -> 600"
            return Change(self.title, change, (ChangeScript(f"chmod 600 {path}"),))
        return None

    def undo(self, facts: ComputerFacts) -> Change | None:  # noqa: ARG002 - of the protocol
        """Return None: keys stay, since other computers may accept them."""
        return None


@dataclass(frozen=True, slots=True)
class WantedOwnLogin:
    """The user may log in with the user's own key, as roslaunch does for nodes on the same computer's full name."""

    title: str

    def request(self, user: str) -> FactsRequest:
        """Request the key, and the authorized keys."""
        return FactsRequest(user, files=frozenset({KEY + ".pub", AUTHORIZED, RECORD}))

    def plan(self, facts: ComputerFacts) -> Change | None:
        """Add the key, also one that is about to be generated. Raises UserError if the present file is not a key."""
        public, authorized = facts.file(KEY + ".pub").text, facts.file(AUTHORIZED).text
        if public and str(_read_key(self.title, KEY + ".pub", public)) in (authorized or "").split("\n"):
            return None
        key, place = quote(facts.resolve(KEY + ".pub")), quote(facts.resolve(AUTHORIZED))
        script = (
            f'set -e; umask 077; {note_script(facts)} own {place}; note "$f" {place}; '
            f'grep -qxF "$(cat {key})" "$f" 2>/dev/null && exit 0; '
            'new=$(mktemp "$f.XXXXXX"); trap \'rm -f "$new"\' EXIT; [ ! -e "$f" ] || sed -e \'$a\\\' "$f" >"$new"; '
            f'cat {key} >>"$new"; replace "$new" "$f"'
        )
        return Change(self.title, f"{AUTHORIZED}: + the key of this user", (ChangeScript(script),))

    def undo(self, facts: ComputerFacts) -> Change | None:
        """Remove the key."""
        public, authorized = facts.file(KEY + ".pub").text, facts.file(AUTHORIZED).text
        if not public or public.strip() not in (authorized or "").split("\n"):
            return None
        return WantedLine(self.title, AUTHORIZED, public.strip(), mode=0o600).undo(facts)


def own_keys(user: str, name: str, host_key: str | None) -> list[Wanted]:
    """Return a user's key pair, and the login of a computer to itself by its full name, which roslaunch uses.

    `name` is the computer's host name, `host_key` its public host key when it has one already.
    """
    items: list[Wanted] = [
        WantedFolder("ssh folder", "~/.ssh", mode=0o700),
        WantedKeyPair("ssh key", KEY, f"{user}@{name}"),
        WantedOwnLogin("login to itself"),
    ]
    if host_key:
        items.append(known_host("its own host key", name, host_key))
    return items


def known_host(title: str, name: str, host_key: str) -> WantedLine:
    """Return a computer's public host key in ~/.ssh/known_hosts, as NAME.local and NAME.

    Raises UserError for an invalid key.
    """
    key = _read_key(title, HOST_KEY, host_key).key
    return WantedLine(title, KNOWN_HOSTS, f"{name}.local,{name} {key}", mode=0o600, old=(f"{name}.local,",))


def allowed_key(title: str, public_key: str) -> WantedLine:
    """Return the authorization of this key's owner to log in. Raises UserError for an invalid key."""
    return WantedLine(title, AUTHORIZED, str(_read_key(title, KEY + ".pub", public_key)), mode=0o600)


def _read_key(title: str, path: str, text: str) -> PublicKey:
    try:
        return parse_public_key(text)
    except ValueError as problem:
        private = path.removesuffix(".pub")
        raise user_error_about(
            title,
            f"{path} is not a public key: {text[:60]!r}; {problem}",
            rule="bad-key",
            help=f"on that computer, make it again from the private key: ssh-keygen -y -f {private} >{path}",
        ) from None
