"""The site's layers as a person draws them, and files of them to import."""

import asyncio
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from recon.api import schema
from recon.fields.field_file import OnlyPathsError, read_import
from recon.model.airspace import SiteLayer
from recon.model.errors import ReconError
from recon.model.person import Person
from recon.site.drawing import (
    DrawnFeature,
    DrawnFeatureError,
    StagedSite,
    read_drawing,
    stage_drawing,
)
from recon.station.api_views import outcome_of
from recon.station.api_views.edited_site import EditedSite, SiteChange, site_refusal

IMPORT_IS_BUSY = "Another file is being read; try again when it is done"


@dataclass(slots=True)
class FileImports:
    """Files to import, one at a time: each takes a process with memory of its own."""

    _reading: asyncio.Lock = field(default_factory=asyncio.Lock)

    async def read(self, name: str, data: bytes, *, close_paths: bool) -> schema.ImportedView:
        """Return the polygons and points of a file, or why it is refused."""
        if self._reading.locked():
            return _refused(IMPORT_IS_BUSY)
        try:
            async with self._reading:
                found = await asyncio.to_thread(read_import, name, data, close_paths=close_paths)
        except ReconError as problem:
            return _refused(str(problem), has_open_paths=isinstance(problem, OnlyPathsError))
        features = [
            schema.ImportedFeatureView(
                name=each.name,
                geometry=schema.DrawnGeometry.model_validate(each.geometry),
                layer=None if each.layer is None else SiteLayer(each.layer),
                properties=dict(each.attributes),
            )
            for each in found.features
        ]
        return schema.ImportedView(
            features=features,
            excluded=[str(each) for each in found.excluded],
            warnings=list(found.warnings),
            is_fit_for_fences=found.is_fit_for_fences,
            has_open_paths=found.has_open_paths,
            reason=None,
        )


def _refused(reason: str, *, has_open_paths: bool = False) -> schema.ImportedView:
    return schema.ImportedView(
        features=[],
        excluded=[],
        warnings=[],
        is_fit_for_fences=True,
        has_open_paths=has_open_paths,
        reason=reason,
    )


@dataclass(slots=True)
class SiteService:
    """The drawing of a site; an undo takes back the newest change of any kind."""

    edited: EditedSite
    _imports: FileImports = field(default_factory=FileImports)

    async def drawing(self) -> schema.SiteDrawingView:
        """Return the layers in the folder."""
        async with self.edited.turn:
            return await self._view()

    async def save(
        self, asked: schema.SiteDrawingRequest, by: Person, *, is_check: bool
    ) -> schema.SiteDrawingResponse:
        """Check a drawing; then save it and bring it into force, unless it is only checked."""
        features = [_feature(each) for each in asked.features]

        def stage(folder: Path) -> StagedSite:
            return stage_drawing(folder, features)

        async with self.edited.turn:
            try:
                change = await self.edited.change(asked.revision, stage, by, is_check=is_check)
            except DrawnFeatureError as problem:
                change = SiteChange(refusal=site_refusal(str(problem)))
                return _answer(change, feature=problem.index)
            is_saved = change.refusal is None and not is_check
            return _answer(change, drawing=await self._view() if is_saved else None)

    async def undo(self, revision: str, by: Person) -> schema.SiteDrawingResponse:
        """Take back the newest change."""
        async with self.edited.turn:
            change = await self.edited.undo(revision, by)
            drawing = await self._view() if change.refusal is None else None
        return _answer(change, drawing=drawing)

    async def import_features(
        self, name: str, data: bytes, *, close_paths: bool
    ) -> schema.ImportedView:
        """Return the polygons and points of a file, or why it is refused."""
        return await self._imports.read(name, data, close_paths=close_paths)

    async def _view(self) -> schema.SiteDrawingView:
        read = await self.edited.read(read_drawing)
        return schema.SiteDrawingView(
            revision=read.revision,
            features=[feature_view(each) for each in read.found],
            locked_reason=read.locked_reason,
            undo=read.undo,
        )


def _feature(view: schema.DrawnFeatureView) -> DrawnFeature:
    geometry: dict[str, Any] = view.geometry.model_dump()
    return DrawnFeature(view.layer, geometry, view.properties)


def feature_view(feature: DrawnFeature) -> schema.DrawnFeatureView:
    """Return a feature as the API shows it."""
    return schema.DrawnFeatureView(
        layer=feature.layer,
        geometry=schema.DrawnGeometry.model_validate(feature.geometry),
        properties=dict(feature.properties),
    )


def _answer(
    change: SiteChange,
    *,
    feature: int | None = None,
    drawing: schema.SiteDrawingView | None = None,
) -> schema.SiteDrawingResponse:
    return schema.SiteDrawingResponse(
        **outcome_of(change.refusal),
        feature=feature,
        layers=list(change.layers),
        also=[] if drawing is None else list(change.also),
        drawing=drawing,
    )
