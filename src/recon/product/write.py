"""What `recon tag` leaves: a table, sidecars, masks, the ground to fly again."""

import csv
import io
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from xml.sax.saxutils import quoteattr

import cv2
import numpy as np
import numpy.typing as npt
import shapely  # type: ignore[import-untyped, unused-ignore]

from recon import version
from recon.model.errors import RecordError
from recon.product.flight import FlightData
from recon.product.photos.photo import Photo
from recon.product.shot_files import ShotFiles
from recon.product.tag import PhotoTag, Selection
from recon.product.timing import TimedPhoto
from recon.record.files.atomic_file import replace_file

ByteMap = npt.NDArray[np.uint8]
FILE_MODE = 0o644
MASK_QUALITY = 100
"""Masks are read as 0 and not 0: at less the edges of black would be ragged."""

COLUMNS = (
    *("name", "file", "vehicle", "utc", "sigma_s", "latitude_deg", "longitude_deg"),
    *("height_above_takeoff_m", "yaw_deg", "pitch_deg", "sunlit", "confidence", "known", "state"),
    *("chosen", "footprint_wkt", "shot", "shows", "light_by", "quality", "note"),
    *("sun_by_sensor", "sun_by_maps_there"),
)


def masked_name(name: str) -> str:
    """Return the file of a photo's mask, as OpenDroneMap looks for it."""
    return f"{Path(name).stem}_mask.JPG"


def mask_jpeg(mask: ByteMap, orientation: int) -> bytes:
    """Return a mask (rows, cols) as JPEG, turned upright as EXIF's orientation has it.

    Software that knows the orientation looks the mask up in the upright picture.
    """
    turned = np.ascontiguousarray(upright(mask, orientation))
    done, data = cv2.imencode(".jpg", turned, [cv2.IMWRITE_JPEG_QUALITY, MASK_QUALITY])
    assert done
    return data.tobytes()


def upright(pixels: ByteMap, orientation: int) -> ByteMap:
    """Return an image turned and mirrored by EXIF's orientation, 1 to 8."""
    if orientation in (5, 6, 7, 8):
        pixels = pixels.swapaxes(0, 1)
    if orientation in (2, 3, 6, 7):
        pixels = pixels[:, ::-1]
    if orientation in (3, 4, 7, 8):
        pixels = pixels[::-1]
    return pixels


def write_photo_files(
    out: Path, flight: FlightData, timed: TimedPhoto, tag: PhotoTag, mask: ByteMap, share: float
) -> None:
    """Write a photo's mask and sidecar; raises OSError."""
    data = mask_jpeg(mask, timed.photo.orientation)
    replace_file(out / "masks" / masked_name(tag.name), data, FILE_MODE, sync=False)
    sidecar = xmp(flight, timed, tag, share).encode()
    replace_file(out / "xmp" / f"{Path(tag.name).stem}.xmp", sidecar, FILE_MODE, sync=False)


def xmp(flight: FlightData, timed: TimedPhoto, tag: PhotoTag, share: float) -> str:
    """Return a photo's sidecar."""
    longitude_deg, latitude_deg = lon_lat(flight, timed)
    state = tag.state(share)
    values = {
        "xmp:CreatorTool": f"Recon {version()}",
        "exif:GPSLatitude": _xmp_degrees(latitude_deg, "N", "S"),
        "exif:GPSLongitude": _xmp_degrees(longitude_deg, "E", "W"),
        "recon:CapturedUTC": flight.utc(timed.at_ns),
        "recon:CapturedSigma": f"{timed.sigma_s:.2f}",
        "recon:Vehicle": timed.serial,
        "recon:SunlitFraction": _share(tag.sunlit),
        "recon:SunlitConfidence": _share(tag.confidence),
        "recon:KnownFraction": _share(tag.known),
        "recon:State": state,
        "recon:HeightAboveTakeoff": f"{timed.height_above_takeoff_m:.1f}",
        "recon:FlightRecord": flight.path.name,
    }
    lines = "\n".join(f"   {name}={quoteattr(value)}" for name, value in values.items() if value)
    return f"""<?xpacket begin="\ufeff" id="W5M0MpCehiHzreSzNTczkc9d"?>
<x:xmpmeta xmlns:x="adobe:ns:meta/">
 <rdf:RDF xmlns:rdf="http://www.w3.org/1999/02/22-rdf-syntax-ns#">
  <rdf:Description rdf:about=""
   xmlns:xmp="http://ns.adobe.com/xap/1.0/"
   xmlns:exif="http://ns.adobe.com/exif/1.0/"
   xmlns:dc="http://purl.org/dc/elements/1.1/"
   xmlns:recon="urn:recon:photo:1"
{lines}>
   <dc:subject><rdf:Bag><rdf:li>{state}</rdf:li></rdf:Bag></dc:subject>
  </rdf:Description>
 </rdf:RDF>
</x:xmpmeta>
<?xpacket end="w"?>
"""


