/** Where this page keeps its token: for this tab only, and never in the address bar or the history. */

const TOKEN_KEY = "recon.token";
const FINGERPRINT_KEY = "recon.fingerprint";

/** What a page was opened with. */
export interface PageLogin {
  readonly token: string | null;
  /** SHA-256 of the station's certificate, as the QR code on the station's terminal gave it. */
  readonly fingerprint: string | null;
}

type Stored = Pick<Storage, "getItem" | "setItem" | "removeItem">;

/** Takes token and fingerprint out of the address, or from this tab's storage. */
export function takeLogin(
  location: Pick<Location, "hash" | "pathname" | "search">,
  history: Pick<History, "replaceState">,
  storage: Stored,
): PageLogin {
  const named = new URLSearchParams(location.hash.replace(/^#/, ""));
  const token = named.get("token");
  const fingerprint = named.get("fingerprint");
  if (token) storage.setItem(TOKEN_KEY, token);
  if (fingerprint) storage.setItem(FINGERPRINT_KEY, fingerprint);
  if (token || fingerprint) {
    history.replaceState(null, "", location.pathname + location.search);
  }
  return { token: storage.getItem(TOKEN_KEY), fingerprint: storage.getItem(FINGERPRINT_KEY) };
}

/** Keeps a token for the next load of this tab; null logs out. */
export function keepToken(token: string | null, storage: Stored): void {
  if (token === null) storage.removeItem(TOKEN_KEY);
  else storage.setItem(TOKEN_KEY, token);
}

/** The token in what a user pasted: the token alone, or the whole address; null without one. */
export function pastedToken(text: string): string | null {
  const [, fragment] = text.trim().split("#", 2);
  const token = fragment === undefined ? text.trim() : new URLSearchParams(fragment).get("token");
  return token !== null && /^[A-Za-z0-9._~-]{1,200}$/.test(token) ? token : null;
}

/** A fingerprint in pairs, as browsers show it. */
export function inPairs(fingerprint: string): string {
  return (fingerprint.replaceAll(":", "").match(/.{1,2}/g) ?? []).join(":").toUpperCase();
}
