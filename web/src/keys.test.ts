import { describe, expect, it, vi } from "vitest";
import { actOnKey, isAllStop, type KeyActions } from "./keys";

function press(init: KeyboardEventInit, target?: HTMLElement) {
  const actions = {
    selectOnly: vi.fn(),
    toggle: vi.fn(),
    selectAll: vi.fn(),
    clear: vi.fn(),
    fit: vi.fn(),
    flyHere: vi.fn(),
    drawMission: vi.fn(),
    details: vi.fn(),
    drawZone: vi.fn(),
    undo: vi.fn(),
    redo: vi.fn(),
    toggleTheme: vi.fn(),
    help: vi.fn(),
  } satisfies KeyActions;
  const event = new KeyboardEvent("keydown", { bubbles: true, cancelable: true, ...init });
  (target ?? document.body).dispatchEvent(event);
  const isHandled = actOnKey(event, actions);
  const called = Object.entries(actions).filter(([, action]) => action.mock.calls.length > 0);
  return {
    isHandled,
    called: called.map(([name, action]) => [name, ...(action.mock.calls[0] ?? [])]),
  };
}

function input(type: string): HTMLInputElement {
  const field = document.createElement("input");
  field.type = type;
  document.body.append(field);
  return field;
}

describe("keyboard shortcuts", () => {
  it.each([
    [{ key: "?", code: "Slash", shiftKey: true }, ["help"]],
    [{ key: "Escape", code: "Escape" }, ["clear"]],
    [{ key: "a", code: "KeyA", ctrlKey: true }, ["selectAll"]],
    [{ key: "3", code: "Digit3" }, ["selectOnly", 3]],
    [{ key: "#", code: "Digit3", shiftKey: true }, ["toggle", 3]],
    [{ key: "7", code: "Numpad7" }, ["selectOnly", 7]],
    [{ key: "f", code: "KeyF" }, ["fit"]],
    [{ key: "m", code: "KeyM" }, ["drawMission"]],
    [{ key: "T", code: "KeyT" }, ["toggleTheme"]],
  ])("%j runs %j", (init, expected) => expect(press(init).called).toEqual([expected]));

  it.each([
    { key: "s", code: "KeyS" },
    { key: "l", code: "KeyL" },
    { key: "0", code: "Digit0" },
    { key: "1", code: "Digit1", altKey: true },
    { key: "s", code: "KeyS", ctrlKey: true, shiftKey: true },
    { key: "S", code: "KeyS", shiftKey: true, repeat: true },
  ])("ignore %j", (init) => {
    expect(press(init)).toEqual({ isHandled: false, called: [] });
  });

  it.each(["radio", "range", "number", "checkbox"])("clear with a %s in focus", (type) => {
    const field = input(type);
    expect(press({ key: "Escape", code: "Escape" }, field).called).toEqual([["clear"]]);
    field.remove();
  });

  it("select vehicles with a radio in focus, and leave digits to a number field", () => {
    const radio = input("radio");
    expect(press({ key: "3", code: "Digit3" }, radio).called).toEqual([["selectOnly", 3]]);
    radio.remove();
    const decimal = input("text");
    decimal.inputMode = "decimal";
    for (const number of [input("number"), decimal]) {
      expect(press({ key: "3", code: "Digit3" }, number).isHandled).toBe(false);
      expect(press({ key: "g", code: "KeyG" }, number).isHandled).toBe(false);
      expect(press({ key: "a", code: "KeyA", ctrlKey: true }, number).isHandled).toBe(false);
      number.remove();
    }
  });

  it("ignore keys typed into text fields", () => {
    const field = document.createElement("textarea");
    document.body.append(field);
    expect(press({ key: "3", code: "Digit3" }, field).called).toEqual([]);
    field.remove();
  });
});

/** Whether a key press on an element is an all stop. */
function stops(target: HTMLElement, init: KeyboardEventInit = {}): boolean {
  document.body.append(target);
  const shiftS = { key: "S", code: "KeyS", shiftKey: true, bubbles: true, ...init };
  const event = new KeyboardEvent("keydown", shiftS);
  target.dispatchEvent(event);
  const result = isAllStop(event);
  target.remove();
  return result;
}

function element(name: string, set: (element: HTMLElement) => void = () => {}): HTMLElement {
  const made = document.createElement(name);
  set(made);
  return made;
}

const NO_TEXT = ["button", "checkbox", "color", "date", "datetime-local", "file", "image", "month"];
const NO_TEXT_EITHER = ["number", "radio", "range", "reset", "submit", "time", "week"];

describe("all stop by key", () => {
  it.each([...NO_TEXT, ...NO_TEXT_EITHER])("works with an input of type %s in focus", (type) => {
    expect(stops(input(type))).toBe(true);
  });

  it.each(["body", "button", "select", "summary", "a", "canvas", "dialog", "details", "output"])(
    "works with a %s in focus",
    (name) => expect(stops(element(name))).toBe(true),
  );

  it.each(["decimal", "numeric"])("works in a text field for a %s number", (mode) => {
    const field = input("text");
    field.inputMode = mode;
    expect(stops(field)).toBe(true);
  });

  it("works in a text field that cannot be typed into", () => {
    const field = input("text");
    field.readOnly = true;
    expect(stops(field)).toBe(true);
    const area = document.createElement("textarea");
    area.disabled = true;
    expect(stops(area)).toBe(true);
  });

  it.each(["text", "search", "password", "email", "url", "tel"])(
    "types an S into a %s field, and works there with Alt",
    (type) => {
      expect(stops(input(type))).toBe(false);
      expect(stops(input(type), { key: "Í", altKey: true })).toBe(true);
    },
  );

  it("types an S into a text area", () => {
    expect(stops(element("textarea"))).toBe(false);
    expect(stops(element("textarea"), { altKey: true })).toBe(true);
  });

  it("works by the letter on another keyboard layout, and once while held", () => {
    expect(stops(element("p"), { code: "Semicolon" })).toBe(true);
    expect(stops(element("p"), { repeat: true })).toBe(false);
    expect(stops(element("p"), { ctrlKey: true })).toBe(false);
    expect(stops(element("p"), { shiftKey: false })).toBe(false);
  });
});
