"""Station addresses as typed or pasted."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from recon.client import AddressError, Station
from recon.client.address import parse_address


@pytest.mark.parametrize(
    ("url", "http", "stream"),
    [
        ("http://127.0.0.1:8080", "http://127.0.0.1:8080", "ws://127.0.0.1:8080/api/stream"),
        ("http://[::1]:8080/", "http://[::1]:8080", "ws://[::1]:8080/api/stream"),
        ("https://field.example", "https://field.example", "wss://field.example/api/stream"),
    ],
)
def test_addresses(url: str, http: str, stream: str) -> None:
    address = parse_address(url)
    assert (address.http, address.stream, address.token) == (http, stream, None)


def test_the_printed_address_contains_the_token() -> None:
    assert parse_address("http://h:1/#token=abc-1").token == "abc-1"
    assert parse_address("http://h:1/#token=abc-1", "other").token == "other"


@pytest.mark.parametrize(
    "url",
    [
        "",
        "127.0.0.1:8080",
        "ftp://h",
        "http://",
        "http://h:port",
        "http://h:99999",
        "http://h:0",
        "http://h/api",
        "http://h?x",
        "http://me:secret@h",
        "http://[::1",
        "http://h h",
    ],
)
def test_invalid_addresses_are_rejected(url: str) -> None:
    with pytest.raises(AddressError, match="expected an address like"):
        Station(url)


@pytest.mark.parametrize("token", ["", "two words", "a\r\nX-Header: b", "ä"])
def test_invalid_tokens_are_rejected_without_printing_them(token: str) -> None:
    with pytest.raises(AddressError, match="letters, digits") as problem:
        Station("http://127.0.0.1", token)
    assert not token or token not in str(problem.value)


@given(st.text() | st.text().map(lambda text: f"http://{text}"))
def test_any_text_is_an_address_or_an_address_error(text: str) -> None:
    try:
        address = parse_address(text)
    except AddressError:
        return
    assert address.http.startswith(("http://", "https://"))
    assert address.stream.endswith("/api/stream")
