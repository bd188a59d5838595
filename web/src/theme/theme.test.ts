import { readdirSync, readFileSync } from "node:fs";
import { describe, expect, it } from "vitest";
import { createThemeSwitch, lookClasses, VEHICLE_LOOKS, vehicleLook } from "./theme";

describe("the looks of vehicles", () => {
  it("are all different: sixteen by colour and shape, then striped", () => {
    const looks = Array.from({ length: VEHICLE_LOOKS }, (_, index) => vehicleLook(index + 1));
    expect(new Set(looks.map((look) => JSON.stringify(look))).size).toBe(VEHICLE_LOOKS);
    expect(looks.slice(0, 16).some(({ isStriped }) => isStriped)).toBe(false);
    expect(new Set(looks.slice(0, 16).map(({ colour, shape }) => `${colour}${shape}`)).size).toBe(
      16,
    );
  });

  it("are grey and round without a number", () => {
    expect(vehicleLook(0)).toEqual({ colour: 0, shape: "round", isStriped: false });
    expect(lookClasses(9)).toBe("look-square");
    expect(lookClasses(17)).toBe("look-round look-striped");
  });
});

describe("the theme", () => {
  it("is kept, and bright sun goes back to what was before", () => {
    const theme = createThemeSwitch(document, localStorage);
    expect(theme.theme()).toBe("auto");
    theme.choose("dark");
    expect(document.documentElement.dataset["theme"]).toBe("dark");
    theme.toggleSun();
    expect(document.documentElement.dataset["theme"]).toBe("sun");
    theme.toggleSun();
    expect(theme.theme()).toBe("dark");
    expect(createThemeSwitch(document, localStorage).theme()).toBe("dark");
    theme.choose("auto");
    expect(["light", "dark"]).toContain(document.documentElement.dataset["theme"]);
  });
});

/** The styles by path; vitest itself empties them. */
const STYLES = Object.fromEntries(
  readdirSync("src", { recursive: true, encoding: "utf-8" })
    .filter((path) => path.endsWith(".css"))
    .map((path) => [path, readFileSync(`src/${path}`, "utf-8")]),
);

describe("the lengths of the page", () => {
  it("are tokens of theme.css: a pixel elsewhere is an exception", () => {
    const raw = Object.entries(STYLES).flatMap(([path, css]) =>
      css
        .replace(/\/\*[\s\S]*?\*\//g, "")
        .split("\n")
        .filter((line) => !line.trim().startsWith("--"))
        .flatMap((line) => (line.match(/[\d.]+px/g) ?? []).map((px) => `${path}: ${px}`)),
    );
    expect(Object.keys(STYLES).length).toBeGreaterThan(25);
    // Widths at which the page changes (media queries take no token), and sizes of one place.
    expect(raw.length, raw.join("\n")).toBeLessThanOrEqual(60);
  });

  it("are all defined", () => {
    const all = Object.values(STYLES).join("\n");
    const defined = new Set(Array.from(all.matchAll(/(--[\w-]+):/g), ([, name]) => name));
    const used = Array.from(all.matchAll(/var\((--[\w-]+)\)/g), ([, name]) => name);
    const set = ["--own", "--towards", "--fill", "--held"];
    expect(used.filter((name) => !defined.has(name) && !set.includes(name ?? ""))).toEqual([]);
  });
});
