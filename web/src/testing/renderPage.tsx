import { createRoot, createSignal, type JSX } from "solid-js";
import { render } from "solid-js/web";
import { type Console, ConsoleProvider, createConsole } from "../console";
import type { ThemeSwitch } from "../look/theme";
import type { OrderResult, StationState } from "../protocol";
import type { Connection, NamedOrder, StationSource } from "../source/stationSource";
import { FakeClock } from "./fakeClock";

/** A part of the page with a source, a clock and a hand on both. */
export interface RenderedPage {
  readonly root: HTMLElement;
  readonly shared: Console;
  readonly clock: FakeClock;
  readonly orders: NamedOrder[];
  readonly acknowledged: number[];
  readonly allStops: () => number;
  /** From now on every order is answered with this. */
  answerWith(results: readonly OrderResult[]): void;
  /** From now on a vehicle's picture is brought by this. */
  bringFrames(fetch: StationSource["vehicleFrame"]): void;
  say(state: StationState): void;
  connect(connection: Connection): void;
  /** How old the newest state is from now on. */
  age(behindS: number): void;
  dispose(): void;
}

/** What the page asked for, and what every order is answered with. */
interface Asked {
  orders: NamedOrder[];
  acknowledged: number[];
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
    acknowledged: [],
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
    acknowledged: asked.acknowledged,
    allStops: () => asked.allStops,
    answerWith: (results) => {
      asked.answer = results;
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
    acknowledge: async (id) => {
      asked.acknowledged.push(id);
      return { kind: "answered", value: null };
    },
    vehicleFrame: (serial, frameId) => asked.bringFrame(serial, frameId),
    groundImage: noPicture,
    groundImageFile: noPicture,
    close: () => {},
  };
}

/** The element a test is about; a missing one ends the test with the selector in its message. */
export function find<E extends Element = HTMLElement>(root: ParentNode, selector: string): E {
  const element = root.querySelector<E>(selector);
  if (element === null) throw new Error(`Nothing on the page matches ${selector}.`);
  return element;
}
