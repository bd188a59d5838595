import { afterEach, describe, expect, it } from "vitest";
import type { AccessView } from "../../protocol";
import { lacking } from "../../source/roles";
import { station, vehicle } from "../../testing/fakeState";
import { find, type RenderedPage, renderPage } from "../../testing/renderPage";
import { OrderBar } from "../orders/OrderBar";
import { SeparationSwitch } from "../separation/SeparationHold";
import { LoginDialog } from "./LoginDialog";
import { PersonTag } from "./PersonTag";

const REFUSED = { kind: "lost", reason: "Token wrong", attempt: 1, needsLogin: true } as const;

function person(role: AccessView["role"], is_logged_in = true): AccessView {
  return { name: "anna", role, is_logged_in, urls: [], fingerprint: null };
}

let page: RenderedPage;
afterEach(() => page.dispose());

describe("the login dialog", () => {
  it("is shown only while the station wants a token", () => {
    page = renderPage(() => <LoginDialog />, station([]));
    expect(page.root.textContent).toBe("");
    page.connect({ kind: "lost", reason: "Station unreachable", attempt: 1 });
    expect(page.root.textContent).toBe("");
    page.connect(REFUSED);
    expect(page.root.textContent).toContain("Token wrong.");
    expect(find<HTMLInputElement>(page.root, "input").type).toBe("password");
    page.connect({ kind: "live" });
    expect(page.root.textContent).toBe("");
  });

  it("states what is no token", () => {
    page = renderPage(() => <LoginDialog />, station([]));
    page.connect(REFUSED);
    find<HTMLFormElement>(page.root, "form").dispatchEvent(new Event("submit"));
    expect(page.root.textContent).toContain("This is not a token");
  });
});

describe("the person", () => {
  it("is shown with the role, and may log out after a login only", () => {
    page = renderPage(() => <PersonTag />, station([]));
    expect(page.root.textContent).toBe("");
    page.nameAs(person("pilot"));
    expect(page.root.textContent).toContain("anna pilot");
    expect(page.root.querySelector("button")).not.toBeNull();
    page.nameAs(person("admin", false));
    expect(page.root.querySelector("button")).toBeNull();
  });

  it("cannot press what needs a higher role, and reads why", () => {
    page = renderPage(
      () => (
        <>
          <OrderBar />
          <SeparationSwitch />
        </>
      ),
      station([vehicle(1)]),
    );
    page.shared.selection.only(1);
    const land = find(page.root, ".order-land");
    const off = find(page.root, ".guard");
    page.nameAs(person("observer"));
    expect(land.getAttribute("aria-disabled")).toBe("true");
    expect(land.getAttribute("title")).toBe("Needs the role pilot; anna has observer");
    page.nameAs(person("operator"));
    expect(land.getAttribute("aria-disabled")).toBe("false");
    expect(off.getAttribute("aria-disabled")).toBe("true");
    expect(off.textContent).toContain("needs admin");
    page.nameAs(person("admin"));
    expect(off.getAttribute("aria-disabled")).toBe("false");
  });

  it("lacks nothing before the station has stated the person", () => {
    page = renderPage(() => <PersonTag />, station([]));
    expect(lacking(null, "admin")).toBeNull();
  });
});
