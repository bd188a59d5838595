"""The sun sensor of a multispectral camera as a second witness of the sun. Pure.

The sensor looks up from the aircraft, so it is in sun where the aircraft's own shadow would be
seen on sunlit ground. What it states differs between cameras and bands by unknown factors; what
counts is where a value lies between those in sun and those in shade of the same band on the same
flight. A flight that saw only one of the two tells nothing, for nobody knows which one it was.
"""

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from recon.geo import cells_of, read_at
from recon.geo.sun import sun_position
from recon.light.agreement import SHOWN, MapAgreement, compared
from recon.model.arrays import BoolArray, FloatArray
from recon.model.geo import LatLon
from recon.model.shade import SUNLIT_TRANSMITTANCE
from recon.model.units import NS_PER_S
from recon.product.flight import FlightData
from recon.product.shot_files import ShotFiles
from recon.product.sun_at import SunHistory
from recon.product.tag import LEAST_KNOWN, PhotoTag, Shown
from recon.product.timing import TimedPhoto

FEWEST = 8
"""Photos of a band, or compared with shade maps: fewer tell nothing."""
LEAST_CONTRAST = 1.5
"""Irradiance in sun by that in shade: the drone's tilt alone makes a tenth or two of difference,
the shade of a cloud leaves a third."""
LOW_PERCENT, HIGH_PERCENT = 5.0, 95.0
MOST_COMPARED = 60
LAG_STEP_S = 2.5
LAGS_S = LAG_STEP_S * np.arange(-4, 5)
LOWEST_SUN_DEG = 5.0
CONFIDENCE = 0.5
"""Of a photo's light by the sensor alone: it sees one point, and the photo's ground is wider than
an edge of shade."""


@dataclass(frozen=True, slots=True)
class SensorAgreement:
    """How the sun sensors follow the shade maps in time, over photos that both tell about."""

    photos: int
    correlation: float
    lag_s: float
    """By how much the sensor is later than the maps where they agree best."""

    def __str__(self) -> str:
        return (
            f"sun sensor, {self.photos} photos: correlation {self.correlation:.2f} with the shade "
            f"maps, lag {round(self.lag_s):+d} s"
        )


def sun_by_sensor(files: ShotFiles) -> dict[str, float]:
    """Return the share of direct sun by the sensor, 0 to 1, by the name of a shot's leading file.

    Shots without a sensor, and those of cameras that saw no contrast, are left out.
    """
    series: dict[object, list[tuple[str, float]]] = defaultdict(list)
    for timed in files.photos:
        photo = timed.photo
        if photo.irradiance is not None:
            band = photo.band.name if photo.band else photo.kind
            lead = files.shot[photo.name]
            series[timed.serial, photo.camera, band].append((lead, photo.irradiance))
    by_lead: dict[str, list[float]] = defaultdict(list)
    for readings in series.values():
        shares = _shares(np.array([value for _lead, value in readings]))
        for (lead, _value), share in zip(readings, shares, strict=False):
            by_lead[lead].append(share)
    return {lead: float(np.median(shares)) for lead, shares in by_lead.items()}


def _shares(values: FloatArray) -> list[float]:
    """Return the shares of direct sun of a band's values (N,); empty without contrast."""
    if len(values) < FEWEST:
        return []
    middle = np.percentile(values, [LOW_PERCENT, HIGH_PERCENT]).mean()
    is_bright = values > middle
    if is_bright.all() or not is_bright.any():
        return []
    shade, clear = np.median(values[~is_bright]), np.median(values[is_bright])
    if clear < LEAST_CONTRAST * shade:
        return []
    shares: list[float] = np.clip((values - shade) / (clear - shade), 0.0, 1.0).tolist()
    return shares


