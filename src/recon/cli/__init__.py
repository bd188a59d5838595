"""The command line: `recon run`, `demo`, `sim`, `all-stop`, `fly` and more; see `recon --help`."""

import os
import sys


def main() -> None:
    """Run the command line."""
    # Matrices here are small: more threads would only wait for each other, at a core's full cost.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    from recon.cli.commands import app

    try:
        app()
    except KeyboardInterrupt:
        sys.exit(130)
