import type {
  NewZone,
  TemporaryZoneRequest,
  TemporaryZoneResponse,
  TimelineFilter,
} from "../protocol";
import {
  answered,
  attempt,
  CHANGE,
  done,
  READ,
  refusal,
  type StationHttp,
  withoutBody,
} from "./stationHttp";

export type StationRequests = ReturnType<typeof stationRequests>;

/** What concerns the whole station: access, apps, alarms, temporary zones, separation, what happened. */
export function stationRequests(http: StationHttp) {
  const { client } = http;
  return {
    /** The person of this page's requests. */
    person: () => answered(READ, (signal) => client.GET("/api/access", { signal })),
    /** Why the station rejects this page, or null: a browser reports no reason for a WebSocket. */
    refusalReason: async (): Promise<string | null> => {
      const outcome = await attempt(READ, async (signal) => {
        const { response, error } = await client.GET("/api/state", { signal });
        return done(response.ok ? null : refusal(response, error));
      });
      return outcome.kind === "answered" ? outcome.value : null;
    },
    /** The address for other computers as a QR code. */
    sharedAddressCode: () => http.picture("/api/access/qr.svg"),
    /** The address for companion apps as a QR code. */
    appAddressCode: () => http.picture("/api/apps/qr.svg"),
    /** Admits the app that waits on a link as this vehicle, on the list or until the station stops. */
    admitApp: (link_id: number, serial: string, lasting: "always" | "session") => {
      const body = { link_id, serial, lasting, any_address: false };
      return answered(CHANGE, (signal) => client.POST("/api/apps/admit", { body, signal }));
    },
    /** Closes the app that waits on a link, and again for some minutes. */
    refuseApp: (link_id: number) =>
      answered(CHANGE, (signal) => client.POST("/api/apps/refuse", { body: { link_id }, signal })),
    acknowledge: (alarm_id: number) => {
      const params = { path: { alarm_id } };
      return withoutBody(CHANGE, (signal) =>
        client.POST("/api/alarms/{alarm_id}/acknowledge", { params, signal }),
      );
    },
    /** Draws a temporary zone, which acts at once. */
    drawZone: (zone: NewZone) => {
      const body = zone as TemporaryZoneRequest;
      return answered(
        CHANGE,
        (signal) => client.POST("/api/zones", { body, signal }),
        // openapi-fetch widens pairs to lists; the station sends pairs.
        (data) => data as TemporaryZoneResponse,
      );
    },
    endZone: (zone_id: number) => {
      const params = { path: { zone_id } };
      return answered(CHANGE, (signal) =>
        client.POST("/api/zones/{zone_id}/end", { params, signal }),
      );
    },
    setSeparationHold: (isOn: boolean) => {
      const path: { switch: "on" | "off" } = { switch: isOn ? "on" : "off" };
      return withoutBody(CHANGE, (signal) =>
        client.POST("/api/separation-hold/{switch}", { params: { path }, signal }),
      );
    },
    /** What happened in this run, the newest first. */
    timeline: ({ serial, about, before }: TimelineFilter, at_most: number) => {
      const query = {
        ...(serial !== null && { serial }),
        ...(about !== null && { about }),
        ...(before !== null && { before }),
        at_most,
      };
      return answered(READ, (signal) => client.GET("/api/timeline", { params: { query }, signal }));
    },
  };
}
