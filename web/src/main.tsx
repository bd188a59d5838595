import { createSignal } from "solid-js";
import { render } from "solid-js/web";
import "./theme/theme.css";
import "./theme/page.css";
import { App } from "./App";
import { ConsoleProvider, createConsole } from "./console";
import { browserClock } from "./source/clock";
import { LiveSource, tokenOf } from "./source/liveSource";
import { createThemeSwitch } from "./theme/theme";

/** Refresh interval of displayed ages. */
const AGE_TICK_MS = 100;

function Page() {
  const [now, setNow] = createSignal(browserClock.now());
  setInterval(() => setNow(browserClock.now()), AGE_TICK_MS);
  const source = new LiveSource({
    origin: location.origin,
    token: tokenOf(location.hash),
    clock: browserClock,
    random: (bytes) => crypto.getRandomValues(bytes),
    openSocket: (url, protocols) => new WebSocket(url, protocols),
    fetch: (request) => fetch(request),
  });
  const shared = createConsole(
    source,
    createThemeSwitch(document, localStorage),
    browserClock,
    now,
  );
  return (
    <ConsoleProvider value={shared}>
      <App />
    </ConsoleProvider>
  );
}

const root = document.getElementById("app");
if (root === null) throw new Error("index.html has no element with id app.");
render(() => <Page />, root);
