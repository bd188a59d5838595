"""Small valid files of each kind, as the tests make them: what the search begins with."""

import io
import json
from pathlib import Path
from random import Random

import numpy as np

CSV_LONG = "time,sensor,lat,lon,light\n" + "".join(
    f"2026-05-01T10:0{at}:00Z,{name},41.90{name},-93.60{name},{100 * at + name}\n"
    for at in range(4)
    for name in range(1, 5)
)
CSV_WIDE = "time,a,b,c\neast_m,0,40,80\nnorth_m,0,30,-20\n" + "".join(
    f"{1_777_000_000 + at},{500 + at},{600 - at},{70 * at}\n" for at in range(4)
)


def fields(folder: Path) -> list[bytes]:
    """Fields in each format, alone and in archives."""
    from tests.fields import written

    random = Random(1)
    some = [(name, written.drawn(random, holes)) for name, holes in (("north", 0), ("b", 1))]
    plain = [
        make(some, random)
        for make in (written.kml, written.geojson, written.isoxml, written.gpx, written.qgc_plan)
    ]
    archives = [
        written.zipped({"doc.kml": plain[0]}),
        written.zipped({"TASKDATA/TASKDATA.XML": plain[2]}),
        written.shapefiles(some, ["EPSG:4326", "EPSG:4326"]),
    ]
    return [*plain, *archives]


def layers(folder: Path) -> list[bytes]:
    """Layers of a site near its origin, and fields elsewhere."""
    at = [[-93.604, 41.901], [-93.602, 41.901], [-93.602, 41.902], [-93.604, 41.901]]
    shapes = (
        {"type": "Polygon", "coordinates": [at]},
        {"type": "MultiPolygon", "coordinates": [[at]]},
        {"type": "Point", "coordinates": at[0]},
    )
    features = [
        {"type": "Feature", "properties": {"name": "a"}, "geometry": shape} for shape in shapes
    ]
    whole = {"type": "FeatureCollection", "features": features}
    return [json.dumps(each).encode() for each in (whole, *features, *shapes)]


def sites(folder: Path) -> list[bytes]:
    """The demonstration's site.toml, and a short one."""
    from tests.site.terrain import HEAD

    from recon.site.load import SITE_FILE, demo_site_folder

    return [(demo_site_folder() / SITE_FILE).read_bytes(), HEAD.encode()]


def missions(folder: Path) -> list[bytes]:
    """A mission in Recon's own form, and one as GeoJSON."""
    waypoint = {"latitude_deg": 41.9, "longitude_deg": -93.6, "height_above_takeoff_m": 40}
    line = {"type": "LineString", "coordinates": [[-93.6, 41.9, 40], [-93.61, 41.9, 40]]}
    own = {"waypoints": [waypoint, {**waypoint, "speed_mps": 5, "loiter_s": 2}], "curved": True}
    return [json.dumps(each).encode() for each in (own, line)]


def weather(folder: Path) -> list[bytes]:
    """An answer of a server of weather."""
    from tests.site.weather_answer import answer

    return [json.dumps(answer([0.0, 50.0, None])).encode()]


def heights(folder: Path) -> list[bytes]:
    """Heights in several types, packed and in tiles."""
    from tests.site.terrain import geotiff

    return [
        geotiff(half_side=60.0),
        geotiff(half_side=60.0, dtype="int16", compress="deflate", nodata=-99),
        geotiff(half_side=0.001, crs="EPSG:4326", pixel=0.0001, dtype="float32"),
    ]


def mbtiles(folder: Path) -> list[bytes]:
    """Tiles of one field."""
    from tests.basemap.made_maps import FIELD, keys_over, write_mbtiles

    keys = keys_over(FIELD, range(15, 16))
    return [write_mbtiles(folder / "a.mbtiles", keys, {"attribution": "x"}).read_bytes()]


def pmtiles(folder: Path) -> list[bytes]:
    """Tiles of one field."""
    from tests.basemap.made_maps import FIELD, keys_over, write_pmtiles

    return [write_pmtiles(folder / "a.pmtiles", keys_over(FIELD, range(15, 17))).read_bytes()]


