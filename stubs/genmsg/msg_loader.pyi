from genmsg import MsgContext
from genmsg.msgs import MsgSpec

def load_msg_from_string(msg_context: MsgContext, text: str, full_name: str) -> MsgSpec: ...
