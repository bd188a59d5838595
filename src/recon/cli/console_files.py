"""Where the built console lies."""

from pathlib import Path

import recon


def console_folder() -> Path | None:
    """Return the folder with the console: inside the package, or web/dist of a checkout."""
    package = Path(recon.__file__).parent
    for folder in (package / "console", package.parent.parent / "web" / "dist"):
        if (folder / "index.html").is_file():
            return folder
    return None
