"""Made by tools/make_message_stubs.py. Do not edit."""

import genpy

class UUID(genpy.Message):
    uuid: bytes
    def __init__(self, uuid: bytes = ...) -> None: ...
