"""The command line: `recon run`, `demo`, `sim`, `all-stop`, `fly` and more; see `recon --help`."""

import os
import sys

from recon.model.errors import ReconError


def main() -> None:
    """Run the command line; an expected error is one sentence and an exit code, no traceback."""
    # Matrices here are small: more threads would only wait for each other, at a core's full cost.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    from recon.cli.commands import app

    try:
        app()
    except ReconError as problem:
        # Imported here: only a command that uses the client has loaded it.
        from recon.client.errors import ClientError

        print(f"recon: {problem}", file=sys.stderr)
        sys.exit(2 if isinstance(problem, ClientError) else 1)
    except KeyboardInterrupt:
        sys.exit(130)
