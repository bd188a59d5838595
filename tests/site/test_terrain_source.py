"""A fetched elevation file states its source in a tag, which is believed within bounds."""

import pytest

from recon.site.terrain_source import TAG, TerrainSource, known_elevation, source_of, tag_of

SOURCE = TerrainSource("Copernicus GLO-30 (host)", 10**9, "EGM2008", True, "© D", ("N52E013",))


def test_what_a_tag_states_is_read_back() -> None:
    assert source_of(tag_of(SOURCE)) == SOURCE


@pytest.mark.parametrize(
    "text",
    [
        *("", "{", "[]", "[" * 7_000, '{"title": 5}', " " * 9_000),
        '{"title":"a","fetched_utc_s":-1,"zero":"b"}',
        '{"title":"a","fetched_utc_s":1e300,"zero":"b"}',
    ],
)
def test_a_damaged_tag_is_none(text: str) -> None:
    assert source_of({TAG: text}) is None


def test_control_characters_do_not_get_through() -> None:
    found = source_of({TAG: '{"title":"a\\n\\u001b[31mb","fetched_utc_s":1,"zero":"c"}'})
    assert found is not None
    assert found.title == "a [31mb"


def test_public_models_are_known_by_their_names() -> None:
    glo30 = known_elevation("https://host/Copernicus_DSM_COG_10_{NS}{lat:02}_00.tif")
    assert glo30 is not None
    assert (glo30.title, glo30.zero, glo30.is_surface) == ("Copernicus GLO-30", "EGM2008", True)
    threedep = known_elevation("https://host/USGS_13_{ns}{north:02}{ew}{lon:03}.tif")
    assert threedep is not None
    assert (threedep.zero, threedep.is_surface) == ("NAVD88", False)
    assert known_elevation("https://host/{lat}{lon}.tif") is None
