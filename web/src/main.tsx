import { createSignal } from "solid-js";
import { render } from "solid-js/web";
import "./theme/theme.css";
import "./theme/page.css";
import { App } from "./App";
import { ConsoleProvider, createConsole } from "./console";
import { keepShell } from "./offline/keepShell";
import { createOpenPanels, NARROW } from "./panels/openPanels";
import { createNotifier, keepScreenOn } from "./sound/attention";
import { createMutes } from "./sound/mutes";
import { createSpeaker } from "./sound/speaker";
import { browserClock } from "./source/clock";
import { browserFrame } from "./source/framePacer";
import { LiveSource } from "./source/liveSource";
import { keepToken, takeLogin } from "./source/login";
import { language } from "./text/catalogue";
import { keepLengthUnit } from "./text/units";
import { createThemeSwitch } from "./theme/theme";

/** Refresh interval of displayed ages. */
const AGE_TICK_MS = 100;

function Page() {
  const [now, setNow] = createSignal(browserClock.now());
  setInterval(() => setNow(browserClock.now()), AGE_TICK_MS);
  const given = takeLogin(location, history, sessionStorage);
  // A new page begins with nothing of the person before.
  const reloadWith = (token: string | null) => {
    keepToken(token, sessionStorage);
    location.reload();
  };
  // An address with another token opened in this tab changes its fragment only.
  window.addEventListener("hashchange", () => {
    if (location.hash.includes("token=")) location.reload();
  });
  keepLengthUnit(localStorage);
  const source = new LiveSource({
    origin: location.origin,
    token: given.token,
    clock: browserClock,
    random: (bytes) => crypto.getRandomValues(bytes),
    nextFrame: browserFrame,
    openSocket: (url, protocols) => new WebSocket(url, protocols),
    fetch: (request) => fetch(request),
  });
  const shared = createConsole(source, browserClock, now, {
    theme: createThemeSwitch(document, localStorage),
    panels: createOpenPanels(localStorage, () => matchMedia(NARROW).matches),
    mutes: createMutes(localStorage),
    speaker: createSpeaker(window),
    notifier: createNotifier(window),
    login: {
      hasToken: given.token !== null,
      fingerprint: given.fingerprint,
      logIn: reloadWith,
      logOut: () => reloadWith(null),
    },
    kept: localStorage,
  });
  keepScreenOn(document, navigator.wakeLock, () =>
    shared.fleet.vehicles.some(({ is_flying }) => is_flying.value === true),
  );
  return (
    <ConsoleProvider value={shared}>
      <App />
    </ConsoleProvider>
  );
}

if (import.meta.env.PROD) keepShell(navigator.serviceWorker);
document.documentElement.lang = language;
const root = document.getElementById("app");
if (root === null) throw new Error("index.html has no element with id app.");
render(() => <Page />, root);
