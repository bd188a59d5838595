"""Faults of the station's code fail its tests; a real run isolates them."""

from typing import NoReturn

import pytest

from recon.model.event import Event


def _fail(_parts: object, _station: object, _event: Event, fault: Exception, _now: int) -> NoReturn:
    raise fault


@pytest.fixture(autouse=True)
def _faults_fail_tests(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("recon.station.kernel.driver.after_fault", _fail)
