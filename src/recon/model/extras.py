"""Packages that a plain install leaves out; who needs one is told which extra brings it."""

from collections.abc import Iterator
from contextlib import contextmanager

from recon.model.errors import RecordError


@contextmanager
def from_extra(name: str, work: str, error: type[Exception] = RecordError) -> Iterator[None]:
    """Import packages of an extra inside; `error` says how to install one that is missing."""
    try:
        yield
    except ModuleNotFoundError as missing:
        raise error(
            f"{work} needs the package {missing.name}, which the plain install leaves out: "
            f"pip install 'recon-gcs[{name}]'"
        ) from None
