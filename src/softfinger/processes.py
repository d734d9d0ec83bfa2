"""What is known of other processes of this machine."""

import os


def is_running(process: int) -> bool:
    """Whether a process of this number runs.

    >>> is_running(os.getpid())
    True
    """
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except OSError:  # another's process
        return True
    return True
