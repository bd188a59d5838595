"""A station and a simulated drone in virtual time: the phases of an order, without waiting.

Run: uv run python examples/02_hover_in_virtual_time.py
"""

from recon.model.command import Hover
from recon.model.event import OperatorOrder
from recon.model.geo import GeoPoint
from recon.sim.fleet import Airborne, SimulationConfig, build_fleet
from recon.site import default_site
from recon.station.kernel.build import first_state
from recon.station.kernel.virtual import VirtualDriver

HOME = GeoPoint(41.9012, -93.6034, 275.0)


def main() -> None:
    """Command a flying drone to hover and print the order's phases."""
    driver = VirtualDriver(first_state(default_site()))
    config = SimulationConfig(home=HOME, vehicle_count=1, airborne=Airborne.ALL, wanders=True)
    for app in build_fleet(config, start_ns=driver.now_ns):
        app.connected(driver.now_ns)
        driver.connect(app)
    driver.run_for(5.0)

    order = OperatorOrder(command_id=1, body=Hover(), issued_by="example", serial="SIM-1")
    driver.handle(order)
    driver.run_for(10.0)

    record = driver.station.orders.records[1]
    for change in record.history:
        print(f"{change.at_ns / 1e9:6.2f} s  {change.phase.value:12}  {change.note}")


if __name__ == "__main__":
    main()
