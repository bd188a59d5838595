"""Text from the wire is untrusted."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from recon.vehicles.text import printable


@given(st.binary(max_size=400))
def test_nothing_unprintable_comes_out(raw: bytes) -> None:
    assert printable(raw).isprintable()


@given(st.binary(max_size=40), st.binary(max_size=40))
def test_two_inputs_never_look_the_same(a: bytes, b: bytes) -> None:
    assert (printable(a) == printable(b)) == (a == b)


@pytest.mark.parametrize(
    ("raw", "shown"),
    [
        (b"plain", "plain"),
        ("grün".encode(), "grün"),
        (b"\x1b[2J", "\\x1b[2J"),
        (b"a\nb", "a\\x0ab"),
        (b"\xff", "\\xff"),
        (b"\x80", "\\x80"),
        (b"\xc2\x80", "\\u0080"),
        ("\u202e".encode(), "\\u202e"),
        ("\U000e0001".encode(), "\\U000e0001"),
        (b"\\x1b", "\\\\x1b"),
    ],
)
def test_escapes(raw: bytes, shown: str) -> None:
    assert printable(raw) == shown


def test_long_text_ends_with_an_ellipsis() -> None:
    assert printable(b"a" * 11, limit_chars=10) == "a" * 10 + "…"
    assert printable(b"a" * 10, limit_chars=10) == "a" * 10
