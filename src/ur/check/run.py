"""The whole check: collect, read, visit, resolve, merge, and apply the comments that hide findings."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from ur.check.cache.recall import Recall
from ur.check.session import CheckSession
from ur.launchfile.world import World
from ur.source.diagnostic import Diagnostic, Severity
from ur.source.progress import Progress, no_progress


@dataclass(frozen=True, slots=True)
class CheckReport:
    """The findings of a check, sorted by place, and the number of checked files."""

    findings: tuple[Diagnostic, ...]
    files: int
    suppressed: int
    left_out: tuple[str, ...] = ()  # links that lead out of what was checked
    gaps: tuple[Diagnostic, ...] = ()  # values that are not known without running the file

    @property
    def errors(self) -> int:
        """The number of findings that are errors."""
        return sum(found.severity is Severity.ERROR for found in self.findings)


def check_paths(
    paths: Sequence[str],
    world: World,
    chosen: frozenset[str] | None = None,
    arguments: Mapping[str, str] | None = None,
    progress: Progress = no_progress,
    recall: Recall | None = None,
) -> CheckReport:
    """Check files, folders and packages; `chosen` are rule ids (None: all). Raises UserError for a bad path.

    `arguments` are given to every launch file that declares them; the others keep their defaults or are unknown.
    `recall` contains findings of an earlier check, which save work without changing the result, and receives those of
    this one.
    """
    session = CheckSession(paths, world, chosen, arguments, progress, recall)
    return finish_report(session)


def finish_report(session: CheckSession) -> CheckReport:
    """Complete the work of a session, and report its findings."""
    for _ in session.steps():
        pass
    found = [session.findings_of(path) for path in session.paths]
    targets = session.sources.targets
    files = len(targets.launch_files) + len(targets.yaml_files) + len(targets.programs)
    findings = tuple(each for group, _ in found for each in group)
    gaps = tuple(each for path in session.paths for each in session.gaps_of(path))
    return CheckReport(findings, files, sum(hidden for _, hidden in found), targets.left_out, gaps)
