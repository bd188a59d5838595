"""Light sensors are shown and recorded: no order, rule, survey or failsafe reads them."""

import ast

from tests.architecture.source import files, imports, name_of, nodes

READERS = {
    "station/api_views/light_sensor_views.py",
    "station/imaging/light_sensors.py",
}
IMPORTERS = READERS | {"station/state/station.py"}
STATE = "recon.station.state.light_sensors"


def test_only_the_view_and_the_writer_read_them() -> None:
    readers = {
        name_of(path)
        for path in files("station", "safety", "guidance", "fleet", "link", "guard", "score")
        for node in nodes(path, ast.Attribute)
        if node.attr == "light_sensors" and not ast.unparse(node.value).endswith("config")
    }
    names = {name for name in readers if name != "station/kernel/step.py"}
    assert names == READERS
    importers = {
        name_of(path) for path in files() if any(name.startswith(STATE) for name in imports(path))
    }
    assert importers == IMPORTERS


def test_the_step_only_hands_them_to_their_room() -> None:
    (step,) = files("station/kernel/step.py")
    used = {
        ast.unparse(node)
        for node in nodes(step, ast.Attribute)
        if "light_sensors" in ast.unparse(node)
    }
    assert used == {"light_sensors.compare", "light_sensors.on_light_read"}
