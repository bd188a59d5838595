import { createHash } from "node:crypto";
import { readdirSync, readFileSync } from "node:fs";
import type { Plugin } from "vite";

/** Name of the worker that keeps the page's files, at the root of what it keeps. */
export const WORKER = "sw.js";
const PUBLIC = new URL("public/", import.meta.url);
/** The page that makes a site is of a station that has just begun: it is not kept. */
const IS_LEFT_OUT = /^sw\.js$|new-?site/i;

/** Writes into the worker which files there are, and a version that changes with any of them. */
export function shellPlugin(): Plugin {
  return {
    name: "shell",
    apply: "build",
    generateBundle: {
      order: "post",
      handler(_options, bundle) {
        const worker = bundle[WORKER];
        if (worker?.type !== "chunk") throw new Error(`The build has no ${WORKER}.`);
        const files = new Map<string, string | Uint8Array>();
        for (const [name, file] of Object.entries(bundle))
          if (!IS_LEFT_OUT.test(name))
            files.set(name, file.type === "chunk" ? file.code : file.source);
        for (const name of readdirSync(PUBLIC))
          files.set(name, readFileSync(new URL(name, PUBLIC)));
        const hash = createHash("sha256");
        for (const [name, content] of [...files].sort(([a], [b]) => (a < b ? -1 : 1)))
          hash.update(name).update(content);
        worker.code = worker.code
          .replace("SHELL_FILES", JSON.stringify([...files.keys()]))
          .replace("SHELL_VERSION", JSON.stringify(hash.digest("hex").slice(0, 16)));
      },
    },
  };
}
