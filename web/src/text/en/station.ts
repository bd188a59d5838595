import type { JSX } from "solid-js";
import type { FlightFile, LinkFiguresView, LinkView, TimelineSubject } from "../../protocol";

/** What the page itself finds about the connection; the station's reasons are its own. */
export const connection = {
  lost: "No connection to the station.",
  noData: "No data received yet.",
  /** `age` is an element that screen readers exclude. */
  dataIsOld: (age: JSX.Element): JSX.Element => ["All data below is ", age, " old."],
  reconnecting: (reason: string, attempt: number) =>
    `${reason}; reconnecting (attempt ${attempt}).`,
  loginAgain: (reason: string) => `${reason}. Log in again.`,
  watchAircraft: "Watch the aircraft and use the remote controllers.",
  startReplay: "This is a replay: start recon replay again.",
  noAnswer: "No answer from the station",
  silent: "No data from the station",
  cannotOpen: (problem: string) => `Cannot open the stream: ${problem}`,
  unreadable: "Unreadable data from the station: reload the page",
  notLoggedIn: "Not logged in",
  pageHung: "This page stopped responding",
  closed: (reason: string) => `Stream closed by the station: ${reason}`,
  denied: "Access denied: open the console with its token",
  unreachable: "Station unreachable",
};

/** Why a request failed, and what to do. */
export const requests = {
  late: (seconds: number, whatToDo: string) =>
    `The station did not answer within ${seconds} s. ${whatToDo}`,
  orderLate: "The order may still have arrived: check the command list.",
  changeLate: "It may still have taken effect: look at what this page shows before trying again.",
  tryAgain: "Try again.",
  planningLate: "No drone moves. Look for the survey in the list before planning it again.",
  siteReadLate: "Nothing was saved. Try again.",
  siteSaveLate: "Load the site again to see whether it was saved.",
  recordLate: "Try again, or use recon export on the station's computer.",
  unreachable: "Station unreachable. Use the remote controllers.",
  badToken: "Not logged in: the token is missing, wrong or ended.",
  stationError: (status: string) => `Station error ${status}`,
  guardRefused: (status: number) => `The guard refused: ${status}`,
  notSeenFlying: "nothing recent shows it in flight; use its controller",
  refused: (reason: string) => `Refused: ${reason}`,
  noReason: "no reason given",
};

export const login = {
  title: "Log in to Recon",
  token: "Token, or the whole address with it",
  notAToken: (command: JSX.Element): JSX.Element => [
    "This is not a token: paste what ",
    command,
    " printed.",
  ],
  logIn: "Log in",
  logOut: "Log out",
  forget: "Forget the token of this tab",
  howTo: (command: JSX.Element): JSX.Element => [
    "An administrator runs ",
    command,
    " at the station's computer; scan the code it shows, or paste the token. The tab forgets it when it is closed.",
  ],
  fingerprint:
    "The code you scanned names this certificate. Compare it with the one your browser shows; if they differ, another computer answers here.",
  otherComputers: "Console for other computers",
  certificate: "Certificate SHA-256",
  addressCode: "The first address as a QR code",
};

export const links = {
  none: "No app connected.",
  link: (id: number) => `Link ${id}`,
  noSerial: "no serial number yet",
  serial: (serial: string) => `Serial number: ${serial}`,
  faults: "faults",
  states: {
    waiting: "Waiting",
    conflict: "Conflict",
    unidentified: "Unidentified",
    identified: "Identified",
    closed: "Closed",
  } satisfies Record<LinkView["status"], string>,
  traffic: (address: string, packets: number, bytes: string, age: string) =>
    `${address}, ${packets} packets, ${bytes}, last ${age} ago`,
  figures: (found: LinkFiguresView) =>
    `Telemetry ${found.rate_hz.toFixed(1)} times per second, jitter ${found.jitter_s.toFixed(2)} s, longest gap of the last minute ${found.longest_gap_s.toFixed(1)} s`,
  ignoredAnswers: (count: number) => `${count} answers ignored: they may belong to another command`,
  closed: (reason: string) => `Closed: ${reason}`,
  badChecksum: (count: number) => `${count} bad checksum`,
  badSize: (count: number) => `${count} bad size`,
  unknownType: (count: number) => `${count} unknown packet type`,
  invalid: (count: number) => `${count} invalid content`,
  skipped: (count: number) => `${count} bytes skipped`,
  connect: "Connect a companion app",
  typeOneOf: "Type the address that the phone reaches, or scan the first one.",
  typeIt: "Type this address in the app, or scan the code with it.",
  qrCode: (address: string) => `QR code of ${address}`,
};

