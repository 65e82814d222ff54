import os
import resource

from ur.run.loop import allow_open_files


def test_limit_of_open_files_is_raised_as_far_as_it_may_be() -> None:
    limits = resource.getrlimit(resource.RLIMIT_NOFILE)
    pid = os.fork()
    if pid == 0:
        resource.setrlimit(resource.RLIMIT_NOFILE, (64, 128))
        allow_open_files(32)
        kept = resource.getrlimit(resource.RLIMIT_NOFILE)
        allow_open_files(100)
        raised = resource.getrlimit(resource.RLIMIT_NOFILE)
        allow_open_files(1000)
        most = resource.getrlimit(resource.RLIMIT_NOFILE)
        os._exit(0 if (kept, raised, most) == ((64, 128), (100, 128), (128, 128)) else 1)
    assert os.waitpid(pid, 0)[1] == 0
    assert resource.getrlimit(resource.RLIMIT_NOFILE) == limits
