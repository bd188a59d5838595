import type { JSX } from "solid-js";

/** The page that makes a site in an empty folder. */
export const newSite = {
  page: (product: string) => `${product}: a new site`,
  title: "Where is your field?",
  what: (folder: JSX.Element): JSX.Element => [
    "Recon makes a site in ",
    folder,
    ", with simulated drones to rehearse with. Boundary, zones and fields are drawn next, on the map.",
  ],
  name: "Name",
  place: "A place in the field: latitude, longitude",
  readFile: "Read it from a file",
  locate: "Where this device is",
  formats:
    "A file is KML, KMZ, Shapefile (zip), GeoPackage, GeoJSON, ISOXML, GPX or a flight plan.",
  height: (unit: string) => `Ground there above sea level, ${unit}`,
  heightHow: "As a map has it. A rough value is enough to rehearse.",
  drones: "Simulated drones",
  make: "Make the site",
  noAnswer: "The station does not answer: start it again, and reload this page.",
  middleOf: (file: string) =>
    `The place is the middle of ${file}. Import its shapes later, under Edit site.`,
  unknownPlace: "This device does not know its place: type it, or read it from a file.",
  made: "The site is made; the station is starting.",
  notStarted: "The site is made, but the station did not start: see its terminal.",
  badPlace: "Place: expected latitude and longitude in degrees, such as 41.9012, -93.6034.",
  badHeight: "Ground above sea level: expected a number.",
  badDrones: "Simulated drones: expected a whole number.",
};
