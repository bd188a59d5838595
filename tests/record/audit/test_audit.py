"""A line of the audit: whatever is put in comes out, and nothing of it harms a terminal."""

import contextlib
import json
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from recon.record.audit.audit import (
    LONGEST_LINE_BYTES,
    NO_LINE_BEFORE,
    AuditEntry,
    AuditLine,
    NumberedEntry,
    decode_line,
    encode_line,
    utc_text,
)

JSON_VALUES = st.recursive(
    st.none() | st.booleans() | st.integers(-(2**53), 2**53) | st.floats() | st.text(),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(), inner, max_size=4),
    max_leaves=20,
)


def line_of(entry: AuditEntry, n: int = 1) -> bytes:
    return encode_line(NumberedEntry(n, 1_748_770_200_123_456_789, 5, entry), NO_LINE_BEFORE)


@given(
    text=st.text(),
    by=st.text(),
    vehicle=st.text(),
    details=st.dictionaries(st.text(max_size=20), JSON_VALUES, max_size=5),
)
def test_any_entry_is_one_harmless_line_that_reads_back(
    text: str, by: str, vehicle: str, details: dict[str, Any]
) -> None:
    line = line_of(AuditEntry("kind", text, by, None, vehicle, details))
    assert all(0x20 <= byte < 0x7F for byte in line)
    read = decode_line(line)
    assert (read.text, read.by, read.vehicle) == (text, by, vehicle)
    json.loads(line, parse_constant=lambda word: pytest.fail(f"{word} is no JSON"))


def test_the_moment_is_written_to_the_microsecond() -> None:
    assert utc_text(1_748_770_200_123_456_789) == "2025-06-01T09:30:00.123456Z"


def test_numbers_without_a_json_form_are_written_as_text() -> None:
    read = decode_line(line_of(AuditEntry("k", "t", details={"speed_mps": float("nan")})))
    assert read.details == {"speed_mps": "nan"}


def test_what_is_too_long_for_a_line_leaves_its_details_out() -> None:
    details = {f"key {n}": "x" * 1900 for n in range(100)}
    line = line_of(AuditEntry("k", "the words stay", details=details))
    assert len(line) < LONGEST_LINE_BYTES
    read = decode_line(line)
    assert read.text == "the words stay"
    assert read.details["excluded_bytes"] > LONGEST_LINE_BYTES


@pytest.mark.parametrize(
    "line",
    [
        b"",
        b"{}",
        b"[]",
        b"nonsense",
        b"\xff\xfe",
        b'{"n": 1}',
        b"[" * 50_000,
        b'{"n":"1","utc":"","t_ns":0,"kind":"","by":"","serial":null,"vehicle":"","text":"",'
        b'"details":{},"before":""}',
        b"x" * (LONGEST_LINE_BYTES + 1),
    ],
)
def test_what_is_no_line_is_a_value_error(line: bytes) -> None:
    with pytest.raises(ValueError, match=r"expected an? (audit )?line"):
        decode_line(line)


@given(st.binary(max_size=300))
def test_any_bytes_are_a_line_or_a_value_error(data: bytes) -> None:
    with contextlib.suppress(ValueError):
        assert isinstance(decode_line(data), AuditLine)
