"""The report and the warnings of a site."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from tools.demo_site import BOUNDARY, FARMYARD, ORIGIN, SURVEY, TREES, Outline

from recon.geo import point_from_enu
from recon.model.airspace import HeightDatum, Region, Zone, ZoneKind
from recon.model.geo import GeoPoint, LocalFrame
from recon.model.vehicle import Failsafe, VehicleProfile
from recon.site import Site, default_site, demo_site_folder, load_site, site_report
from recon.site.report import site_warnings
from recon.site.site import Layers


def test_the_report_tells_the_fit_and_every_residual() -> None:
    site = load_site(demo_site_folder())
    assert site.imager is not None
    lines = site_report(site)
    solution = site.imager.solution
    assert solution is not None
    assert lines[0] == "site demo field: 8 vehicle profiles"
    assert "544 x 544 cells of 1 m" in lines[1]
    assert lines[2] == "imaging drone SIM-IMAGER: 1280 x 720 lens model"
    assert f"8 control points fit to {solution.rms_px:.2f} px RMS" in lines[3]
    assert f"height {solution.height_above_ground_m:.1f} +-" in lines[3]
    points = [line.split(":")[0] for line in lines[4:12]]
    assert points == [f"control point {n}" for n in "ABCDEFGH"]


def shoelace_ha(outline: Outline) -> float:
    ends = (*outline[1:], outline[0])
    return abs(sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(outline, ends, strict=True))) / 2e4


def test_the_report_lists_the_layers_the_terrain_and_the_limits() -> None:
    lines = site_report(load_site(demo_site_folder()))
    field_ha, yard_ha, trees_ha = (shoelace_ha(area) for area in (BOUNDARY, FARMYARD, TREES))
    survey_ha = sum(shoelace_ha(outline) for outline in SURVEY.values())
    assert lines[12:] == (
        f"layer boundary from boundary.geojson: polygons: 1, together {field_ha:.2f} ha",
        f"layer keep_out from keep_out.geojson: polygons: 1, together {yard_ha:.2f} ha",
        f"layer height_zones from height_zones.geojson: polygons: 1, together {trees_ha:.2f} ha",
        "layer landing_pads from landing_pads.geojson: 9 pads",
        "layer survey_regions from survey_regions.geojson: polygons: 2, together "
        f"{survey_ha:.2f} ha",
        "terrain: model from ground.tif, 52 x 52 cells of 30 m, ground from 275.0 to 275.0 m above "
        "the WGS84 ellipsoid",
        "limits: 5 to 130 m above ground, 500 m from home, 15 m/s; 15 m beside or 6 m above each "
        "other; 5 m from fences; 25 % of the battery left at home",
        "failsafe matrix: default",
    )


def warnings_of(site: Site) -> list[str]:
    lines = [line for line in site_report(site) if line.startswith("warning: ")]
    assert lines == [f"warning: {warning}" for warning in site_warnings(site)]
    return [line.removeprefix("warning: ") for line in lines]


def pad(east_m: float, up_m: float = 0.0) -> GeoPoint:
    return point_from_enu(LocalFrame(ORIGIN), (east_m, 0.0, up_m))


def site_with(*profiles: VehicleProfile, **more: Any) -> Site:
    profiles_by_serial = {profile.serial: profile for profile in profiles}
    return replace(load_site(demo_site_folder()), profiles=profiles_by_serial, **more)


def complete(serial: str, height_m: float, place: GeoPoint) -> VehicleProfile:
    return VehicleProfile(
        serial,
        pad=place,
        endurance_s=900.0,
        go_home_height_m=height_m,
        failsafe=Failsafe.HOVER,
    )


def test_a_complete_site_gets_no_warning() -> None:
    assert warnings_of(load_site(demo_site_folder())) == []
    assert site_warnings(default_site()) == ()


def test_the_report_names_the_assumptions_without_layers_and_elevation() -> None:
    bare = site_with(layers=Layers(), elevation=None)
    assert "terrain: assumed flat at origin.ground_altitude_m" in site_report(bare)
    assert warnings_of(bare) == ["no boundary: only the distance from home, 500 m, limits flights"]


def test_each_incomplete_vehicle_is_named_with_its_missing_keys() -> None:
    half = VehicleProfile("B", "Bea", endurance_s=900.0, pad=pad(45.0))
    site = site_with(VehicleProfile("A"), half, complete("C", 50.0, pad(90.0)))
    effect = "the worst case is assumed, or the order refused"
    keys = "endurance_min, go_home_height_m, failsafe, pad"
    assert warnings_of(site) == [
        f"vehicle A: site.toml does not set {keys}; {effect}",
        f"vehicle Bea: site.toml does not set go_home_height_m, failsafe; {effect}",
    ]


def test_go_home_heights_too_close_or_too_low_are_named() -> None:
    high = Zone("mast", ZoneKind.HEIGHT, Region(np.array(TREES)), 317.0, None, HeightDatum.WGS84)
    layers = replace(load_site(demo_site_folder()).layers, zones=(high,), landing_pads=())
    vehicles = [complete("A", 41.0, pad(0.0)), complete("B", 48.4, pad(40.0))]
    assert warnings_of(site_with(*vehicles, layers=layers)) == [
        "vehicles A and B have go-home heights of 41 m and 48.4 m; they must be 7.5 m apart",
        "vehicle A has a go-home height of 41 m, below the floor of zone mast",
    ]
    trees = site_with(complete("A", 34.0, pad(150.0)))
    assert warnings_of(trees) == [
        "vehicle A has a go-home height of 34 m, below the floor of zone tree line"
    ]


def test_pads_too_close_or_off_the_ground_are_named() -> None:
    layers = replace(load_site(demo_site_folder()).layers, landing_pads=())
    vehicles = [complete("A", 40.0, pad(0.0, -6.0)), complete("B", 50.0, pad(19.7, 7.0))]
    close = "pads A and B are 19.7 m apart, less than 20 m: vehicles land one at a time"
    for elevation, ground in (
        (load_site(demo_site_folder()).elevation, "the model's ground"),
        (None, "the ground, assumed flat"),
    ):
        site = site_with(*vehicles, layers=layers, elevation=elevation)
        assert warnings_of(site) == [
            close,
            f"pad A lies 6.0 m below {ground}, there; is its altitude above the WGS84 ellipsoid?",
            f"pad B lies 7.0 m above {ground}, there; is its altitude above the WGS84 ellipsoid?",
        ]


def test_a_model_with_gaps_gives_the_share_of_the_boundary_without_ground() -> None:
    model = load_site(demo_site_folder()).elevation
    assert model is not None
    heights_m = model.ellipsoid_height_m.copy()
    heights_m[:26] = np.nan
    (warning,) = warnings_of(site_with(elevation=replace(model, ellipsoid_height_m=heights_m)))
    share = float(warning.partition("under ")[2].partition(" %")[0])
    assert share == pytest.approx(50.0, abs=5.0)
    assert warning.endswith("of the boundary: flights over it are refused")


def test_the_report_names_a_missing_marked_frame() -> None:
    site = load_site(demo_site_folder())
    assert site.imager is not None
    without = site.with_imager(replace(site.imager, marked_frame=None))
    assert any(
        "[imager.marked_frame] is missing: the first frame received" in x
        for x in site_report(without)
    )


def test_the_report_of_no_site_names_what_is_off() -> None:
    assert site_report(default_site()) == (
        "No site loaded: vehicle profiles and ground image are off",
    )
