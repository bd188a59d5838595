"""Faults of the station's code are loud in its tests; a real run contains them."""

from typing import NoReturn

import pytest

from recon.model.event import Event
from recon.station.state.station import Station


def _loud(_station: Station, _event: Event, fault: Exception, _now_ns: int) -> NoReturn:
    raise fault


@pytest.fixture(autouse=True)
def _faults_are_loud(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("recon.station.kernel.driver.after_fault", _loud)
