"""A site's summary at the start of a station."""

import numpy as np

from recon.camera import PoseSolution
from recon.geo import Polygon
from recon.model.airspace import FlightLimits, ZoneKind
from recon.site.site import Imager, Layers, Site
from recon.site.warnings import site_warnings


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
    if site.imager is None:
        lines.append("no imaging drone: ground image is off")
    else:
        lines += _imager_report(site.imager)
    lines += _layers_report(site.layers)
    lines += [_terrain_report(site), _limits_report(site.limits)]
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
    lines += pose_report(imager.solution)
    if imager.first_frame_stands_for_marked_frame:
        lines.append(
            "[imager.marked_frame] is missing: the first frame received in flight is used instead, "
            "which is right only if it was taken from the same position"
        )
    return lines


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
