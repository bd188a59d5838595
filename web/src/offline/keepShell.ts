/** After the first screen, which it must not delay. */
const AFTER_MS = 5000;

/**
 * Has the browser keep the page's files, so that it opens without a station and can be installed. A browser keeps none
 * for an address whose certificate it does not trust; the page is the same without.
 */
export function keepShell(workers: Pick<ServiceWorkerContainer, "register"> | undefined): void {
  setTimeout(() => {
    workers?.register("./sw.js", { updateViaCache: "none" }).catch(() => {});
  }, AFTER_MS);
}
