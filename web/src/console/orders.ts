import { type Accessor, createMemo } from "solid-js";
import { createSelection, type Selection, selectedVehicles } from "../fleet/selection";
import { createOrderApi, type OrderApi } from "../orders/orderApi";
import { type Targets, targetsOf } from "../orders/targets";
import type { StationPart } from "./station";

/** To whom orders go, and how. */
export interface OrderPart {
  readonly selection: Selection;
  /** The vehicles an order would be sent to. */
  readonly targets: Accessor<Targets>;
  readonly orderApi: OrderApi;
}

export function createOrderPart({ source, clock, fleet }: StationPart): OrderPart {
  const selection = createSelection();
  return {
    selection,
    targets: createMemo(() => targetsOf(selectedVehicles(fleet.vehicles, selection))),
    orderApi: createOrderApi(source.orders, clock),
  };
}
