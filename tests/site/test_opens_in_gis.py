"""The demonstration's layers through GDAL, which is what QGIS opens and saves them with."""

import shutil
from pathlib import Path

import pytest
from pyogrio import raw, read_info

from recon.site import demo_site_folder, load_site

TEXT, NUMBER = "object", "float64"
LAYERS = {
    "boundary": ("Polygon", 1, {"name": TEXT}),
    "keep_out": ("Polygon", 1, {"name": TEXT}),
    "height_zones": ("Polygon", 1, {"name": TEXT, "floor_m": NUMBER, "datum": TEXT}),
    "landing_pads": ("Point", 9, {"name": TEXT, "serial": TEXT, "altitude_m": NUMBER}),
    "survey_regions": ("Polygon", 2, {"name": TEXT}),
}


@pytest.mark.parametrize("layer", LAYERS)
def test_a_layer_opens_with_its_place_its_features_and_its_attributes(layer: str) -> None:
    geometry, count, attributes = LAYERS[layer]
    info = read_info(demo_site_folder() / f"{layer}.geojson")
    assert info["crs"] == "EPSG:4326"
    assert (info["geometry_type"], info["features"]) == (geometry, count)
    assert dict(zip(info["fields"], info["dtypes"], strict=True)) == attributes


def test_every_layer_of_the_site_is_among_them() -> None:
    assert set(load_site(demo_site_folder()).layers.files) == set(LAYERS)


def test_layers_that_were_opened_and_saved_again_are_the_same_site(tmp_path: Path) -> None:
    folder = tmp_path / "site"
    shutil.copytree(demo_site_folder(), folder)
    for layer in LAYERS:
        _save_again(folder / f"{layer}.geojson")
    saved, shipped = load_site(folder).layers, load_site(demo_site_folder()).layers
    assert saved.boundary is not None
    assert shipped.boundary is not None
    assert saved.boundary.outline_m == pytest.approx(shipped.boundary.outline_m, abs=0.01)
    for ours, theirs in zip(saved.zones, shipped.zones, strict=True):
        assert ours.region.outline_m == pytest.approx(theirs.region.outline_m, abs=0.01)
        assert (ours.name, ours.kind, ours.floor_m, ours.ceiling_m, ours.datum) == (
            (theirs.name, theirs.kind, theirs.floor_m, theirs.ceiling_m, theirs.datum)
        )
    pads = [[(pad.name, pad.serial) for pad in one.landing_pads] for one in (saved, shipped)]
    assert pads[0] == pads[1]
    assert list(saved.survey_regions) == list(shipped.survey_regions)


def _save_again(path: Path) -> None:
    meta, _index, geometry, values = raw.read(path)
    path.unlink()
    raw.write(
        path,
        geometry,
        values,
        fields=meta["fields"],
        geometry_type=meta["geometry_type"],
        crs=meta["crs"],
        driver="GeoJSON",
    )
