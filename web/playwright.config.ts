import { existsSync } from "node:fs";
import { defineConfig } from "@playwright/test";

/** The system's browser: the one named by `RECON_CHROMIUM`, or the first found where packages put it. */
const named = process.env["RECON_CHROMIUM"];
const usual = ["chromium", "chromium-browser", "google-chrome"].map((name) => `/usr/bin/${name}`);
const executablePath = [...(named === undefined ? [] : [named]), ...usual].find((path) =>
  existsSync(path),
);
if (executablePath === undefined) {
  throw new Error(
    "No Chromium found. Install it (sudo apt-get install chromium) or name one in RECON_CHROMIUM.",
  );
}
const args = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"];
const PORT = 4173;

export default defineConfig({
  testDir: "e2e",
  workers: 1,
  timeout: 60_000,
  expect: { timeout: 15_000 },
  reporter: "list",
  projects: [
    { name: "e2e", testIgnore: "screens.spec.ts" },
    { name: "screens", testMatch: "screens.spec.ts" },
  ],
  use: {
    baseURL: `http://127.0.0.1:${PORT}`,
    viewport: { width: 1440, height: 900 },
    launchOptions: { args, executablePath },
  },
  webServer: {
    command: `npm run --silent build && npx vite preview --port ${PORT} --strictPort`,
    url: `http://127.0.0.1:${PORT}`,
    reuseExistingServer: false,
  },
});
