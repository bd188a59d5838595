"""The site's folder that a command is given."""

import sys
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from recon.cli.output import printable
from recon.model.errors import SiteError

if TYPE_CHECKING:
    from recon.site import Site
    from recon.site.drawing import StagedSite

FolderArgument = Annotated[Path, typer.Argument(help="The site's folder.")]


def opened_site(folder: Path) -> "Site":
    """Load a site as each start does: a change that a crash has interrupted is undone first.

    Raises `SiteError`, or `RecordError` for a change that was edited by hand.
    """
    from recon.record.files.file_set import finish_interrupted
    from recon.site import load_site

    try:
        is_repaired = finish_interrupted(folder)
    except OSError as problem:
        raise SiteError(
            f"{folder}: an interrupted change cannot be undone: {problem.strerror or problem}"
        ) from problem
    if is_repaired:
        # Not among results, which may be JSON.
        text = f"{folder}: a change of the site that was interrupted is undone"
        print(printable(text), file=sys.stderr, flush=True)
    return load_site(folder)


def save_staged(folder: Path, staged: "StagedSite", what: str) -> None:
    """Write a site's changed files, all of them or none; the change can be undone.

    Raises `SiteError`.
    """
    from recon.record.files.file_set import replace_files

    utc = datetime.now(UTC).isoformat(timespec="seconds")
    try:
        replace_files(folder, staged.files, what=what, by="recon site", utc=utc)
    except OSError as problem:
        raise SiteError(f"{folder} cannot be written: {problem.strerror or problem}") from problem
