"""A site's summary at the start of a station, and warnings that do not prevent a start."""

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from recon.camera import PoseSolution, placing_error_m
from recon.geo import Polygon, cell_centres_m, enu_from_points
from recon.model.airspace import HOVER_DRIFT_M, FlightLimits, HeightDatum, Zone, ZoneKind
from recon.model.vehicle import VehicleProfile
from recon.safety import SafetySettings
from recon.safety.separation_minima import gate_minima
from recon.site.consistency import highest_ground_m
from recon.site.elevation import ground_heights_m
from recon.site.failsafe import failsafe_report, failsafe_warnings
from recon.site.site import Imager, Layers, Site


def site_report(site: Site) -> tuple[str, ...]:
    """Return lines on the files read, the fit of the control points, and the warnings."""
    if site.frame is None:
        return ("No site loaded: vehicle profiles and ground image are off",)
    lines = [f"site {site.name}: {len(site.profiles)} vehicle profiles"]
    if site.ground_grid is not None:
        grid = site.ground_grid
        lines.append(
            f"ground image {grid.cols} x {grid.rows} cells of {grid.cell_m:g} m around the origin"
        )
    if not site.imagers:
        lines.append("no imaging drone: ground image is off")
    for imager in site.imagers.values():
        lines += _imager_report(imager)
    lines += _layers_report(site.layers)
    lines += [_terrain_report(site), _limits_report(site.limits)]
    lines.append(failsafe_report(site.failsafe))
    lines += [f"warning: {warning}" for warning in site_warnings(site)]
    return tuple(lines)


def _terrain_report(site: Site) -> str:
    if site.elevation is None:
        return "terrain: assumed flat at origin.ground_altitude_m"
    grid, heights_m = site.elevation.grid, site.elevation.ellipsoid_height_m
    known = heights_m[np.isfinite(heights_m)]
    return (
        f"terrain: model from {site.elevation_file}, {grid.cols} x {grid.rows} cells of "
        f"{grid.cell_m:.3g} m, ground from {known.min():.1f} to {known.max():.1f} m above the "
        "WGS84 ellipsoid"
    )


def _limits_report(limits: FlightLimits) -> str:
    return (
        f"limits: {limits.min_height_above_ground_m:g} to {limits.max_height_above_ground_m:g} m "
        f"above ground, {limits.max_distance_from_home_m:g} m from home, "
        f"{limits.max_speed_mps:g} m/s; {limits.min_separation_horizontal_m:g} m beside or "
        f"{limits.min_separation_vertical_m:g} m above each other; {limits.boundary_margin_m:g} m "
        f"from fences; {100.0 * limits.battery_reserve_fraction:g} % of the battery left at home"
    )


def _layers_report(layers: Layers) -> list[str]:
    counts = {
        "boundary": [layers.boundary] if layers.boundary else [],
        "keep_out": [z.region for z in layers.zones if z.kind is ZoneKind.KEEP_OUT],
        "height_zones": [z.region for z in layers.zones if z.kind is ZoneKind.HEIGHT],
        "survey_regions": list(layers.survey_regions.values()),
    }
    lines = []
    for key, name in layers.files.items():
        if key == "landing_pads":
            holds = f"{len(layers.landing_pads)} pads"
        else:
            hectares = sum(Polygon(region).area_m2 for region in counts[key]) / 1e4
            holds = f"polygons: {len(counts[key])}, together {hectares:.2f} ha"
        lines.append(f"layer {key} from {name}: {holds}")
    return lines


def _imager_report(imager: Imager) -> list[str]:
    lines = [
        f"imaging drone {imager.serial}: {imager.camera.cols} x {imager.camera.rows} lens model"
    ]
    lines += placing_report() if imager.solution is None else pose_report(imager.solution)
    if imager.first_frame_stands_for_marked_frame:
        lines.append(
            "[imager.marked_frame] is missing: the first frame received in flight is used instead, "
            "which is right only if it was taken from the same position"
        )
    return lines


PLACING_HEIGHT_M, PLACING_AWAY_M = 120.0, 195.0
"""The usual height, and 1.6 times it."""


def placing_report() -> list[str]:
    """Return the line about a camera that telemetry alone places: how wrong that is."""
    below_m, away_m = (placing_error_m(PLACING_HEIGHT_M, far) for far in (0.0, PLACING_AWAY_M))
    return [
        "no control points: telemetry places the camera, pointing straight down, its top to the "
        f"drone's front; at {PLACING_HEIGHT_M:g} m expect the ground image off by {below_m:.0f} m "
        f"below the drone and {away_m:.0f} m at {PLACING_AWAY_M:g} m from there"
    ]


def pose_report(solution: PoseSolution) -> list[str]:
    """Return lines with the fit, the height, the tilt and each point's residual."""
    lines = [
        f"{len(solution.residuals)} control points fit to {solution.rms_px:.2f} px RMS; height "
        f"{solution.height_above_ground_m:.1f} +- {solution.height_sigma_m:.1f} m, tilt "
        f"{solution.tilt_deg:.1f} +- {solution.tilt_sigma_deg:.1f} degrees"
    ]
    lines += [
        f"control point {r.name}: off by {r.size_px:.1f} px, {r.ground_m:.1f} m on the ground "
        f"({r.east_m:+.1f} m east, {r.north_m:+.1f} m north)"
        for r in solution.residuals
    ]
    return lines


SUNKEN_M = 5.0
"""Largest difference between a pad's altitude and the ground there."""
SHARE_SHOWN = 0.001
SETTINGS = SafetySettings()
"""The gate's minima are the site's limits plus the margins of these."""


