"""A lock on an open file, for its process: it ends with the process, however that ends."""

from importlib import import_module
from importlib.util import find_spec
from typing import Any


def lock_file(descriptor: int, *, shared: bool = False) -> None:
    """Lock a file where the system knows how; raises OSError when another process holds it.

    Several processes may hold a shared lock, as long as none holds the other kind.
    """
    if find_spec("fcntl") is not None:
        fcntl: Any = import_module("fcntl")
        fcntl.flock(descriptor, (fcntl.LOCK_SH if shared else fcntl.LOCK_EX) | fcntl.LOCK_NB)
