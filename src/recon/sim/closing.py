"""Closing a connection so that buffered bytes still arrive."""

import asyncio

CLOSING_S = 0.5


async def close(writer: asyncio.StreamWriter) -> None:
    """Close, and wait at most `CLOSING_S` for buffered bytes; then abort."""
    writer.close()
    try:
        async with asyncio.timeout(CLOSING_S):
            await writer.wait_closed()
    except TimeoutError:
        writer.transport.abort()
    except OSError:
        return
