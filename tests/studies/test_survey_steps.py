"""The pictures of the decisions: what they show is what was decided."""

from studies.survey_decisions import COLOURS, PAPER, flights_under_bands

from studies import survey_steps


def test_the_steps_lead_to_the_mission_that_was_given() -> None:
    flights = flights_under_bands()
    flights.run(survey_steps.FROM_S)
    choice, given = survey_steps.next_choice(flights)
    best = choice.best(choice.share(choice.free()))
    route = choice.long_enough(choice.committed(best))
    assert route == flights.state.flights[given.serial].route
    assert len(best.legs) > len(route)
    drawn = survey_steps.mission_panel(choice, COLOURS[0])
    assert (drawn == COLOURS[0]).all(axis=2).sum() > 300
    assert (drawn[-1] == PAPER).all()


def test_the_other_steps_have_scenes_in_which_they_happen() -> None:
    for panel in (survey_steps.battery_panel, survey_steps.closed_panel):
        assert panel().shape == (survey_steps.HIGH + survey_steps.TEXT_PX, survey_steps.WIDE, 3)
    drawn = survey_steps.replaced_panel()
    assert (drawn == COLOURS[0]).all(axis=2).sum() > 300
    assert (drawn == survey_steps.FADED).all(axis=2).sum() > 300
