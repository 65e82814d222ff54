"""Record of the files that `ur` created in a home folder, so that it can remove them all.

The record has a line for each file and folder that did not exist before, and `unended PATH` for files whose last line
had no line end. Replaced files are saved beside the record. The scripts that create files write the record first.
"""

from dataclasses import dataclass

from ur.robot.setup.change import Change, ChangeScript
from ur.robot.setup.facts import ComputerFacts, FactsRequest
from ur.robot.ssh.shell import REPLACE, quote

FOLDER = "~/.local/state/ubiquity_launches/setup"
RECORD = f"{FOLDER}/made"


def kept_path(path: str) -> str:
    """Return the path of the saved original of a replaced file."""
    return f"{FOLDER}/before{path.removeprefix('~').replace('/', '%')}"


def is_made(facts: ComputerFacts, path: str) -> bool:
    """Return whether the record lists this file or folder as created by `ur`."""
    return facts.resolve(path) in (facts.file(RECORD).text or "").split("\n")


def was_unended(facts: ComputerFacts, path: str) -> bool:
    """Return whether the last line of this file originally had no line end."""
    return f"unended {facts.resolve(path)}" in (facts.file(RECORD).text or "").split("\n")


def note_script(facts: ComputerFacts) -> str:
    """Return shell functions.

    `own PATH` sets f to PATH without symbolic links, for the others. `note PATH NAME` is to be called before PATH is
    created or changed; NAME is its path as the user writes it. `keep PATH PLACE` saves a file of the user that will be
    replaced. `prune PATH` removes folders that were created for PATH.
    """
    home, record = quote(facts.home), quote(facts.resolve(RECORD))
    return (
        # The home folder may be a symbolic link: paths are as its user writes them.
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
    """The record itself: no set-up needs it, and the removal of everything deletes it last."""

    title: str = "record of what was there"

    def request(self, user: str) -> FactsRequest:
        """Request the record."""
        return FactsRequest(user, files=frozenset({RECORD}))

    def plan(self, facts: ComputerFacts) -> Change | None:  # noqa: ARG002 - of the protocol
        """Return None: the record is written together with other files."""
        return None

    def undo(self, facts: ComputerFacts) -> Change | None:
        """Remove the record, and the folders that were created for it."""
        if facts.file(RECORD).text is None:
            return None
        folder = quote(facts.resolve(FOLDER))
        script = (
            f'{note_script(facts)} all=$(cat "$r"); made() {{ printf "%s\\n" "$all" | grep -qxF -- "$1"; }}; '
            f'rm -f "$r"; d={folder}; r=/; while made "$d" && rmdir "$d" 2>/dev/null; do d=${{d%/*}}; done; :'
        )
        return Change(self.title, f"{RECORD}: removed", (ChangeScript(script),))
