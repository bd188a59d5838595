"""Which folders of the station's computer a person may name for photos."""

import os
from pathlib import Path

from recon.api.photo_routes import PhotoRequestError


def photo_folder(text: str, records: Path) -> str:
    """Return a folder that can be read; raises `PhotoRequestError`."""
    path = Path(text.strip().strip("\"'")).expanduser()
    if not path.is_absolute():
        raise PhotoRequestError(
            f"Give the folder's whole path on the station's computer, such as /media/card/DCIM; "
            f"got {text!r}"
        )
    try:
        if not path.exists():
            raise PhotoRequestError(
                f"No folder {path} on the station's computer: is the card in it, and is the path "
                "right?"
            )
        if not path.is_dir():
            raise PhotoRequestError(f"{path} is a file: give the folder that holds it")
        with os.scandir(path) as entries:
            next(entries, None)
        whole = path.resolve()
        if records.resolve().is_relative_to(whole):
            raise PhotoRequestError(
                f"{path} holds the station's flight records: give the folder of the photos alone"
            )
    except (OSError, ValueError) as problem:
        reason = getattr(problem, "strerror", None) or problem
        raise PhotoRequestError(
            f"{path} cannot be read by the station: {reason}. Copy the photos into a folder of the "
            "station's user"
        ) from problem
    return str(path)
