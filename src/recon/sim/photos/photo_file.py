"""A photo as a JPEG with what DJI's cameras state of it, in EXIF and XMP."""

from dataclasses import dataclass
from io import BytesIO

from PIL import ExifTags, Image
from PIL.TiffImagePlugin import IFDRational

from recon.model.geo import GeoPoint
from recon.model.imagery import RgbImage
from recon.sim.photos.cameras import PhotoCamera

QUALITY = 90


@dataclass(frozen=True, slots=True)
class StatedAttitude:
    """Attitude of a camera as its gimbal states it, in degrees: yaw clockwise from north."""

    yaw_deg: float
    pitch_deg: float = -90.0
    roll_deg: float = 0.0


@dataclass(frozen=True, slots=True)
class StatedFacts:
    """What a photo's file states besides its pixels, right or wrong."""

    camera: PhotoCamera
    body: str
    """Serial number of the camera's body."""
    clock: str
    """The camera's clock: YYYY:MM:DD HH:MM:SS."""
    place: GeoPoint
    height_above_takeoff_m: float
    attitude: StatedAttitude | None
    flight_yaw_deg: float
    """Heading of the aircraft's nose."""
    position_sigma_m: float
    """Standard deviation of the position, which cameras with RTK state."""


def jpeg_of(pixels: RgbImage, stated: StatedFacts) -> bytes:
    """Return the file of a photo's pixels (rows, cols, 3)."""
    file = BytesIO()
    image = Image.fromarray(pixels)
    image.save(file, "JPEG", quality=QUALITY, exif=_exif(stated, image.width), xmp=_xmp(stated))
    return file.getvalue()


def _exif(stated: StatedFacts, cols: int) -> Image.Exif:
    exif, camera = Image.Exif(), stated.camera
    exif[ExifTags.Base.Make], exif[ExifTags.Base.Model] = camera.make, camera.model
    details = exif.get_ifd(ExifTags.IFD.Exif)
    details[ExifTags.Base.DateTimeOriginal] = stated.clock
    details[ExifTags.Base.BodySerialNumber] = stated.body
    details[ExifTags.Base.FocalLength] = _rational(camera.focal_mm)
    details[ExifTags.Base.FocalLengthIn35mmFilm] = camera.film_mm
    # Of the photo as it is, reduced or not: readers take it before the rounded focal length.
    details[ExifTags.Base.FocalPlaneXResolution] = _rational(cols / camera.sensor_mm)
    details[ExifTags.Base.FocalPlaneResolutionUnit] = 4  # millimetres
    gps, place = exif.get_ifd(ExifTags.IFD.GPSInfo), stated.place
    gps[ExifTags.GPS.GPSLatitudeRef] = "N" if place.latitude_deg >= 0 else "S"
    gps[ExifTags.GPS.GPSLatitude] = _dms(place.latitude_deg)
    gps[ExifTags.GPS.GPSLongitudeRef] = "E" if place.longitude_deg >= 0 else "W"
    gps[ExifTags.GPS.GPSLongitude] = _dms(place.longitude_deg)
    gps[ExifTags.GPS.GPSAltitude] = _rational(place.ellipsoid_height_m)
    return exif


def _rational(value: float) -> IFDRational:
    return IFDRational(round(value * 1e6), 1_000_000)


def _dms(degrees: float) -> tuple[IFDRational, ...]:
    whole, minutes = divmod(abs(degrees) * 60.0, 60.0)
    parts = (int(whole), int(minutes), (minutes - int(minutes)) * 60.0)
    return tuple(_rational(part) for part in parts)


def _xmp(stated: StatedFacts) -> bytes:
    values = {
        "AbsoluteAltitude": f"{stated.place.ellipsoid_height_m:+.3f}",
        "RelativeAltitude": f"{stated.height_above_takeoff_m:+.3f}",
        "FlightYawDegree": f"{stated.flight_yaw_deg:+.2f}",
    }
    if stated.attitude is not None:
        values |= {
            "GimbalYawDegree": f"{stated.attitude.yaw_deg:+.2f}",
            "GimbalPitchDegree": f"{stated.attitude.pitch_deg:+.2f}",
            "GimbalRollDegree": f"{stated.attitude.roll_deg:+.2f}",
        }
    if stated.camera.has_rtk:
        sigma_m = f"{stated.position_sigma_m:.5f}"
        values |= {"AltitudeType": "RtkAlt", "RtkFlag": "50"}
        values |= dict.fromkeys(("RtkStdLon", "RtkStdLat", "RtkStdHgt"), sigma_m)
    else:
        values["AltitudeType"] = "GpsFusionAlt"
    facts = " ".join(f'drone-dji:{name}="{value}"' for name, value in values.items())
    return (
        '<x:xmpmeta xmlns:x="adobe:ns:meta/">'
        '<rdf:RDF xmlns:rdf="http://www.w3.org/1999/02/22-rdf-syntax-ns#">'
        '<rdf:Description rdf:about="DJI Meta Data" '
        f'xmlns:drone-dji="http://www.dji.com/drone-dji/1.0/" {facts}/></rdf:RDF></x:xmpmeta>'
    ).encode()
