// Runs in the console's page before its own scripts. It notes when each state is received and when the frame
// that shows it is on the screen: with the first change of a drone's symbol after a state, a text with the state's
// number is put on the page, and Element Timing reports when the frame with that text was presented.
(() => {
  const probe = { received: [], painted: [], useful_ms: null };
  window.reconProbe = probe;
  const holder = document.createElement("div");
  holder.style.cssText = "position:fixed;left:0;bottom:0;z-index:9999;font:8px monospace";
  const mark = (name) => {
    const text = document.createElement("div");
    text.setAttribute("elementtiming", name);
    text.textContent = ".";
    text.style.cssText = "position:absolute;left:0;bottom:0";
    holder.append(text);
    // One that is removed before its frame is presented is not reported.
    if (holder.childElementCount > 60) holder.firstElementChild.remove();
    if (!holder.isConnected) document.body.append(holder);
  };
  new PerformanceObserver((list) => {
    for (const { identifier, renderTime } of list.getEntries()) {
      if (identifier === "useful") probe.useful_ms = renderTime;
      else probe.painted.push([Number(identifier), performance.timeOrigin + renderTime]);
    }
  }).observe({ type: "element", buffered: true });

  const Native = window.WebSocket;
  let newest = null;
  window.WebSocket = class extends Native {
    constructor(...given) {
      super(...given);
      this.addEventListener("message", ({ data }) => {
        const stamp_ms = Number(/"time_ns":(\d+)/.exec(data)?.[1]) / 1e6;
        probe.received.push([stamp_ms, performance.timeOrigin + performance.now()]);
        newest = stamp_ms;
      });
    }
  };
  new MutationObserver((changes) => {
    const isMoved = changes.some(({ target }) => target.classList?.contains("craft"));
    if (!isMoved || newest === null) return;
    if (probe.useful_ms !== null) mark(String(newest));
    newest = null;
  }).observe(document, { attributes: true, attributeFilter: ["style"], subtree: true });

  const DRONES = window.reconDrones;
  const look = () => {
    const has = (selector) => document.querySelectorAll(selector).length >= DRONES;
    if (has("button.craft") && has(".vehicle")) mark("useful");
    else requestAnimationFrame(look);
  };
  document.addEventListener("DOMContentLoaded", look);
})();
