"""The line between station and guard."""

from hypothesis import given
from hypothesis import strategies as st

from recon.guard import messages
from recon.guard.messages import Lines, LinkPicture
from recon.guard.watch import Intervention
from recon.model.units import NS_PER_S

NOW_NS = 50 * NS_PER_S
TEXTS = st.text(max_size=40)
BELIEFS = st.sampled_from([True, False, None])
PICTURES = st.builds(
    LinkPicture,
    link_id=st.integers(1, 10_000),
    serial=TEXTS | st.none(),
    name=TEXTS,
    is_flying=BELIEFS,
    reported_is_flying=BELIEFS,
    age_s=st.floats(0.0, 1e6) | st.none(),
    is_steered=st.booleans(),
)


@given(st.lists(PICTURES, max_size=5, unique_by=lambda picture: picture.link_id))
def test_a_picture_arrives_as_it_was_sent(pictures: list[LinkPicture]) -> None:
    (message,) = Lines().feed(messages.picture_line(pictures))
    links = messages.picture_of(message, NOW_NS).links
    assert list(links) == [picture.link_id for picture in pictures]
    for picture in pictures:
        watched = links[picture.link_id]
        assert (watched.name, watched.is_steered) == (picture.name, picture.is_steered)
        vehicle = watched.vehicle
        assert (vehicle.serial, vehicle.link_id) == (picture.serial, picture.link_id)
        assert vehicle.is_flying.value is picture.is_flying
        assert vehicle.reported_is_flying.value is picture.reported_is_flying
        received_ns = vehicle.is_flying.received_at_ns
        if picture.age_s is None:
            assert received_ns is None
        else:
            assert received_ns == NOW_NS - round(picture.age_s * NS_PER_S)


@given(
    st.builds(
        Intervention,
        why=TEXTS,
        serials=st.lists(TEXTS, max_size=3).map(tuple),
        names=st.lists(TEXTS, max_size=3).map(tuple),
        refused=st.lists(TEXTS, max_size=3).map(tuple),
        by=TEXTS | st.none(),
    )
)
def test_an_act_arrives_as_it_was_sent(intervention: Intervention) -> None:
    (message,) = Lines().feed(messages.intervention_line(intervention))
    assert message["is"] == messages.INTERVENED
    assert messages.intervention_of(message) == intervention


@given(st.lists(st.integers(1, 9), min_size=1, max_size=6), st.data())
def test_lines_come_whole_however_their_bytes_are_split(
    links: list[int], data: st.DataObject
) -> None:
    sent = b"".join(messages.closed_line(link) for link in links)
    lines, found = Lines(), []
    while sent:
        size = data.draw(st.integers(1, len(sent)))
        found += [message["link"] for message in lines.feed(sent[:size])]
        sent = sent[size:]
    assert found == links
