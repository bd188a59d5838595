"""What tests import leaves the process's event loop as users of the commands have it."""

import asyncio


def test_no_import_has_chosen_another_event_loop() -> None:
    assert type(asyncio.get_event_loop_policy()) is asyncio.DefaultEventLoopPolicy
