"""Surveys: planned by the worker, started by an operator, flown under guidance.

`commands` has what operators may command, `planning` the worker's jobs, `execution` the step on a
tick, `mission_dispatch` how missions become orders, `availability` which vehicles can fly, and
`return_to_home` their route home. Surveys live in memory only: after a restart none continues. What
they have imaged is kept for the next one (`station.recovery.flown_regions`).
"""

from recon.model.event import SurveyRequested, SurveyStarted, SurveyStopped
from recon.station.operations.operation import Operation
from recon.station.operations.survey.audit import survey_entries
from recon.station.operations.survey.commands import start_survey, stop_survey
from recon.station.operations.survey.conditions import conditions
from recon.station.operations.survey.execution import advance, on_position, on_shade
from recon.station.operations.survey.photos import on_photos
from recon.station.operations.survey.planning import request_survey
from recon.station.state.steps import on

SURVEY = Operation(
    name="survey",
    tick=advance,
    conditions=conditions,
    commands=(
        on(SurveyRequested, request_survey),
        on(SurveyStarted, start_survey),
        on(SurveyStopped, stop_survey),
    ),
    audit=survey_entries,
    on_position=on_position,
    on_photos=on_photos,
    on_shade=on_shade,
)
