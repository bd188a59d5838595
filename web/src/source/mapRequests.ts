import type { BaseMapView } from "../protocol";
import { text } from "../text/catalogue";
import { answered, type Limit, type StationHttp } from "./stationHttp";

/** What a new map covers is counted in seconds, or in a minute for a large one. */
const MAPS: Limit = { ms: 180_000, ifLate: text.requests.tryAgain };

export type MapRequests = ReturnType<typeof mapRequests>;

/** The base maps in the site's folder. */
export function mapRequests(http: StationHttp) {
  const { client, origin, headers } = http;
  return {
    list: () => answered(MAPS, (signal) => client.GET("/api/maps", { signal })),
    /** The address of a map's tiles, as MapLibre fills it in; kept by the browser while the file is the same. */
    tiles: ({ name, version }: Pick<BaseMapView, "name" | "version">) =>
      `${origin}/api/maps/${encodeURIComponent(name)}/{z}/{x}/{y}?v=${encodeURIComponent(version)}`,
    /** A request for a tile, with the token if it is the station's. */
    tileRequest: (url: string) =>
      url.startsWith(`${origin}/api/maps/`) ? { url, headers } : { url },
  };
}