def map_pictures(folder: Path) -> list[bytes]:
    """An aerial picture with and without overviews."""
    from tests.basemap.test_geotiff_map import ramps, write

    found = []
    for overviews in (False, True):
        write(folder / "a.tif", ramps(96), overviews=overviews)
        found.append((folder / "a.tif").read_bytes())
    return found


def photos(folder: Path) -> list[bytes]:
    """A drone's photo with EXIF and XMP, and a band as TIFF."""
    from tests.product.made_flight import write_photo
    from tests.product.photos.made_bands import write_band
    from tests.product.photos.packets import packet

    xmp = packet({"RelativeAltitude": "+40.00", "GimbalYawDegree": "+91.2", "RtkFlag": "50"})
    where = {"place_m": (10.0, 20.0), "clock_ns": 1_777_000_000_000_000_000, "size": (64, 48)}
    photo = write_photo(folder / "a.jpg", xmp=xmp, subsec="25", altitude_m=310.0, **where)
    band = write_band(folder / "a_MS_NIR.tif", photo, xmp)
    return [photo.read_bytes(), band.read_bytes()]


def pictures(folder: Path) -> list[bytes]:
    """JPEG, plain and progressive, and PNG."""
    from PIL import Image

    pixels = np.arange(24 * 32 * 3, dtype=np.uint8).reshape(24, 32, 3)
    found = []
    for kind, more in (("JPEG", {}), ("JPEG", {"progressive": True}), ("PNG", {})):
        data = io.BytesIO()
        Image.fromarray(pixels).save(data, kind, **more)
        found.append(data.getvalue())
    return found


def records(folder: Path) -> list[bytes]:
    """A record with its end, and one without."""
    from tests.record.mcap.test_mcap_file import written

    finished = written(folder / "a.mcap").read_bytes()
    return [finished, written(folder / "b.mcap", finish=False).read_bytes()]


def flights(folder: Path) -> list[bytes]:
    """The record of a short flight."""
    from tests.product.made_flight import Rows, flight, write_record

    return [write_record(flight(Rows(), maps_every_s=1e4), folder / "a.mcap").read_bytes()]


def light_tables(folder: Path) -> list[bytes]:
    """CSV in both forms."""
    return [CSV_LONG.encode(), CSV_WIDE.encode()]


def _arrays() -> dict[str, np.ndarray]:
    return {
        "time": 1_777_000_000.0 + np.arange(4.0),
        "light": np.arange(12.0).reshape(4, 3) + 100.0,
        "lat": np.array([41.9, 41.901, 41.902]),
        "lon": np.array([-93.6, -93.601, -93.602]),
    }


def light_arrays(folder: Path) -> list[bytes]:
    """NumPy's arrays, stored and packed."""
    found = []
    for save in (np.savez, np.savez_compressed):
        data = io.BytesIO()
        save(data, **_arrays())
        found.append(data.getvalue())
    return found


def mavlink_frames(folder: Path) -> list[bytes]:
    """Heartbeat, a command and an item of a mission, of both versions."""
    from pymavlink.dialects.v10 import common as first
    from pymavlink.dialects.v20 import common as second

    found = []
    for dialect in (first, second):
        mav = dialect.MAVLink(None, 255, 190)
        messages = (
            dialect.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3),
            dialect.MAVLink_command_long_message(1, 1, 400, 0, 1.0, 0, 0, 0, 0, 0, 0),
            dialect.MAVLink_mission_count_message(1, 1, 3),
        )
        found.append(b"".join(message.pack(mav) for message in messages))
    return found


def mavlink_payloads(folder: Path) -> list[bytes]:
    """Each kind that the gateway handles, to it, with nothing in it, and all of them."""
    from tests.gateway.test_hostile import HANDLED

    each = [bytes((number,)) + b"\x01" * 64 for number in range(len(HANDLED))]
    return [*each, b"".join(each)]