def _xmp_degrees(value: float, positive: str, negative: str) -> str:
    whole, minutes = divmod(abs(value) * 60.0, 60.0)
    return f"{whole:.0f},{minutes:.6f}{positive if value >= 0.0 else negative}"


def _share(value: float) -> str:
    return "" if np.isnan(value) else f"{value:.3f}"


def lon_lat(flight: FlightData, timed: TimedPhoto) -> tuple[float, float]:
    """Return a photo's longitude and latitude in degrees."""
    aim = timed.view.aim
    (place,) = flight.lon_lat(np.array([[aim.east_m, aim.north_m]]))
    return place


def table(
    flight: FlightData,
    files: ShotFiles,
    tags: Mapping[str, PhotoTag],
    chosen: Sequence[str],
    refused: Mapping[str, str],
    quality: Mapping[str, str],
    share: float,
    both: Mapping[str, tuple[float, float]],
) -> str:
    """Return the CSV: a row for each file, those without a tag with the reason last.

    `both` is the direct sun by the shade maps and by the photo's own sensor, by name.
    """
    out = io.StringIO()
    rows = csv.writer(out, lineterminator="\n")
    rows.writerow(COLUMNS)
    kept = frozenset(chosen)
    for timed in files.photos:
        tag, aim, name = tags[timed.photo.name], timed.view.aim, timed.photo.name
        longitude_deg, latitude_deg = lon_lat(flight, timed)
        rows.writerow(
            (
                *(cell(name), cell(str(timed.photo.path)), cell(timed.serial)),
                *(flight.utc(timed.at_ns), f"{timed.sigma_s:.2f}"),
                *(f"{latitude_deg:.8f}", f"{longitude_deg:.8f}"),
                f"{timed.height_above_takeoff_m:.1f}",
                *(f"{aim.yaw_deg:.1f}", f"{aim.pitch_deg:.1f}"),
                *(_share(tag.sunlit), _share(tag.confidence), _share(tag.known)),
                *(tag.state(share), "yes" if name in kept else "no", _wkt(flight, timed)),
                *(
                    cell(files.shot[name]),
                    _shows(timed.photo),
                    _light_by(tag),
                    quality.get(name, ""),
                    "",
                ),
                *(_share(each) for each in reversed(both.get(name, (np.nan, np.nan)))),
            )
        )
    for name, reason in sorted(refused.items()):
        rows.writerow((cell(name), *[""] * 13, "no", *[""] * 5, cell(reason), "", ""))
    return out.getvalue()


def _light_by(tag: PhotoTag) -> str:
    if tag.is_by_sensor:
        return "sun sensor"
    return "shade maps" if tag.known > 0.0 else ""


def _shows(photo: Photo) -> str:
    """Return visible, zoom or thermal, or the name of a band."""
    return photo.band.name if photo.kind == "band" and photo.band else photo.kind


def cell(text: str) -> str:
    """Return a text that no spreadsheet takes for a formula."""
    return f"'{text}" if text[:1] in ("=", "+", "-", "@", "\t", "\r") else text


def _wkt(flight: FlightData, timed: TimedPhoto) -> str:
    points = [f"{x:.8f} {y:.8f}" for x, y in flight.lon_lat(timed.view.corners_m)]
    return f"POLYGON (({', '.join((*points, points[0]))}))"


def fly_again(flight: FlightData, selection: Selection) -> str:
    """Return the GeoJSON of what is to be flown again: regions that `recon survey create` takes."""
    features = []
    for number, polygon in enumerate(selection.again, start=1):
        properties: dict[str, str | float] = {
            "name": f"again {number}",
            "area_m2": round(polygon.area),
        }
        if flight.surveys:
            newest = flight.surveys[-1]
            reference = "ground" if newest.request().is_above_ground else "takeoff"
            properties[f"height_above_{reference}_m"] = newest.request().height_m
            properties["speed_mps"] = newest.speed_mps
        geometry = {"type": "Polygon", "coordinates": _rings(polygon, flight)}
        features.append({"type": "Feature", "properties": properties, "geometry": geometry})
    return json.dumps({"type": "FeatureCollection", "features": features}) + "\n"


def _rings(polygon: shapely.Polygon, flight: FlightData) -> list[list[list[float]]]:
    """Return a polygon's rings as GeoJSON has them: closed, counter-clockwise outside."""
    turned = shapely.geometry.polygon.orient(polygon)
    return [
        [[round(x, 8), round(y, 8)] for x, y in flight.lon_lat(np.asarray(ring.coords)[:, :2])]
        for ring in (turned.exterior, *turned.interiors)
    ]


def write_text(path: Path, text: str) -> None:
    """Write a file whole or not at all; raises `RecordError`."""
    try:
        replace_file(path, text.encode(), FILE_MODE)
    except OSError as problem:
        raise RecordError(f"{path}: cannot be written: {problem.strerror}") from problem
