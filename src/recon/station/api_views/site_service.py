"""The site's folder, edited while the station runs: drawings are checked, saved, and in force.

Files are read and written on threads. One change at a time; the event that brings it into force
checks again what may have changed meanwhile, and what it refuses is put back.
"""

import asyncio
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from recon.api import schema
from recon.model.airspace import SiteLayer, layers_text
from recon.model.command import Refusal
from recon.model.errors import ReconError, SiteError
from recon.model.event import SiteRedrawn
from recon.model.person import Person, Role
from recon.record import file_set
from recon.site import Site, demo_site_folder
from recon.site.drawing import (
    FENCES,
    DrawnFeature,
    DrawnFeatureError,
    StagedSite,
    drawing_digest,
    read_drawing,
    stage_drawing,
    stage_files,
)
from recon.site.imports import read_import
from recon.station.api_views import RunningStation
from recon.station.api_views.site_view import site_view
from recon.station.control import site_drawing

NO_FOLDER = (
    "The station was started without a site's folder; make one with recon site new FOLDER and "
    "start with recon run --site FOLDER"
)
IS_DEMO = (
    "The demonstration's site is part of the program; make your own with recon site new FOLDER and "
    "rehearse there with recon demo --site FOLDER"
)
CHANGED_BY_HAND = (
    "site.toml or a layer's file was changed by hand since the start; restart the station to use it"
)
IMPORT_IS_BUSY = "Another file is being read; try again when it is done"
CHANGED_MEANWHILE = "The site was changed meanwhile, perhaps on another screen; load it again"


