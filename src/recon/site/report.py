"""What a site's folder came to, in sentences for the operator."""

from recon.camera import PoseSolution
from recon.geo import Polygon
from recon.model.zone import ZoneKind
from recon.site.site import Eye, Layers, Site


def site_report(site: Site) -> tuple[str, ...]:
    """Return lines that say what was read, how well the control points fit, what is assumed."""
    if site.frame is None:
        return ("no site: nothing is known of any vehicle, no frame is laid on the ground",)
    lines = [f"site {site.name}: {len(site.profiles)} vehicle profiles"]
    if site.ground_grid is not None:
        grid = site.ground_grid
        lines.append(
            f"ground image {grid.cols} x {grid.rows} cells of {grid.cell_m:g} m around the origin"
        )
    if site.eye is None:
        lines.append("no eye: frames are shown as they come, none is laid on the ground")
    else:
        lines += _eye_report(site.eye)
    lines += _layers_report(site.layers)
    return tuple(lines)


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
    if lines:
        lines.append("the safety gate does not yet check orders against the layers")
    return lines


def _eye_report(eye: Eye) -> list[str]:
    lines = [f"eye {eye.serial}: {eye.camera.cols} x {eye.camera.rows} lens model"]
    lines += pose_report(eye.solution)
    if eye.first_frame_stands_for_marked_frame:
        lines.append(
            "the marked frame's telemetry is not given: the first frame received in flight stands "
            "for it, which is right only where that frame was taken"
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
