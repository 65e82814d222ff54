"""Requests of pages that drive: each is checked, answered, and passed on to the mux and to navigation."""

import itertools
from dataclasses import dataclass, replace

from ur.web.wire.map_requests import MapRequest
from ur.web.wire.reading import BadRequestError
from ur.web.wire.requests import (
    Alive,
    AskForLease,
    AskPatrol,
    Cancel,
    LetGo,
    LimitSpeed,
    ReleaseAll,
    Request,
    SaveRecording,
    Stick,
    StopAll,
    SwitchObstacleStop,
    read_request,
)
from ur_nodes.client.mux import MuxLink
from ur_nodes.client.patrol_text import PatrolLink, PatrolRequest, PatrolRoute, PatrolStop
from ur_nodes.client.saving import request_recording
from ur_nodes.motion.challenge.freshness import Stamp
from ur_nodes.motion.lease.text import clean_computer, clean_name, is_client
from ur_nodes.ports.node import Node
from ur_nodes.ports.values import Result, Twist
from ur_nodes.web.driving.driver_link import DriverLink
from ur_nodes.web.driving.page_goals import GoalPage, PageGoals
from ur_nodes.web.driving.page_lease import (
    PageLease,
    StickState,
    Verdict,
    end_stick,
    expire_stick,
    let_go,
    may_drive,
    participates,
    request_action,
    step_page,
    step_stick,
)
from ur_nodes.web.maps.map_link import MapChanges, Reply
from ur_nodes.web.maps.place_file import PlaceFile

_TICK = 0.1  # s: presses end in time even where challenges stay away
_MOST_PAGES = 100


@dataclass(frozen=True, slots=True)
class DrivenRobot:
    """The parts of a robot that pages may command: mux, navigation, places, patrols and the map."""

    mux: MuxLink
    goals: PageGoals
    places: PlaceFile
    patrol: PatrolLink
    changes: MapChanges


