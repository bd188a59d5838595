import { beforeEach, describe, expect, it } from "vitest";
import { createShell } from "./shell";

const FOLDER = "https://station:8443/";
const FILES = ["index.html", "assets/index-abc.js", "manifest.webmanifest"];

/** Caches in memory, by name and address. */
const stored = new Map<string, Map<string, string>>();
let online = true;
let isSilent = false;
let asked: string[] = [];

const pageOf = async (request: Request | string): Promise<Response> => {
  const url = String(request);
  asked.push(url);
  if (isSilent) return new Promise(() => {});
  if (!online) throw new TypeError("no network");
  return new Response(`new ${url}`);
};
const caches = {
  open: async (name: string) => {
    const entries = stored.get(name) ?? new Map<string, string>();
    stored.set(name, entries);
    return {
      addAll: async (urls: string[]) => urls.forEach((url) => void entries.set(url, `kept ${url}`)),
      match: async (url: string) =>
        entries.has(url) ? new Response(entries.get(url) as string) : undefined,
    } as unknown as Cache;
  },
  keys: async () => [...stored.keys()],
  delete: async (name: string) => stored.delete(name),
};
const shellOf = (version: string) =>
  createShell(FILES, version, { caches, fetch: pageOf, wait: async () => {}, folder: FOLDER });
const shell = shellOf("v1");
const get = (path: string, mode: RequestMode = "no-cors", method = "GET") =>
  shell.answer({ method, mode, url: FOLDER + path });
const textOf = async (path: string, mode?: RequestMode) => (await get(path, mode))?.text();

beforeEach(async () => {
  stored.clear();
  [online, isSilent, asked] = [true, false, []];
  await shell.install();
});

describe("the page without a station", () => {
  it("is the kept one, whatever follows its address", async () => {
    online = false;
    for (const path of ["", "index.html", "?x=1"])
      expect(await textOf(path, "navigate"), path).toBe(`kept ${FOLDER}index.html`);
    expect(await textOf("assets/index-abc.js")).toBe(`kept ${FOLDER}assets/index-abc.js`);
  });

  it("is the kept one where the station is silent", async () => {
    isSilent = true;
    expect(await textOf("", "navigate")).toBe(`kept ${FOLDER}index.html`);
  });
});

describe("the page with a station", () => {
  it("is asked for first: a new version replaces the old one at once", async () => {
    expect(await textOf("", "navigate")).toBe(`new ${FOLDER}`);
  });

  it("drops the files of other versions, and nothing of others", async () => {
    stored.set("elsewhere", new Map());
    const next = shellOf("v2");
    await next.install();
    await next.activate();
    expect([...stored.keys()].sort()).toEqual(["elsewhere", "recon-shell-v2"]);
  });
});

it.each([
  ["api/state", "cors", "GET"],
  ["api/stream?owner=1", "websocket", "GET"],
  ["api/ground-image.png", "no-cors", "GET"],
  ["api/orders", "cors", "POST"],
  ["api/flights", "navigate", "GET"],
  ["openapi.json", "navigate", "GET"],
  ["assets/of-another-build.js", "no-cors", "GET"],
] as const)("%s is the station's alone, and never kept", (path, mode, method) => {
  expect(get(path, mode as RequestMode, method)).toBeNull();
});
