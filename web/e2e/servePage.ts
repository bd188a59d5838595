import { mkdtemp, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { build, preview } from "vite";

const ROOT = fileURLToPath(new URL("..", import.meta.url));

/**
 * Serves the page on a free port; tests get the address in `RECON_E2E_PAGE`. The page is the one built in
 * `RECON_E2E_DIST`, else it is built into a temporary folder, so that concurrent runs do not interfere.
 */
export default async function servePage(): Promise<() => Promise<void>> {
  const built = process.env["RECON_E2E_DIST"];
  const outDir = built ?? (await mkdtemp(join(tmpdir(), "recon-console-")));
  if (built === undefined)
    await build({ root: ROOT, logLevel: "warn", build: { outDir, emptyOutDir: true } });
  const server = await preview({
    root: ROOT,
    logLevel: "warn",
    build: { outDir },
    preview: { port: 0 },
  });
  const address = server.httpServer.address();
  if (address === null || typeof address === "string") {
    throw new Error(`Expected a port, got ${address}.`);
  }
  process.env["RECON_E2E_PAGE"] = `http://127.0.0.1:${address.port}`;
  return async () => {
    await server.close();
    if (built === undefined) await rm(outDir, { recursive: true });
  };
}
