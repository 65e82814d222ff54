"""Wanted states of the system: Debian packages and their services."""

from dataclasses import dataclass

from ur.robot.setup.change import Change, ChangeScript
from ur.robot.setup.facts import APT_USERS, ComputerFacts, FactsRequest
from ur.robot.ssh.shell import quote

APT_SECONDS = 3600.0
LOCK_SECONDS = 1800  # a freshly flashed Ubuntu upgrades itself first
APT_LOG = "/var/log/ubiquity-setup.log"


@dataclass(frozen=True, slots=True)
class WantedPackages:
    """Debian packages. In a name with |, the first alternative that exists in this release is chosen."""

    title: str
    names: tuple[str, ...]

    def request(self, user: str) -> FactsRequest:
        """Request all alternatives."""
        return FactsRequest(user, packages=frozenset(name for entry in self.names for name in entry.split("|")))

    def missing(self, facts: ComputerFacts) -> list[str]:
        """Return the entries of which no alternative is installed."""
        return [entry for entry in self.names if not any(name in facts.packages for name in entry.split("|"))]

    def plan(self, facts: ComputerFacts) -> Change | None:
        """Install missing packages, after repairing an interrupted installation."""
        missing = self.missing(facts)
        if not missing:
            return None
        difference = "new packages: " + " ".join(entry.split("|")[0] for entry in missing)
        note = f"{facts.apt_user} installs something there: waiting for its end" if facts.apt_user else ""
        return Change(self.title, difference, (install_packages(missing),), note=note)

    def undo(self, facts: ComputerFacts) -> Change | None:  # noqa: ARG002 - of the protocol
        """Return None: packages stay, since other programs may need them."""
        return None


@dataclass(frozen=True, slots=True)
class WantedService:
    """A systemd unit that is enabled and running."""

    title: str
    unit: str

    def request(self, user: str) -> FactsRequest:
        """Request the unit."""
        return FactsRequest(user, services=frozenset({self.unit}))

    def plan(self, facts: ComputerFacts) -> Change | None:
        """Enable and start the unit."""
        state = facts.services[self.unit]
        if state.enabled in ("enabled", "static", "alias") and state.active in ("active", "activating"):
            return None
        difference = f"{self.unit}: {state.active or 'absent'}, {state.enabled or 'absent'} -> active, enabled"
        return Change(
            self.title, difference, (ChangeScript(f"systemctl enable --now {quote(self.unit)} 2>&1", root=True),)
        )

    def undo(self, facts: ComputerFacts) -> Change | None:  # noqa: ARG002 - of the protocol
        """Return None: services stay, since other programs may need them."""
        return None


def install_packages(entries: list[str]) -> ChangeScript:
    """Install packages with one script, which continues if the connection breaks. Its output goes to APT_LOG."""
    choose = "".join(
        f'for n in {entry.replace("|", " ")}; do apt-cache show $n >/dev/null 2>&1 && break; done; set -- "$@" "$n"; '
        if "|" in entry
        else f'set -- "$@" {quote(entry)}; '
        for entry in entries
    )
    # apt waits for dpkg's lock if configured to, but never for the lock of the package lists.
    wait = f'n=0; while [ -n "$({APT_USERS})" ] && [ $n -lt {LOCK_SECONDS // 2} ]; do sleep 2; n=$((n + 1)); done'
    # The proxy of a set-up closes its connection after each file.
    apt = f"apt-get -q -o APT::Status-Fd=1 -o DPkg::Lock::Timeout={LOCK_SECONDS}"
    apt += " ${http_proxy:+-o Acquire::http::Pipeline-Depth=0}"
    script = (
        f"exec 3>&1 >>{APT_LOG} 2>&1 </dev/null; trap '' HUP PIPE; export DEBIAN_FRONTEND=noninteractive LC_ALL=C; "
        f"from=$(($(wc -l <{APT_LOG}) + 1)); {wait}; dpkg --configure -a; {apt} update; {_FIND_BROKEN}"
        f'[ -z "$broken" ] || {apt} -y --reinstall install $broken; set --; {choose}'
        f'{apt} -y --no-install-recommends install "$@"; code=$?; [ $code -eq 0 ] || {{ '
        f"said=$(tail -n +$from {APT_LOG}); {_EXPLAIN}; }} >&3; exit $code"
    )
    return ChangeScript(script, root=True, timeout=APT_SECONDS, fetches=True, log=APT_LOG)


# A package whose unpacking was killed blocks the configuration of itself and of all that depend on it.
_FIND_BROKEN = "broken=$(dpkg-query -W -f='${db:Status-Eflag} ${binary:Package}\\n' | sed -n 's/^reinstreq //p'); "
# Without a network, apt names a file that it cannot download; the reason is in an earlier line.
_EXPLAIN = (
    'echo "$said" | grep -m 1 -oE \'(Temporary failure resolving|Could not resolve|Could not connect to|'
    "Unable to connect to|Cannot initiate the connection to|Connection timed out).*' | "
    "sed 's/^/it does not reach its package servers: /'; "
    "echo \"$said\" | grep -E '^(E|Err|W):' | tail -n 4"
)
