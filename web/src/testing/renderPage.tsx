import { createRoot, createSignal, type JSX } from "solid-js";
import { render } from "solid-js/web";
import { type Console, ConsoleProvider, createConsole } from "../console";
import { createOpenPanels } from "../panels/openPanels";
import type {
  AccessView,
  ActionResponse,
  BaseMapsView,
  Connection,
  FlightFiguresView,
  FlightView,
  FlownRegionView,
  NamedOrder,
  OrderResult,
  PhotoJobView,
  PreflightView,
  ReplayMarksView,
  StationState,
  SurveyEstimateView,
  SurveyView,
  UpwindPlaceView,
} from "../protocol";
import type { Announcement } from "../sound/announcements";
import { createMutes } from "../sound/mutes";
import type { SoundProblem } from "../sound/speaker";
import type { StationSource } from "../source/stationSource";
import type { ThemeSwitch } from "../theme/theme";
import { FakeClock } from "./fakeClock";
import { surveyEstimate } from "./fakeField";
import type { FakeSite } from "./fakeSite";
import { createFakeStation, type FakeTimeline, fakeSource } from "./fakeStation";
import { answered, failed, type PageRequest } from "./pageRequests";

/** A rendered component with a fake source and clock that the test controls. */
export interface RenderedPage {
  readonly root: HTMLElement;
  readonly shared: Console;
  readonly clock: FakeClock;
  readonly orders: NamedOrder[];
  /** Orders that were checked. */
  readonly checks: NamedOrder[];
  readonly acknowledged: number[];
  /** Requests other than orders. */
  readonly requests: PageRequest[];
  readonly allStops: () => number;
  /** The site's folder behind the page. */
  readonly site: FakeSite;
  /** All entries of the timeline, the newest first, and what was asked for. */
  readonly timeline: FakeTimeline;
  /** Sets the answer to every further order. */
  answerWith(results: readonly OrderResult[]): void;
  /** Sets the answer to every further request other than orders. */
  answerRequestsWith(response: ActionResponse): void;
  /** Sets the regions that were flown before; read when a survey's phase changes. */
  showFlown(...regions: FlownRegionView[]): void;
  /** Sets what every further estimate of a survey finds. */
  estimateWith(changes: Partial<SurveyEstimateView>): void;
  /** Sets the place upwind of further answers. */
  findUpwind(place: UpwindPlaceView): void;
  showPreflight(preflight: PreflightView): void;
  /** Sets the base maps of the site's folder. */
  showMaps(maps: BaseMapsView): void;
  /** Sets the marks of a replay. */
  showMarks(marks: ReplayMarksView): void;
  /** Sets the job on photos, or why it cannot be read. */
  showPhotos(job: PhotoJobView | null | string): void;
  /** Sets the flight records, or why they cannot be read, and the figures of each. */
  /** What the next plan becomes. */
  planAs(planned: SurveyView): void;
  showFlights(flights: readonly FlightView[] | string, figures: FlightFiguresView | string): void;
  failPreflight(problem: string): void;
  /** Sets how vehicle pictures are fetched. */
  fetchFramesWith(fetch: StationSource["vehicles"]["frame"]): void;
  receive(state: StationState): void;
  connect(connection: Connection): void;
  /** Sets the person of the page's requests. */
  nameAs(person: AccessView): void;
  /** Time goes on for what depends on it without a timer. */
  tick(ms: number): void;
  /** What was announced by sound. */
  readonly announced: readonly Announcement[];
  /** Sets why there is no sound. */
  blockSound(problem: SoundProblem | null): void;
  /** Sets the age of the newest state, seconds. */
  age(behindS: number): void;
  dispose(): void;
}

const PLAIN_THEME: ThemeSwitch = {
  theme: () => "auto",
  changes: () => 0,
  choose: () => {},
  toggleSun: () => {},
};

const NOTHING_KEPT = { getItem: () => null, setItem: () => {} };
const BROWSER = {
  theme: PLAIN_THEME,
  panels: createOpenPanels(NOTHING_KEPT, () => false),
  login: { hasToken: false, fingerprint: null, logIn: () => {}, logOut: () => {} },
  kept: NOTHING_KEPT,
};

