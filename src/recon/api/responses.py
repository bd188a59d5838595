"""Shared parts of the routes' responses."""

from typing import TypeVar

from fastapi import HTTPException, Response

from recon.api import schema

_T = TypeVar("_T")

PROBLEMS: dict[int | str, dict[str, object]] = {404: {"model": schema.Problem}}
PNG: dict[int | str, dict[str, object]] = {200: {"content": {"image/png": {}}}}
ARRAYS: dict[int | str, dict[str, object]] = {200: {"content": {"application/zip": {}}}}


def found(value: _T | None, sentence: str) -> _T:
    """Return the value; raises 404 with a sentence for None."""
    if value is None:
        raise HTTPException(404, sentence)
    return value


def png(data: bytes, number: int) -> Response:
    """Return a PNG response with the number that the state shows for the picture."""
    return Response(data, media_type="image/png", headers={"X-Frame-Id": str(number)})


def arrays(data: bytes, number: int) -> Response:
    """Return a response of numpy arrays (.npz) with the number that the state shows for them."""
    return Response(data, media_type="application/zip", headers={"X-Frame-Id": str(number)})