def agreement(
    flight: FlightData,
    leads: Sequence[TimedPhoto],
    sensor: Mapping[str, float],
    history: SunHistory,
) -> SensorAgreement | None:
    """Return how a sensor agrees with the shade maps; None where they tell about too few photos."""
    both = [each for each in leads if each.photo.name in sensor]
    picked = np.linspace(0, len(both) - 1, min(len(both), MOST_COMPARED)).astype(np.int64)
    both = [both[number] for number in np.unique(picked)] if both else []
    measured = np.array([sensor[each.photo.name] for each in both])
    shaded_m = [shaded_place_m(flight, each) for each in both]
    by_lag = np.array(
        [
            [_on_map(history, each.at_ns - round(lag_s * NS_PER_S), place)
             for each, place in zip(both, shaded_m, strict=True)]
            for lag_s in LAGS_S
        ]
    )  # fmt: skip
    now = by_lag[len(LAGS_S) // 2]
    is_known = np.isfinite(now)
    if is_known.sum() < FEWEST:
        return None
    correlations = [_correlation(on_map, measured) for on_map in by_lag]
    return SensorAgreement(int(is_known.sum()), max(correlations), _lag_s(correlations))


def _lag_s(correlations: Sequence[float]) -> float:
    """Return the lag at the top of the parabola through the largest of `LAGS_S`' correlations."""
    best = int(np.argmax(correlations))
    if not 0 < best < len(correlations) - 1:
        return float(LAGS_S[best])
    before, top, after = correlations[best - 1 : best + 2]
    bend = before - 2.0 * top + after
    return float(LAGS_S[best]) + (LAG_STEP_S * 0.5 * (before - after) / bend if bend < 0.0 else 0.0)


def map_and_sensor(
    flight: FlightData,
    leads: Sequence[TimedPhoto],
    sensor: Mapping[str, float],
    history: SunHistory,
) -> dict[str, tuple[float, float]]:
    """Return the direct sun by the shade maps, NaN where they know nothing, and by the sensor of
    each photo that has one, by name: both where the aircraft's own shadow falls."""
    return {
        each.photo.name: (
            _on_map(history, each.at_ns, shaded_place_m(flight, each)),
            sensor[each.photo.name],
        )
        for each in leads
        if each.photo.name in sensor
    }


def agreement_of(both: Iterable[tuple[float, float]]) -> MapAgreement:
    """Return how often the maps said what photos' own sun sensors show."""
    pairs = np.array([*both], dtype=np.float32).reshape(-1, 2)
    return compared(pairs[:, 0], pairs[:, 1])


def agreement_lines(counted: MapAgreement) -> Iterator[str]:
    """Yield how right the maps were, by the sun sensors of photos in sun and of those in shade."""
    for shown in SHOWN:
        known = sum(counted.count(says, shown) for says in SHOWN)
        unknown = counted.count("unknown", shown)
        if known + unknown:
            right = f"{100.0 * counted.count(shown, shown) / known:.0f} %" if known else "none"
            beside = f"; {unknown} more were where the maps know nothing" if unknown else ""
            yield (
                f"Of {known} photos in {shown} by their own sun sensor, the maps said {shown} in "
                f"{right}{beside}"
            )


def shaded_place_m(flight: FlightData, timed: TimedPhoto) -> FloatArray:
    """Return where the aircraft's own shadow falls (2,), in east-north metres: level ground."""
    aim, origin = timed.view.aim, flight.frame.origin
    place = LatLon(origin.latitude_deg, origin.longitude_deg)
    sun = sun_position(place, (timed.at_ns + flight.utc_ahead_ns) / NS_PER_S)
    below = np.array([aim.east_m, aim.north_m])
    if sun.elevation_deg < LOWEST_SUN_DEG:
        return below
    east, north, up = sun.toward_enu
    shaded: FloatArray = below - aim.height_m / up * np.array([east, north])
    return shaded


def _on_map(history: SunHistory, at_ns: int, place_m: FloatArray) -> float:
    """Return the transmittance at a place and time; NaN where nothing is known."""
    sun, grid = history.around(at_ns, place_m[np.newaxis])
    cells = cells_of(grid, place_m[:1], place_m[1:])
    is_known = read_at(sun.confidence, cells) > 0.0
    return float(np.where(is_known, read_at(sun.transmittance, cells), np.nan)[0])


def _correlation(on_map: FloatArray, measured: FloatArray) -> float:
    is_known: BoolArray = np.isfinite(on_map)
    here, there = on_map[is_known], measured[is_known]
    if len(here) < FEWEST or here.std() == 0.0 or there.std() == 0.0:
        return 0.0
    return float(np.corrcoef(here, there)[0, 1])


def lit_by_sensor(tag: PhotoTag, share: float | None) -> PhotoTag:
    """Return a photo's tag with the light that the sensor states where the maps know too little."""
    if share is None or tag.known >= LEAST_KNOWN:
        return tag
    sunlit = 1.0 if share >= SUNLIT_TRANSMITTANCE else 0.0
    return replace(tag, sunlit=sunlit, confidence=CONFIDENCE, is_by_sensor=True)


def shown_by_sensor(shown: Shown, share: float | None) -> Shown:
    """Return what a photo shows, with its ground in unknown light as the sensor has it."""
    if share is None:
        return shown
    is_lit = shown.is_lit | (shown.is_unknown & (share >= SUNLIT_TRANSMITTANCE))
    return Shown(shown.cells, is_lit, np.zeros_like(shown.is_unknown))
