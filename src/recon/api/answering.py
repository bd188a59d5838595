"""What all routes share: who asks, and what is answered when there is nothing."""

from typing import TypeVar

from fastapi import HTTPException, Request

from recon.api import schema

_T = TypeVar("_T")

PROBLEMS: dict[int | str, dict[str, object]] = {404: {"model": schema.Problem}}
PNG: dict[int | str, dict[str, object]] = {200: {"content": {"image/png": {}}}}


def found(value: _T | None, sentence: str) -> _T:
    """Return a value that is there; raises 404 with a sentence when it is not."""
    if value is None:
        raise HTTPException(404, sentence)
    return value


def who(request: Request) -> str:
    """Return who asks, for the record."""
    return f"api {request.client.host}" if request.client is not None else "api"
