import { type Accessor, createContext, useContext } from "solid-js";
import type { Clock, Instant } from "../source/clock";
import type { StationSource } from "../source/stationSource";
import { createMapPart, type MapPart } from "./mapModes";
import { createOrderPart, type OrderPart } from "./orders";
import { type Browser, createPagePart, type PagePart } from "./page";
import { createSiteEditingPart, type SiteEditingPart } from "./siteEditing";
import { createStationPart, type StationPart } from "./station";

export type { MapCentre } from "./mapModes";
export type { Login } from "./page";

/** State and services shared by the page, in parts: a component takes the parts it needs. */
export type Console = StationPart & OrderPart & SiteEditingPart & MapPart & PagePart;

/** Creates the shared parts; `now` changes as often as displayed ages are refreshed. */
export function createConsole(
  source: StationSource,
  clock: Clock,
  now: Accessor<Instant>,
  browser: Browser,
): Console {
  const station = createStationPart(source, clock, now);
  const orders = createOrderPart(station);
  const editing = createSiteEditingPart(station);
  const map = createMapPart(station, orders, editing, browser.kept);
  return { ...station, ...orders, ...editing, ...map, ...createPagePart(station, now, browser) };
}

const ConsoleContext = createContext<Console>();

export const ConsoleProvider = ConsoleContext.Provider;

function shared(): Console {
  const found = useContext(ConsoleContext);
  if (found === undefined) throw new Error("A shared part was used outside ConsoleProvider.");
  return found;
}

// For components inside `ConsoleProvider`.
export const useStation = (): StationPart => shared();
export const useOrders = (): OrderPart => shared();
export const useSiteEditing = (): SiteEditingPart => shared();
export const useMapModes = (): MapPart => shared();
export const usePage = (): PagePart => shared();
