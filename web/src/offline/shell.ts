/** What the shell needs of its worker; a test gives its own. */
export interface ShellParts {
  readonly caches: Pick<CacheStorage, "open" | "keys" | "delete">;
  fetch(request: Request | string): Promise<Response>;
  /** Resolves after so many milliseconds. */
  wait(ms: number): Promise<void>;
  /** Address of the folder that the page is served from, with a slash at its end. */
  readonly folder: string;
}

/** The page without its station. */
export interface Shell {
  install(): Promise<void>;
  activate(): Promise<void>;
  /** The answer to a request; null: it is none of the shell's, and the browser asks the station. */
  answer(request: Pick<Request, "method" | "mode" | "url">): Promise<Response> | null;
}

export const PAGE = "index.html";
const PREFIX = "recon-shell-";
/** A station that does not answer for so long gives way to the kept page, which says so. */
export const PAGE_WITHIN_MS = 4000;

/**
 * Keeps the page's own files, so that it opens without a station. Theory of operation. Only the files of one build are
 * kept, under its version; the page itself is always asked for first, so that a new version replaces the old one at the
 * next load. Nothing else is answered here: what the API says is never kept, and so nothing old is shown as if it were
 * of now. A kept page has no state, connects, and says that there is no station.
 */
export function createShell(files: readonly string[], version: string, parts: ShellParts): Shell {
  const { caches, folder } = parts;
  const name = `${PREFIX}${version}`;
  const own = new Set(files.map((file) => folder + file));
  const kept = async (url: string) => (await caches.open(name)).match(url);

  const page = async (url: string): Promise<Response> => {
    const asked = parts.fetch(url).catch(() => null);
    const first = await Promise.race([asked, parts.wait(PAGE_WITHIN_MS).then(() => null)]);
    const answer = first ?? (await kept(folder + PAGE)) ?? (await asked);
    return answer ?? Response.error();
  };
  const file = async (url: string) => (await kept(url)) ?? parts.fetch(url);

  return {
    install: async () => (await caches.open(name)).addAll([...own]),
    activate: async () => {
      const old = (await caches.keys()).filter((key) => key.startsWith(PREFIX) && key !== name);
      await Promise.all(old.map((key) => caches.delete(key)));
    },
    answer: ({ method, mode, url }) => {
      const plain = url.replace(/[?#].*$/, "");
      if (method !== "GET") return null;
      if (mode === "navigate")
        return plain === folder || plain === folder + PAGE ? page(url) : null;
      return own.has(plain) ? file(plain) : null;
    },
  };
}
