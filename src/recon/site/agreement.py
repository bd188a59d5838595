"""Whether what the folder's files say fits together: pads, fences, heights."""

from collections.abc import Iterator, Mapping
from pathlib import Path

from recon.geo import Polygon, enu_from_points
from recon.model.airspace import Airspace, FlightLimits
from recon.model.vehicle import VehicleProfile
from recon.model.zone import HeightDatum, LandingPad, Zone, ZoneKind
from recon.site.errors import SiteError
from recon.site.site import Layers


def refuse_high_ways_home(
    place: str, profiles: Mapping[str, VehicleProfile], limits: FlightLimits
) -> None:
    """Raise `SiteError` for an aircraft whose way home is higher than the site allows."""
    ceiling_m = limits.max_height_above_ground_m
    for number, profile in enumerate(profiles.values(), start=1):
        height_m = profile.go_home_height_m
        if height_m is not None and height_m > ceiling_m:
            raise SiteError(
                f"{place}: vehicles (entry {number}).go_home_height_m: expected at most "
                f"limits.max_height_above_ground_m, {ceiling_m:g} m, got {height_m:g} m; set a "
                "lower one in the aircraft too"
            )


def refuse_fenced_pads(
    site_file: Path, layers: Layers, profiles: Mapping[str, VehicleProfile], airspace: Airspace
) -> None:
    """Raise `SiteError` for a pad that no vehicle could leave or come home to.

    So it is when the pad lies outside the boundary, in a keep-out zone that begins at the ground,
    or closer to the edge of either than the margin.
    """
    if airspace.frame is None:
        return
    margin_m = airspace.limits.boundary_margin_m
    boundary = None if airspace.boundary is None else Polygon(airspace.boundary)
    keep_out = [(zone, Polygon(zone.region)) for zone in airspace.zones if _is_on_ground(zone)]
    for place, pad in _placed_pads(site_file, layers, profiles):
        point_m = enu_from_points(airspace.frame, [pad.place])[:, :2]
        if boundary is not None:
            inside_m = float(boundary.distance_to_edge_m(point_m)[0])
            if inside_m < margin_m:
                raise SiteError(
                    f"{place}: expected a place inside the boundary in "
                    f"{layers.files['boundary']}, {margin_m:g} m from its edge at least, got one "
                    f"{_how_far(inside_m)}"
                )
        for zone, polygon in keep_out:
            inside_m = float(polygon.distance_to_edge_m(point_m)[0])
            if inside_m > -margin_m:
                raise SiteError(
                    f"{place}: expected a place {margin_m:g} m outside the keep-out zone "
                    f"{zone.name!a} at least, got one {_how_far(inside_m)}"
                )


def _is_on_ground(zone: Zone) -> bool:
    """Whether a zone keeps vehicles from standing there; one that begins higher does not."""
    begins_at_ground = zone.floor_m is None or (
        zone.datum is HeightDatum.GROUND and zone.floor_m <= 0.0
    )
    return zone.kind is ZoneKind.KEEP_OUT and begins_at_ground


def _placed_pads(
    site_file: Path, layers: Layers, profiles: Mapping[str, VehicleProfile]
) -> Iterator[tuple[str, LandingPad]]:
    """Return every pad once, each with the file and the feature or key that tells it."""
    owners = {pad.serial for pad in layers.landing_pads}
    for number, pad in enumerate(layers.landing_pads, start=1):
        file = site_file.parent / layers.files["landing_pads"]
        yield f"{file}: feature {number} ({pad.name!a})", pad
    for number, profile in enumerate(profiles.values(), start=1):
        if profile.pad is not None and profile.serial not in owners:
            place = f"{site_file}: vehicles (entry {number}).pad"
            yield place, LandingPad(profile.display_name, profile.serial, profile.pad)


def _how_far(inside_m: float) -> str:
    return f"{abs(inside_m):.1f} m {'inside' if inside_m >= 0.0 else 'outside'}"
