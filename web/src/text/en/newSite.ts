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
  formats: "A file is KML, KMZ, Shapefile (zip), GeoPackage or GeoJSON.",
  altitude: (unit: string) => `Ground altitude there, above the WGS84 ellipsoid, ${unit}`,
  altitudeHow: (least: string, most: string) =>
    `A rough value is enough to rehearse. It is the height above sea level plus the height of the geoid there, which is between ${least} and ${most}.`,
  drones: "Simulated drones",
  make: "Make the site",
  noAnswer: "The station does not answer: start it again, and reload this page.",
  middleOf: (file: string) =>
    `The place is the middle of ${file}. Import its shapes later, under Edit site.`,
  unknownPlace: "This device does not know its place: type it, or read it from a file.",
  made: "The site is made; the station is starting.",
  notStarted: "The site is made, but the station did not start: see its terminal.",
  badPlace: "Place: expected latitude and longitude in degrees, such as 41.9012, -93.6034.",
  badAltitude: "Ground altitude: expected a number.",
  badDrones: "Simulated drones: expected a whole number.",
};
