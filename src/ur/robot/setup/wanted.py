"""Wanted states, one class per kind: the facts it needs, the change that reaches it, and the change that reverts it.

`plan` returns None if the computer is already in the state. `undo` returns None if there is nothing to revert.
"""

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from ur.robot.setup.change import Change, ChangeScript, show_difference
from ur.robot.setup.facts import ComputerFacts, FactsRequest
from ur.robot.setup.made import RECORD, is_made, kept_path, note_script, was_unended
from ur.robot.ssh.shell import REPLACE, quote


class Wanted(Protocol):
    """A property that a computer is to have."""

    @property
    def title(self) -> str:
        """A few words that name the state."""

    def request(self, user: str) -> FactsRequest:
        """Return the facts that `plan` and `undo` need."""

    def plan(self, facts: ComputerFacts) -> Change | None:
        """Plan the missing changes."""

    def undo(self, facts: ComputerFacts) -> Change | None:
        """Plan the changes that undo it."""


@dataclass(frozen=True, slots=True)
class WantedFile:
    """A file with exactly this text, owned by root unless it lies in the home folder (~/).

    `then` is a script that runs in the same command, as root: it makes a service read the file.
    """

    title: str
    path: str
    text: str
    mode: int = 0o644
    then: str = ""

    def request(self, user: str) -> FactsRequest:
        """Request the file, and the record of its original."""
        return FactsRequest(user, files=frozenset({self.path, RECORD, kept_path(self.path)}))

    def plan(self, facts: ComputerFacts) -> Change | None:
        """Write the file if its text or mode differ. An existing file of the user is saved."""
        state = facts.file(self.path)
        if state.text == self.text and state.mode == self.mode:
            return None
        difference = show_difference(self.path, state.text, self.text)
        difference = difference or f"{self.path}: mode {state.mode:o} -> {self.mode:o}"
        return Change(
            self.title, difference, (write_file(facts, self.path, self.text, self.mode, self.then, keep=True),)
        )

    def undo(self, facts: ComputerFacts) -> Change | None:
        """Remove the file if it is unchanged since `ur` wrote it, and restore the original."""
        state, kept = facts.file(self.path), facts.file(kept_path(self.path)).text
        if state.text != self.text:
            return None
        if kept is None:
            return _remove_file(facts, self.title, self.path, state.text, self.then)
        place = quote(facts.resolve(kept_path(self.path)))
        script = f'{note_script(facts)} own {quote(facts.resolve(self.path))}; replace {place} "$f"'
        return Change(self.title, show_difference(self.path, state.text, kept), (ChangeScript(script),))


@dataclass(frozen=True, slots=True)
class WantedLine:
    """A line in a text file of the user, as the first or the last one. The user's own lines stay unchanged.

    `old` are beginnings of lines that it replaces: those of earlier versions.
    """

    title: str
    path: str
    line: str
    first: bool = False
    mode: int = 0o644
    old: tuple[str, ...] = ()

    def request(self, user: str) -> FactsRequest:
        """Request the file, and the record of its original."""
        return FactsRequest(user, files=frozenset({self.path, RECORD}))

    def plan(self, facts: ComputerFacts) -> Change | None:
        """Put the line in its place and remove it elsewhere in the file. A mode is corrected only if it is too wide."""
        state = facts.file(self.path)
        rest = self._rest(state.text)
        if self.first:
            text = f"{self.line}\n{rest}"
        else:
            text = rest + ("\n" if rest and not rest.endswith("\n") else "") + f"{self.line}\n"
        present = state.text is not None and self.line in state.text.split("\n")
        settled = state.text == text if self.first else present
        wide = bool(state.mode & ~self.mode & 0o077) and not self.first
        if settled and not wide:
            return None
        mode = self.mode if state.text is None or wide else state.mode
        text = text if not settled else state.text or ""
        difference = show_difference(self.path, state.text, text) or f"{self.path}: mode {state.mode:o} -> {mode:o}"
        return Change(self.title, difference, (write_file(facts, self.path, text, mode),))

    def undo(self, facts: ComputerFacts) -> Change | None:
        """Remove the line, and the file if it did not exist before and is empty otherwise."""
        state = facts.file(self.path)
        if state.text is None or self.line not in state.text.split("\n"):
            return None
        rest = self._rest(state.text)
        if not rest and is_made(facts, self.path):
            return _remove_file(facts, self.title, self.path, state.text)
        if not self.first and state.text == f"{rest}{self.line}\n" and was_unended(facts, self.path):
            rest = rest.removesuffix("\n")
        difference = show_difference(self.path, state.text, rest)
        return Change(self.title, difference, (write_file(facts, self.path, rest, state.mode),))

    def _rest(self, text: str | None) -> str:
        lines = re.findall(r"[^\n]*\n|[^\n]+", text or "")  # str.splitlines would also split at a form feed
        return "".join(line for line in lines if not self._is_ours(line.rstrip("\n")))

    def _is_ours(self, line: str) -> bool:
        return line == self.line or (bool(self.old) and line.startswith(self.old))


