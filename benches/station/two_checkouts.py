"""Two checkouts measured in turn, each in a process of its own."""

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]


class Side:
    """One checkout's process, which does a block of work when it is asked to."""

    def __init__(self, folder: Path, *words: str) -> None:
        """Run a script of this checkout, which prints a number for each line it is sent."""
        paths = os.pathsep.join((str(folder / "src"), str(ROOT)))
        environment = {**os.environ, "PYTHONPATH": paths, "OPENBLAS_NUM_THREADS": "1"}
        self._process = subprocess.Popen(
            [sys.executable, *words],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env=environment,
        )

    def block(self) -> float:
        """Return what one more block has taken."""
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._process.stdin.write("\n")
        self._process.stdin.flush()
        return float(self._process.stdout.readline())

    def end(self) -> None:
        """End the process."""
        self._process.kill()
        self._process.wait()
