import { type Accessor, createSignal } from "solid-js";
import { createFrameOnScreen } from "../fleet/createFrameOnScreen";
import type { ShownFrame } from "../fleet/frameOnScreen";
import type { StationState } from "../protocol";
import type { StationSource } from "../source/stationSource";
import type { GroundWitness } from "./groundImageLayer";

/** The ground image on the map. */
export interface ShownGround extends ShownFrame {
  /** How well it is placed, as the station said of this very frame. */
  readonly registration: string;
}

/** Between the layer, which knows what lies on the ground, and the note, which tells it. */
export interface GroundOnMap extends GroundWitness {
  readonly shown: Accessor<ShownGround | null>;
}

/** Keeps the facts of the ground image that is shown, as the source's states go on. */
export function createGroundOnMap(source: Pick<StationSource, "state">): GroundOnMap {
  const frame = createFrameOnScreen(source, announcedIn);
  const [registration, setRegistration] = createSignal("");
  return {
    run: frame.run,
    show: (image) => {
      setRegistration(image.registration);
      frame.show(image.frame_id);
    },
    shown: () => {
      const facts = frame.facts();
      return facts === null ? null : { ...facts, registration: registration() };
    },
  };
}

function announcedIn({ ground_image: image }: StationState) {
  return image === null ? null : { ...image, id: image.frame_id };
}
