import type { PhotoFile, PhotoRequest } from "../protocol";
import { answered, CHANGE, PICTURE, PLANNING, READ, type StationHttp } from "./stationHttp";

export type PhotoRequests = ReturnType<typeof photoRequests>;

/** The station's one job on the photos of a flight. */
export function photoRequests(http: StationHttp) {
  const { client } = http;
  return {
    view: () => answered(READ, (signal) => client.GET("/api/photos", { signal })),
    /** The station looks into the folders first, which may be on a slow card. */
    start: (body: PhotoRequest) =>
      answered(PLANNING, (signal) => client.POST("/api/photos", { body, signal })),
    cancel: () => answered(CHANGE, (signal) => client.DELETE("/api/photos", { signal })),
    file: (name: PhotoFile) => http.picture(`/api/photos/files/${name}`, PICTURE),
  };
}
