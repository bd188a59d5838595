"""Where a vehicle may be that is not heard, as the API says it."""

from recon.api import schema
from recon.model.geo import LatLon
from recon.model.vehicle import VehicleState
from recon.safety.datum import home
from recon.safety.prediction.motion import last_place
from recon.station.state.station import Station
from recon.station.traffic.known_traffic import dismissed_by, hazard


def hazard_view(station: Station, vehicle: VehicleState, now_ns: int) -> schema.HazardView | None:
    """Return a vehicle's hazard area; None while it is heard, is on the ground or was dismissed."""
    found = hazard(station, vehicle, now_ns)
    place, _at_ns = last_place(vehicle)
    if found is None or place is None:
        return None
    home_place = home(vehicle) if found.home_m is not None else None
    way = [] if home_place is None else [_lon_lat(place), _lon_lat(home_place)]
    return schema.HazardView(
        dismissed_as=dismissed_by(station, vehicle),
        age_s=found.age_s,
        latitude_deg=place.latitude_deg,
        longitude_deg=place.longitude_deg,
        radius_m=found.radius_m,
        growth_mps=found.growth_mps,
        largest_radius_m=found.largest_m,
        corridor=way,
        corridor_half_width_m=found.corridor_half_m,
    )


def _lon_lat(place: LatLon) -> tuple[float, float]:
    return place.longitude_deg, place.latitude_deg
