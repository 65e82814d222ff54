"""The texts of an editor, saved or not, and the findings in them, kept up to date."""

import os
import re
import threading
import time
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from typing import NamedTuple

from ur.check.cases import resolve_cases
from ur.check.collect import collect_targets
from ur.check.rule import LaunchView, survey_launch_file
from ur.check.session import CheckSession
from ur.check.worlds import CachedWorld
from ur.launchfile.plan.specs import Plan, TraceStep
from ur.launchfile.query.written import ENDINGS
from ur.launchfile.syntax.parse import decode_text
from ur.launchfile.world import World
from ur.launchfile.world.overlay import OverlayWorld
from ur.source.diagnostic import Diagnostic, UserError
from ur.source.file import SourceFile

MakeWorld = Callable[[Sequence[str]], World]  # of the paths that are checked; see ur.check.worlds
_ENCODING = re.compile(r"""\A<\?xml[^>]*?encoding\s*=\s*["']([A-Za-z0-9._-]+)["']""")
_SLICE = 0.1  # seconds of work within one piece after which requests are looked at
_UNREADABLE = frozenset({"python-syntax", "bad-yaml", "bad-xml", "undefined-name"})
_PATIENCE = 0.03  # seconds of processor
_KEPT = 16  # files whose plans are kept

ResolvedCase = tuple[str, Plan, tuple[TraceStep, ...]]
"""The arguments of a case as they would be typed, its plan, and how values resulted."""


class _KnownCases(NamedTuple):
    version: int
    cases: list[ResolvedCase]
    seconds: float  # of processor, to find them


class Workspace:
    """Folders that an editor has opened, and the texts that it has changed. `version` grows with each change."""

    def __init__(self, folders: Sequence[str], make_world: MakeWorld) -> None:
        self.folders = [os.path.realpath(each) for each in folders]
        self.version = 0
        self._make_world = make_world
        self._texts: dict[str, bytes] = {}
        self._more: list[str] = []  # files and packages outside of the folders
        self._session: CheckSession | None = None
        self._stale = True
        self._cases: dict[str, _KnownCases] = {}

    # Texts

    def set_text(self, path: str, text: str) -> None:
        """Take the text of a file as the editor shows it."""
        self._replace(path, encode_text(text))

    def drop_text(self, path: str) -> None:
        """Take the text of a file as it is stored."""
        self._replace(path, None)

    def _replace(self, path: str, data: bytes | None) -> None:
        if data is None:
            self._texts.pop(path, None)
        else:
            self._texts[path] = data
        self.note_change(path)

    def note_change(self, path: str) -> None:
        """Note that a file may have changed, on the disk or in the editor."""
        self.version += 1
        if self._session is None or not self._covers(path) or not self._session.change(path):
            self._stale = True

    def _covers(self, path: str) -> bool:
        return any(path == each or path.startswith(each.rstrip("/") + "/") for each in (*self.folders, *self._more))

    # Findings

    @property
    def session(self) -> CheckSession | None:
        """The check of everything that is opened; None where there is nothing to check."""
        if self._stale:
            self._stale = False
            self._renew()
        return self._session

    def _renew(self) -> None:
        before = (*self._more,)
        for path in self._texts:
            if not self._covers(path):
                self._more.append(_package_of(path) or path)
        paths = [each for each in (*self.folders, *self._more) if each in self._texts or os.path.lexists(each)]
        world = OverlayWorld(self._make_world(paths), self._texts, os.path.realpath)
        try:
            if self._session is not None and before == (*self._more,):
                self._session.renew(world)
            else:
                self._session = _begin_session(paths, world)
        except UserError:
            self._session = _begin_session(paths, world)

    def steps(self, first: Sequence[str] = ()) -> Iterator[frozenset[str]]:
        """Find what has changed, `first` in those files; yields after each piece the files with other findings."""
        if self.session is not None:
            yield from _in_slices(self._steps(self.session, first), self.session.world)

    def _steps(self, session: CheckSession, first: Sequence[str]) -> Iterator[frozenset[str]]:
        yield from session.steps(first)
        for path in first:  # the editor may ask for them next
            if path.endswith(ENDINGS) and (view := self.view(path)) is not None:
                self._renew_cases(view)
                yield frozenset()

    def findings_of(self, path: str) -> list[Diagnostic]:
        """The findings in one file, as far as they are known."""
        return self.session.findings_of(path)[0] if self.session is not None else []

    # Files

    @property
    def world(self) -> CachedWorld:
        """The world with the texts of the editor."""
        if self.session is not None:
            return self.session.world
        return CachedWorld(OverlayWorld(self._make_world(self.folders), self._texts, os.path.realpath))

    def source(self, path: str) -> SourceFile:
        """The text of a file. Raises OSError."""
        return SourceFile(path, decode_text(self.world.read_bytes(path))[0])

    @property
    def views(self) -> dict[str, LaunchView]:
        """All launch files of the workspace."""
        session = self.session
        if session is None:
            return {}
        if not session.sources.views:
            next(session.steps(), None)
        return {**session.sources.views, **session.sources.neighbours}

    def view(self, path: str) -> LaunchView | None:
        """A launch file, of the workspace or not; None where it cannot be read."""
        known = self.views.get(path)
        if known is not None:
            return known
        try:
            return survey_launch_file(path, None, self.world)
        except OSError:
            return None

    def cases(self, view: LaunchView) -> list[ResolvedCase]:
        """The plans of a launch file for each base and variant, kept until something changes.

        Those of a program that take long are of an earlier text until `steps` has found the new ones.
        """
        known = self._cases.get(view.path)
        if known is None or (view.path.endswith(ENDINGS) and known.seconds < _PATIENCE):
            return self._renew_cases(view)
        broken = view.tree.launch is not None and view.tree.diagnostics  # the values of before are better than none
        return known.cases if broken or view.path.endswith(ENDINGS) else self._renew_cases(view)

    def _renew_cases(self, view: LaunchView) -> list[ResolvedCase]:
        known = self._cases.get(view.path)
        if known is None or known.version != self.version:
            began, version = time.thread_time(), self.version
            found = list(self._resolve(view))
            if known is not None and any(each.rule in _UNREADABLE for _, plan, _ in found for each in plan.diagnostics):
                found = known.cases
            known = _KnownCases(version, found, time.thread_time() - began)
            self._cases = {view.path: known, **dict(list(self._cases.items())[:_KEPT])}
        return known.cases

    def _resolve(self, view: LaunchView) -> Iterator[ResolvedCase]:
        trace: list[TraceStep] = []
        trees = self.session.sources.trees if self.session is not None else None
        seen = set()
        for resolved in resolve_cases(view, self.world, trace=trace, trees=trees):
            if resolved.case.flipped is not None:
                break
            if resolved.case.label not in seen:
                seen.add(resolved.case.label)
                yield resolved.case.label, resolved.plan, tuple(trace)
            trace.clear()


