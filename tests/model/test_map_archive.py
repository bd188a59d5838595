"""Shade maps and forecasts as archives: back to the bit, and nothing else is read."""

import io
from contextlib import suppress
from dataclasses import fields, replace
from typing import Any

import numpy as np
import pytest
from hypothesis import strategies as st
from tests.gateway.drawn import given_examples
from tests.gateway.recorded_station import maps

from recon.model import map_archive
from recon.model.geo import GeoPoint, LocalFrame
from recon.model.map_archive import (
    MapArchiveError,
    forecast_archive,
    read_forecast,
    read_shade,
    shade_archive,
)

SHADE, SUN = maps(LocalFrame(GeoPoint(45.0, -93.0, 280.5)), 1_700_000_000_123_456_789)
READERS = ((read_shade, shade_archive(SHADE)), (read_forecast, forecast_archive(SUN)))


def same(one: Any, other: Any) -> None:
    for each in fields(one):
        left, right = getattr(one, each.name), getattr(other, each.name)
        if isinstance(left, np.ndarray):
            assert left.dtype == right.dtype
            assert np.array_equal(left, right, equal_nan=left.dtype.kind == "f"), each.name
        else:
            assert left == right, each.name


def test_they_come_back_to_the_bit() -> None:
    same(read_shade(shade_archive(SHADE)), SHADE)
    same(read_forecast(forecast_archive(SUN)), SUN)
    still = replace(SUN, velocity_mps=None)
    same(read_forecast(forecast_archive(still)), still)
    nobodys = replace(SHADE, source_serials=())
    same(read_shade(shade_archive(nobodys)), nobodys)


@given_examples(st.data())
def test_what_is_no_archive_is_one_error(data: st.DataObject) -> None:
    read, whole = data.draw(st.sampled_from(READERS))
    damaged = bytearray(whole)
    for _ in range(data.draw(st.integers(1, 20))):
        damaged[data.draw(st.integers(0, len(whole) - 1))] = data.draw(st.integers(0, 255))
    end = data.draw(st.integers(0, len(whole)))
    for attempt in (bytes(damaged), whole[:end], bytes(damaged[:end])):
        with suppress(MapArchiveError):
            read(attempt)


def test_other_arrays_and_larger_ones_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    file = io.BytesIO()
    np.savez(file, transmittance=np.zeros((2, 2)))
    with pytest.raises(MapArchiveError, match="transmittance: float32 of 2 dimensions"):
        read_shade(file.getvalue())
    pickled = io.BytesIO()
    np.savez(pickled, transmittance=np.array([None], object))
    with pytest.raises(MapArchiveError, match="Object arrays cannot be loaded"):
        read_shade(pickled.getvalue())
    with pytest.raises(MapArchiveError, match="expected an array transmittance, got"):
        read_shade(forecast_archive(SUN))
    monkeypatch.setattr(map_archive, "MOST_BYTES", 1000)
    with pytest.raises(MapArchiveError, match="arrays of at most 1000 bytes"):
        read_shade(shade_archive(SHADE))
