"""Text from the wire is untrusted: what of it reaches a screen, a log or a file."""


def _escape(character: str) -> str:
    if character == "\\":
        return "\\\\"
    if character.isprintable():
        return character
    code = ord(character)
    if code < 0x80:
        return f"\\x{code:02x}"
    return f"\\u{code:04x}" if code < 0x10000 else f"\\U{code:08x}"


def printable(raw: bytes, limit_chars: int = 1000) -> str:
    """Return `raw` as text without control, formatting or private characters.

    Bytes that are not UTF-8 and characters that are not printable (terminal escapes, line breaks,
    direction overrides) appear as backslash escapes; a backslash is doubled, so that two different
    inputs within the limit never look the same. Longer text ends with an ellipsis.
    """
    text = raw[: 4 * limit_chars].decode("utf-8", errors="surrogateescape")
    if not text.isprintable() or "\\" in text:
        text = "".join(
            f"\\x{ord(c) - 0xDC00:02x}" if 0xDC80 <= ord(c) <= 0xDCFF else _escape(c) for c in text
        )
    return text if len(text) <= limit_chars else text[:limit_chars] + "…"
