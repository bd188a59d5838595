"""Lines of the commands on photos: what they say is taken, and no line breaks the job."""

import json

from hypothesis import given, settings
from hypothesis import strategies as st
from tests.examples import examples

from recon.station.host.json_lines import LINE_MARK
from recon.station.host.photo_progress import FACTS, STEPS, after_line, begun, marked, running

JOB = marked(begun("flight-1", ["/card"], "/out"), STEPS[0], "running")
json_values = st.recursive(
    st.none() | st.booleans() | st.floats() | st.text(max_size=9),
    lambda values: st.lists(values, max_size=3) | st.dictionaries(st.text(max_size=9), values),
    max_leaves=9,
)
facts = st.dictionaries(st.sampled_from(sorted(FACTS)) | st.text(max_size=9), json_values)


@given(st.text() | facts.map(lambda told: LINE_MARK + json.dumps(told)))
@settings(max_examples=examples(300))
def test_no_line_breaks_the_job(line: str) -> None:
    job = after_line(JOB, line)
    assert job.model_validate(job.model_dump()) == job
    assert running(job) in STEPS


def test_a_warning_is_kept_once() -> None:
    job = JOB
    for _ in range(2):
        job = after_line(job, "warning: the clock is off")
    assert job.warnings == ["the clock is off"]
