import { execFileSync, spawn } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { expect, test } from "@playwright/test";
import { faintTexts, smallTexts } from "./legibility";
import { openPanel } from "./openPanel";

/** A station that other computers log in to, here over loopback, with its own state folder. */
const PROJECT = fileURLToPath(new URL("../..", import.meta.url));
const RECON = join(PROJECT, ".venv", "bin", "recon");
const STARTS_WITHIN_MS = 180_000;

const folder = mkdtempSync(join(tmpdir(), "recon-login-"));
const environment = { ...process.env, XDG_STATE_HOME: folder };
let station: ReturnType<typeof spawn> | null = null;
let url = "";
let token = "";

test.use({ ignoreHTTPSErrors: true });
// One station for the file.
test.describe.configure({ mode: "default" });

test.beforeAll(async () => {
  test.setTimeout(STARTS_WITHIN_MS + 30_000);
  const added = execFileSync(RECON, ["user", "add", "anna", "--role", "pilot"], {
    env: environment,
    encoding: "utf8",
  });
  token = /token: (\S+)/.exec(added)?.[1] ?? "";
  url = await startedStation();
});

test.afterAll(() => {
  station?.kill("SIGTERM");
  rmSync(folder, { recursive: true, force: true });
});

function startedStation(): Promise<string> {
  const free = ["--link-port", "0", "--http-port", "0", "--https-port", "0"];
  const started = spawn(RECON, ["run", ...free, "--https-host", "127.0.0.1"], { env: environment });
  station = started;
  return new Promise((resolve, reject) => {
    let output = "";
    const timer = setTimeout(() => reject(new Error(output)), STARTS_WITHIN_MS);
    started.stdout.on("data", (chunk: Buffer) => {
      output += chunk.toString();
      const found = /other computers, with login: (https:\/\/\S+)/.exec(output)?.[1];
      if (found === undefined) return;
      clearTimeout(timer);
      resolve(found);
    });
  });
}

test("asks for a token, shows the person, and logs out", async ({ page }) => {
  await page.goto(url);
  const dialog = page.getByRole("dialog", { name: "Log in to Recon" });
  await expect(dialog).toContainText("Token missing");
  await page.getByLabel("Token, or the whole address with it").fill("wrong");
  await page.getByRole("button", { name: "Log in" }).click();
  await expect(dialog).toContainText("Token wrong");
  await page.getByLabel("Token, or the whole address with it").fill(`${url}/#token=${token}`);
  await page.getByRole("button", { name: "Log in" }).click();
  await expect(dialog).toHaveCount(0);
  await page.reload();
  await page.getByRole("button", { name: "Menu", exact: true }).click();
  await expect(page.locator(".person")).toContainText("anna pilot");
  await page.getByRole("button", { name: "Log out" }).click();
  await expect(dialog).toContainText("Token missing");
});

test("takes the token out of the address", async ({ page }) => {
  await page.goto(`${url}/#token=${token}`);
  await openPanel(page, "Station and site");
  expect(page.url()).toBe(`${url}/`);
  await expect(page.getByAltText("The first address as a QR code")).toBeVisible();
});

test("is legible in light and dark colours", async ({ page }) => {
  const isLegible = async () => {
    for (const colorScheme of ["light", "dark"] as const) {
      await page.emulateMedia({ colorScheme });
      expect(await smallTexts(page), colorScheme).toEqual([]);
      expect(await faintTexts(page), colorScheme).toEqual([]);
    }
  };
  await page.goto(`${url}/#fingerprint=${"AB".repeat(32)}`);
  await expect(page.getByRole("dialog")).toContainText("AB:AB");
  await isLegible();
  await page.goto(`${url}/#token=${token}`);
  await page.getByRole("button", { name: "Menu", exact: true }).click();
  await expect(page.locator(".person")).toContainText("anna pilot");
  await isLegible();
});
