"""The console's files: compressed once, and cached by the browser for as long as their names say.

Vite puts a hash of the content into the names under assets/, so those never change; index.html
names them and is asked for again each time.
"""

import gzip
from functools import lru_cache
from os import PathLike, stat_result
from pathlib import Path

from fastapi.staticfiles import StaticFiles
from starlette.concurrency import run_in_threadpool
from starlette.datastructures import Headers
from starlette.responses import Response
from starlette.types import Scope

COMPRESSED = (".html", ".js", ".css", ".json", ".svg", ".webmanifest")
SMALLEST_BYTES = 1_024
"""Size below which, within one network packet, compression saves nothing."""
LARGEST_BYTES = 16 * 1024 * 1024
FOR_EVER = "public, max-age=31536000, immutable"
ASK_AGAIN = "no-cache"


class ConsoleFiles(StaticFiles):
    """Serves a folder with gzip and cache headers; ranges and old clients get the plain files."""

    async def get_response(self, path: str, scope: Scope) -> Response:
        """Return a file, compressed where the client takes it."""
        response = await super().get_response(path, scope)
        is_hashed = path.replace("\\", "/").startswith("assets/")
        response.headers["Cache-Control"] = FOR_EVER if is_hashed else ASK_AGAIN
        found = getattr(response, "path", None)
        if response.status_code != 200 or found is None or scope["method"] != "GET":
            return response
        file = Path(found)
        if file.suffix not in COMPRESSED:
            return response
        response.headers["Vary"] = "Accept-Encoding"
        headers = Headers(scope=scope)
        state: stat_result | None = getattr(response, "stat_result", None)
        takes_gzip = "gzip" in headers.get("accept-encoding", "") and "range" not in headers
        if state is None or not takes_gzip or not SMALLEST_BYTES <= state.st_size <= LARGEST_BYTES:
            return response
        data = await run_in_threadpool(_compressed, file, state.st_mtime_ns, state.st_size)
        kept = {
            name: value
            for name, value in response.headers.items()
            if name in ("cache-control", "vary", "last-modified", "content-type")
        }
        etag = response.headers.get("etag")
        if etag is not None:
            # Another representation of the same file: a weak tag, as RFC 9110 asks.
            kept["etag"] = f"W/{etag.removeprefix('W/')}"
        return Response(data, headers={**kept, "Content-Encoding": "gzip"})


@lru_cache(maxsize=64)
def _compressed(file: str | PathLike[str], _mtime_ns: int, _size: int) -> bytes:
    """Return a file's content compressed; a changed file is another key."""
    return gzip.compress(Path(file).read_bytes(), compresslevel=9, mtime=0)
