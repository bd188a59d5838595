import type { FlightFile } from "../protocol";
import { answered, READ, RECORD, type StationHttp } from "./stationHttp";

export type FlightRequests = ReturnType<typeof flightRequests>;

/** The flight records in the station's folder. */
export function flightRequests(http: StationHttp) {
  const { client } = http;
  const pathOf = (name: string) => `/api/flights/${encodeURIComponent(name)}`;
  return {
    /** The newest first. */
    list: () => answered(READ, (signal) => client.GET("/api/flights", { signal })),
    /** Takes seconds: the station reads the record. */
    figures: (name: string) =>
      answered(RECORD, (signal) =>
        client.GET("/api/flights/{name}", { params: { path: { name } }, signal }),
      ),
    file: (name: string, file: FlightFile) => http.picture(`${pathOf(name)}/files/${file}`, RECORD),
    record: (name: string) => http.picture(`${pathOf(name)}/record.mcap`, RECORD),
  };
}
