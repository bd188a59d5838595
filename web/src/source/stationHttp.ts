import createClient from "openapi-fetch";
import type { Outcome, Picture } from "../protocol";
import type { paths } from "../protocol/schema";
import { text } from "../text/catalogue";

/** How long a request may take, and what the operator does when it took longer. */
export interface Limit {
  readonly ms: number;
  readonly ifLate: string;
}

/** An order must not arrive long after the operator sent it. */
export const ORDER: Limit = {
  ms: 3_000,
  ifLate: text.requests.orderLate,
};
/** What changes the station, but is in no command list. */
export const CHANGE: Limit = {
  ms: 3_000,
  ifLate: text.requests.changeLate,
};
export const READ: Limit = { ms: 3_000, ifLate: text.requests.tryAgain };
export const PICTURE: Limit = { ms: 12_000, ifLate: text.requests.tryAgain };
/** Planning waits for image processing and moves nothing. */
export const PLANNING: Limit = {
  ms: 12_000,
  ifLate: text.requests.planningLate,
};
/** The site's files are read or written. */
const SITE_MS = 25_000;
export const SITE_READ: Limit = { ms: SITE_MS, ifLate: text.requests.siteReadLate };
/** A file to import may be read for 120 s, after another one, and the station says what is wrong with a slow one. */
export const SITE_IMPORT: Limit = { ms: 150_000, ifLate: text.requests.siteReadLate };
export const SITE_SAVE: Limit = {
  ms: SITE_MS,
  ifLate: text.requests.siteSaveLate,
};
/** A file made of a long flight record takes minutes, and nothing waits for it. */
export const RECORD: Limit = {
  ms: 600_000,
  ifLate: text.requests.recordLate,
};

/** HTTP to the station, with this page's token. */
export class StationHttp {
  readonly client;
  readonly headers: Readonly<Record<string, string>>;

  constructor(
    readonly origin: string,
    token: string | null,
    readonly fetch: (request: Request) => Promise<Response>,
  ) {
    this.headers = token === null ? {} : { Authorization: `Bearer ${token}` };
    this.client = createClient<paths>({ baseUrl: origin, headers: this.headers, fetch });
  }

  /** Fetches a picture or file; always with the token's header, which an `<img>` could not send. */
  picture(path: string, limit = PICTURE): Promise<Outcome<Picture>> {
    return this.read(limit, path, {}, async (response) => ({
      blob: await response.blob(),
      frameId: frameIdOf(response),
    }));
  }

  /** For requests that the typed client cannot express. */
  read<T>(
    limit: Limit,
    path: string,
    init: RequestInit,
    value: (response: Response) => Promise<T>,
  ): Promise<Outcome<T>> {
    return attempt(limit, async (signal) => {
      const { origin, headers } = this;
      const response = await this.fetch(new Request(origin + path, { ...init, headers, signal }));
      if (response.ok) return done(await value(response));
      return failed(refusal(response, await response.json().catch(() => null)));
    });
  }
}

function frameIdOf(response: Response): number | null {
  const id = response.headers.get("X-Frame-Id");
  return id !== null && /^\d+$/.test(id) ? Number(id) : null;
}

interface ApiResponse<D> {
  readonly data?: D;
  readonly error?: unknown;
  readonly response: Response;
}

type Ask<D> = (signal: AbortSignal) => Promise<ApiResponse<D>>;

/** The answer's body; `read` takes the value out of it. */
export function answered<D>(limit: Limit, ask: Ask<D>): Promise<Outcome<D>>;
export function answered<D, T>(
  limit: Limit,
  ask: Ask<D>,
  read: (data: D) => T,
): Promise<Outcome<T>>;
export function answered<D, T>(
  limit: Limit,
  ask: Ask<D>,
  read?: (data: D) => T,
): Promise<Outcome<D | T>> {
  return attempt(limit, async (signal) => {
    const { data, error, response } = await ask(signal);
    if (data === undefined) return failed(refusal(response, error));
    return done(read === undefined ? data : read(data));
  });
}

/** For requests whose answer has no body. */
export function withoutBody(limit: Limit, ask: Ask<unknown>): Promise<Outcome<null>> {
  return attempt(limit, async (signal) => {
    const { error, response } = await ask(signal);
    return response.ok ? done(null) : failed(refusal(response, error));
  });
}

/** Failures are values with a sentence for the operator. */
export async function attempt<T>(
  { ms, ifLate }: Limit,
  ask: (signal: AbortSignal) => Promise<Outcome<T>>,
): Promise<Outcome<T>> {
  try {
    return await ask(AbortSignal.timeout(ms));
  } catch (error) {
    const isLate = error instanceof DOMException && error.name === "TimeoutError";
    if (isLate) return failed(text.requests.late(ms / 1000, ifLate));
    return failed(text.requests.unreachable);
  }
}

export function done<T>(value: T): Outcome<T> {
  return { kind: "answered", value };
}

export function failed<T>(problem: string): Outcome<T> {
  return { kind: "failed", problem };
}

const UNAUTHORISED = 401;

export function refusal(response: Response, body: unknown): string {
  if (response.status === UNAUTHORISED) {
    return text.requests.badToken;
  }
  const message =
    typeof body === "object" && body !== null ? (body as { error?: unknown }).error : null;
  if (typeof message === "string") return message;
  return text.requests.stationError(`${response.status} ${response.statusText}`.trim());
}