/** Renders a component over a source whose state is `first`. */
export function renderPage(component: () => JSX.Element, first: StationState | null): RenderedPage {
  const clock = new FakeClock();
  const station = createFakeStation(first);
  const [now, setNow] = createSignal(clock.now());
  const tick = (ms: number) => {
    clock.advance(ms);
    setNow(clock.now());
  };
  const sound = createFakeSound();
  const { shared, disposeShared } = createRoot((disposeShared) => ({
    shared: createConsole(fakeSource(station), clock, now, { ...BROWSER, ...sound }),
    disposeShared,
  }));
  const root = document.createElement("div");
  document.body.append(root);
  const unmount = render(
    () => <ConsoleProvider value={shared}>{component()}</ConsoleProvider>,
    root,
  );
  const { orders, checks, acknowledged, requests, site, timeline, flights } = station;
  const { receive, connect, nameAs } = station;
  return {
    root,
    shared,
    clock,
    orders,
    checks,
    acknowledged,
    requests: requests.sent,
    allStops: () => station.allStops,
    site,
    timeline,
    announced: sound.announced,
    blockSound: sound.block,
    tick,
    answerWith: (results) => {
      station.answer = results;
    },
    answerRequestsWith: (response) => {
      requests.response = response;
    },
    showFlown: (...regions) => {
      flights.flown = { ...flights.flown, regions };
    },
    planAs: (planned) => {
      flights.planned = planned;
    },
    estimateWith: (changes) => {
      flights.estimate = surveyEstimate(changes);
    },
    findUpwind: (place) => {
      station.upwindPlace = answered({ place, reason: "" });
    },
    showMarks: (marks) => {
      station.marks = marks;
    },
    showFlights: (records, figures) => {
      flights.records = typeof records === "string" ? failed(records) : answered([...records]);
      flights.figures = typeof figures === "string" ? failed(figures) : answered(figures);
    },
    showPhotos: (job) => {
      flights.photos = typeof job === "string" ? failed(job) : answered({ job });
    },
    showMaps: (maps) => {
      station.maps = answered(maps);
    },
    showPreflight: (value) => {
      station.preflight = answered(value);
    },
    failPreflight: (problem) => {
      station.preflight = failed(problem);
    },
    fetchFramesWith: (fetch) => {
      station.fetchFrame = fetch;
    },
    receive,
    connect,
    nameAs,
    age: (seconds) => {
      station.behindS = seconds;
      tick(1);
    },
    dispose: () => {
      unmount();
      disposeShared();
      root.remove();
    },
  };
}

function createFakeSound() {
  const [problem, block] = createSignal<SoundProblem | null>(null);
  const announced: Announcement[] = [];
  return {
    announced,
    block,
    notifier: { permission: () => "absent" as const, ask: async () => {}, notify: () => {} },
    mutes: createMutes({ getItem: () => null, setItem: () => {} }),
    speaker: {
      announce: (announcement: Announcement) => announced.push(announcement),
      isSpeaking: () => false,
      problem,
      hasVoice: () => true,
    },
  };
}

/** The first element matching `selector`; throws without a match. */
export function find<E extends Element = HTMLElement>(root: ParentNode, selector: string): E {
  const element = root.querySelector<E>(selector);
  if (element === null) throw new Error(`No element matches ${selector}.`);
  return element;
}

/** The first button with this label, or whose text begins with it. */
export function findButton(root: ParentNode, text: string): HTMLButtonElement {
  const found = [...root.querySelectorAll("button")].find(
    (one) => one.getAttribute("aria-label") === text || one.textContent?.startsWith(text),
  );
  if (found === undefined) throw new Error(`No button "${text}".`);
  return found;
}

/** Lets answers of fakes arrive, and what is asked because of them. */
export async function settled(): Promise<void> {
  for (let turn = 0; turn < 10; turn += 1) await Promise.resolve();
}
