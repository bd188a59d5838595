import { createRoot, createSignal, type JSX } from "solid-js";
import { render } from "solid-js/web";
import { type Console, ConsoleProvider, createConsole } from "../console";
import type {
  AuthorityHolder,
  OrderResult,
  PreflightView,
  StationState,
  WordResponse,
} from "../protocol";
import type {
  Connection,
  NamedOrder,
  NewSurvey,
  Outcome,
  StationSource,
} from "../source/stationSource";
import type { ThemeSwitch } from "../theme/theme";
import { FakeClock } from "./fakeClock";

/** A part of the page with a source, a clock and a hand on both. */
export interface RenderedPage {
  readonly root: HTMLElement;
  readonly shared: Console;
  readonly clock: FakeClock;
  readonly orders: NamedOrder[];
  /** Orders whose judgement was asked for. */
  readonly checks: NamedOrder[];
  readonly acknowledged: number[];
  /** Words that are no orders, as they were said. */
  readonly said: Said[];
  readonly allStops: () => number;
  /** From now on every order is answered with this. */
  answerWith(results: readonly OrderResult[]): void;
  /** From now on every word that is no order, and every checklist, is answered with these. */
  answerWordsWith(word: WordResponse): void;
  showPreflight(preflight: PreflightView): void;
  failPreflight(problem: string): void;
  /** From now on a vehicle's picture is brought by this. */
  bringFrames(fetch: StationSource["vehicleFrame"]): void;
  say(state: StationState): void;
  connect(connection: Connection): void;
  /** How old the newest state is from now on. */
  age(behindS: number): void;
  dispose(): void;
}

/** Something said to the station that is no order of a vehicle. */
export type Said =
  | { readonly authority: AuthorityHolder; readonly serial: string }
  | { readonly override: string; readonly serial: string }
  | { readonly dismissed: string }
  | { readonly separationHold: boolean }
  | { readonly fleetReturn: readonly string[] | null }
  | { readonly askedSurvey: NewSurvey }
  | {
      readonly startedSurvey: number;
      readonly serials: readonly string[];
      readonly takeoff: boolean;
    }
  | { readonly stoppedSurvey: number; readonly word: "pause" | "abort" };

/** What the page asked for, and what every order is answered with. */
interface Asked {
  orders: NamedOrder[];
  checks: NamedOrder[];
  acknowledged: number[];
  said: Said[];
  word: WordResponse;
  preflight: Outcome<PreflightView>;
  allStops: number;
  answer: readonly OrderResult[];
  bringFrame: StationSource["vehicleFrame"];
}

const noPicture = async () => ({ kind: "failed", problem: "no picture in this test" }) as const;

const PLAIN_THEME: ThemeSwitch = { theme: () => "auto", changes: () => 0, toggle: () => {} };

/** Renders a part of the page over a source that says `first`. */
export function renderPage(part: () => JSX.Element, first: StationState | null): RenderedPage {
  const clock = new FakeClock();
  const [state, setState] = createSignal<StationState | null>(first, { equals: false });
  const [connection, setConnection] = createSignal<Connection>({ kind: "live" });
  const [now, setNow] = createSignal(clock.now());
  const asked: Asked = {
    orders: [],
    checks: [],
    acknowledged: [],
    said: [],
    word: { accepted: true, rule: null, reason: null },
    preflight: { kind: "failed", problem: "no checklist in this test" },
    allStops: 0,
    answer: [],
    bringFrame: noPicture,
  };
  let behindS = 0;
  const source = fakeSource(state, connection, () => behindS, asked);
  const { shared, disposeShared } = createRoot((disposeShared) => ({
    shared: createConsole(source, PLAIN_THEME, clock, now),
    disposeShared,
  }));
  const root = document.createElement("div");
  document.body.append(root);
  const unmount = render(() => <ConsoleProvider value={shared}>{part()}</ConsoleProvider>, root);
  return {
    root,
    shared,
    clock,
    orders: asked.orders,
    checks: asked.checks,
    acknowledged: asked.acknowledged,
    said: asked.said,
    allStops: () => asked.allStops,
    answerWith: (results) => {
      asked.answer = results;
    },
    answerWordsWith: (word) => {
      asked.word = word;
    },
    showPreflight: (value) => {
      asked.preflight = { kind: "answered", value };
    },
    failPreflight: (problem) => {
      asked.preflight = { kind: "failed", problem };
    },
    bringFrames: (fetch) => {
      asked.bringFrame = fetch;
    },
    say: setState,
    connect: setConnection,
    age: (seconds) => {
      behindS = seconds;
      clock.advance(1);
      setNow(clock.now());
    },
    dispose: () => {
      unmount();
      disposeShared();
      root.remove();
    },
  };
}

function fakeSource(
  state: StationSource["state"],
  connection: StationSource["connection"],
  behindS: () => number,
  asked: Asked,
): StationSource {
  return {
    state,
    connection,
    behindS,
    order: async (order) => {
      asked.orders.push(order);
      return { kind: "answered", value: asked.answer };
    },
    allStop: async () => {
      asked.allStops += 1;
      return { kind: "answered", value: [] };
    },
    check: async (order) => {
      asked.checks.push(order);
      return { kind: "answered", value: asked.answer };
    },
    fleetReturn: async (serials) => {
      asked.said.push({ fleetReturn: serials });
      return { kind: "answered", value: asked.answer };
    },
    takeAuthority: async (serial, authority) => {
      asked.said.push({ authority, serial });
      return { kind: "answered", value: asked.word };
    },
    preflight: async () => asked.preflight,
    overridePreflight: async (serial, override) => {
      asked.said.push({ override, serial });
      return { kind: "answered", value: asked.word };
    },
    dismissHazard: async (dismissed) => {
      asked.said.push({ dismissed });
      return { kind: "answered", value: null };
    },
    switchSeparationHold: async (separationHold) => {
      asked.said.push({ separationHold });
      return { kind: "answered", value: null };
    },
    acknowledge: async (id) => {
      asked.acknowledged.push(id);
      return { kind: "answered", value: null };
    },
    vehicleFrame: (serial, frameId) => asked.bringFrame(serial, frameId),
    groundImage: noPicture,
    groundImageFile: noPicture,
    askSurvey: async (askedSurvey) => {
      asked.said.push({ askedSurvey });
      return { kind: "answered", value: { ...asked.word, survey: null } };
    },
    startSurvey: async (startedSurvey, serials, takeoff) => {
      asked.said.push({ startedSurvey, serials, takeoff });
      return { kind: "answered", value: { ...asked.word, survey: null } };
    },
    stopSurvey: async (stoppedSurvey, word) => {
      asked.said.push({ stoppedSurvey, word });
      return { kind: "answered", value: { ...asked.word, survey: null } };
    },
    surveyWays: noPicture,
    surveyCells: noPicture,
    shadePicture: noPicture,
    forecastPicture: noPicture,
    close: () => {},
  };
}

/** The element a test is about; a missing one ends the test with the selector in its message. */
export function find<E extends Element = HTMLElement>(root: ParentNode, selector: string): E {
  const element = root.querySelector<E>(selector);
  if (element === null) throw new Error(`Nothing on the page matches ${selector}.`);
  return element;
}
