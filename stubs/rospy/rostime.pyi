import threading

import genpy

_rostime_current: genpy.Time
_rostime_cond: threading.Condition

def _set_rostime(t: genpy.Time) -> None: ...
def wallsleep(duration: float) -> None: ...