/** An app that the station's list does not admit. */
export const waitingApp = {
  name: (of: string) => `Admit ${of}`,
  noSerial: "No serial number yet",
  from: (serial: JSX.Element, address: string, since: JSX.Element): JSX.Element => [
    serial,
    ` from ${address} `,
    since,
  ],
  waits: (age: string, reason: string) => `waits for ${age}: ${reason}`,
  flies: "Reports flight: others keep clear of it, and stops reach it.",
  compare: "An app's serial is not authenticated: compare it with the aircraft.",
  admit: "Admit",
  admitOf: (name: string) => `${name} for good, from its present address`,
  admitOnce: "Admit for this run",
  admitOnceOf: (name: string) => `${name} until the station stops`,
  refuse: "Refuse for 5 min",
};

export const station = {
  title: "Station",
  noData: "No data yet.",
  version: "Version",
  uptime: "Uptime",
  appAddress: "App address",
  framesDropped: "Frames dropped",
  rawCapture: "Raw capture",
  captureOff: "off",
  refused: "Connections refused",
  captureLost: "Lost from raw capture",
  site: "Site",
  groundAltitude: "Ground altitude, WGS84",
  terrain: "Terrain",
  elevationModel: "elevation model",
  flat: "assumed flat",
  maxHeight: "Max. height above ground",
  maxDistance: "Max. distance from home",
  imagers: "Imaging drones",
  poseError: "Camera pose error, RMS",
  poseHeight: "Camera pose height above ground",
  saveGroundImage: "Save ground image (GeoTIFF)",
};

export const timeline = {
  drone: "Drone",
  allDrones: "All",
  about: "About",
  everything: "Everything",
  subjects: {
    orders: "Orders",
    alarms: "Alarms",
    flights: "Flights and links",
    operations: "Surveys, zones, site",
    station: "Station and users",
  } satisfies Record<TimelineSubject, string>,
  loading: "Loading the timeline.",
  empty: "Nothing has happened.",
  name: "What happened, the newest first",
  onlyNewest: (count: number) =>
    `The newest ${count} are shown. Choose a drone or a subject to see earlier ones.`,
  earlier: "Earlier",
};

export const flights = {
  refresh: "Refresh",
  refreshHint: "Read the folder again",
  loading: "Loading the flight records.",
  none: "No flight records in the station's folder.",
  recording: "recording",
  onGround: (time: string) => `${time}, on the ground`,
  stillRecorded: "Record MCAP: this flight is still being recorded.",
  tooLarge: "Record MCAP: too large for a browser; copy it from the station's folder.",
  reading: "Reading the record…",
  coverage: "Ground photographed in sun",
  well: "in sun on enough photos",
  sunlit: "on fewer",
  shade: "not surely in sun",
  gap: "not photographed",
  files: {
    "report.html": "Report",
    "sun.tif": "Sun GeoTIFF",
    "surveys.kml": "Surveys KML",
    "tracks.gpx": "Tracks GPX",
    "tracks.geojson": "Tracks GeoJSON",
    "tracks.csv": "Tracks CSV",
    // The picture of the coverage is shown, not offered.
  } satisfies Record<Exclude<FlightFile, "coverage.png">, string>,
  record: "Record MCAP",
  recordHint: "The whole record, for replays and bug reports",
  site: "Site",
  unnamed: "unnamed",
  time: "Time",
  fromTo: (begin: string, end: string) => `${begin} to ${end} UTC`,
  vehicles: "Vehicles",
  airborne: "In the air, together",
  region: "Region",
  noSurvey: "no survey",
  photographed: "Photographed",
  inSun: "In sun on a photo",
  wellInSun: "In sun on enough photos",
  meanSun: "Mean sun on the region",
  alarms: "Alarms",
  endsEarly: (reason: string) => `The record ends early: ${reason}`,
  estimated: "Estimated from tracks and camera timer; recon tag reads the photos.",
};

export const replay = {
  name: "Replay",
  mark: "REPLAY",
  markHint: "A recorded flight: no orders are possible",
  pause: "Pause the replay",
  play: "Play the replay",
  pauseHint: "Pause (Space)",
  playHint: "Play (Space)",
  speed: "Speed",
  speedName: "Replay speed",
  previous: "Previous alarm or order",
  next: "Next alarm or order",
  localTime: "Local time of the record",
  position: "Position in the record",
  positionOf: (position: string, duration: string, time: string) =>
    `${position} of ${duration}, local time ${time}`,
  endsEarly: (reason: string) => `The record ends early: ${reason}`,
};
