import type { AuthorityHolder } from "../protocol";
import { answered, CHANGE, READ, type StationHttp, withoutBody } from "./stationHttp";

export type VehicleRequests = ReturnType<typeof vehicleRequests>;

/** What is asked about one vehicle, or changed at the station, without an order to it. */
export function vehicleRequests(http: StationHttp) {
  const { client } = http;
  return {
    /** `take_over`: also from another person who operates the vehicle. */
    setAuthority: (serial: string, holder: AuthorityHolder, take_over = false) => {
      const options = { params: { query: { serial } }, body: { holder, take_over } };
      return answered(CHANGE, (signal) =>
        client.POST("/api/vehicle/authority", { ...options, signal }),
      );
    },
    preflight: (serial: string) => {
      const params = { query: { serial } };
      return answered(READ, (signal) => client.GET("/api/vehicle/preflight", { params, signal }));
    },
    overridePreflight: (serial: string, reason: string) => {
      const options = { params: { query: { serial } }, body: { reason } };
      return answered(CHANGE, (signal) =>
        client.POST("/api/vehicle/preflight/override", { ...options, signal }),
      );
    },
    /** Clears a lost vehicle's hazard area. */
    dismissHazard: (serial: string) => {
      const params = { query: { serial } };
      return withoutBody(CHANGE, (signal) =>
        client.POST("/api/vehicle/hazard/dismiss", { params, signal }),
      );
    },
    frame: (serial: string, frameId: number) =>
      http.picture(`/api/vehicle/frame.jpg?serial=${encodeURIComponent(serial)}&id=${frameId}`),
  };
}
