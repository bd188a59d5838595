import { type Accessor, createContext, createMemo, createSignal, useContext } from "solid-js";
import { createFleetView, type FleetView } from "./fleet/fleetView";
import { createSelection, type Selection, selectedVehicles } from "./fleet/selection";
import type { LonLat } from "./map/localGrid";
import { createOverlay, type Overlay } from "./map/overlays";
import { createFlyHere, type FlyHere } from "./orders/flyHere";
import { createDesk, type Desk } from "./orders/orderApi";
import { type Targets, targetsOf } from "./orders/targets";
import type { SurveyView } from "./protocol";
import type { Clock, Instant } from "./source/clock";
import type { StationSource } from "./source/stationSource";
import type { ThemeSwitch } from "./theme/theme";

/** What every part of the page shares. */
export interface Console {
  readonly source: StationSource;
  /** What held buttons are timed by. */
  readonly clock: Clock;
  /** The newest state as a store: a panel's parts change only where the state did. */
  readonly fleet: FleetView;
  readonly selection: Selection;
  /** Whom an order would go to. */
  readonly targets: Accessor<Targets>;
  readonly desk: Desk;
  readonly flyHere: FlyHere;
  readonly overlay: Overlay;
  readonly theme: ThemeSwitch;
  /** Seconds to add to every age of the newest state, growing as one looks. */
  readonly behindS: Accessor<number>;
  readonly fitRequests: Accessor<number>;
  /** Asks the map to show everything. */
  fit(): void;
  /** Aims at what is in the map's middle, for those who move the map by keys. */
  aimAtMiddle(): void;
  /** The map says where its middle is. */
  setMiddle(middle: () => LonLat): void;
}

const FLOWN: readonly SurveyView["phase"][] = ["running", "paused"];

/** Puts the page's shared parts together; `now` ticks as often as ages shall be shown anew. */
export function createConsole(
  source: StationSource,
  theme: ThemeSwitch,
  clock: Clock,
  now: Accessor<Instant>,
): Console {
  const fleet = createFleetView(source);
  const selection = createSelection();
  const [fitRequests, setFitRequests] = createSignal(0);
  const behindS = createMemo(() => {
    source.state();
    return source.behindS(now()) ?? 0;
  });
  const targets = createMemo(() => targetsOf(selectedVehicles(fleet.vehicles, selection)));
  const desk = createDesk(source, clock);
  const alone = createMemo(() => {
    const [only, ...others] = selectedVehicles(fleet.vehicles, selection);
    return only === undefined || only.serial === null || others.length > 0 ? null : only;
  });
  const flyHere = createFlyHere(alone, source, desk, clock);
  let middle: (() => LonLat) | null = null;
  return {
    source,
    clock,
    fleet,
    selection,
    targets,
    desk,
    flyHere,
    overlay: createOverlay(() => fleet.surveys.some(({ phase }) => FLOWN.includes(phase))),
    theme,
    behindS,
    fitRequests,
    fit: () => setFitRequests((count) => count + 1),
    aimAtMiddle: () => {
      if (middle !== null) flyHere.aim(middle());
    },
    setMiddle: (of) => {
      middle = of;
    },
  };
}

const ConsoleContext = createContext<Console>();

export const ConsoleProvider = ConsoleContext.Provider;

/** The shared parts, for a component inside the page. */
export function useConsole(): Console {
  const shared = useContext(ConsoleContext);
  if (shared === undefined) throw new Error("A part of the page was used outside ConsoleProvider.");
  return shared;
}
