"""Archives of numpy arrays (`.npz`) of others: their size is limited before anything is unpacked,
and nothing is unpickled."""

import zipfile
import zlib
from pathlib import Path
from typing import IO, Any

import numpy as np
import numpy.typing as npt

from recon.model.errors import ReconError

PACKINGS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
"""Python unpacks the others without a limit of size."""
DAMAGE = (
    *(zipfile.BadZipFile, zlib.error, NotImplementedError, RuntimeError, EOFError),  # the archive
    *(ValueError, KeyError, OverflowError, MemoryError),  # what it says of its members
)
"""What Python raises for a zip archive that is damaged, encrypted, or claims more than it holds."""


class ArchiveError(ReconError):
    """An archive of others that cannot be read."""


def read_arrays(file: Path | IO[bytes], most_bytes: int) -> dict[str, npt.NDArray[Any]]:
    """Return the arrays of an `.npz` of at most so many bytes unpacked, by name.

    Raises `ArchiveError`, and OSError for a file that cannot be read at all.
    """
    try:
        with zipfile.ZipFile(file) as archive:
            members = archive.infolist()
        if any(each.compress_type not in PACKINGS for each in members):
            raise ArchiveError("expected arrays stored or deflated, got another packing")
        # What a member states of its size is the most that is unpacked of it.
        size = sum(each.file_size for each in members)
        if size > most_bytes:
            raise ArchiveError(f"expected arrays of at most {most_bytes} bytes, got {size}")
        with np.load(file, allow_pickle=False) as found:
            return {name: np.asarray(found[name]) for name in found}
    except DAMAGE as problem:
        raise ArchiveError(f"expected an .npz of arrays, got: {problem}") from problem
