import { render } from "solid-js/web";
import "../theme/theme.css";
import "../theme/page.css";
import { language, text } from "../text/catalogue";
import { keepLengthUnit } from "../text/units";
import { createThemeSwitch } from "../theme/theme";
import { NewSitePage } from "./NewSitePage";
import { createNewSite } from "./newSite";

const root = document.getElementById("app");
if (root === null) throw new Error("new-site.html has no element with id app.");
document.documentElement.lang = language;
document.title = text.newSite.page("Recon");
createThemeSwitch(document, localStorage);
keepLengthUnit(localStorage);
const newSite = createNewSite({
  fetch: (path, init) => fetch(path, init),
  locate: () =>
    new Promise((resolve, reject) => navigator.geolocation.getCurrentPosition(resolve, reject)),
  wait: (ms) => new Promise((resolve) => setTimeout(resolve, ms)),
  openConsole: () => location.replace("./"),
});
void newSite.begin();
render(() => <NewSitePage newSite={newSite} />, root);
