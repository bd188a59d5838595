"""The command line: `recon run`, `recon demo`, `recon sim`, `recon inspect`, `recon openapi`."""

import sys

from recon.cli.app import app
from recon.model.errors import ReconError


def main() -> None:
    """Run the command line; what goes wrong is one sentence and an exit code, no traceback."""
    try:
        app()
    except ReconError as problem:
        print(f"recon: {problem}", file=sys.stderr)
        sys.exit(1)
    except KeyboardInterrupt:
        sys.exit(130)
