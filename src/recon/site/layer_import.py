"""Shapes of a file as features of one layer; what the layer cannot take is named."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from recon.fields.choice import shown_name
from recon.fields.field_file import Imported, ImportedFeature
from recon.model.airspace import SiteLayer
from recon.model.errors import SiteError
from recon.site.drawing import FENCES, DrawnFeature


@dataclass(frozen=True, slots=True, eq=False)
class LayerImport:
    """Features for a layer, and a sentence for each shape that it cannot take."""

    features: tuple[DrawnFeature, ...]
    excluded: tuple[str, ...]


def layer_import(
    place: str,
    found: Imported,
    chosen: Sequence[ImportedFeature],
    layer: SiteLayer,
    ground_altitude_m: float,
) -> LayerImport:
    """Return shapes as features of a layer; landing pads at the altitude of the site's ground.

    Raises `SiteError`, led by `place`, for fences whose place on the globe is not known, and where
    nothing is left.
    """
    if layer in FENCES and not found.is_fit_for_fences:
        raise SiteError(
            f"{place}: expected coordinates whose place on the globe is known for {layer}, got "
            "others; export the file as WGS84 (EPSG:4326)"
        )
    faults = [_fault(each, layer) for each in chosen]
    excluded = tuple(
        f"{shown_name(each, number)}: {fault}"
        for number, (each, fault) in enumerate(zip(chosen, faults, strict=True), start=1)
        if fault is not None
    )
    features = tuple(
        DrawnFeature(layer, each.geometry, _properties(each, layer, ground_altitude_m))
        for each, fault in zip(chosen, faults, strict=True)
        if fault is None
    )
    if not features:
        wanted = f"{_kind(layer).lower()}s for {layer}"
        raise SiteError(f"{place}: expected {wanted}, got none: {'; '.join(excluded[:5])}")
    return LayerImport(features, excluded)


def _kind(layer: SiteLayer) -> str:
    return "Point" if layer is SiteLayer.LANDING_PADS else "Polygon"


def _fault(shape: ImportedFeature, layer: SiteLayer) -> str | None:
    kind = shape.geometry["type"]
    if kind != _kind(layer):
        return f"a {kind.lower()}, where {layer} takes {_kind(layer).lower()}s"
    if shape.layer not in (None, layer):
        return f"by its file of {shape.layer}: import it with --as {shape.layer}"
    return None


def _properties(
    shape: ImportedFeature, layer: SiteLayer, ground_altitude_m: float
) -> Mapping[str, str | float | None]:
    # A file's heights may count from anywhere: pads stand on the site's ground.
    height = {"altitude_m": ground_altitude_m} if layer is SiteLayer.LANDING_PADS else {}
    own = shape.attributes if shape.layer == layer else {}
    return {"name": shape.name or None, **height, **own}
