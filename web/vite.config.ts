import solid from "vite-plugin-solid";
import { defineConfig } from "vitest/config";
import { shellPlugin, WORKER } from "./shellPlugin.ts";

/** The station under development; `npm run dev` sends the API's requests there. */
const station = process.env["RECON_STATION"] ?? "http://127.0.0.1:8080";

export default defineConfig({
  plugins: [solid(), shellPlugin()],
  // Relative addresses, so that the built page works under any folder it is served from.
  base: "./",
  build: {
    target: "es2022",
    chunkSizeWarningLimit: 1500,
    rolldownOptions: {
      input: ["index.html", "new-site.html", "src/offline/serviceWorker.ts"],
      output: {
        // A worker keeps what is below its own address.
        entryFileNames: ({ name }) =>
          name === "serviceWorker" ? WORKER : "assets/[name]-[hash].js",
      },
    },
  },
  server: { host: "127.0.0.1", proxy: { "/api": { target: station, ws: true } } },
  preview: { host: "127.0.0.1", proxy: { "/api": { target: station, ws: true } } },
  test: {
    environment: "happy-dom",
    include: ["src/**/*.test.{ts,tsx}"],
    restoreMocks: true,
    // Each file in a context of its own, as with processes, at a sixth of their time.
    pool: "vmThreads",
    // Only a broken test takes this long; a busy machine must not fail one.
    testTimeout: 60_000,
    hookTimeout: 60_000,
  },
});
