"""Shapes of a file, chosen by name."""

from collections.abc import Sequence
from pathlib import Path

from recon.fields.field_file import Imported, ImportedFeature
from recon.model.errors import SiteError
from recon.model.names import did_you_mean, first_names

MOST_LISTED = 20


def shown_name(feature: ImportedFeature, number: int) -> str:
    """Return a shape's name, or its number in the file where it has none."""
    return feature.name or f"feature {number}"


def chosen_features(
    path: Path, found: Imported, names: Sequence[str] | None
) -> tuple[ImportedFeature, ...]:
    """Return the shapes of these names, in any case of letters; all without names.

    Raises `SiteError` for a name that the file does not have.
    """
    if not names:
        return found.features
    by_name = {
        shown_name(feature, number).casefold(): feature
        for number, feature in enumerate(found.features, start=1)
    }
    chosen = []
    for name in names:
        if name.casefold() not in by_name:
            raise SiteError(
                f"{path}: expected a feature named {name!a}, got none{_near(name, found)}"
            )
        chosen.append(by_name[name.casefold()])
    return tuple(chosen)


def listed(found: Imported, features: Sequence[ImportedFeature]) -> str:
    """Return the names of shapes for an error, the first of many."""
    numbers = {id(feature): number for number, feature in enumerate(found.features, start=1)}
    return first_names(
        [ascii(shown_name(each, numbers[id(each)])) for each in features], MOST_LISTED
    )


def _near(name: str, found: Imported) -> str:
    hint = did_you_mean(name, (each.name for each in found.features if each.name), most=3)
    return hint or f"; features: {listed(found, found.features)}"
