import {
  type Accessor,
  createContext,
  createEffect,
  createMemo,
  createSignal,
  on,
  useContext,
} from "solid-js";
import { activeSurveys } from "./fleet/activity";
import { createFleetView, type FleetView } from "./fleet/fleetView";
import { createSelection, type Selection, selectedVehicles } from "./fleet/selection";
import { type BaseMaps, createBaseMaps, type Kept } from "./map/baseMaps";
import type { LonLat } from "./map/localGrid";
import { createOverlay, type Overlay } from "./map/overlays";
import { createFlyHere, type FlyHere } from "./orders/flyHere";
import { createMissionDraft, type MissionDraft } from "./orders/missionDraft";
import { createOrderApi, type OrderApi } from "./orders/orderApi";
import { type Targets, targetsOf } from "./orders/targets";
import { createZoneDraft, type ZoneDraft } from "./orders/zoneDraft";
import { createLargeCamera, type LargeCamera } from "./panels/cameras/largeCamera";
import type { OpenPanels } from "./panels/openPanels";
import type { ReplayView, Role } from "./protocol";
import { type Calibration, createCalibration } from "./site/calibration";
import { createSiteDraft, type SiteDraft } from "./site/siteDraft";
import { createVehicleTable, type VehicleTable } from "./site/vehicleTable";
import { type AlarmSound, createAlarmSound } from "./sound/alarmSound";
import type { Notifier } from "./sound/attention";
import type { Mutes } from "./sound/mutes";
import type { Speaker } from "./sound/speaker";
import type { Clock, Instant } from "./source/clock";
import { lacking } from "./source/roles";
import type { StationSource } from "./source/stationSource";
import { text } from "./text/catalogue";
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

const NOTHING_KEPT: Kept = { getItem: () => null, setItem: () => {} };

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
  readonly missionDraft: MissionDraft;
  readonly zoneDraft: ZoneDraft;
  readonly siteDraft: SiteDraft;
  readonly vehicleTable: VehicleTable;
  readonly calibration: Calibration;
  readonly overlay: Overlay;
  readonly baseMaps: BaseMaps;
  readonly theme: ThemeSwitch;
  readonly panels: OpenPanels;
  readonly largeCamera: LargeCamera;
  readonly alarmSound: AlarmSound;
  /** What this browser keeps. */
  readonly kept: Kept;
  readonly login: Login;
  /** Where a replay stands; null on a live station. */
  readonly replay: Accessor<ReplayView | null>;
  /** Whether this is a replay; changes only when that does. */
  readonly isReplay: Accessor<boolean>;
  /** Why this person cannot do what needs a role; null when nothing is in the way. */
  lacks(needed: Role): string | null;
  /** Whether the page is locked against stray touches. */
  readonly lock: { readonly isOn: Accessor<boolean>; set(isOn: boolean): void };
  /** Seconds to add to every age in the newest state; grows until the next state. */
  readonly behindS: Accessor<number>;
  readonly fitRequests: Accessor<number>;
  /** Zooms the map to show everything. */
  fit(): void;
  /** A press on the map: a place for the zone or mission being drawn, or the fly-here target. */
  aim(at: LonLat): void;
  /** The same at the map centre, for operators using the keyboard. */
  aimAtCentre(): void;
  /** The middle of the map's free part, and how wide that is; null before there is a map. */
  mapCentre(): MapCentre | null;
  /** Registers a function that returns the map centre. */
  setMapCentre(centre: () => MapCentre): void;
}

/** A place on the map, with the width around it that is in view, metres. */
export interface MapCentre extends LonLat {
  readonly width_m: number;
}

/** Creates the shared parts; `now` changes as often as displayed ages are refreshed. */
export function createConsole(
  source: StationSource,
  theme: ThemeSwitch,
  clock: Clock,
  now: Accessor<Instant>,
  panels: OpenPanels,
  sound: { readonly mutes: Mutes; readonly speaker: Speaker; readonly notifier: Notifier },
  login: Login = NO_LOGIN,
  kept: Kept = NOTHING_KEPT,
): Console {
  const fleet = createFleetView(source);
  const selection = createSelection();
  const [fitRequests, setFitRequests] = createSignal(0);
  const [isLocked, setLocked] = createSignal(false);
  const behindS = createMemo(() => {
    source.state();
    return source.behindS(now()) ?? 0;
  });
  const targets = createMemo(() => targetsOf(selectedVehicles(fleet.vehicles, selection)));
  const orderApi = createOrderApi(source.orders, clock);
  const single = createMemo(() => {
    const [only, ...others] = selectedVehicles(fleet.vehicles, selection);
    return only === undefined || only.serial === null || others.length > 0 ? null : only;
  });
  const flyHere = createFlyHere(single, source.orders, orderApi, clock);
  const missionDraft = createMissionDraft(single, source.orders, orderApi, clock);
  const zoneDraft = createZoneDraft();
  const siteDraft = createSiteDraft(
    source.site,
    clock,
    () => fleet.site?.ground_altitude_m ?? null,
  );
  const vehicleTable = createVehicleTable(source.site, clock);
  const calibration = createCalibration(source.site, clock);
  createEffect(
    on([vehicleTable.saves, calibration.saves], () => void siteDraft.refresh(), { defer: true }),
  );
  createEffect(
    on([siteDraft.saves, calibration.saves], () => void vehicleTable.refresh(), { defer: true }),
  );
  // A press on the map means one thing at a time.
  const modes = [
    { isOn: flyHere.isOn, leave: () => flyHere.isOn() && flyHere.toggle() },
    missionDraft,
    zoneDraft,
    siteDraft,
    calibration,
  ];
  for (const mode of modes) {
    createEffect(
      on(mode.isOn, (isOn) => {
        if (isOn) for (const other of modes) if (other !== mode) other.leave();
      }),
    );
  }
  const replay = () => source.state()?.replay ?? null;
  const isReplay = createMemo(() => replay() !== null);
  const aim = (at: LonLat) => {
    if (calibration.isOn()) calibration.aim(at);
    else if (!siteDraft.isOn())
      ([zoneDraft, missionDraft].find(({ isOn }) => isOn()) ?? flyHere).aim(at);
  };
  // A draft may be saved when the last vehicle has landed, and no more when one takes off.
  const inTheAir = createMemo(
    () => fleet.vehicles.filter(({ is_flying }) => is_flying.value !== false).length,
  );
  createEffect(on(inTheAir, () => siteDraft.recheck(), { defer: true }));
  let centre: (() => MapCentre) | null = null;
  return {
    source,
    clock,
    fleet,
    selection,
    targets,
    orderApi,
    flyHere,
    missionDraft,
    zoneDraft,
    siteDraft,
    vehicleTable,
    calibration,
    overlay: createOverlay(() => activeSurveys(fleet.surveys).length > 0),
    baseMaps: createBaseMaps(source, kept),
    kept,
    theme,
    panels,
    largeCamera: createLargeCamera(),
    alarmSound: createAlarmSound(source, isReplay, now, sound.mutes, sound.speaker, sound.notifier),
    login,
    replay,
    isReplay,
    lacks: (needed) => (isReplay() ? text.page.noOrdersInReplay : lacking(source.person(), needed)),
    // A replay has no orders to guard.
    lock: { isOn: () => isLocked() && !isReplay(), set: setLocked },
    behindS,
    fitRequests,
    fit: () => setFitRequests((count) => count + 1),
    aim,
    aimAtCentre: () => {
      if (centre !== null) aim(centre());
    },
    mapCentre: () => centre?.() ?? null,
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
