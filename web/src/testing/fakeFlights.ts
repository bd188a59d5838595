import type {
  FlightFiguresView,
  FlightView,
  FlownRegionsView,
  Outcome,
  PhotoJobView,
  PhotosView,
  SurveyCameraView,
  SurveyEstimateView,
  SurveyView,
} from "../protocol";
import type { FlightRequests } from "../source/flightRequests";
import type { PhotoRequests } from "../source/photoRequests";
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
  photos: Outcome<PhotosView>;
  /** What a plan becomes. */
  planned: SurveyView | null;
}

export function fakeFlights(): FakeFlights {
  return {
    records: answered([]),
    figures: failed("no figures in this test"),
    estimate: surveyEstimate(),
    flown: { today: "2026-05-03", regions: [], unreadable: [] },
    photos: answered({ job: null }),
    planned: null,
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

/** A finished job that has found everything, with `changes` applied. */
export function photoJob(changes: Partial<PhotoJobView> = {}): PhotoJobView {
  const names = ["clock", "tags", "gaps", "mosaic", "report"] as const;
  return {
    flight: "flight-20250620T160412Z",
    folders: ["/media/card/DCIM"],
    out: "/home/anna/records/flight-20250620T160412Z-photos",
    state: "done",
    steps: names.map((name) => ({ name, state: "done", problem: "" })),
    doing: "",
    share: null,
    clocks: [
      {
        camera: "CAM-1",
        vehicle: "Drone 1",
        photos: 48,
        offset_s: -18_037.6,
        sigma_s: 0.3,
        distance_m: 1.5,
        is_stated: false,
        is_reported: false,
      },
    ],
    counts: { photos: 48, sunlit: 12, mixed: 4, shaded: 30, unknown: 2 },
    gaps: { area_m2: 7_000, regions: 2 },
    mosaic: {
      resolution_m: 0.5,
      sun_m2: 10_000,
      shade_m2: 28_000,
      unknown_m2: 1_000,
      missing_m2: 1_000,
    },
    files: ["tags.csv", "fly-again.geojson", "mosaic.png", "report.html"],
    warnings: ["CAM-1: its clock is off by no time zone"],
    ...changes,
  };
}

export function fakePhotoRequests(flights: FakeFlights, requests: PageRequests): PhotoRequests {
  return {
    view: async () => flights.photos,
    start: async (startedPhotos) => {
      requests.sent.push({ startedPhotos });
      return flights.photos;
    },
    cancel: async () => {
      requests.sent.push({ cancelled: "photos" });
      return flights.photos;
    },
    file: async (photoFile) => {
      requests.sent.push({ photoFile });
      return answered({ blob: new Blob(["x"]), frameId: null });
    },
  };
}

export function fakeSurveyRequests(flights: FakeFlights, requests: PageRequests): SurveyRequests {
  const none = { survey: null };
  return {
    flownRegions: async () => answered(flights.flown),
    again: (surveyAgain) => requests.answer({ surveyAgain }, none),
    plan: (plannedSurvey) => requests.answer({ plannedSurvey }, { survey: flights.planned }),
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
