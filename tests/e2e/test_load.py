"""Sixteen apps and an image stream for three seconds, over sockets: nothing is lost."""

import asyncio

from benches.station.measured import Load, measure_station


def test_nothing_is_lost() -> None:
    # An image that is sent in one piece: a sender without a core stalls in the middle of others.
    load = Load(apps=16, streams=1, seconds=3.0, image_rows=90, image_cols=160)
    outcome = asyncio.run(measure_station(load))
    assert outcome.lost == {"core": 0, "extended": 0, "images": 0}
    sent = {kind: outcome.sent.packets[kind] for kind in outcome.lost}
    assert sent == {"core": 480, "extended": 96, "images": 15}


def test_all_stop_reaches_every_app() -> None:
    outcome = asyncio.run(measure_station(Load(apps=16, streams=0, seconds=2.0)))
    assert outcome.ordered == 16
    assert len(outcome.sent.first_command_at_s) == 16
