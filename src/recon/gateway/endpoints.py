"""Where a gateway listens or sends."""

Endpoint = tuple[str, int]


def shown_endpoint(place: Endpoint) -> str:
    """Return an address as HOST:PORT, as the options take it."""
    host, port = place
    return f"[{host}]:{port}" if ":" in host else f"{host}:{port}"
