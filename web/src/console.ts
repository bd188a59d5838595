import {
  type Accessor,
  createContext,
  createEffect,
  createMemo,
  createSignal,
  untrack,
  useContext,
} from "solid-js";
import { createFleetView, type FleetView } from "./fleet/fleetView";
import { createSelection, type Selection, selectedVehicles } from "./fleet/selection";
import type { LonLat } from "./map/localGrid";
import { createOverlay, type Overlay } from "./map/overlays";
import { createFlyHere, type FlyHere } from "./orders/flyHere";
import { createOrderApi, type OrderApi } from "./orders/orderApi";
import { type Targets, targetsOf } from "./orders/targets";
import { createZoneDraft, type ZoneDraft } from "./orders/zoneDraft";
import type { OpenPanels } from "./panels/openPanels";
import type { SurveyView } from "./protocol";
import type { Clock, Instant } from "./source/clock";
import { lacking, type Role } from "./source/roles";
import type { StationSource } from "./source/stationSource";
import type { ThemeSwitch } from "./theme/theme";

/** The login of this page. */
export interface Login {
  readonly hasToken: boolean;
  /** SHA-256 of the certificate that the page's QR code named; null without one. */
  readonly fingerprint: string | null;
  logIn(token: string): void;
  logOut(): void;
}

const NO_LOGIN: Login = { hasToken: false, fingerprint: null, logIn: () => {}, logOut: () => {} };

/** State and services shared by all parts of the page. */
export interface Console {
  readonly source: StationSource;
  /** Clock for hold-to-confirm buttons. */
  readonly clock: Clock;
  /** The newest state as a store; a panel rerenders only where the state changed. */
  readonly fleet: FleetView;
  readonly selection: Selection;
  /** The vehicles an order would be sent to. */
  readonly targets: Accessor<Targets>;
  readonly orderApi: OrderApi;
  readonly flyHere: FlyHere;
  readonly zoneDraft: ZoneDraft;
  readonly overlay: Overlay;
  readonly theme: ThemeSwitch;
  readonly panels: OpenPanels;
  readonly login: Login;
  /** Why this person cannot do what needs a role; null when nothing is in the way. */
  lacks(needed: Role): string | null;
  /** Seconds to add to every age in the newest state; grows until the next state. */
  readonly behindS: Accessor<number>;
  readonly fitRequests: Accessor<number>;
  /** Zooms the map to show everything. */
  fit(): void;
  /** A press on the map: a place for the zone being drawn, or the fly-here target. */
  aim(at: LonLat): void;
  /** The same at the map centre, for operators using the keyboard. */
  aimAtCentre(): void;
  /** Registers a function that returns the map centre. */
  setMapCentre(centre: () => LonLat): void;
}

const ACTIVE: readonly SurveyView["phase"][] = ["running", "paused"];

/** Creates the shared parts; `now` changes as often as displayed ages are refreshed. */
export function createConsole(
  source: StationSource,
  theme: ThemeSwitch,
  clock: Clock,
  now: Accessor<Instant>,
  panels: OpenPanels,
  login: Login = NO_LOGIN,
): Console {
  const fleet = createFleetView(source);
  const selection = createSelection();
  const [fitRequests, setFitRequests] = createSignal(0);
  const behindS = createMemo(() => {
    source.state();
    return source.behindS(now()) ?? 0;
  });
  const targets = createMemo(() => targetsOf(selectedVehicles(fleet.vehicles, selection)));
  const orderApi = createOrderApi(source, clock);
  const single = createMemo(() => {
    const [only, ...others] = selectedVehicles(fleet.vehicles, selection);
    return only === undefined || only.serial === null || others.length > 0 ? null : only;
  });
  const flyHere = createFlyHere(single, source, orderApi, clock);
  const zoneDraft = createZoneDraft();
  // A press on the map means one thing at a time.
  createEffect(() => {
    if (flyHere.isOn()) zoneDraft.leave();
  });
  createEffect(() => {
    if (zoneDraft.isOn() && untrack(flyHere.isOn)) flyHere.toggle();
  });
  const aim = (at: LonLat) => (zoneDraft.isOn() ? zoneDraft : flyHere).aim(at);
  let centre: (() => LonLat) | null = null;
  return {
    source,
    clock,
    fleet,
    selection,
    targets,
    orderApi,
    flyHere,
    zoneDraft,
    overlay: createOverlay(() => fleet.surveys.some(({ phase }) => ACTIVE.includes(phase))),
    theme,
    panels,
    login,
    lacks: (needed) => lacking(source.person(), needed),
    behindS,
    fitRequests,
    fit: () => setFitRequests((count) => count + 1),
    aim,
    aimAtCentre: () => {
      if (centre !== null) aim(centre());
    },
    setMapCentre: (of) => {
      centre = of;
    },
  };
}

const ConsoleContext = createContext<Console>();

export const ConsoleProvider = ConsoleContext.Provider;

/** The shared parts, for components inside `ConsoleProvider`. */
export function useConsole(): Console {
  const shared = useContext(ConsoleContext);
  if (shared === undefined) throw new Error("useConsole was called outside ConsoleProvider.");
  return shared;
}
