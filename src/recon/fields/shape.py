"""Shapes as a file holds them, before they are tidied."""

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from typing import Literal

Position = tuple[float, float]
"""Longitude and latitude in degrees of WGS84."""
Kind = Literal["polygon", "path", "point"]
Attributes = dict[str, str | float]
"""Of a site's layer: heights with their datum, notes."""


class FieldFileError(Exception):
    """What is wrong with a file, as the end of a sentence that begins with its name."""


@dataclass(frozen=True, slots=True)
class Shape:
    """A polygon as its outline and holes, each closed or not, a path or a point as one list."""

    name: str
    kind: Kind
    rings: list[list[Position]]
    feature: int
    """Shapes of one number are parts of one."""
    layer: str | None = None
    """The site's layer that it is by its file, where that says so."""
    attributes: Attributes = field(default_factory=dict)


@dataclass(slots=True)
class Found:
    """What a reader found: shapes, and what it cannot use, by name and reason."""

    shapes: list[Shape] = field(default_factory=list)
    excluded: list[tuple[str, str]] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)
    is_fit_for_fences: bool = True
    has_open_paths: bool = False
    """Whether paths are excluded that would be areas if they were closed."""
    feature: int = 0

    def begin_feature(self) -> None:
        """Begin the next of the file's features: what is added until then are its parts."""
        self.feature += 1

    def add(
        self,
        name: str,
        kind: Kind,
        rings: Iterable[list[Position]],
        layer: str | None = None,
        attributes: Attributes | None = None,
    ) -> None:
        """Take a shape."""
        shape = Shape(name, kind, list(rings), self.feature, layer, attributes or {})
        self.shapes.append(shape)

    def exclude(self, name: str, reason: str) -> None:
        """Name what is left out, and why."""
        self.excluded.append((name, reason))

    def extend(self, other: "Found") -> None:
        """Take all that another reader found."""
        self.shapes += (replace(each, feature=each.feature + self.feature) for each in other.shapes)
        self.feature += other.feature
        self.excluded += other.excluded
        self.warnings += other.warnings
        self.is_fit_for_fences = self.is_fit_for_fences and other.is_fit_for_fences
