"""From the options of `ur launch` to those of a run."""

from __future__ import annotations

from collections.abc import Callable

from ur.request.launch_request import LaunchRequest
from ur.request.options import LaunchOptions
from ur.run.options import Options
from ur.run.record.entry import RunEntry
from ur.run.startup.timings import Timings
from ur.run.supervisor.model import Limits


def make_run_options(request: LaunchRequest, call_started: Callable[[RunEntry], None] | None = None) -> Options:
    """The options of the run that a request asks for. `call_started` is that of a detached run."""
    options, selection, values = request.options, request.selection, request.values
    assert selection is not None
    base = values.get("robot_base", selection.base)
    return Options(
        limits=make_limits(options),
        force_screen=options.screen,
        force_log=options.log,
        force_required=options.required,
        wait_for_master=options.wait and not options.detach,
        port=options.port,
        workers=options.numworkers,
        master_words=make_master_arguments(options),
        base=base,
        variant=values.get("robot_variant", selection.variant if base == selection.base else ""),
        events=1 if options.json else None,
        timings=_begin_timings() if options.timings else None,
        call_started=call_started,
    )


def make_limits(options: LaunchOptions) -> Limits:
    """Times and counts, those of `Limits` where no option changes them."""
    defaults = Limits()
    return Limits(
        interrupt=options.sigint_timeout or defaults.interrupt,
        terminate=options.sigterm_timeout or defaults.terminate,
        quick_deaths=defaults.quick_deaths if options.respawn_limit is None else options.respawn_limit,
    )


def make_master_arguments(options: LaunchOptions) -> tuple[str, ...]:
    """The arguments of rosmaster that options choose."""
    found: list[str] = []
    if options.timeout is not None:
        found += ["-t", str(options.timeout)]
    if options.master_logger_level is not None:
        found += ["--master-logger-level", options.master_logger_level]
    return tuple(found)


def _begin_timings() -> Timings:
    from ur.run.startup.timings import begin_timings

    timings = begin_timings()
    timings.mark("launch file")
    return timings
