import type { StationState } from "../protocol";
import type { Clock } from "./clock";
import type { Connection } from "./stationSource";

/** The name under which this page holds steered orders: one for each connection, never used again. */

/** Random bytes in a name: nobody guesses another page's. */
const BYTES = 16;

/** The page says that it lives at most so often; the station gives up after 2 s of silence. */
export const BEAT_MS = 400;

/** A new name, 32 hexadecimal digits. */
export function newOwner(random: (bytes: Uint8Array) => Uint8Array): string {
  const bytes = random(new Uint8Array(BYTES));
  return Array.from(bytes, (byte) => byte.toString(16).padStart(2, "0")).join("");
}

/** Waits between attempts: soon at first, since most losses are short, then calm. */
export const RECONNECT_DELAYS_MS = [250, 500, 1000, 2000, 4000] as const;
/** A station that speaks 10 times a second and says nothing for so long is taken for lost. */
export const SILENCE_MS = 2_000;
/** An attempt that neither opens nor fails is given up after this. */
export const OPENING_MS = 4_000;

/** The part of `WebSocket` that is used. */
export interface Socket {
  onopen: ((event: Event) => void) | null;
  onmessage: ((event: MessageEvent) => void) | null;
  onclose: ((event: CloseEvent) => void) | null;
  send(text: string): void;
  close(): void;
}

export interface StreamListener {
  /** A whole state; `isFirst` marks the first one of a connection. */
  onState(state: StationState, isFirst: boolean): void;
  onConnection(connection: Connection): void;
}

/** Keeps one stream open: notices silence, reconnects with growing pauses, hands out whole states. */
export class Stream {
  private socket: Socket | null = null;
  private attempt = 0;
  private isFirst = true;
  private beatAtMs = Number.NEGATIVE_INFINITY;
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
    this.drop();
  }

  private connect(): void {
    const socket = this.tryToOpen();
    if (socket === null) return;
    this.socket = socket;
    this.isFirst = true;
    this.beatAtMs = Number.NEGATIVE_INFINITY;
    this.expectNewsWithin(OPENING_MS, "The station did not answer.");
    socket.onopen = () => this.expectNewsWithin(SILENCE_MS, "The station says nothing.");
    socket.onmessage = (event) => this.take(event.data);
    socket.onclose = (event) => this.lose(closingReason(event.code, event.reason));
  }

  /** A browser throws at once for a token that cannot be a subprotocol. */
  private tryToOpen(): Socket | null {
    try {
      return this.openSocket();
    } catch (error) {
      this.lose(`The stream cannot be opened: ${error instanceof Error ? error.message : error}.`);
      return null;
    }
  }

  private take(data: unknown): void {
    const state = readState(data);
    if (state === null) {
      this.lose("The station sent something this page cannot read. Reload the page.");
      return;
    }
    this.attempt = 0;
    this.expectNewsWithin(SILENCE_MS, "The station says nothing.");
    const isFirst = this.isFirst;
    this.isFirst = false;
    if (isFirst) this.listener.onConnection({ kind: "live" });
    this.listener.onState(state, isFirst);
    this.beat();
  }

  /**
   * Says that the page lives. Only what has just read and shown a state says it: a page that hangs, or
   * shows nothing new, holds no steered order any more.
   */
  private beat(): void {
    const nowMs = this.clock.now().monotonicMs;
    if (this.socket === null || nowMs - this.beatAtMs < BEAT_MS) return;
    this.beatAtMs = nowMs;
    this.socket.send("");
  }

  private expectNewsWithin(delayMs: number, otherwise: string): void {
    this.cancelTimer();
    this.cancelTimer = this.clock.after(delayMs, () => this.lose(otherwise));
  }

  private lose(reason: string): void {
    this.drop();
    this.cancelTimer();
    const last = RECONNECT_DELAYS_MS.length - 1;
    const delayMs = RECONNECT_DELAYS_MS[Math.min(this.attempt, last)] ?? 0;
    this.attempt += 1;
    this.listener.onConnection({ kind: "lost", reason, attempt: this.attempt });
    this.cancelTimer = this.clock.after(delayMs, () => this.connect());
  }

  /** Lets go of the socket, deaf to whatever it may still say. */
  private drop(): void {
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

function closingReason(code: number, reason: string): string {
  if (reason !== "") return `The station closed the stream: ${reason}`;
  if (code === POLICY_VIOLATION) return "The station refuses this page. Open it with its token.";
  return "The station cannot be reached.";
}

const LISTS = ["vehicles", "links", "commands", "alarms"] as const;

/** The state in a message, or null when it is none. */
export function readState(data: unknown): StationState | null {
  if (typeof data !== "string") return null;
  let value: unknown;
  try {
    value = JSON.parse(data);
  } catch {
    return null;
  }
  if (typeof value !== "object" || value === null) return null;
  const record = value as Record<string, unknown>;
  const hasLists = LISTS.every((name) => Array.isArray(record[name]));
  const isState = hasLists && typeof record["time_ns"] === "number" && "station" in record;
  return isState ? (value as StationState) : null;
}
