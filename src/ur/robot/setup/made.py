"""Records of what `ur` made in a home folder, so that it can be undone without a trace.

The record has a line for each file and folder that was not there, and `unended PATH` for files whose last line had no
end. Files that were replaced lie beside it. It is written before anything is made, by the scripts that make it.
"""

from __future__ import annotations

from dataclasses import dataclass

from ur.robot.setup.change import Change, ChangeScript
from ur.robot.setup.facts import ComputerFacts, FactsRequest
from ur.robot.ssh.shell import REPLACE, quote

FOLDER = "~/.local/state/ubiquity_launches/setup"
RECORD = f"{FOLDER}/made"


def kept_path(path: str) -> str:
    """The path of the kept original of a replaced file."""
    return f"{FOLDER}/before{path.removeprefix('~').replace('/', '%')}"


def is_made(facts: ComputerFacts, path: str) -> bool:
    """Return whether it is known that this file or folder was not there before."""
    return facts.resolve(path) in (facts.file(RECORD).text or "").split("\n")


def was_unended(facts: ComputerFacts, path: str) -> bool:
    """Return whether the last line of this file had no end."""
    return f"unended {facts.resolve(path)}" in (facts.file(RECORD).text or "").split("\n")


def note_script(facts: ComputerFacts) -> str:
    """Shell functions. `own PATH` sets f to what PATH is without symbolic links, for the others.

    `note PATH NAME` is to be called before PATH is made or changed; NAME is what its user calls it. `keep PATH PLACE`
    puts a file of the user away that will be replaced. `prune PATH` removes folders that were made for PATH.
    """
    home, record = quote(facts.home), quote(facts.resolve(RECORD))
    return (
        # The home folder may be reached through a link: paths are as its user writes them.
        f'{REPLACE}h={home}; own() {{ f=$(readlink -m "$1"); H=$(readlink -m "$h"); '
        'case $f in "$H"/*) f=$h${f#"$H"};; esac; }; '
        f'r={record}; made() {{ grep -qxF -- "$1" "$r" 2>/dev/null; }}; '
        'miss() { case $1 in "$h"/*) miss "${1%/*}"; [ -e "$1" ] || printf "%s\\n" "$1";; esac; }; '
        'note() { new=$(miss "$r"; miss "$1"; [ "$1" = "$2" ] || [ -e "$1" ] || printf "%s\\n" "$2"; '
        'if [ -f "$1" ] && [ -n "$(tail -c 1 "$1" | tr -d "\\n\\0")" ]; then printf "unended %s\\n" "$2"; fi); '
        '[ -z "$new" ] || { (umask 077; mkdir -p "${r%/*}"); printf "%s\\n" "$new" >>"$r"; last "$r" "${r%/*}"; }; }; '
        'keep() { [ ! -f "$1" ] || [ -e "$2" ] || made "$1" || { cp -p "$1" "$2.new" && replace "$2.new" "$2"; }; }; '
        'prune() { d=${1%/*}; while [ "$d" != "$h" ] && made "$d" && rmdir "$d" 2>/dev/null; '
        "do d=${d%/*}; done; :; }; "
    )


@dataclass(frozen=True, slots=True)
class WantedRecord:
    """The record itself: no set-up wants it, and what takes everything back removes it at the end."""

    title: str = "record of what was there"

    def request(self, user: str) -> FactsRequest:
        """The record."""
        return FactsRequest(user, files=frozenset({RECORD}))

    def plan(self, facts: ComputerFacts) -> Change | None:  # noqa: ARG002 - of the protocol
        """It is written when something is."""
        return None

    def undo(self, facts: ComputerFacts) -> Change | None:
        """Remove it, and the folders that were made for it."""
        if facts.file(RECORD).text is None:
            return None
        folder = quote(facts.resolve(FOLDER))
        script = (
            f'{note_script(facts)} all=$(cat "$r"); made() {{ printf "%s\\n" "$all" | grep -qxF -- "$1"; }}; '
            f'rm -f "$r"; d={folder}; r=/; while made "$d" && rmdir "$d" 2>/dev/null; do d=${{d%/*}}; done; :'
        )
        return Change(self.title, f"{RECORD}: removed", (ChangeScript(script),))