@dataclass(slots=True)
class SiteService:
    """The site that is in force, and its folder."""

    driver: RunningStation
    site: Site
    folder: Path | None
    _applied: str | None = None
    """The digest of the files that are in force; None before the first reading."""
    _turn: asyncio.Lock = field(default_factory=asyncio.Lock)
    _reading: asyncio.Lock = field(default_factory=asyncio.Lock)
    """Held while a file is imported: each takes a process with memory of its own."""

    def __post_init__(self) -> None:
        # Simplifying outlines with very many corners takes a moment: now, not in flight.
        site_view(self.site)
        if self.folder is not None and self.locked_reason is None:
            self._applied = drawing_digest(self.folder)

    @property
    def locked_reason(self) -> str | None:
        """Why nothing can be saved; None if it can."""
        if self.folder is None:
            return NO_FOLDER
        is_demo = self.folder.resolve() == demo_site_folder().resolve()
        return IS_DEMO if is_demo else None

    async def drawing(self) -> schema.SiteDrawingView:
        """Return the layers in the folder."""
        async with self._turn:
            return await asyncio.to_thread(self._view)

    async def save(
        self, asked: schema.SiteDrawingRequest, by: Person, *, is_check: bool
    ) -> schema.SiteDrawingResponse:
        """Check a drawing; then save it and bring it into force, unless it is only checked."""
        features = [_feature(each) for each in asked.features]

        def stage(folder: Path) -> StagedSite:
            return stage_drawing(folder, features)

        async with self._turn:
            try:
                staged = await self._staged(asked.revision, stage)
            except DrawnFeatureError as problem:
                return _refused(_refusal(str(problem)), feature=problem.index)
            if isinstance(staged, Refusal):
                return _refused(staged)
            event = self._event(staged, by, is_undo=False)
            refusal = self._refusal(event, by)
            if refusal is not None:
                return _refused(refusal, event.layers)
            folder = self.folder
            if not is_check and staged.changed and folder is not None:
                what = layers_text(event.layers)
                refusal = await self._commit(
                    staged,
                    event,
                    write=lambda: _save(folder, staged.files, event, what),
                    put_back=lambda: _undo_last(folder),
                )
                if refusal is not None:
                    return _refused(refusal, event.layers)
            view = None if is_check else await asyncio.to_thread(self._view)
        return _answer(event.layers, drawing=view)

    async def undo(self, revision: str, by: Person) -> schema.SiteDrawingResponse:
        """Take back the newest change."""
        async with self._turn:
            folder = self.folder
            if folder is None or self.locked_reason is not None:
                return _refused(_refusal(self.locked_reason or NO_FOLDER))
            change = await asyncio.to_thread(file_set.last_change, folder)
            if change is None:
                return _refused(_refusal("No change of the site to undo"))

            def stage(folder: Path) -> StagedSite:
                edited = ", ".join(file_set.changed_since(folder, change))
                if edited:
                    raise SiteError(f"{edited} was edited since then; an undo would lose that")
                return stage_files(folder, file_set.files_before(folder, change))

            staged = await self._staged(revision, stage)
            if isinstance(staged, Refusal):
                return _refused(staged)
            event = self._event(staged, by, is_undo=True)
            after = await asyncio.to_thread(_contents, folder, staged.files)
            about = {"what": change.what, "by": change.by, "utc": change.utc}
            refusal = self._refusal(event, by) or await self._commit(
                staged,
                event,
                write=lambda: file_set.undo(folder, change),
                put_back=lambda: file_set.replace_files(folder, after, **about),
            )
            if refusal is not None:
                return _refused(refusal, event.layers)
            view = await asyncio.to_thread(self._view)
        return _answer(event.layers, drawing=view)

    async def import_features(self, name: str, data: bytes) -> schema.ImportedView:
        """Return the polygons and points of a file, or why it is refused."""
        if self._reading.locked():
            return schema.ImportedView(features=[], left_out=0, reason=IMPORT_IS_BUSY)
        try:
            async with self._reading:
                found = await asyncio.to_thread(read_import, name, data)
        except ReconError as problem:
            return schema.ImportedView(features=[], left_out=0, reason=str(problem))
        features = [
            schema.ImportedFeatureView(
                name=each.name, geometry=schema.DrawnGeometry.model_validate(each.geometry)
            )
            for each in found.features
        ]
        return schema.ImportedView(features=features, left_out=found.left_out, reason=None)

    async def _staged(
        self, revision: str, stage: Callable[[Path], StagedSite]
    ) -> StagedSite | Refusal:
        if self.locked_reason is not None or self.folder is None:
            return _refusal(self.locked_reason or NO_FOLDER)
        folder = self.folder
        try:
            on_disk = await asyncio.to_thread(drawing_digest, folder)
            if on_disk != self._applied:
                return _refusal(CHANGED_BY_HAND)
            if on_disk != revision:
                return _refusal(CHANGED_MEANWHILE)
            return await asyncio.to_thread(stage, folder)
        except DrawnFeatureError:
            raise
        except ReconError as problem:
            return _refusal(str(problem))
        except (OSError, ValueError) as problem:
            return _refusal(f"{folder} cannot be read: {problem}")

    def _refusal(self, event: SiteRedrawn, by: Person) -> Refusal | None:
        refusal = site_drawing.refusal(self.driver.station, event, self.driver.now_ns())
        if refusal is None and FENCES & set(event.layers) and not by.role.includes(Role.ADMIN):
            return _refusal(
                f"{by.name} has the role {by.role.value}; boundary, zones and pads need admin"
            )
        return refusal

    async def _commit(
        self,
        staged: StagedSite,
        event: SiteRedrawn,
        *,
        write: Callable[[], None],
        put_back: Callable[[], None],
    ) -> Refusal | None:
        """Write the files and bring them into force; what fails or is refused is put back."""
        folder = self.folder
        assert folder is not None, "a drawing was staged in it"
        try:
            await asyncio.to_thread(write)
        except (OSError, ReconError) as problem:
            return _refusal(f"{folder} cannot be written: {problem}")
        # A drone may have taken off while the disk was busy.
        refusal = site_drawing.refusal(self.driver.station, event, self.driver.now_ns())
        if refusal is not None:
            try:
                await asyncio.to_thread(put_back)
            except (OSError, ReconError) as problem:
                return _refusal(
                    f"{refusal.reason}. It is not in force, but its files could not be taken back "
                    f"({problem}): restore the layers before the next start"
                )
            return refusal
        # Without an await between: the fence in force and the one shown are the same.
        self.driver.handle(event)
        drawn = staged.site
        elevation = self.site.elevation if event.elevation is None else event.elevation
        self.site = replace(
            self.site, layers=drawn.layers, profiles=drawn.profiles, elevation=elevation
        )
        site_view(self.site)
        self._applied = await asyncio.to_thread(drawing_digest, folder)
        return None

    def _event(self, staged: StagedSite, by: Person, *, is_undo: bool) -> SiteRedrawn:
        airspace = staged.site.airspace
        pads = {serial: profile.pad for serial, profile in staged.site.profiles.items()}
        known, read = self.site.elevation, airspace.elevation
        has_other_ground = known is not None and read is not None and known.grid != read.grid
        return SiteRedrawn(
            airspace.boundary,
            airspace.zones,
            airspace.landing_pads,
            pads,
            staged.changed,
            by.label,
            is_undo=is_undo,
            elevation=read if has_other_ground else None,
        )

    def _view(self) -> schema.SiteDrawingView:
        folder, locked = self.folder, self.locked_reason
        if folder is None:
            return schema.SiteDrawingView(revision="", features=[], locked_reason=locked, undo=None)
        try:
            revision = drawing_digest(folder)
            if locked is None and revision != self._applied:
                locked = CHANGED_BY_HAND
            features = [_feature_view(each) for each in read_drawing(folder)]
        except (ReconError, OSError):
            revision, features, locked = "", [], CHANGED_BY_HAND
        change = None if locked else file_set.last_change(folder)
        return schema.SiteDrawingView(
            revision=revision,
            features=features,
            locked_reason=locked,
            undo=None
            if change is None
            else schema.SavedChangeView(what=change.what, by=change.by, utc=change.utc),
        )


