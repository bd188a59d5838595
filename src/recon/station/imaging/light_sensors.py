"""Readings of light sensors, and each shade map compared with them as it comes."""

import numpy as np

from recon.geo import cells_of, enu_from_geo, read_at
from recon.light.agreement import compared, near_enough_s
from recon.light.lines import MOST_SENSORS
from recon.model.geo import LatLon
from recon.model.light import LightRead, LightReading
from recon.model.replacing import replace
from recon.model.shade import FloatMap, ShadeMap
from recon.model.units import NS_PER_S, seconds_to_ns
from recon.station.state.light_sensors import LightSensor, LightSensors
from recon.station.state.station import Station
from recon.station.state.steps import Stepped

FORGOTTEN_S = 600.0
"""A sensor silent for longer gives way to a new one where there are too many."""
AHEAD_NS = 2 * NS_PER_S
"""A logger's clock that is further ahead may be set back."""


def on_light_read(station: Station, event: LightRead, now_ns: int) -> Station:
    """Take the readings of a logger."""
    lights = station.light_sensors
    ahead_ns = 0 if station.clock is None else station.clock.ahead_ns
    sensors, problem = dict(lights.sensors), event.problem
    for reading in event.readings:
        at_ns = reading.at_ns - ahead_ns
        problem = _take(sensors, event.source, reading, at_ns, now_ns) or problem
    for name in sensors.keys() & {reading.sensor for reading in event.readings}:
        sensor = sensors[name]
        sensors[name] = replace(sensor, shows=sensor.direct(sensor.readings[-1][1]))
    lights = replace(lights, sensors=sensors, refused=lights.refused + event.refused)
    if problem:
        lights = replace(lights, problem=f"{event.source}: {problem}", problem_at_ns=now_ns)
    return replace(station, light_sensors=lights)


def _take(
    sensors: dict[str, LightSensor], source: str, reading: LightReading, at_ns: int, now_ns: int
) -> str:
    """Add a reading to its sensor's; return why it was not added, empty if it was."""
    name, known = reading.sensor, sensors.get(reading.sensor)
    if known is None and len(sensors) >= MOST_SENSORS:
        oldest = min(sensors, key=lambda each: sensors[each].readings[-1][0])
        if now_ns - sensors[oldest].readings[-1][0] < seconds_to_ns(FORGOTTEN_S):
            return f"sensor {name} not shown: expected at most {MOST_SENSORS} sensors"
        del sensors[oldest]
    if known is not None:
        if known.source != source and known.is_live(now_ns):
            return f"sensor {name} not used: {known.source} sends one of this name"
        newest_ns = known.readings[-1][0]
        if at_ns <= newest_ns and newest_ns <= now_ns + AHEAD_NS:
            return ""  # a line that came before
        if at_ns <= newest_ns or known.source != source:
            known = replace(known, source=source, readings=())
    sensor = known or LightSensor(source)
    sensors[name] = sensor.with_reading(at_ns, reading.value, reading.place)
    return ""


def compare(station: Station, _now_ns: int) -> Stepped:
    """Compare a new shade map with the sensors on it."""
    lights, shade, number = station.light_sensors, station.shade.shade, station.shade.number
    if shade is None or number == lights.compared_number or not lights.sensors:
        return station, ()
    said = _said(lights, shade)
    sensors = {
        name: _compared(sensor, said[name], shade.captured_at_ns)
        for name, sensor in lights.sensors.items()
    }
    lights = replace(lights, sensors=sensors, compared_number=number)
    return replace(station, light_sensors=lights), ()


def _said(lights: LightSensors, shade: ShadeMap) -> dict[str, float]:
    """Return a map's transmittance at each sensor, NaN where it knows nothing."""
    names = [name for name, each in lights.sensors.items() if each.place is not None]
    places = [each.place for each in lights.sensors.values() if each.place is not None]
    found = dict.fromkeys(lights.sensors, float("nan"))
    if places:
        known = np.where(shade.valid, shade.transmittance, np.float32(np.nan))
        found.update(zip(names, _values(known, shade, places), strict=True))
    return found


def _values(known: FloatMap, shade: ShadeMap, places: list[LatLon]) -> list[float]:
    frame = shade.grid.frame
    at = np.array([(each.latitude_deg, each.longitude_deg) for each in places])
    ground_m = np.full(len(at), frame.origin.ellipsoid_height_m)
    enu_m = enu_from_geo(frame, at[:, 0], at[:, 1], ground_m)
    values: list[float] = read_at(known, cells_of(shade.grid, enu_m[:, 0], enu_m[:, 1])).tolist()
    return values


def _compared(sensor: LightSensor, says: float, at_ns: int) -> LightSensor:
    sensor = replace(sensor, says=None if np.isnan(says) else says)
    nearest_ns, value = min(sensor.readings, key=lambda each: abs(each[0] - at_ns))
    direct = sensor.direct(value)
    is_near = abs(nearest_ns - at_ns) <= seconds_to_ns(near_enough_s(sensor.step_s))
    if direct is None or sensor.place is None or not is_near:
        return sensor
    both = (np.array([each], dtype=np.float32) for each in (says, direct))
    return replace(sensor, agreement=sensor.agreement + compared(*both))
