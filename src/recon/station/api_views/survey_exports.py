"""A planned survey's flights as files for other programs; nothing changes at the station."""

from dataclasses import dataclass
from datetime import UTC, datetime
from functools import cached_property

from recon.api import schema
from recon.model.command import Refusal
from recon.plans.aircraft import AIRCRAFT, PAYLOADS, aircraft_named
from recon.plans.features import FormatName
from recon.plans.flight_plan import ExportedPlan, PlanExportError
from recon.plans.formats import FORMATS, ExportedPlans, FileFacts, exported
from recon.plans.from_survey import flight_plans
from recon.plans.kmz import zip_of
from recon.station.api_views.survey_preview import PreviewedFleet

ONE, SEVERAL = "application/octet-stream", "application/zip"


@dataclass(frozen=True, slots=True)
class PlanFile:
    """A file to download."""

    name: str
    data: bytes
    media_type: str


@dataclass(frozen=True, eq=False)
class SurveyExports:
    """Writes a survey's flights; safe on any thread, tens of milliseconds."""

    known: PreviewedFleet

    @cached_property
    def flights(self) -> list[ExportedPlan]:
        """The flights of all vehicles. Raises `PlanExportError` where no battery lasts."""
        known = self.known
        needs = known.needs()
        if isinstance(needs, Refusal):
            raise PlanExportError(needs.reason)
        return flight_plans(known.plan, needs, known.fleet, known.names)

    def view(self, aircraft: str | None, payload: str | None) -> schema.PlanExportsView:
        """Return each format with what the pilot sets by hand, or why it has no file."""
        return schema.PlanExportsView(
            survey_id=self.known.plan.survey.id,
            formats=[self._format(name, aircraft, payload) for name in FormatName],
            aircraft=[
                schema.PlanAircraftView(
                    name=name, payloads=list(PAYLOADS) if each.takes_payloads else []
                )
                for name, each in AIRCRAFT.items()
            ],
        )

    def file(self, kind: str, aircraft: str | None, payload: str | None) -> PlanFile:
        """Return the flights in a format, in an archive if they are several files.

        Raises `PlanExportError` with what the format cannot hold.
        """
        made = self._made(FormatName(f".{kind}"), aircraft, payload)
        if len(made.files) == 1:
            ((name, data),) = made.files.items()
            return PlanFile(name, data, ONE)
        return PlanFile(f"{self._stem}.{kind}.zip", zip_of(dict(made.files)), SEVERAL)

    def _format(
        self, name: FormatName, aircraft: str | None, payload: str | None
    ) -> schema.PlanFormatView:
        kind, title = name.value[1:], FORMATS[name].title
        try:
            made = self._made(name, aircraft, payload)
        except PlanExportError as problem:
            return schema.PlanFormatView(
                kind=kind, title=title, files=0, by_hand=[], refusal=str(problem)
            )
        by_hand = list(made.by_hand)
        return schema.PlanFormatView(
            kind=kind, title=title, files=len(made.files), by_hand=by_hand, refusal=None
        )

    def _made(self, name: FormatName, aircraft: str | None, payload: str | None) -> ExportedPlans:
        model = aircraft_named(aircraft, payload) if name is FormatName.WPML else None
        created_ms = round(1_000.0 * datetime.now(UTC).timestamp())
        return exported(name, self.flights, self._stem, FileFacts(created_ms, model))

    @property
    def _stem(self) -> str:
        """Of the files' names: the survey's number, since its name may be in any script."""
        return f"survey-{self.known.plan.survey.id}"
