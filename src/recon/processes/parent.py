"""The end of a process whose parent has ended."""

import multiprocessing
import os
from threading import Thread


def end_with_parent() -> None:
    """End this process as soon as the one that started it ends, even when that is killed.

    Otherwise it would finish its work, and then wait for the next piece indefinitely.
    """
    parent = multiprocessing.parent_process()
    assert parent is not None

    def watch() -> None:
        parent.join()
        os._exit(1)

    Thread(target=watch, daemon=True).start()
