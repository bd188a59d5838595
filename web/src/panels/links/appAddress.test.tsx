import { afterEach, expect, it } from "vitest";
import { station, vehicle } from "../../testing/fakeState";
import { type RenderedPage, renderPage } from "../../testing/renderPage";
import { VehicleList } from "../vehicles/VehicleList";
import { AppAddress } from "./AppAddress";

let page: RenderedPage;
afterEach(() => page.dispose());

function reached(
  vehicles: Parameters<typeof station>[0] = [],
  link_addresses = ["192.168.8.20:3001"],
) {
  const state = station(vehicles);
  const app_url = `recon://${link_addresses[0]}`;
  return { ...state, station: { ...state.station, app_url, link_addresses } };
}

it("shows the address as it is typed, only if phones reach it", () => {
  page = renderPage(() => <AppAddress />, station([]));
  expect(page.root.textContent).toBe("");
  page.receive(reached());
  expect(page.root.textContent).toContain("192.168.8.20:3001");
  expect(page.root.textContent).not.toContain("recon://");
});

it("shows every address of a computer in two networks, and which one the code has", () => {
  page = renderPage(() => <AppAddress />, reached([], ["192.168.8.20:3001", "10.0.0.7:3001"]));
  expect(page.root.textContent).toContain("10.0.0.7:3001");
  expect(page.root.textContent).toContain("scan the first one");
});

it("is in the list of vehicles until the first one is there", () => {
  page = renderPage(() => <VehicleList />, reached());
  expect(page.root.textContent).toContain("Connect a companion app");
  page.receive(reached([vehicle(1)]));
  expect(page.root.textContent).not.toContain("Connect a companion app");
});
