import { createShell } from "./shell";

/** What the library of types for pages leaves out. */
interface WorkerScope {
  readonly registration: { readonly scope: string };
  readonly clients: { claim(): Promise<void> };
  skipWaiting(): Promise<void>;
  addEventListener(kind: string, listener: (event: WorkerEvent) => void): void;
}

interface WorkerEvent extends Event {
  readonly request: Request;
  waitUntil(done: Promise<unknown>): void;
  respondWith(answer: Promise<Response>): void;
}

/** Set by the build: the files of this version, and its name. */
declare const SHELL_FILES: readonly string[];
declare const SHELL_VERSION: string;

const scope = self as unknown as WorkerScope;
const shell = createShell(SHELL_FILES, SHELL_VERSION, {
  caches,
  fetch: (request) => fetch(request),
  wait: (ms) => new Promise((resolve) => setTimeout(resolve, ms)),
  folder: scope.registration.scope,
});
scope.addEventListener("install", (event) => {
  // At once: an old version must not outlive the station's update.
  event.waitUntil(Promise.all([shell.install(), scope.skipWaiting()]));
});
scope.addEventListener("activate", (event) => {
  event.waitUntil(Promise.all([shell.activate(), scope.clients.claim()]));
});
scope.addEventListener("fetch", (event) => {
  const answer = shell.answer(event.request);
  if (answer !== null) event.respondWith(answer);
});
