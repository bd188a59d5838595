"""Lines of a running station's log."""

import re

import pytest

from recon.station.audit.log_line import print_info, print_warning


def test_a_line_has_time_level_text_and_person(capsys: pytest.CaptureFixture[str]) -> None:
    print_info("Hold of V1", "anna b")
    print_warning("no disk")
    first, second = (line[20:] for line in capsys.readouterr().out.splitlines())
    assert first == "[info     ] Hold of V1                     by='anna b'"
    assert second == "[warning  ] no disk"


def test_a_line_begins_with_the_time(capsys: pytest.CaptureFixture[str]) -> None:
    print_info("ready")
    assert re.match(r"\d{4}-\d\d-\d\d \d\d:\d\d:\d\d \[", capsys.readouterr().out)
