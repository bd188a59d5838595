import type {
  FlightFiguresView,
  FlightView,
  FlownRegionsView,
  Outcome,
  SurveyCameraView,
  SurveyEstimateView,
} from "../protocol";
import type { FlightRequests } from "../source/flightRequests";
import type { SurveyRequests } from "../source/surveyRequests";
import { planExports, surveyEstimate } from "./fakeField";
import { answered, failed, noPicture, type PageRequests } from "./pageRequests";

const MINI_3_PRO: SurveyCameraView = {
  name: "mini3pro",
  title: "Mini 3 Pro (12 MP)",
  across_px: 4032,
  along_px: 3024,
  across_deg: 69.7,
  along_deg: 55.2,
  timer_s: [2, 3, 5],
  shutter: "rolling",
  source: "specifications",
};

/** Flight records, and surveys to fly: what is answered about them. */
export interface FakeFlights {
  records: Outcome<FlightView[]>;
  figures: Outcome<FlightFiguresView>;
  estimate: SurveyEstimateView;
  flown: FlownRegionsView;
}

export function fakeFlights(): FakeFlights {
  return {
    records: answered([]),
    figures: failed("no figures in this test"),
    estimate: surveyEstimate(),
    flown: { today: "2026-05-03", regions: [], unreadable: [] },
  };
}

export function fakeFlightRequests(flights: FakeFlights, requests: PageRequests): FlightRequests {
  return {
    list: async () => flights.records,
    figures: async (flight) => {
      requests.sent.push({ flight });
      return flights.figures;
    },
    file: async (flight, file) => {
      requests.sent.push({ flight, file });
      return answered({ blob: new Blob(["x"]), frameId: null });
    },
    record: async (flight) => {
      requests.sent.push({ flight, file: "record.mcap" });
      return failed("no record in this test");
    },
  };
}

export function fakeSurveyRequests(flights: FakeFlights, requests: PageRequests): SurveyRequests {
  const none = { survey: null };
  return {
    flownRegions: async () => answered(flights.flown),
    again: (surveyAgain) => requests.answer({ surveyAgain }, none),
    plan: (plannedSurvey) => requests.answer({ plannedSurvey }, none),
    start: (startedSurvey, serials, takeoff) =>
      requests.answer({ startedSurvey, serials, takeoff }, none),
    stop: (stoppedSurvey, word) => requests.answer({ stoppedSurvey, word }, none),
    estimate: async (_id, serials) => {
      const one = { time_s: 300, flights: 1 };
      const drones = serials.map((serial) => ({ serial, vehicle_name: serial, ...one }));
      return answered({ ...flights.estimate, drones });
    },
    estimateDraft: async () => answered(flights.estimate),
    exports: async (_id, _serials, model) => answered(planExports(model?.aircraft ?? null)),
    planFile: async (savedPlan, kind, serials, model) => {
      requests.sent.push({ savedPlan, kind, serials, model });
      return answered({ blob: new Blob(["x"]), frameId: null });
    },
    cameras: async () => answered([MINI_3_PRO]),
    paths: noPicture,
    cells: noPicture,
  };
}