class DriverSession:
    """Pages that may drive, by client id; on the node's thread. `reply` sends an answer to a page."""

    def __init__(self, node: Node, link: DriverLink, robot: DrivenRobot, reply: Reply) -> None:
        self._node, self._link, self._robot, self._reply = node, link, robot, reply
        self._pages: dict[str, GoalPage] = {}
        self._numbers = itertools.count(1)
        node.every(_TICK, self.expire, steady=True)
        node.on_end(self.remove_all)

    def come(self, client: str, name: str, computer: str, *, once: bool = False) -> None:
        """Add a page that may drive. `computer` identifies its browser; a page that is `once` cannot reconnect."""
        if not is_client(client):
            return
        lease = PageLease(client, clean_computer(computer))
        self._pages[client] = GoalPage(clean_name(name) or "a page", lease, once=once)
        while len(self._pages) > _MOST_PAGES:
            self.remove(next(iter(self._pages)))

    def rename(self, client: str, name: str) -> None:
        """Change the name of a page, from its next request on."""
        if client in self._pages:
            self._pages[client] = replace(self._pages[client], name=clean_name(name) or "a page")

    def remove(self, client: str) -> None:
        """Remove a page that has disconnected, and end its press at once.

        The mux then loses it, and its goal is held. A page that cannot reconnect gives up goal and lease at once.
        """
        page = self._pages.pop(client, None)
        if page is not None:
            _, verdict = end_stick(page.stick)
            self._finish(page, verdict, "")
            if page.once:
                self._give_up(page)

    def _give_up(self, page: GoalPage) -> None:
        """Cancel the goal of a client and release its lease, or withdraw its request for it."""
        lease, newest = self._link.lease, self._link.newest
        if lease is None or newest is None:
            return
        if lease.client == page.lease.client:
            self._robot.goals.cancel()
        if participates(page.lease, lease):
            self._link.request(page.lease, page.name, "release", newest)

    def remove_all(self) -> None:
        """Remove all pages: the server has ended."""
        for client in list(self._pages):
            self.remove(client)

    def expire(self) -> None:
        """End presses whose commands have stopped arriving; to be called often, and with each challenge."""
        now = self._node.steady()
        for client, page in list(self._pages.items()):
            if page.stick.live:
                self._step(client, page, expire_stick(page.stick, now), "late")

    def emergency(self) -> None:
        """Stop every motion, at the request of any page."""
        self._robot.mux.ask("stop")

    def receive(self, client: str, text: str) -> None:
        """Carry out a request of a page, or refuse it."""
        try:
            request = read_request(text)
        except BadRequestError as problem:
            self._reply(client, {"t": "bad", "why": str(problem)})
            return
        page = self._pages.get(client)
        if page is None:
            return
        if isinstance(request, MapRequest):
            self._robot.changes.apply(client, request)
        elif isinstance(request, AskPatrol):
            self._ask_patrol(client, page, request)
        else:
            self._obey(client, page, request)

    def _obey(self, client: str, page: GoalPage, request: Request) -> None:
        if isinstance(request, Stick):
            self._drive(client, page, request)
        elif isinstance(request, LetGo):
            self._step(client, page, let_go(page.stick, request.hold), "")
        elif isinstance(request, Alive):
            self._renew(client, page, request.answers)
        elif isinstance(request, AskForLease):
            self._ask_for_lease(client, page, request)
        elif isinstance(request, StopAll | ReleaseAll):
            self._robot.mux.ask("stop" if isinstance(request, StopAll) else "release")
        elif isinstance(request, LimitSpeed):
            self._link.limit_speed(request.percent)
        elif isinstance(request, SwitchObstacleStop):
            self._robot.mux.ask("obstacles on" if request.on else "obstacles off")
        elif isinstance(request, Cancel):
            self._robot.goals.cancel()
        elif isinstance(request, SaveRecording):
            self._save_recording(client)
        elif not isinstance(request, MapRequest | AskPatrol):
            after = self._robot.goals.apply(page, request, lambda what, why: self._refuse(client, what, why))
            self._pages[client] = after
            if after.goal != page.goal:
                self._reply(client, {"t": "sent", "what": "goal", "number": after.goal})

    def _ask_for_lease(self, client: str, page: GoalPage, request: AskForLease) -> None:
        lease = self._link.lease
        if request.action == "release" and page.goal and lease and lease.client == client:
            self._robot.goals.cancel()  # a goal whose client has left would be held
        page = replace(page, lease=request_action(page.lease, request.action, self._node.steady()))
        self._renew(client, page, request.answers)

    def _drive(self, client: str, page: GoalPage, command: Stick) -> None:
        age = self._link.age_of(command.answers)
        stick, verdict = step_stick(page.stick, command.hold, age, self._node.steady())
        why = "late"
        if verdict == "drive" and not may_drive(page.lease, self._link.lease):
            stick, verdict = end_stick(stick)
            why = "driver"
        elif verdict == "drive" and not self._link.connected:
            stick, verdict = end_stick(stick)
            why = "no mux"
        if verdict == "drive":
            page = replace(page, lease=replace(page.lease, ended_at=None))
            if command.hold != page.stick.hold:
                page = self._robot.goals.acquire(page, command.answers)
            self._link.drive(page.lease, command.answers, Twist(command.forward, command.turn, command.left))
        self._step(client, page, (stick, verdict), why)

    def _step(self, client: str, page: GoalPage, step: tuple[StickState, Verdict], why: str) -> None:
        stick, verdict = step
        self._pages[client] = replace(page, stick=stick)
        self._finish(page, verdict, why)
        if verdict == "over" and why:
            self._reply(client, {"t": "over", "hold": stick.hold, "why": why})

    def _finish(self, page: GoalPage, verdict: Verdict, why: str) -> None:
        """Send a stop when a press has ended; without it the mux would stop the robot a moment later."""
        if verdict == "over" and why != "driver" and may_drive(page.lease, self._link.lease):
            self._link.stop(page.lease)

    def _renew(self, client: str, page: GoalPage, answer: Stamp) -> None:
        page = self._robot.goals.note(page)
        lease, action = step_page(page.lease, self._link.lease, self._node.steady())
        page = self._pages[client] = replace(page, lease=lease)
        if action is not None:
            self._link.request(page.lease, page.name, action, answer)

    def _ask_patrol(self, client: str, page: GoalPage, request: AskPatrol) -> None:
        """Pass on a request for a patrol; the patrol's node checks its age and the lease."""

        def answer(problem: str) -> None:
            what = {"t": "refused", "why": problem} if problem else {"t": "done"}
            self._reply(client, {**what, "what": "patrol"})

        stops = tuple(self._find_stop(each) for each in request.stops)
        if None in stops:
            answer("no place")
            return
        route = PatrolRoute(tuple(each for each in stops if each), request.loop, request.wait)
        id = f"{client[:40]}-{next(self._numbers)}"
        asked = PatrolRequest(request.action, route, id, page.lease.client, page.name, request.answers)
        if not self._robot.patrol.request(asked, answer):
            answer("no patrol")

    def _save_recording(self, client: str) -> None:
        """Have the black box write what has happened, and pass its answer on."""

        def answer(result: Result) -> None:
            what = {"t": "done", "place": result.text} if result.success else {"t": "refused", "why": result.text}
            self._reply(client, {**what, "what": "save_recording"})

        request_recording(self._node, answer)

    def _find_stop(self, stop: str | tuple[float, ...]) -> PatrolStop | None:
        if not isinstance(stop, str):
            return PatrolStop("", stop[0], stop[1])
        place = self._robot.places.find(stop)
        return None if place is None else PatrolStop(stop, place.x, place.y)

    def _refuse(self, client: str, what: str, why: str) -> None:
        self._reply(client, {"t": "refused", "what": what, "why": why})
