"""Requests of services that carry at most a switch, and their answers."""

from __future__ import annotations

from std_srvs.srv import Empty, SetBool
from std_srvs.srv import Trigger as TriggerService

from ur_nodes.codecs.codec import ServiceCodec, response_or_fail
from ur_nodes.codecs.dialect import parts_of
from ur_nodes.ports.services import Silent, Switch, Trigger
from ur_nodes.ports.values import Result

_TriggerRequest, _TriggerResponse = parts_of(TriggerService)
_SwitchRequest, _SwitchResponse = parts_of(SetBool)
_SilentRequest, _SilentResponse = parts_of(Empty)


def _reported(response: TriggerService.Response | SetBool.Response) -> Result:
    return Result(bool(response.success), str(response.message))


SERVICES = {
    Trigger: ServiceCodec(
        TriggerService,
        lambda _value: _TriggerRequest(),
        lambda _request: Trigger(),
        lambda result: _TriggerResponse(success=result.success, message=result.text),
        _reported,
    ),
    Silent: ServiceCodec(
        Empty,
        lambda _value: _SilentRequest(),
        lambda _request: Silent(),
        lambda result: response_or_fail(result, _SilentResponse()),
        lambda _response: Result(success=True),
    ),
    Switch: ServiceCodec(
        SetBool,
        lambda value: _SwitchRequest(data=value.on),
        lambda request: Switch(bool(request.data)),
        lambda result: _SwitchResponse(success=result.success, message=result.text),
        _reported,
    ),
}