@dataclass(frozen=True, slots=True)
class WantedFolder:
    """A folder of the user."""

    title: str
    path: str
    mode: int = 0o755

    def request(self, user: str) -> FactsRequest:
        """Request the folder, and the record of its origin."""
        return FactsRequest(user, files=frozenset({self.path, RECORD}))

    def plan(self, facts: ComputerFacts) -> Change | None:
        """Create the folder. If others must not enter it, permissions that are too wide are removed."""
        state = facts.file(self.path)
        strict = not self.mode & 0o077
        if state.folder and not (strict and state.mode & ~self.mode):
            return None
        path = quote(facts.resolve(self.path))
        if state.folder:
            difference = f"{self.path}: mode {state.mode:o} -> {self.mode:o}"
            return Change(self.title, difference, (ChangeScript(f"chmod {self.mode:o} {path}"),))
        script = (
            f'{note_script(facts)} own {path}; note "$f" {path}; mkdir -p -m {self.mode:o} "$f" && last "${{f%/*}}"'
        )
        return Change(self.title, f"{self.path}/: new folder", (ChangeScript(script),))

    def undo(self, facts: ComputerFacts) -> Change | None:
        """Remove the folder if `ur` created it and it is empty. A private one stays: it holds keys."""
        if not facts.file(self.path).folder or not self.mode & 0o077 or not is_made(facts, self.path):
            return None
        script = f'{note_script(facts)} own {quote(facts.resolve(self.path))}; prune "$f/."'
        return Change(self.title, f"{self.path}/: removed if empty", (ChangeScript(script),))


@dataclass(frozen=True, slots=True)
class WantedGroups:
    """Groups of the user, of those that exist on the computer."""

    title: str
    names: tuple[str, ...]

    def request(self, user: str) -> FactsRequest:
        """Request the groups."""
        return FactsRequest(user, files=frozenset({"/etc/group"}))

    def plan(self, facts: ComputerFacts) -> Change | None:
        """Add the user to missing groups, which takes effect at the next login."""
        existing = {line.split(":")[0] for line in (facts.file("/etc/group").text or "").splitlines()}
        missing = [name for name in self.names if name in existing and name not in facts.groups]
        if not missing:
            return None
        script = f"usermod --append --groups {','.join(missing)} {quote(facts.user)}"
        difference = f"{facts.user} joins {', '.join(missing)}"
        return Change(self.title, difference, (ChangeScript(script, root=True),))

    def undo(self, facts: ComputerFacts) -> Change | None:  # noqa: ARG002 - of the protocol
        """Return None: group memberships stay, since other programs may need them."""
        return None


@dataclass(frozen=True, slots=True)
class WantedScript:
    """A script that runs in any case, such as one whose input is a secret: it is sent and never shown."""

    title: str
    difference: str
    make: Callable[[ComputerFacts], ChangeScript]

    def request(self, user: str) -> FactsRequest:
        """Request no facts."""
        return FactsRequest(user)

    def plan(self, facts: ComputerFacts) -> Change | None:
        """Run the script."""
        return Change(self.title, self.difference, (self.make(facts),))

    def undo(self, facts: ComputerFacts) -> Change | None:  # noqa: ARG002 - of the protocol
        """Return None: its effect stays."""
        return None


def write_file(
    facts: ComputerFacts, path: str, text: str, mode: int, then: str = "", *, keep: bool = False
) -> ChangeScript:
    """Write a file atomically: a reader sees the old or the new one, also if a process is killed.

    A file that is a symbolic link stays one: its target is written. With `keep`, an existing file of the user is saved.
    """
    own = path.startswith("~/")
    target = quote(facts.resolve(path))
    if own:
        find = f'{note_script(facts)} own {target}; note "$f" {target}; '
        find += f'keep "$f" {quote(facts.resolve(kept_path(path)))}; ' if keep else ""
    else:
        find = f"{REPLACE}f=$(readlink -m {target}); "
    script = (
        f'set -e; {find}d=${{f%/*}}; [ -d "$d" ] || {{ (umask 022; mkdir -p "$d"); sync -f "$d"; }}; umask 077; '
        'new=$(mktemp "$f.XXXXXX"); trap \'rm -f "$new"\' EXIT HUP INT TERM; cat >"$new"; '
        # An interrupted transmission must not count as complete.
        f'[ "$(wc -c <"$new")" -eq {len(text.encode(errors="surrogateescape"))} ]; '
        f'chmod {mode:o} "$new"; replace "$new" "$f"'
    )
    if then:
        script += f"; {then}"
    return ChangeScript(script, root=not own, stdin=text)


def _remove_file(facts: ComputerFacts, title: str, path: str, text: str | None, then: str = "") -> Change:
    own = path.startswith("~/")
    target = quote(facts.resolve(path))
    script = f'{note_script(facts)} own {target}; rm -f "$f"; prune "$f"' if own else f"rm -f {target}"
    script += f"; {then}" if then else ""
    return Change(title, show_difference(path, text, None), (ChangeScript(script, root=not own),))
