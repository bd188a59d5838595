"""Frames and maps of a real station: what there is, and a sentence where there is none."""

import pytest
from tests.client.running_station import running_station
from tests.patient_loop import run_patiently

from recon.client import BadAnswerError, RequestRefusedError, Station


def test_what_there_is_not_is_refused_with_a_sentence() -> None:
    async def main() -> None:
        async with running_station(vehicles=1) as url, Station(url) as station:
            for asked in (station.pictures.shade(), station.pictures.forecast()):
                with pytest.raises(RequestRefusedError, match="No shade map yet"):
                    await asked
            with pytest.raises(RequestRefusedError, match="No frame received from 'A/B'"):
                await station.pictures.frame("A/B")
            with pytest.raises(BadAnswerError, match="expected a number in X-Frame-Id, got ''"):
                await station.pictures._http.get_picture("/api/state")

    run_patiently(main())
