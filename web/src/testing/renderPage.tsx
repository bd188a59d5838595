import { createRoot, createSignal, type JSX } from "solid-js";
import { render } from "solid-js/web";
import { type Console, ConsoleProvider, createConsole } from "../console";
import { createOpenPanels } from "../panels/openPanels";
import type {
  AccessView,
  ActionResponse,
  AuthorityHolder,
  CalibrationRequest,
  CalibrationView,
  FlightFiguresView,
  FlightView,
  FrozenFrameView,
  ImportedView,
  OrderResult,
  PreflightView,
  ReplayMarksView,
  ReplayTransport,
  SiteDrawingRequest,
  SiteDrawingResponse,
  SiteDrawingView,
  SiteVehiclesRequest,
  SiteVehiclesResponse,
  SiteVehiclesView,
  StationState,
  SurveyCameraView,
  SurveyEstimateView,
  TimelineEntryView,
  UpwindPlaceView,
  UpwindView,
} from "../protocol";
import type { Announcement } from "../sound/announcements";
import { createMutes } from "../sound/mutes";
import type { SoundProblem, Speaker } from "../sound/speaker";
import type { FlightFile, FlightRequests } from "../source/flightRequests";
import type { SiteRequests } from "../source/siteRequests";
import type {
  Connection,
  NamedOrder,
  NewZone,
  Outcome,
  StationSource,
  TimelineFilter,
} from "../source/stationSource";
import type { NewSurvey, SurveyRequests } from "../source/surveyRequests";
import type { ThemeSwitch } from "../theme/theme";
import { FakeClock } from "./fakeClock";
import { surveyEstimate } from "./fakeState";

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
  readonly timeline: {
    entries: TimelineEntryView[];
    /** Why it cannot be read; null: it can. */
    problem: string | null;
    readonly asked: TimelineFilter[];
  };
  /** Sets the answer to every further order. */
  answerWith(results: readonly OrderResult[]): void;
  /** Sets the answer to every further request other than orders. */
  answerRequestsWith(response: ActionResponse): void;
  /** Sets what every further estimate of a survey finds. */
  estimateWith(changes: Partial<SurveyEstimateView>): void;
  /** Sets the place upwind of further answers. */
  findUpwind(place: UpwindPlaceView): void;
  showPreflight(preflight: PreflightView): void;
  /** Sets the marks of a replay. */
  showMarks(marks: ReplayMarksView): void;
  /** Sets the flight records, or why they cannot be read, and the figures of each. */
  showFlights(flights: readonly FlightView[] | string, figures: FlightFiguresView | string): void;
  failPreflight(problem: string): void;
  /** Sets how vehicle pictures are fetched. */
  fetchFramesWith(fetch: StationSource["vehicleFrame"]): void;
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

/** A request other than a vehicle order. */
export type PageRequest =
  | { readonly authority: AuthorityHolder; readonly serial: string; readonly takeOver?: boolean }
  | { readonly override: string; readonly serial: string }
  | { readonly clearedHazard: string }
  | { readonly separationHold: boolean }
  | { readonly drawnZone: NewZone }
  | { readonly endedZone: number }
  | { readonly releasedStop: readonly string[] | null }
  | {
      readonly admittedLink: number;
      readonly serial: string;
      readonly lasting: "always" | "session";
    }
  | { readonly refusedLink: number }
  | { readonly fleetReturn: readonly string[] | null }
  | { readonly lookAside: string }
  | { readonly plannedSurvey: NewSurvey }
  | {
      readonly startedSurvey: number;
      readonly serials: readonly string[];
      readonly takeoff: boolean;
    }
  | { readonly stoppedSurvey: number; readonly word: "pause" | "abort" }
  | { readonly transport: ReplayTransport }
  | { readonly flight: string; readonly file?: FlightFile | "record.mcap" };

/** A site's folder: what it answers, and what it was asked. */
export interface FakeSite {
  drawing: SiteDrawingView;
  /** The answer to checks, saves and undos. */
  response: SiteDrawingResponse;
  imported: ImportedView;
  readonly asked: (readonly [what: "check" | "save", drawing: SiteDrawingRequest])[];
  /** The vehicles, and the answer to their checks and saves. */
  vehicles: SiteVehiclesView;
  vehiclesResponse: SiteVehiclesResponse;
  readonly askedVehicles: (readonly [what: "check" | "save", vehicles: SiteVehiclesRequest])[];
  /** What a freeze and a fit answer; the points that were asked about. */
  frozen: FrozenFrameView;
  fit: CalibrationView;
  readonly askedFits: (readonly [what: "fit" | "accept", asked: CalibrationRequest])[];
  readonly undone: string[];
  readonly files: File[];
}

