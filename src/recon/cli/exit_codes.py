"""The exit codes of all commands, and the one place that gives an error its code.

0 done; 1 refused, or failed though it was asked for rightly: no station, a taken port, a full disk;
2 wrong use: an option, a name or a file that is not what the command takes. `recon replay --check`
alone has a fourth.
"""

import errno
import sys

from recon.model.errors import ReconError

DONE, REFUSED, WRONG_USE = 0, 1, 2

NAMES_NO_SUCH_FILE = frozenset(
    {errno.ENOENT, errno.ENOTDIR, errno.EISDIR, errno.EEXIST, errno.ENAMETOOLONG, errno.ELOOP}
)
"""Reasons of a system that are about the name which was given, not about disk or rights."""


def exit_code(problem: ReconError) -> int:
    """Return the exit code of an error."""
    cause = problem.__cause__
    while isinstance(cause, ReconError):
        cause = cause.__cause__
    # GDAL's own errors are of the system by their type, and without a number.
    number = cause.errno if isinstance(cause, OSError) else None
    has_failed = number is not None and number not in NAMES_NO_SUCH_FILE
    return REFUSED if problem.is_failure or has_failed else WRONG_USE


def report_error(problem: ReconError, command: str) -> int:
    """Print an error as one sentence; return its exit code."""
    # Imported here: a stop command waits for nothing that it does not need.
    from recon.cli.output import printable

    print(f"{command}: {printable(str(problem))}", file=sys.stderr)
    return exit_code(problem)
