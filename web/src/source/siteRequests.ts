import type {
  CalibrationRequest,
  ImportedView,
  SiteDrawingRequest,
  SiteVehiclesRequest,
} from "../protocol";
import { answered, SITE_IMPORT, SITE_READ, SITE_SAVE, type StationHttp } from "./stationHttp";

export type SiteRequests = ReturnType<typeof siteRequests>;

/** The site's layers and vehicles: read, checked and saved. */
export function siteRequests(http: StationHttp) {
  const { client } = http;
  return {
    /** The site's layers with all corners, as they are in its folder. */
    drawing: () => answered(SITE_READ, (signal) => client.GET("/api/site/drawing", { signal })),
    /** Checks a drawing as the station would at its start; nothing is saved. */
    check: (body: SiteDrawingRequest) =>
      answered(SITE_READ, (signal) => client.POST("/api/site/drawing/check", { body, signal })),
    /** Saves a drawing in the site's folder and brings it into force. */
    save: (body: SiteDrawingRequest) =>
      answered(SITE_SAVE, (signal) => client.POST("/api/site/drawing", { body, signal })),
    /** Takes back the newest save. */
    undo: (revision: string) =>
      answered(SITE_SAVE, (signal) =>
        client.POST("/api/site/drawing/undo", { body: { revision }, signal }),
      ),
    /** The vehicles of the site's folder, connected or not. */
    vehicles: () => answered(SITE_READ, (signal) => client.GET("/api/site/vehicles", { signal })),
    /** Checks vehicles as the station would at its start; nothing is saved. */
    checkVehicles: (body: SiteVehiclesRequest) =>
      answered(SITE_READ, (signal) => client.POST("/api/site/vehicles/check", { body, signal })),
    /** Saves vehicles in the site's folder and brings them into force. */
    saveVehicles: (body: SiteVehiclesRequest) =>
      answered(SITE_SAVE, (signal) => client.POST("/api/site/vehicles", { body, signal })),
    /** Keeps the newest frame of an imaging drone, for control points to be marked on. */
    freeze: (serial: string) =>
      answered(SITE_READ, (signal) =>
        client.POST("/api/site/calibration/freeze", { body: { serial }, signal }),
      ),
    /** The picture of the kept frame. */
    frozenPicture: (serial: string) =>
      http.picture(`/api/site/calibration/frame.jpg?serial=${encodeURIComponent(serial)}`),
    /** Solves the camera's pose by control points; nothing is saved. */
    fitCalibration: (body: CalibrationRequest) =>
      answered(SITE_READ, (signal) => client.POST("/api/site/calibration/fit", { body, signal })),
    /** Saves control points; the next frames are placed by them. */
    calibrate: (body: CalibrationRequest) =>
      answered(SITE_SAVE, (signal) => client.POST("/api/site/calibration", { body, signal })),
    /** Reads the polygons and points of a file of another program; nothing is saved. */
    readFile: (file: File, closePaths = false) =>
      http.read(
        SITE_IMPORT,
        `/api/site/import?close_paths=${closePaths}&name=${encodeURIComponent(file.name.slice(-100))}`,
        { method: "POST", body: file },
        (response): Promise<ImportedView> => response.json(),
      ),
  };
}
