"""What a site's folder came to, in sentences for the operator."""

from recon.camera import PoseSolution
from recon.site.site import Eye, Site


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
    return tuple(lines)


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
