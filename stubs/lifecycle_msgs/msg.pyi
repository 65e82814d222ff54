"""Made by tools/make_message_stubs.py. Do not edit."""

import genpy

class State(genpy.Message):
    PRIMARY_STATE_UNKNOWN: int
    PRIMARY_STATE_UNCONFIGURED: int
    PRIMARY_STATE_INACTIVE: int
    PRIMARY_STATE_ACTIVE: int
    PRIMARY_STATE_FINALIZED: int
    TRANSITION_STATE_CONFIGURING: int
    TRANSITION_STATE_CLEANINGUP: int
    TRANSITION_STATE_SHUTTINGDOWN: int
    TRANSITION_STATE_ACTIVATING: int
    TRANSITION_STATE_DEACTIVATING: int
    TRANSITION_STATE_ERRORPROCESSING: int
    id: int
    label: str
    def __init__(self, id: int = ..., label: str = ...) -> None: ...
