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
