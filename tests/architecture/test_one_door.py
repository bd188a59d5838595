"""Only safety makes an approved command, and links send nothing else."""

import ast
import copy
import pickle
from dataclasses import fields, replace

import pytest
from tests.architecture.source import calls, dotted, files, imports, name_of, nodes
from tests.safety.cases import approved, command, situation

from recon.link.session import Session
from recon.link.settings import LinkSettings
from recon.model.command import Hover, LandNow
from recon.safety import ApprovedCommand, approve

GATE = "safety/gate.py"
MAY_KNOW_IT = ("safety", "api", "record", "sim", "guard", "link", "site", "station", "cli")
"""The rooms that the layers let import safety."""


def hold() -> ApprovedCommand:
    return approved(approve(command(Hover()), situation()))


class TestOnlyTheGateMakesOne:
    def test_no_file_but_the_gate_calls_the_class(self) -> None:
        makers = {
            name_of(path)
            for path in files()
            for _, name in calls(path)
            if name.split(".")[-1] == "ApprovedCommand"
        }
        assert makers == {GATE}

    def test_no_file_but_the_gate_knows_its_key(self) -> None:
        for path in files():
            if name_of(path) == GATE:
                continue
            assert not any(module.startswith("recon.safety.gate._") for module in imports(path))
            assert not any(
                dotted(node).endswith("gate._KEY") for node in nodes(path, ast.Attribute)
            )

    def test_no_file_goes_round_the_constructor_or_changes_a_frozen_value(self) -> None:
        tricks = ("object.__new__", "object.__setattr__", "copyreg.__newobj__")
        found = [
            (name_of(path), call.lineno, name)
            for path in files(*MAY_KNOW_IT)
            for call, name in calls(path)
            if name.endswith("ApprovedCommand.__new__") or name in tricks
        ]
        assert found == []

    def test_no_class_inherits_from_it(self) -> None:
        heirs = [
            name_of(path)
            for path in files()
            for node in nodes(path, ast.ClassDef)
            if any(dotted(base).endswith("ApprovedCommand") for base in node.bases)
        ]
        assert heirs == []

    def test_only_the_station_and_its_guard_ask_for_approval(self) -> None:
        askers = {
            name_of(path)
            for path in files()
            for _, name in calls(path)
            if name.split(".")[-1] == "approve"
        }
        assert askers == {"station/control/order_gateway.py", "guard/watch.py"}


class TestOneCannotBecomeAnother:
    def test_constructing_needs_the_key(self) -> None:
        one = hold()
        values = {field.name: getattr(one, field.name) for field in fields(one)}
        with pytest.raises(TypeError, match="only recon"):
            ApprovedCommand(**values, key=object())

    def test_replace_does_not_keep_the_key(self) -> None:
        with pytest.raises(ValueError, match="key"):
            replace(hold(), link_ids=(99,))
        with pytest.raises(TypeError, match="only recon"):
            replace(hold(), command=command(LandNow()), key=None)

    def test_the_key_is_not_to_be_had_from_it(self) -> None:
        one = hold()
        assert not hasattr(one, "key")
        assert not hasattr(one, "__dict__")
        assert "key" not in repr(one)

    def test_copies_and_pickles_are_refused(self) -> None:
        for attempt in (copy.copy, copy.deepcopy, pickle.dumps):
            with pytest.raises(TypeError, match="ask recon"):
                attempt(hold())
        with pytest.raises(TypeError, match="ask recon"):
            hold().__setstate__([])

    def test_one_made_round_the_constructor_is_empty_and_not_sent(self) -> None:
        empty = object.__new__(ApprovedCommand)
        with pytest.raises(AttributeError):
            Session(1, LinkSettings(), 0).submit(empty)

    def test_its_values_are_frozen(self) -> None:
        with pytest.raises(AttributeError):
            hold().link_ids = (2,)  # type: ignore[misc]


class TestLinksSendNothingElse:
    def test_a_session_takes_no_command_that_was_not_approved(self) -> None:
        session = Session(1, LinkSettings(), 0)
        for other in (command(Hover()), Hover(), b"\xda\xa7", None):
            with pytest.raises(TypeError):
                session.submit(other)  # type: ignore[arg-type]
        assert session.next_packet(0) is None

    def test_a_session_takes_no_command_approved_for_another_link(self) -> None:
        with pytest.raises(TypeError, match="approved for links"):
            Session(2, LinkSettings(), 0).submit(hold())

    def test_one_place_of_each_encodes_packets_for_apps(self) -> None:
        encoders = {
            name_of(path)
            for path in files()
            if not name_of(path).startswith("sim/")
            for _, name in calls(path)
            if name in ("encode", "wire.encode", "to_packet")
        }
        assert encoders == {"link/session.py", "guard/process.py"}

    def test_one_line_of_the_link_room_writes_to_a_transport_and_it_writes_outgoing(self) -> None:
        senders = ("send", "sendall", "sendto", "sendmsg", "writelines", "write_eof")
        writes: list[str] = []
        for path in files("link"):
            for node in nodes(path, ast.Call):
                if isinstance(node.func, ast.Attribute):
                    assert node.func.attr not in senders, (path, node.lineno)
                    if node.func.attr == "write":
                        writes.append(f"{name_of(path)}: {ast.unparse(node)}")
        assert writes == ["link/connection.py: self._transport.write(outgoing.data)"]

    def test_outgoing_bytes_are_made_in_the_session_alone(self) -> None:
        makers = {
            name_of(path) for path in files() for _, name in calls(path) if name == "Outgoing"
        }
        assert makers == {"link/session.py"}
