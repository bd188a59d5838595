import { existsSync } from "node:fs";
import { defineConfig } from "@playwright/test";

/** The system's browser: the one named by `RECON_CHROMIUM`, or the first found where packages put it. */
const named = process.env["RECON_CHROMIUM"];
const usual = ["chromium-headless-shell", "chromium", "chromium-browser", "google-chrome"].map(
  (name) => `/usr/bin/${name}`,
);
const executablePath = [...(named === undefined ? [] : [named]), ...usual].find((path) =>
  existsSync(path),
);
if (executablePath === undefined) {
  throw new Error(
    "No Chromium found. Install it (sudo apt-get install chromium) or name one in RECON_CHROMIUM.",
  );
}
// Workers read this file too and must find the same folder.
process.env["RECON_E2E_RUN"] ??= String(process.pid);
const args = [
  "--no-sandbox",
  "--use-angle=swiftshader",
  "--enable-unsafe-swiftshader",
  // Without a GPU the page is put together faster by the processor than by an emulated GPU; the map stays WebGL.
  "--disable-gpu-compositing",
];

/** Tests with a station that flies. */
const FLYING = ["restart.spec.ts", "site.spec.ts", "station.spec.ts", "surveys.spec.ts"];

export default defineConfig({
  testDir: "e2e",
  globalSetup: "./e2e/servePage.ts",
  // One folder for each run, which clears it when it begins.
  outputDir: `test-results/${process.env["RECON_E2E_RUN"]}`,
  workers: 2,
  // Deadlines that only a broken test reaches, however busy the machine is.
  timeout: 300_000,
  expect: { timeout: 60_000 },
  reporter: "list",
  projects: [
    // Flights are in real time, and two at once would be late on two cores: one after the other, while
    // pages with a fake station, a replay or vehicles on the ground take the other worker.
    { name: "flights", testMatch: FLYING, workers: 1 },
    { name: "pages", testIgnore: ["screens.spec.ts", ...FLYING], fullyParallel: true },
    { name: "screens", testMatch: "screens.spec.ts" },
  ],
  use: {
    // Set by the global setup, before the workers read this file.
    baseURL: process.env["RECON_E2E_PAGE"],
    // A small laptop's window: without a GPU each pixel of the map costs the processor.
    viewport: { width: 1200, height: 720 },
    // Each page would keep all files anew; one test has it.
    serviceWorkers: "block",
    launchOptions: { args, executablePath },
  },
});
