"""Ending a connection politely."""

import asyncio

CLOSING_S = 0.5


async def close(writer: asyncio.StreamWriter) -> None:
    """Close, and wait a moment for what is still buffered."""
    writer.close()
    try:
        async with asyncio.timeout(CLOSING_S):
            await writer.wait_closed()
    except TimeoutError:
        writer.transport.abort()
    except OSError:
        return
