"""Text of a file or a server, as it may be shown."""

LONGEST_SHOWN = 200


def one_line(text: object, longest: int = LONGEST_SHOWN) -> str:
    """Return foreign text on one line without control characters, shortened."""
    plain = "".join(c if c.isprintable() else " " for c in str(text)[: 4 * longest])
    return " ".join(plain.split())[:longest]
