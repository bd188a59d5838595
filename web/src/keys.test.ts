import { describe, expect, it, vi } from "vitest";
import { actOnKey, type KeyActions } from "./keys";

function press(init: KeyboardEventInit, target?: HTMLElement) {
  const actions = {
    allStop: vi.fn(),
    selectOnly: vi.fn(),
    toggle: vi.fn(),
    selectAll: vi.fn(),
    clear: vi.fn(),
    fit: vi.fn(),
    flyHere: vi.fn(),
    drawZone: vi.fn(),
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
    [{ key: "S", code: "KeyS", shiftKey: true }, ["allStop"]],
    [{ key: "f", code: "KeyF" }, ["fit"]],
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

  it.each(["radio", "range", "number", "checkbox"])("stop all with a %s in focus", (type) => {
    const field = input(type);
    expect(press({ key: "S", code: "KeyS", shiftKey: true }, field).called).toEqual([["allStop"]]);
    expect(press({ key: "Escape", code: "Escape" }, field).called).toEqual([["clear"]]);
    field.remove();
  });

  it("select vehicles with a radio in focus, and leave digits to a number field", () => {
    const radio = input("radio");
    expect(press({ key: "3", code: "Digit3" }, radio).called).toEqual([["selectOnly", 3]]);
    radio.remove();
    const number = input("number");
    expect(press({ key: "3", code: "Digit3" }, number).isHandled).toBe(false);
    expect(press({ key: "a", code: "KeyA", ctrlKey: true }, number).isHandled).toBe(false);
    number.remove();
  });

  it.each(["text", "search", "password"])(
    "type an S into a %s field, and stop all with Alt",
    (type) => {
      const field = input(type);
      expect(press({ key: "S", code: "KeyS", shiftKey: true }, field).isHandled).toBe(false);
      expect(press({ key: "3", code: "Digit3" }, field).isHandled).toBe(false);
      const chord = { key: "Í", code: "KeyS", shiftKey: true, altKey: true };
      expect(press(chord, field)).toEqual({ isHandled: true, called: [["allStop"]] });
      field.remove();
    },
  );

  it("stop all by the letter on another keyboard layout, and only once while held", () => {
    expect(press({ key: "S", code: "Semicolon", shiftKey: true }).called).toEqual([["allStop"]]);
    const held = { key: "S", code: "KeyS", shiftKey: true, altKey: true, repeat: true };
    expect(press(held).called).toEqual([]);
  });

  it("ignore keys typed into text fields", () => {
    const field = document.createElement("textarea");
    document.body.append(field);
    expect(press({ key: "3", code: "Digit3" }, field).called).toEqual([]);
    field.remove();
  });
});
