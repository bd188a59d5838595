"""`recon inspect` reads the log that the companion app shares."""

import io
import json

from hypothesis import example, given
from hypothesis import strategies as st

from recon.cli.inspect import inspect

APP = "Recon companion for Android, DJI Mobile SDK 5, station 10.0.0.2:3001"
TOLD = (
    '{"kind":"facts","model":"Mini 4 Pro","firmware":"01.00"}',
    '{"kind":"photos","series":7,"photos":[{"index":3,"age_s":0.5}]}',
    '{"kind":"outcome","action":"mission_load","ok":false,"code":"WPMZ"}',
)
LOG = f"""\
2026-11-29T08:00:00.123Z start   {APP}
2026-11-29T08:00:01Z info    Registered with DJI
2026-11-29T08:00:02Z told    recon 1 {TOLD[0]}
2026-11-29T08:00:03Z state   1581F5: GPS_ATTI, 45.0, -93.0, 20.0 m above takeoff
half a line
2026-11-29T08:00:04Z told    recon 1 {TOLD[1]}
2026-11-29T08:00:05Z warning Mission refused by the aircraft: \x1b[31m
2026-11-29T08:00:06Z told    recon 1 {TOLD[2]}
"""


def shown(data: bytes, json_lines: bool = False) -> tuple[bool, list[str]]:
    out = io.StringIO()
    is_log = inspect(io.BytesIO(data), json_lines, out)
    return is_log, out.getvalue().splitlines()


def test_a_log_is_shown_line_by_line_with_a_summary() -> None:
    is_log, lines = shown(LOG.encode())
    assert is_log
    assert lines[1] == "2026-11-29T08:00:01Z  info  Registered with DJI"
    assert r"\x1b[31m" in lines[5]
    assert lines[7:] == [
        "app log from 2026-11-29T08:00:00.123Z to 2026-11-29T08:00:06Z: "
        "info 1, start 1, state 1, told 3, warning 1; 1 lines not read",
        f"started: {APP}",
        "last facts: model Mini 4 Pro, firmware 01.00",
        "photos of series 7: 1 told of 3",
        "failed 1 times: mission_load WPMZ",
    ]
    _, as_json = shown(LOG.encode(), json_lines=True)
    assert json.loads(as_json[0])["kind"] == "start"
    assert [json.loads(each)["summary"] for each in as_json[7:]] == lines[7:]


@given(st.binary(max_size=300))
@example(b"2026-11-29T08:00:00Z told    recon 1 {")
@example(b"2026-11-" + b"9" * 20_000)
def test_whatever_follows_the_start_of_a_log_is_read(tail: bytes) -> None:
    _, lines = shown(b"2026-11-29T08:00:00Z told " + tail)
    assert lines[-1]
