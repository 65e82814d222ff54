from collections.abc import Callable

renew_latest_logdir: Callable[[str], bool]
