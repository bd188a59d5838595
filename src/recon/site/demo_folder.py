"""Where the demonstration's site lies."""

from pathlib import Path


def demo_site_folder() -> Path:
    """Return the folder of the demonstration's site, inside the installed package."""
    return Path(__file__).parent / "demo"
