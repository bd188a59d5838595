/** The orders with buttons of their own, and how each is confirmed. */
export interface OrderKind {
  readonly kind: "hover" | "land" | "return_home";
  readonly label: string;
  /** Completes "Keep holding to ...", before the vehicles' names. */
  readonly verb: string;
  /** How long the button is held. */
  readonly hold_ms: number;
  /** With Shift, held as long as the button. */
  readonly key: string;
}

/**
 * All three are confirmed by the same gesture, so that no hurry has to remember which is which. Hover
 * is the safe one and asks for 0.4 s: longer than a brush of the hand or a double press, shorter
 * than a thought. A second press instead could be a double press by mistake. Landing and return
 * ask for 1.5 s.
 */
export const ORDER_KINDS: readonly OrderKind[] = [
  { kind: "hover", label: "Hover", verb: "hover", hold_ms: 400, key: "H" },
  { kind: "return_home", label: "Return home", verb: "return home", hold_ms: 1500, key: "R" },
  { kind: "land", label: "Land", verb: "land", hold_ms: 1500, key: "L" },
];
