import { answered, READ, type StationHttp } from "./stationHttp";

export type LightRequests = ReturnType<typeof lightRequests>;

/** The ground image, the maps of shade made of it, and what they say of a place. */
export function lightRequests(http: StationHttp) {
  const { client } = http;
  return {
    groundImage: (frameId: number) => http.picture(`/api/ground-image.png?id=${frameId}`),
    groundImageFile: () => http.picture("/api/ground-image.tif"),
    shadePicture: (number: number) => http.picture(`/api/shade.png?id=${number}`),
    forecastPicture: (number: number, lead_s: number) =>
      http.picture(`/api/forecast.png?id=${number}&lead_s=${lead_s}`),
    /** The light at a place, and when it changes next. */
    sunAt: (latitude_deg: number, longitude_deg: number) => {
      const params = { query: { latitude_deg, longitude_deg } };
      return answered(READ, (signal) => client.GET("/api/sun-at", { params, signal }));
    },
    /** Where an imaging drone sees most of the shade that comes over the region. */
    upwindPlace: (serial: string) => {
      const params = { query: { serial } };
      return answered(READ, (signal) => client.GET("/api/upwind-place", { params, signal }));
    },
  };
}
