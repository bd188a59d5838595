"""What the operator is told of a site."""

from dataclasses import replace

from recon.site import Site, default_site, demo_site_folder, load_site, site_report
from recon.site.demo_layers import BOUNDARY, FARMYARD, SURVEY, Outline


def test_the_report_tells_the_fit_and_every_residual() -> None:
    site = load_site(demo_site_folder())
    assert site.eye is not None
    lines = site_report(site)
    solution = site.eye.solution
    assert lines[0] == "site demo field: 4 vehicle profiles"
    assert "512 x 512 cells of 1 m" in lines[1]
    assert lines[2] == "eye SIM-EYE: 1280 x 720 lens model"
    assert f"8 control points fit to {solution.rms_px:.2f} px RMS" in lines[3]
    assert f"height {solution.height_above_ground_m:.1f} +-" in lines[3]
    points = [line.split(":")[0] for line in lines[4:12]]
    assert points == [f"control point {n}" for n in "ABCDEFGH"]


def shoelace_ha(outline: Outline) -> float:
    ends = (*outline[1:], outline[0])
    return abs(sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(outline, ends, strict=True))) / 2e4


def test_the_report_lists_the_layers_and_that_nothing_checks_them_yet() -> None:
    lines = site_report(load_site(demo_site_folder()))
    field_ha, yard_ha = shoelace_ha(BOUNDARY), shoelace_ha(FARMYARD)
    survey_ha = sum(shoelace_ha(outline) for outline in SURVEY.values())
    assert lines[12:] == (
        f"layer boundary from boundary.geojson: polygons: 1, together {field_ha:.2f} ha",
        f"layer keep_out from keep_out.geojson: polygons: 1, together {yard_ha:.2f} ha",
        "layer survey_regions from survey_regions.geojson: polygons: 2, together "
        f"{survey_ha:.2f} ha",
        "the safety gate does not yet check orders against the layers",
    )


def test_the_report_says_when_the_first_frame_stands_for_the_marked_one() -> None:
    site = load_site(demo_site_folder())
    assert site.eye is not None
    guessed = Site(site.name, site.frame, site.ground_grid, replace(site.eye, marked_frame=None))
    assert "first frame received in flight stands for it" in site_report(guessed)[-1]


def test_the_report_of_no_site_says_what_is_missing() -> None:
    assert site_report(default_site()) == (
        "no site: nothing is known of any vehicle, no frame is laid on the ground",
    )
