"""Light sensors, as the API sends them."""

from recon.api import schema
from recon.api.schema.station import Light
from recon.model.shade import SUNLIT_TRANSMITTANCE
from recon.station.api_views.ages import known_since_s, since_s
from recon.station.state.light_sensors import LightSensor
from recon.station.state.station import Station

OLD_MAP_S = 10.0
"""A shadow at 10 m/s has moved by a hundred metres."""


def light_sensors_view(station: Station, now_ns: int) -> schema.LightSensorsView | None:
    """Return the sensors by name; None where no logger has sent a line."""
    lights, shade = station.light_sensors, station.shade.shade
    if not (lights.sensors or lights.refused):
        return None
    is_current = shade is not None and since_s(shade.captured_at_ns, now_ns) <= OLD_MAP_S
    return schema.LightSensorsView(
        sensors=[
            _sensor(name, sensor, now_ns, is_current=is_current)
            for name, sensor in sorted(lights.sensors.items())
        ],
        refused_lines=lights.refused,
        problem=lights.problem,
        problem_age_s=known_since_s(lights.problem_at_ns, now_ns),
    )


def _sensor(
    name: str, sensor: LightSensor, now_ns: int, *, is_current: bool
) -> schema.LightSensorView:
    at_ns, value = sensor.readings[-1]
    is_live, place = sensor.is_live(now_ns), sensor.place
    return schema.LightSensorView(
        name=name,
        source=sensor.source,
        latitude_deg=None if place is None else round(place.latitude_deg, 7),
        longitude_deg=None if place is None else round(place.longitude_deg, 7),
        value=value,
        age_s=since_s(at_ns, now_ns),
        is_live=is_live,
        shows=_light(sensor.shows if is_live else None),
        map_says=_light(sensor.says if is_current else None),
        right=sensor.agreement.right,
        compared=sensor.agreement.known,
    )


def _light(direct: float | None) -> Light:
    if direct is None:
        return "unknown"
    return "sun" if direct >= SUNLIT_TRANSMITTANCE else "shade"
