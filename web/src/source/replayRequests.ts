import type { ReplayTransport } from "../protocol";
import { answered, READ, type StationHttp } from "./stationHttp";

export type ReplayRequests = ReturnType<typeof replayRequests>;

/** The transport of a replay, the only thing in it that can be changed. */
export function replayRequests({ client }: StationHttp) {
  return {
    /** Alarms and orders of the whole record. */
    marks: () => answered(READ, (signal) => client.GET("/api/replay/marks", { signal })),
    /** Plays, pauses, changes the speed or seeks; answered when the state is that of the moment. */
    change: (body: ReplayTransport) =>
      answered(READ, (signal) => client.POST("/api/replay", { body, signal })),
  };
}