const EMPTY_SITE: SiteDrawingView = {
  revision: "r1",
  features: [],
  locked_reason: null,
  undo: null,
};

/** Recorded requests, and the answers to give. */
interface Recorded {
  orders: NamedOrder[];
  checks: NamedOrder[];
  acknowledged: number[];
  requests: PageRequest[];
  response: ActionResponse;
  preflight: Outcome<PreflightView>;
  allStops: number;
  answer: readonly OrderResult[];
  fetchFrame: StationSource["vehicleFrame"];
  upwindPlace: Outcome<UpwindView>;
  site: FakeSite;
  estimate: SurveyEstimateView;
  cameras: SurveyCameraView[];
  timeline: RenderedPage["timeline"];
  marks: ReplayMarksView;
  flights: Outcome<FlightView[]>;
  figures: Outcome<FlightFiguresView>;
}

const noPicture = async () => ({ kind: "failed", problem: "no picture in this test" }) as const;

const PLAIN_THEME: ThemeSwitch = {
  theme: () => "auto",
  changes: () => 0,
  choose: () => {},
  toggleSun: () => {},
};

const PANELS = createOpenPanels({ getItem: () => null, setItem: () => {} }, () => false);

/** Renders a component over a source whose state is `first`. */
export function renderPage(component: () => JSX.Element, first: StationState | null): RenderedPage {
  const clock = new FakeClock();
  const [state, setState] = createSignal<StationState | null>(first, { equals: false });
  const [connection, setConnection] = createSignal<Connection>({ kind: "live" });
  const [person, setPerson] = createSignal<AccessView | null>(null);
  const [now, setNow] = createSignal(clock.now());
  const mutes = createMutes({ getItem: () => null, setItem: () => {} });
  const [soundProblem, setSoundProblem] = createSignal<SoundProblem | null>(null);
  const announced: Announcement[] = [];
  const speaker: Speaker = {
    announce: (announcement) => announced.push(announcement),
    isSpeaking: () => false,
    problem: soundProblem,
    hasVoice: () => true,
  };
  const recorded: Recorded = {
    orders: [],
    checks: [],
    acknowledged: [],
    requests: [],
    response: { accepted: true, rule: null, reason: null },
    preflight: { kind: "failed", problem: "no checklist in this test" },
    allStops: 0,
    answer: [],
    fetchFrame: noPicture,
    upwindPlace: {
      kind: "answered",
      value: { place: null, reason: "no region in this test" },
    },
    site: {
      drawing: EMPTY_SITE,
      response: {
        accepted: true,
        rule: null,
        reason: null,
        feature: null,
        layers: [],
        also: [],
        drawing: null,
      },
      vehicles: { revision: "r1", vehicles: [], locked_reason: null, undo: null },
      vehiclesResponse: {
        accepted: true,
        rule: null,
        reason: null,
        row: null,
        changes: [],
        vehicles: null,
      },
      askedVehicles: [],
      frozen: {
        accepted: true,
        reason: null,
        frame_id: 7,
        cols: 1280,
        rows: 720,
        latitude_deg: 41.9,
        longitude_deg: -93.6,
        surveyed: [],
      },
      fit: {
        accepted: true,
        rule: null,
        reason: null,
        rms_px: 1.25,
        residuals: [],
        height_above_ground_m: 110,
        tilt_deg: 2,
      },
      askedFits: [],
      imported: { features: [], left_out: 0, reason: null },
      asked: [],
      undone: [],
      files: [],
    },
    estimate: surveyEstimate(),
    cameras: [
      {
        name: "mini3pro",
        title: "Mini 3 Pro (12 MP)",
        across_px: 4032,
        along_px: 3024,
        across_deg: 69.7,
        along_deg: 55.2,
        timer_s: [2, 3, 5],
        shutter: "rolling",
        source: "specifications",
      },
    ],
    timeline: { entries: [], problem: null, asked: [] },
    marks: { marks: [], read_share: 0 },
    flights: { kind: "answered", value: [] },
    figures: { kind: "failed", problem: "no figures in this test" },
  };
  let behindS = 0;
  const source = fakeSource(state, connection, person, () => behindS, recorded);
  const { shared, disposeShared } = createRoot((disposeShared) => ({
    shared: createConsole(source, PLAIN_THEME, clock, now, PANELS, { mutes, speaker }),
    disposeShared,
  }));
  const root = document.createElement("div");
  document.body.append(root);
  const unmount = render(
    () => <ConsoleProvider value={shared}>{component()}</ConsoleProvider>,
    root,
  );
  return {
    root,
    shared,
    clock,
    orders: recorded.orders,
    checks: recorded.checks,
    acknowledged: recorded.acknowledged,
    requests: recorded.requests,
    allStops: () => recorded.allStops,
    site: recorded.site,
    timeline: recorded.timeline,
    announced,
    blockSound: setSoundProblem,
    tick: (ms) => {
      clock.advance(ms);
      setNow(clock.now());
    },
    answerWith: (results) => {
      recorded.answer = results;
    },
    answerRequestsWith: (response) => {
      recorded.response = response;
    },
    estimateWith: (changes) => {
      recorded.estimate = surveyEstimate(changes);
    },
    findUpwind: (place) => {
      recorded.upwindPlace = { kind: "answered", value: { place, reason: "" } };
    },
    showMarks: (marks) => {
      recorded.marks = marks;
    },
    showFlights: (flights, figures) => {
      recorded.flights = outcomeOf(typeof flights === "string" ? flights : [...flights]);
      recorded.figures = outcomeOf(figures);
    },
    showPreflight: (value) => {
      recorded.preflight = { kind: "answered", value };
    },
    failPreflight: (problem) => {
      recorded.preflight = { kind: "failed", problem };
    },
    fetchFramesWith: (fetch) => {
      recorded.fetchFrame = fetch;
    },
    receive: setState,
    connect: setConnection,
    nameAs: setPerson,
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
  person: StationSource["person"],
  behindS: () => number,
  recorded: Recorded,
): StationSource {
  return {
    state,
    connection,
    person,
    sharedAddressCode: noPicture,
    appAddressCode: noPicture,
    behindS,
    replay: {
      marks: async () => ({ kind: "answered", value: recorded.marks }),
      change: async (transport) => {
        recorded.requests.push({ transport });
        const replay = state()?.replay ?? null;
        return replay === null
          ? { kind: "failed", problem: "This station is live: nothing is replayed" }
          : { kind: "answered", value: replay };
      },
    },
    order: async (order) => {
      recorded.orders.push(order);
      return { kind: "answered", value: recorded.answer };
    },
    allStop: async () => {
      recorded.allStops += 1;
      return { kind: "answered", value: recorded.answer };
    },
    drawZone: async (drawnZone) => {
      recorded.requests.push({ drawnZone });
      return { kind: "answered", value: { ...recorded.response, zone: null } };
    },
    endZone: async (endedZone) => {
      recorded.requests.push({ endedZone });
      return { kind: "answered", value: recorded.response };
    },
    releaseStop: async (releasedStop) => {
      recorded.requests.push({ releasedStop });
      return { kind: "answered", value: recorded.response };
    },
    admitApp: async (admittedLink, serial, lasting) => {
      recorded.requests.push({ admittedLink, serial, lasting });
      return { kind: "answered", value: recorded.response };
    },
    refuseApp: async (refusedLink) => {
      recorded.requests.push({ refusedLink });
      return { kind: "answered", value: recorded.response };
    },
    check: async (order) => {
      recorded.checks.push(order);
      return { kind: "answered", value: recorded.answer };
    },
    fleetReturn: async (serials) => {
      recorded.requests.push({ fleetReturn: serials });
      return { kind: "answered", value: recorded.answer };
    },
    lookAside: async (serial) => {
      recorded.requests.push({ lookAside: serial });
      return { kind: "answered", value: recorded.response };
    },
    setAuthority: async (serial, authority, takeOver) => {
      recorded.requests.push({ authority, serial, ...(takeOver && { takeOver }) });
      return { kind: "answered", value: recorded.response };
    },
    preflight: async () => recorded.preflight,
    overridePreflight: async (serial, override) => {
      recorded.requests.push({ override, serial });
      return { kind: "answered", value: recorded.response };
    },
    dismissHazard: async (clearedHazard) => {
      recorded.requests.push({ clearedHazard });
      return { kind: "answered", value: null };
    },
    setSeparationHold: async (separationHold) => {
      recorded.requests.push({ separationHold });
      return { kind: "answered", value: null };
    },
    acknowledge: async (id) => {
      recorded.acknowledged.push(id);
      return { kind: "answered", value: null };
    },
    vehicleFrame: (serial, frameId) => recorded.fetchFrame(serial, frameId),
    groundImage: noPicture,
    groundImageFile: noPicture,
    shadePicture: noPicture,
    forecastPicture: noPicture,
    sunAt: noPicture,
    upwindPlace: async () => recorded.upwindPlace,
    timeline: async (filter, atMost) => {
      recorded.timeline.asked.push(filter);
      const { problem } = recorded.timeline;
      if (problem !== null) return { kind: "failed", problem };
      const found = recorded.timeline.entries.filter(
        ({ n, serial }) =>
          (filter.before === null || n < filter.before) &&
          (filter.serial === null || serial === filter.serial),
      );
      const value = { entries: found.slice(0, atMost), has_more: found.length > atMost };
      return { kind: "answered", value };
    },
    site: fakeSiteRequests(recorded.site),
    flights: fakeFlightRequests(recorded),
    surveys: fakeSurveyRequests(recorded),
    close: () => {},
  };
}

/** A text is a problem. */
function outcomeOf<T>(answer: T | string): Outcome<T> {
  return typeof answer === "string"
    ? { kind: "failed", problem: answer }
    : { kind: "answered", value: answer };
}

function fakeSiteRequests(site: FakeSite): SiteRequests {
  const answer = async () => ({ kind: "answered", value: site.response }) as const;
  return {
    drawing: async () => ({ kind: "answered", value: site.drawing }),
    check: (drawing) => {
      site.asked.push(["check", drawing]);
      return answer();
    },
    save: (drawing) => {
      site.asked.push(["save", drawing]);
      return answer();
    },
    undo: (revision) => {
      site.undone.push(revision);
      return answer();
    },
    vehicles: async () => ({ kind: "answered", value: site.vehicles }),
    checkVehicles: async (vehicles) => {
      site.askedVehicles.push(["check", vehicles]);
      return { kind: "answered", value: site.vehiclesResponse };
    },
    saveVehicles: async (vehicles) => {
      site.askedVehicles.push(["save", vehicles]);
      return { kind: "answered", value: site.vehiclesResponse };
    },
    freeze: async () => ({ kind: "answered", value: site.frozen }),
    frozenPicture: async () => ({
      kind: "answered",
      value: { blob: new Blob(["x"]), frameId: site.frozen.frame_id },
    }),
    fitCalibration: async (asked) => {
      site.askedFits.push(["fit", asked]);
      return { kind: "answered", value: site.fit };
    },
    calibrate: async (asked) => {
      site.askedFits.push(["accept", asked]);
      return { kind: "answered", value: site.fit };
    },
    readFile: async (file) => {
      site.files.push(file);
      return { kind: "answered", value: site.imported };
    },
  };
}

function fakeFlightRequests(recorded: Recorded): FlightRequests {
  return {
    list: async () => recorded.flights,
    figures: async (flight) => {
      recorded.requests.push({ flight });
      return recorded.figures;
    },
    file: async (flight, file) => {
      recorded.requests.push({ flight, file });
      return { kind: "answered", value: { blob: new Blob(["x"]), frameId: null } };
    },
    record: async (flight) => {
      recorded.requests.push({ flight, file: "record.mcap" });
      return { kind: "failed", problem: "no record in this test" };
    },
  };
}

function fakeSurveyRequests(recorded: Recorded): SurveyRequests {
  return {
    plan: async (plannedSurvey) => {
      recorded.requests.push({ plannedSurvey });
      return { kind: "answered", value: { ...recorded.response, survey: null } };
    },
    start: async (startedSurvey, serials, takeoff) => {
      recorded.requests.push({ startedSurvey, serials, takeoff });
      return { kind: "answered", value: { ...recorded.response, survey: null } };
    },
    stop: async (stoppedSurvey, word) => {
      recorded.requests.push({ stoppedSurvey, word });
      return { kind: "answered", value: { ...recorded.response, survey: null } };
    },
    estimate: async (_id, serials) => ({
      kind: "answered",
      value: {
        ...recorded.estimate,
        drones: serials.map((serial) => ({
          serial,
          vehicle_name: serial,
          time_s: 300,
          flights: 1,
        })),
      },
    }),
    cameras: async () => ({ kind: "answered", value: recorded.cameras }),
    ways: noPicture,
    cells: noPicture,
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