def _contents(folder: Path, files: file_set.Files) -> file_set.Files:
    """Return the present contents of some files."""
    paths = {name: folder / name for name in files}
    return {name: path.read_bytes() if path.is_file() else None for name, path in paths.items()}


def _save(folder: Path, files: file_set.Files, event: SiteRedrawn, what: str) -> None:
    utc = datetime.now(UTC).isoformat(timespec="seconds")
    file_set.replace_files(folder, files, what=what, by=event.by, utc=utc)


def _undo_last(folder: Path) -> None:
    change = file_set.last_change(folder)
    if change is not None:
        file_set.undo(folder, change)


def _feature(view: schema.DrawnFeatureView) -> DrawnFeature:
    geometry: dict[str, Any] = view.geometry.model_dump()
    return DrawnFeature(view.layer, geometry, view.properties)


def _feature_view(feature: DrawnFeature) -> schema.DrawnFeatureView:
    return schema.DrawnFeatureView(
        layer=feature.layer,
        geometry=schema.DrawnGeometry.model_validate(feature.geometry),
        properties=dict(feature.properties),
    )


def _refusal(reason: str) -> Refusal:
    return Refusal(site_drawing.RULE, reason)


def _refused(
    refusal: Refusal, layers: tuple[SiteLayer, ...] = (), feature: int | None = None
) -> schema.SiteDrawingResponse:
    return _answer(layers, refusal=refusal, feature=feature)


def _answer(
    layers: tuple[SiteLayer, ...],
    *,
    refusal: Refusal | None = None,
    feature: int | None = None,
    drawing: schema.SiteDrawingView | None = None,
) -> schema.SiteDrawingResponse:
    return schema.SiteDrawingResponse(
        accepted=refusal is None,
        rule=None if refusal is None else refusal.rule,
        reason=None if refusal is None else refusal.reason,
        feature=feature,
        layers=list(layers),
        drawing=drawing,
    )
