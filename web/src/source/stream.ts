import type { Connection, StationState } from "../protocol";
import { text } from "../text/catalogue";
import { capitalised } from "../text/names";
import type { Clock } from "./clock";
import { changedState, isStateChange } from "./stateChange";

/** Length of an owner name; random, so that no page can guess another's. */
const OWNER_BYTES = 16;

/** Shortest interval between keepalives; the station stops steered orders after 2 s without one. */
export const KEEPALIVE_MS = 400;

/**
 * A new owner name, 32 hexadecimal digits. The page owns its steered orders under this name: one for each
 * connection, never reused.
 */
export function newStreamOwner(random: (bytes: Uint8Array) => Uint8Array): string {
  const bytes = random(new Uint8Array(OWNER_BYTES));
  return Array.from(bytes, (byte) => byte.toString(16).padStart(2, "0")).join("");
}

/** Waits between reconnection attempts: short at first, since most losses are short. */
export const RECONNECT_DELAYS_MS = [250, 500, 1000, 2000, 4000] as const;
/** The station sends 10 states a second; after this long without one the connection counts as lost. */
export const SILENCE_MS = 2_000;
/** Timeout of one connection attempt. */
export const OPENING_MS = 4_000;

/** The part of `WebSocket` used here. */
export interface Socket {
  onopen: ((event: Event) => void) | null;
  onmessage: ((event: MessageEvent) => void) | null;
  onclose: ((event: CloseEvent) => void) | null;
  send(text: string): void;
  close(): void;
}

export interface StreamListener {
  /** A complete state; `isFirst` marks the first one of a connection. */
  onState(state: StationState, isFirst: boolean): void;
  onConnection(connection: Connection): void;
}

/**
 * Keeps one WebSocket to the station open and hands out complete states.
 *
 *   connecting --first state--> live --closed, unreadable or silent for SILENCE_MS--> lost
 *   lost --next wait of RECONNECT_DELAYS_MS--> a new attempt --first state--> live
 *
 * An attempt that neither opens nor fails ends after OPENING_MS. The wait grows with each failed attempt
 * and starts over after a received state. Each received state also sends a keepalive, at most one per
 * KEEPALIVE_MS: a page that hangs receives nothing, sends nothing, and its steered orders stop.
 */
export class Stream {
  private socket: Socket | null = null;
  private attempt = 0;
  /** The last state of this connection, to which changes are applied. */
  private base: StationState | null = null;
  private isFirst = true;
  private keepaliveAtMs = Number.NEGATIVE_INFINITY;
  private cancelTimer: () => void = () => {};

  constructor(
    private readonly openSocket: () => Socket,
    private readonly clock: Clock,
    private readonly listener: StreamListener,
  ) {}

  open(): void {
    this.listener.onConnection({ kind: "connecting" });
    this.connect();
  }

  close(): void {
    this.cancelTimer();
    this.closeSocket();
  }

  private connect(): void {
    const socket = this.openOrFail();
    if (socket === null) return;
    this.socket = socket;
    this.isFirst = true;
    this.base = null;
    this.keepaliveAtMs = Number.NEGATIVE_INFINITY;
    this.expectMessageWithin(OPENING_MS, text.connection.noAnswer);
    socket.onopen = () => this.expectMessageWithin(SILENCE_MS, text.connection.silent);
    socket.onmessage = (event) => this.receive(event.data);
    socket.onclose = (event) => {
      if (event.code === LOGIN_NEEDED) this.awaitLogin(event.reason);
      else this.loseConnection(closingReason(event.code, event.reason));
    };
  }

  /** A browser throws for a token that is not a valid subprotocol. */
  private openOrFail(): Socket | null {
    try {
      return this.openSocket();
    } catch (error) {
      const problem = error instanceof Error ? error.message : String(error);
      this.loseConnection(text.connection.cannotOpen(problem));
      return null;
    }
  }

  private receive(data: unknown): void {
    const state = readState(data, this.base);
    this.base = state;
    if (state === null) {
      this.loseConnection(text.connection.unreadable);
      return;
    }
    this.attempt = 0;
    this.expectMessageWithin(SILENCE_MS, text.connection.silent);
    const isFirst = this.isFirst;
    this.isFirst = false;
    if (isFirst) this.listener.onConnection({ kind: "live" });
    this.listener.onState(state, isFirst);
    this.sendKeepalive();
  }

  /** Sent only after a state was received and handed on, so that a hanging page loses its steered orders. */
  private sendKeepalive(): void {
    const nowMs = this.clock.now().monotonicMs;
    if (this.socket === null || nowMs - this.keepaliveAtMs < KEEPALIVE_MS) return;
    this.keepaliveAtMs = nowMs;
    this.socket.send("");
  }

  private expectMessageWithin(delayMs: number, otherwise: string): void {
    this.cancelTimer();
    this.cancelTimer = this.clock.after(delayMs, () => this.loseConnection(otherwise));
  }

  private loseConnection(reason: string): void {
    this.closeSocket();
    this.cancelTimer();
    const last = RECONNECT_DELAYS_MS.length - 1;
    const delayMs = RECONNECT_DELAYS_MS[Math.min(this.attempt, last)] ?? 0;
    this.attempt += 1;
    this.listener.onConnection({ kind: "lost", reason, attempt: this.attempt });
    this.cancelTimer = this.clock.after(delayMs, () => this.connect());
  }

  /** Without a right token each further attempt would count as a failed login. */
  private awaitLogin(reason: string): void {
    this.closeSocket();
    this.cancelTimer();
    this.attempt += 1;
    this.listener.onConnection({
      kind: "lost",
      reason: reason === "" ? text.connection.notLoggedIn : capitalised(reason),
      attempt: this.attempt,
      needsLogin: true,
    });
  }

  /** Closes the socket and ignores any further events from it. */
  private closeSocket(): void {
    const socket = this.socket;
    this.socket = null;
    if (socket === null) return;
    socket.onopen = null;
    socket.onmessage = null;
    socket.onclose = null;
    socket.close();
  }
}

const POLICY_VIOLATION = 1008;
/** The station received no keepalive from this page in time. */
const OWNER_SILENT = 4008;

/** The station wants a token, or ended the one of this page. */
const LOGIN_NEEDED = 4401;

function closingReason(code: number, reason: string): string {
  if (code === OWNER_SILENT) return text.connection.pageHung;
  if (reason !== "") return text.connection.closed(reason);
  if (code === POLICY_VIOLATION) return text.connection.denied;
  return text.connection.unreachable;
}

const LISTS = ["vehicles", "links", "commands", "alarms"] as const;

/** The state in a message, whole or as a change of the one before; null when it is neither. */
export function readState(data: unknown, base: StationState | null = null): StationState | null {
  if (typeof data !== "string") return null;
  let value: unknown;
  try {
    value = JSON.parse(data);
  } catch {
    return null;
  }
  if (typeof value !== "object" || value === null) return null;
  if (!isStateChange(value)) return isState(value) ? value : null;
  const state = base === null ? null : changedState(base, value);
  return isState(state) ? state : null;
}

function isState(value: unknown): value is StationState {
  if (typeof value !== "object" || value === null) return false;
  const record = value as Record<string, unknown>;
  const hasLists = LISTS.every((name) => Array.isArray(record[name]));
  return hasLists && typeof record["time_ns"] === "number" && "station" in record;
}
