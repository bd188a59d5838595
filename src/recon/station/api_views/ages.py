"""Ages as the API states them."""

from recon.model.units import NS_PER_MS


def since_s(at_ns: int, now_ns: int) -> float:
    """Return an age in seconds, of whole milliseconds: a state's time less the age is constant."""
    return (now_ns // NS_PER_MS - at_ns // NS_PER_MS) / 1e3


def known_since_s(at_ns: int | None, now_ns: int) -> float | None:
    """Return the same, None for what never was."""
    return None if at_ns is None else since_s(at_ns, now_ns)
