from collections.abc import Iterator, Mapping, Sequence

from genmsg import MsgContext
from genmsg.msgs import MsgSpec

def msg_generator(
    msg_context: MsgContext, spec: MsgSpec, search_path: Mapping[str, Sequence[str]]
) -> Iterator[str]: ...
