"""Files of one shot belong together; those of two do not."""

from pathlib import Path

import pytest
from tests.product.made_flight import write_photo
from tests.product.photos.made_bands import write_band
from tests.product.photos.packets import packet

from recon.model.units import NS_PER_S
from recon.product.photos.band import PhotoBand
from recon.product.photos.photo import Photo, read_photo_facts
from recon.product.photos.photo_error import PhotoError
from recon.product.photos.shots import shots_of

CLOCK_NS = 1_750_001_234 * NS_PER_S
THERMAL = packet({"drone-dji:ImageSource": "InfraredCamera"})
EVERY_S = 2


class Folder:
    """A card whose files are read in the order of their names."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def photo(self, name: str, number: int, late_s: int = 0, **changes: object) -> Path:
        facts = {
            "place_m": (8.0 * EVERY_S * number, 0.0),
            "clock_ns": CLOCK_NS + (EVERY_S * number + late_s) * NS_PER_S,
            "size": (64, 48),
        }
        path = self.path / name
        path.parent.mkdir(exist_ok=True, parents=True)
        return write_photo(path, **(facts | changes))

    def read(self) -> list[Photo]:
        files = (path for path in sorted(self.path.rglob("*")) if path.is_file())
        return [read_photo_facts(path, path.name) for path in files]

    def shots(self) -> list[list[str]]:
        return [[photo.name for photo in shot.files] for shot in shots_of(self.read())]


@pytest.fixture
def card(tmp_path: Path) -> Folder:
    return Folder(tmp_path)


def test_a_mavic_3_multispectral(card: Folder) -> None:
    for number in range(3):
        stem = f"DJI_2025062016000{EVERY_S * number}_{number + 1:04d}"
        lead = card.photo(f"{stem}_D.JPG", number)
        for name, wavelength in (("G", "560"), ("NIR", "860"), ("R", "650"), ("RE", "730")):
            facts = {"Camera:BandName": name, "Camera:CentralWavelength": wavelength}
            write_band(card.path / f"{stem}_MS_{name}.TIF", lead, packet(facts))
    expected = [
        [f"DJI_2025062016000{EVERY_S * n}_{n + 1:04d}_{end}" for end in
         ("D.JPG", "MS_G.TIF", "MS_R.TIF", "MS_RE.TIF", "MS_NIR.TIF")]
        for n in range(3)
    ]  # fmt: skip
    assert card.shots() == expected


def test_bands_without_xmp_are_known_by_their_names(card: Folder) -> None:
    lead = card.photo("A_D.JPG", 0)
    write_band(card.path / "A_MS_RE.TIF", lead)
    assert card.shots() == [["A_D.JPG", "A_MS_RE.TIF"]]
    assert card.read()[1].band == PhotoBand("RE")


def test_a_phantom_4_multispectral_has_a_number_for_each_file(card: Folder) -> None:
    for shot in range(2):
        facts = {"drone-dji:CaptureUUID": f"id-{shot}"}
        lead = card.photo(f"DJI_00{shot}0.JPG", shot, xmp=packet(facts))
        for number, name in enumerate(("Blue", "Green"), start=1):
            band = packet(facts | {"Camera:BandName": name})
            write_band(card.path / f"DJI_00{shot}{number}.TIF", lead, band)
    assert card.shots() == [
        [f"DJI_00{shot}{number}.{end}" for number, end in enumerate(("JPG", "TIF", "TIF"))]
        for shot in range(2)
    ]


def test_micasense_has_bands_alone_and_numbers_that_begin_again(card: Folder) -> None:
    for folder in ("000", "001"):
        for number in range(2):
            later = number + (10 if folder == "001" else 0)
            like = card.photo(f"{folder}/like.JPG", later)
            for band, name in enumerate(("Blue", "Green", "NIR"), start=1):
                facts = packet({"Camera:BandName": name})
                write_band(card.path / f"{folder}/IMG_{number:04d}_{band}.tif", like, facts)
            like.unlink()
    names = [[f"IMG_{number:04d}_{band}.tif" for band in (1, 2, 3)] for number in range(2)]
    assert card.shots() == names * 2


@pytest.mark.parametrize(
    ("visible", "thermal"),
    [
        ("DJI_20250620160000_0001_V.JPG", "DJI_20250620160001_0001_T.JPG"),
        ("DJI_20250620160000_0001_W.JPG", "DJI_20250620160000_0002_T.JPG"),
        ("wide/DJI_0001.JPG", "thermal/DJI_0002.JPG"),
    ],
)
def test_thermal_pairs_by_name_or_by_moment(card: Folder, visible: str, thermal: str) -> None:
    card.photo(visible, 0)
    card.photo(thermal, 0, late_s=1, xmp=THERMAL)
    card.photo(visible.replace("01", "07", 1), 5)
    (pair, _alone) = card.shots()
    assert pair == [Path(visible).name, Path(thermal).name]


def test_a_pair_far_apart_or_late_is_none(card: Folder) -> None:
    card.photo("DJI_0001.JPG", 0)
    card.photo("DJI_0002.JPG", 0, late_s=2, xmp=THERMAL)
    card.photo("DJI_0003.JPG", 0, place_m=(9.0, 0.0), xmp=THERMAL)
    assert card.shots() == [["DJI_0001.JPG"], ["DJI_0003.JPG"], ["DJI_0002.JPG"]]


def test_wide_zoom_and_thermal_are_one_shot(card: Folder) -> None:
    card.photo("DJI_0001_W.JPG", 0)
    card.photo("DJI_0001_T.JPG", 0, size=(640, 512))
    card.photo("DJI_0001_Z.JPG", 0)
    assert card.shots() == [["DJI_0001_W.JPG", "DJI_0001_Z.JPG", "DJI_0001_T.JPG"]]


def test_photos_alone_stay_alone(card: Folder) -> None:
    for number in range(3):
        card.photo(f"DJI_000{number}.JPG", number)
    card.photo("DJI_0001_1.JPG", 1)
    card.photo("DJI_0001_2.JPG", 1)
    assert len(card.shots()) == 5


def test_what_a_band_states_is_read(card: Folder) -> None:
    facts = {
        "Camera:BandName": "Red Edge",
        "Camera:CentralWavelength": "730",
        "Camera:WavelengthFWHM": "16",
        "Camera:BlackCurrent": "3200",
        "Camera:Irradiance": "1234.5",
        "drone-dji:SensorGain": "2.0",
        "drone-dji:ExposureTime": "1250",
        "drone-dji:CaptureUUID": "abc",
    }
    write_band(card.path / "x.TIF", card.photo("like.JPG", 0), packet(facts))
    found = card.read()[-1]
    assert found.band == PhotoBand("RedEdge", 730.0, 16.0, 3200.0, 2.0)
    assert (found.kind, found.capture) == ("band", "abc")
    assert (found.exposure_s, found.irradiance) == (0.00125, 1234.5)


def test_micasenses_sun_sensor_is_of_level_ground_in_si_units(card: Folder) -> None:
    facts = {
        "Camera:HorizontalIrradiance": "80.0",
        "Camera:SpectralIrradiance": "99.0",
        "Camera:IrradianceScaleToSIUnits": "0.01",
    }
    write_band(card.path / "x.TIF", card.photo("like.JPG", 0), packet(facts))
    assert card.read()[-1].irradiance == pytest.approx(0.8)


def test_a_band_cut_off_is_refused(card: Folder) -> None:
    path = write_band(card.path / "x.TIF", card.photo("like.JPG", 0), size=(200, 150))
    data = path.read_bytes()
    for share in (0.2, 0.6, 0.95):
        path.write_bytes(data[: int(share * len(data))])
        with pytest.raises(PhotoError):
            read_photo_facts(path, "x.TIF")


def test_a_real_thermal_photo_is_known(photos_data: Path) -> None:
    for path in sorted((photos_data / "thermal-mavic2").glob("*.JPG"))[:2]:
        assert read_photo_facts(path, path.name).kind == "thermal"
    path = photos_data / "beach-phantom3/DJI_0024.JPG"
    assert read_photo_facts(path, path.name).kind == "visible"
