import type { PhotoFile, PhotoStepView } from "../../protocol";
import { plural } from "./grammar";

/** The photos of a flight, after it: tags, gaps, mosaic, report. */
export const photos = {
  where:
    "The station's computer reads the photos itself: put the card into it, and type or paste the folder's path.",
  title: "Flight and folders",
  flight: "Flight",
  noFlights: "No flight record of this station: photos are tagged by one.",
  folders: "Folders, one in each line",
  example: "/media/card/DCIM",
  dropped: (name: string) =>
    `A browser is given only the name of a dropped folder: ${name}. Paste its path on the station's computer.`,
  camera: "Camera",
  ofCamera: (field: string) => `Camera: ${field}`,
  clockOffset: "Clock offset, s",
  clockHint: "Seconds to add to the camera's clock for UTC. Empty: found by the photos' places.",
  field: "Field of view, °",
  fieldHint: "Along the longer side. Empty: as the photos state.",
  start: "Start",
  again: "Start again",
  cancel: "Cancel",
  running: "Runs on the station's computer, also with this panel closed.",
  results: (flight: string) => `Photos of ${flight}`,
  out: (folder: string) => `Results: ${folder}`,
  steps: {
    clock: "Clock",
    tags: "Tags",
    gaps: "Gaps",
    mosaic: "Mosaic in sun",
    report: "Report",
  } satisfies Record<PhotoStepView["name"], string>,
  states: {
    waiting: "waiting",
    running: "running",
    done: "done",
    failed: "failed",
  } satisfies Record<PhotoStepView["state"], string>,
  doing: (what: string, share: string) => `${what}, ${share}`,
  clock: (camera: string, vehicle: string, count: number) =>
    `${camera}, ${plural(count, "photo")} of ${vehicle}`,
  offset: (offset: string, within: string) => `${offset}, 95 % within ${within}`,
  stated: (offset: string) => `${offset}, as stated`,
  reported: (offset: string) => `${offset}; each photo reported by its app`,
  inSun: (sunlit: number, all: number) => `${sunlit} of ${plural(all, "photo")} in sun`,
  otherLight: (mixed: number, shaded: number, unknown: number) =>
    `${mixed} mixed, ${shaded} shaded, ${unknown} unknown`,
  noGaps: "All ground is in sun on enough photos.",
  gaps: (area: string, regions: number) => `${area} in ${plural(regions, "place")}`,
  flyGaps: "Fly the gaps",
  flyGapsOf: (region: string) => `Fly the gaps of ${region}`,
  flyHint: "On the rows of the survey. Nothing flies before you start it in Survey.",
  planned: "Planned: start it in the panel Survey.",
  noRegion:
    "They lie in no region that this station has surveyed: import Gaps GeoJSON in Edit site, and survey it.",
  mosaicShare: (share: string, area: string, pixel: string) =>
    `${share} of ${area} in sun, ${pixel} a pixel`,
  mosaicPicture: "Mosaic of the photos in sun",
  files: {
    "report.html": "Report",
    "tags.csv": "Tags CSV",
    "fly-again.geojson": "Gaps GeoJSON",
    // Shown, not offered.
  } satisfies Record<Exclude<PhotoFile, "mosaic.png">, string>,
  reportHint: "One page, which every browser shows and prints as PDF",
  warnings: (count: number) => plural(count, "note"),
  open: "Photos of this flight",
};
