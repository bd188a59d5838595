import { createSignal } from "solid-js";
import type {
  AccessView,
  BaseMapsView,
  Connection,
  NamedOrder,
  OrderResult,
  Outcome,
  PreflightView,
  ReplayMarksView,
  StationState,
  TimelineEntryView,
  TimelineFilter,
  UpwindView,
} from "../protocol";
import type { StationSource } from "../source/stationSource";
import {
  fakeFlightRequests,
  fakeFlights,
  fakePhotoRequests,
  fakeSurveyRequests,
} from "./fakeFlights";
import { fakeSite, fakeSiteRequests } from "./fakeSite";
import { answered, failed, noPicture, PageRequests } from "./pageRequests";

/** All entries of the timeline, the newest first, and what was asked for. */
export interface FakeTimeline {
  entries: TimelineEntryView[];
  /** Why it cannot be read; null: it can. */
  problem: string | null;
  readonly asked: TimelineFilter[];
}

export type FakeStation = ReturnType<typeof createFakeStation>;

/** A station whose state is `first`: what it answers, and what it was asked, which a test may set and read. */
export function createFakeStation(first: StationState | null) {
  const [state, receive] = createSignal<StationState | null>(first, { equals: false });
  const [connection, connect] = createSignal<Connection>({ kind: "live" });
  const [person, nameAs] = createSignal<AccessView | null>(null);
  return {
    state,
    receive,
    connection,
    connect,
    person,
    nameAs,
    /** The age of the newest state. */
    behindS: 0,
    orders: [] as NamedOrder[],
    checks: [] as NamedOrder[],
    acknowledged: [] as number[],
    allStops: 0,
    /** The answer to every order. */
    answer: [] as readonly OrderResult[],
    requests: new PageRequests(),
    preflight: failed("no checklist in this test") as Outcome<PreflightView>,
    upwindPlace: answered<UpwindView>({ place: null, reason: "no region in this test" }),
    marks: { marks: [], read_share: 0 } as ReplayMarksView,
    fetchFrame: noPicture as StationSource["vehicles"]["frame"],
    timeline: { entries: [], problem: null, asked: [] } as FakeTimeline,
    site: fakeSite(),
    flights: fakeFlights(),
    maps: answered<BaseMapsView>({
      maps: [],
      note: "No map in this test",
    }) as Outcome<BaseMapsView>,
  };
}

export function fakeSource(station: FakeStation): StationSource {
  const { requests } = station;
  return {
    state: station.state,
    connection: station.connection,
    person: station.person,
    behindS: () => station.behindS,
    orders: {
      send: async (order) => {
        station.orders.push(order);
        return answered(station.answer);
      },
      check: async (order) => {
        station.checks.push(order);
        return answered(station.answer);
      },
      allStop: async () => {
        station.allStops += 1;
        return answered(station.answer);
      },
      releaseStop: (releasedStop) => requests.answer({ releasedStop }),
      fleetReturn: async (serials) => {
        requests.sent.push({ fleetReturn: serials });
        return answered(station.answer);
      },
      sideStep: (serial) => requests.answer({ sideStep: serial }),
      relieve: (relieved, spare, takeoff) => requests.answer({ relieved, spare, takeoff }),
    },
    vehicles: {
      setAuthority: (serial, authority, takeOver) =>
        requests.answer({ authority, serial, ...(takeOver && { takeOver }) }),
      preflight: async () => station.preflight,
      overridePreflight: (serial, override) => requests.answer({ override, serial }),
      dismissHazard: async (clearedHazard) => {
        requests.sent.push({ clearedHazard });
        return answered(null);
      },
      frame: (serial, frameId) => station.fetchFrame(serial, frameId),
    },
    surveys: fakeSurveyRequests(station.flights, requests),
    light: {
      groundImage: noPicture,
      groundImageFile: noPicture,
      shadePicture: noPicture,
      forecastPicture: noPicture,
      sunAt: noPicture,
      upwindPlace: async () => station.upwindPlace,
    },
    site: fakeSiteRequests(station.site),
    maps: {
      list: async () => station.maps,
      tiles: ({ name }) => `http://station/api/maps/${name}/{z}/{x}/{y}`,
      tileRequest: (url) => ({ url }),
    },
    flights: fakeFlightRequests(station.flights, requests),
    photos: fakePhotoRequests(station.flights, requests),
    replay: {
      marks: async () => answered(station.marks),
      change: async (transport) => {
        requests.sent.push({ transport });
        const replay = station.state()?.replay ?? null;
        return replay === null
          ? failed("This station is live: nothing is replayed")
          : answered(replay);
      },
    },
    station: {
      person: async () => failed("nobody is asked for in this test"),
      refusalReason: async () => null,
      sharedAddressCode: noPicture,
      appAddressCode: noPicture,
      admitApp: (admittedLink, serial, lasting) =>
        requests.answer({ admittedLink, serial, lasting }),
      refuseApp: (refusedLink) => requests.answer({ refusedLink }),
      acknowledge: async (id) => {
        station.acknowledged.push(id);
        return answered(null);
      },
      drawZone: (drawnZone) => requests.answer({ drawnZone }, { zone: null }),
      endZone: (endedZone) => requests.answer({ endedZone }),
      setSeparationHold: async (separationHold) => {
        requests.sent.push({ separationHold });
        return answered(null);
      },
      timeline: async (filter, atMost) => {
        const { asked, problem, entries } = station.timeline;
        asked.push(filter);
        if (problem !== null) return failed(problem);
        const found = entries.filter(
          ({ n, serial }) =>
            (filter.before === null || n < filter.before) &&
            (filter.serial === null || serial === filter.serial),
        );
        return answered({ entries: found.slice(0, atMost), has_more: found.length > atMost });
      },
    },
    close: () => {},
  };
}