def site_warnings(site: Site) -> tuple[str, ...]:
    """Return what to check before flying; empty for a complete site."""
    if site.frame is None:
        return ()
    return (
        *failsafe_warnings(site.failsafe),
        *_unbounded(site),
        *_unknown_ground(site),
        *_missing_keys(site),
        *_close_go_home_heights(site),
        *_low_go_home_heights(site),
        *_high_zones(site),
        *_close_pads(site),
        *_sunken_pads(site),
    )


def _unbounded(site: Site) -> Iterator[str]:
    if site.layers.boundary is None:
        yield (
            "no boundary: only the distance from home, "
            f"{site.limits.max_distance_from_home_m:g} m, limits flights"
        )


def _unknown_ground(site: Site) -> Iterator[str]:
    """Yield the share of the boundary without ground in the elevation model."""
    if site.elevation is None or site.layers.boundary is None:
        return
    grid = site.elevation.grid
    easts, norths = cell_centres_m(grid)
    middles_m = np.stack(np.meshgrid(easts, norths), axis=-1).reshape(-1, 2)
    is_inside = Polygon(site.layers.boundary).contains(middles_m)
    is_unknown = np.isnan(site.elevation.ellipsoid_height_m.ravel())
    share = float((is_unknown & is_inside).sum()) / max(1, int(is_inside.sum()))
    if share > SHARE_SHOWN:
        yield (
            f"the elevation model has no ground under {100.0 * share:.1f} % of the boundary: "
            "flights over it are refused"
        )


def _missing_keys(site: Site) -> Iterator[str]:
    for profile in site.profiles.values():
        missing = [key for key, value in _flight_keys(profile).items() if value is None]
        if missing:
            yield (
                f"vehicle {profile.display_name}: site.toml does not set {', '.join(missing)}; "
                "the worst case is assumed, or the order refused"
            )


def _flight_keys(profile: VehicleProfile) -> dict[str, object]:
    return {
        "endurance_min": profile.endurance_s,
        "go_home_height_m": profile.go_home_height_m,
        "failsafe": profile.failsafe,
        "pad": profile.pad,
    }


def _close_go_home_heights(site: Site) -> Iterator[str]:
    least_m = gate_minima(site.limits, SETTINGS).vertical_m
    known = [
        (profile.go_home_height_m, profile.display_name)
        for profile in site.profiles.values()
        if profile.go_home_height_m is not None
    ]
    for (height_m, one), (other_m, other) in pairwise(sorted(known)):
        if other_m - height_m < least_m:
            yield (
                f"vehicles {one} and {other} have go-home heights of {height_m:g} m and "
                f"{other_m:g} m; they must be {least_m:g} m apart"
            )


def _low_go_home_heights(site: Site) -> Iterator[str]:
    for profile in site.profiles.values():
        height_m = profile.go_home_height_m
        for zone in site.layers.zones:
            if height_m is not None and _is_above(zone, height_m, site):
                yield (
                    f"vehicle {profile.display_name} has a go-home height of {height_m:g} m, below "
                    f"the floor of zone {zone.name}"
                )


def _high_zones(site: Site) -> Iterator[str]:
    """Yield each keep-out zone above every allowed height."""
    for zone in site.layers.zones:
        if zone.kind is not ZoneKind.KEEP_OUT or zone.floor_m is None or zone.datum is None:
            continue
        highest_m = highest_ground_m(site, zone) + site.limits.max_height_above_ground_m
        if zone.floor_m > highest_m:
            yield (
                f"keep-out zone {zone.name} begins at {zone.floor_m:g} m ({zone.datum.value}), "
                "above every allowed height there; is its datum right?"
            )


def _is_above(zone: Zone, height_m: float, site: Site) -> bool:
    """Whether a height zone's floor is higher than a height above flat ground."""
    if zone.kind is not ZoneKind.HEIGHT or zone.floor_m is None or site.frame is None:
        return False
    is_above_ground = zone.datum is HeightDatum.GROUND
    return zone.floor_m - height_m > (
        0.0 if is_above_ground else site.frame.origin.ellipsoid_height_m
    )


def _close_pads(site: Site) -> Iterator[str]:
    """Yield each pad that is too close to its nearest neighbour for a fleet return to both."""
    assert site.frame is not None
    pads = site.airspace.landing_pads
    places_m = enu_from_points(site.frame, [pad.place for pad in pads])[:, :2]
    least_m = gate_minima(site.limits, SETTINGS).horizontal_m + HOVER_DRIFT_M
    named: set[frozenset[int]] = set()
    for one, place_m in enumerate(places_m):
        apart_m = np.linalg.norm(places_m - place_m, axis=1)
        apart_m[one] = np.inf
        other = int(apart_m.argmin())
        if apart_m[other] < least_m and frozenset((one, other)) not in named:
            named.add(frozenset((one, other)))
            yield (
                f"pads {pads[one].name} and {pads[other].name} are {apart_m[other]:.1f} m apart, "
                f"less than {least_m:g} m: vehicles land one at a time"
            )


def _sunken_pads(site: Site) -> Iterator[str]:
    assert site.frame is not None
    for pad in site.airspace.landing_pads:
        place_m = enu_from_points(site.frame, [pad.place])[:, :2]
        if site.elevation is None:
            ground_m = site.frame.origin.ellipsoid_height_m
        else:
            ground_m = float(ground_heights_m(site.elevation, place_m)[0])
        gap_m = pad.place.ellipsoid_height_m - ground_m
        if abs(gap_m) > SUNKEN_M:
            assumed = "the ground, assumed flat" if site.elevation is None else "the model's ground"
            yield (
                f"pad {pad.name} lies {abs(gap_m):.1f} m {'above' if gap_m > 0.0 else 'below'} "
                f"{assumed}, there; is its altitude above the WGS84 ellipsoid?"
            )
