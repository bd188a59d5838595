"""The study of the session in short; `make study` runs it for 100,000 simulated seconds."""

import pytest
from tests.oracles.counting_app import CountingApp
from tests.oracles.session_study import SessionStudy


@pytest.mark.parametrize("seed", [101, 102])
def test_no_command_is_carried_out_twice_or_lost_silently(seed: int) -> None:
    tally = SessionStudy(seed, vehicles=2).run(100.0)
    assert tally.broken == []
    assert tally.executed > 0
    assert tally.emergencies > 0
    assert sum(tally.faults.values()) > 0


def test_a_command_received_twice_is_detected(monkeypatch: pytest.MonkeyPatch) -> None:
    carry_out = CountingApp.receive

    def receive_twice(app: CountingApp, data: bytes, now_ns: int) -> None:
        carry_out(app, data, now_ns)
        carry_out(app, data, now_ns)

    monkeypatch.setattr(CountingApp, "receive", receive_twice)
    tally = SessionStudy(103, vehicles=1).run(100.0)
    assert any("carried out 2 times" in text for text in tally.broken)