class _Abandoned(BaseException):
    """Ends work that is not wanted any more, wherever it is."""


def _in_slices(work: Iterator[frozenset[str]], world: CachedWorld) -> Iterator[frozenset[str]]:
    """Yield what `work` does, and nothing after each slice of a longer piece.

    The work has a thread of its own, which stands still except while the caller waits for the next piece.
    """
    go, back = threading.Semaphore(0), threading.Semaphore(0)
    found: deque[frozenset[str] | BaseException | None] = deque()
    until, wanted = 0.0, True

    def hand_over(piece: frozenset[str]) -> None:
        questions, world.noted = world.noted, None
        found.append(piece)
        back.release()
        go.acquire()
        world.noted = questions
        if not wanted:
            raise _Abandoned

    def pause() -> None:
        if threading.current_thread() is thread and time.monotonic() > until:
            hand_over(frozenset())

    def run() -> None:
        end: BaseException | None = None
        try:
            go.acquire()
            for piece in work if wanted else ():
                hand_over(piece)
        except BaseException as problem:  # raised where the work is wanted
            end = problem
        world.pause_by(None)
        found.append(end)
        back.release()

    thread = threading.Thread(target=run, daemon=True)
    thread.start()
    try:
        while True:
            until = time.monotonic() + _SLICE
            world.pause_by(pause)
            go.release()
            back.acquire()
            piece = found.pop()
            if isinstance(piece, BaseException):
                raise piece
            if piece is None:
                return
            yield piece
    finally:
        wanted = False
        go.release()
        thread.join(1.0)


def encode_text(text: str) -> bytes:
    """A text of an editor as the bytes that it would store: in the encoding that the text declares, else UTF-8."""
    declared = _ENCODING.match(text)
    try:
        return text.encode(declared.group(1) if declared else "utf-8")
    except (LookupError, UnicodeError):
        return text.encode("utf-8", "replace")


def _begin_session(paths: Sequence[str], world: World) -> CheckSession | None:
    with suppress(UserError):
        return CheckSession(paths, world)
    usable = [path for path in paths if _can_be_checked(path, world)]
    return CheckSession(usable, world) if usable else None


def _can_be_checked(path: str, world: World) -> bool:
    # Not a folder without files, and no file of another kind.
    try:
        collect_targets([path], world)
    except UserError:
        return False
    return True


def _package_of(path: str) -> str | None:
    folder = os.path.dirname(path)  # noqa: PTH120 - texts throughout
    while len(folder) > 1:
        if os.path.isfile(f"{folder}/package.xml"):  # noqa: PTH113 - likewise
            return folder
        folder = os.path.dirname(folder)  # noqa: PTH120 - likewise
    return None
