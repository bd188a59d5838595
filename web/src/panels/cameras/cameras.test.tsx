import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import type { VehicleView } from "../../protocol";
import { station, vehicle } from "../../testing/fakeState";
import { findButton, type RenderedPage, renderPage, settled } from "../../testing/renderPage";
import { CamerasPanel, LargeCamera } from "./CamerasPanel";

function sending(number: number, id = 12): VehicleView {
  const frame = { id, received_age_s: 0.1, captured_age_s: 0.5, captured_sigma_s: 0.2 };
  return vehicle(number, { frame });
}

let page: RenderedPage;
let asked: string[];

beforeEach(async () => {
  let made = 0;
  vi.spyOn(URL, "createObjectURL").mockImplementation(() => `blob:${++made}`);
  vi.spyOn(URL, "revokeObjectURL").mockReturnValue(undefined);
  asked = [];
  page = renderPage(
    () => (
      <>
        <LargeCamera />
        <CamerasPanel />
      </>
    ),
    station([vehicle(1), vehicle(2)]),
  );
  page.fetchFramesWith(async (serial, frameId) => {
    asked.push(`${serial} ${frameId}`);
    return { kind: "answered", value: { blob: new Blob([serial]), frameId } };
  });
  await settled();
});

afterEach(() => page.dispose());

const pictures = (within: string) =>
  [...page.root.querySelectorAll<HTMLImageElement>(`${within} img`)].map(({ alt }) => alt);

const enlarge = (number: number) =>
  page.root.querySelectorAll<HTMLButtonElement>(".cameras button")[number - 1];

async function receive(...vehicles: VehicleView[]) {
  page.receive(station(vehicles));
  await settled();
  await settled();
}

describe("the cameras", () => {
  it("are missing at first, and the panel states what to do", () => {
    expect(page.root.textContent).toContain("No camera sends pictures. Select a vehicle");
  });

  it("are shown live, each with its vehicle's name", async () => {
    await receive(sending(1), vehicle(2), sending(3));
    expect(pictures(".cameras")).toHaveLength(2);
    expect(asked).toEqual(["SN-001 12", "SN-003 12"]);
    await receive(sending(1, 13), vehicle(2), sending(3));
    expect(asked).toEqual(["SN-001 12", "SN-003 12", "SN-001 13"]);
  });

  it("can be large, one at a time, and are fetched once", async () => {
    await receive(sending(1), sending(2));
    enlarge(1)?.click();
    await settled();
    expect(pictures(".camera-large")).toHaveLength(1);
    expect(pictures(".cameras")).toHaveLength(1);
    enlarge(2)?.click();
    await settled();
    expect(pictures(".camera-large")).toEqual(["Camera of Birch"]);
    expect(pictures(".cameras")).toEqual(["Camera of Alder"]);
    findButton(page.root, "✕").click();
    await settled();
    expect(pictures(".camera-large")).toEqual([]);
    expect(pictures(".cameras")).toHaveLength(2);
  });

  it("are large no more when they send nothing, and Esc makes one small", async () => {
    await receive(sending(1), sending(2));
    enlarge(1)?.click();
    await receive(vehicle(1), sending(2));
    expect(page.root.querySelector(".camera-large")).toBeNull();
    await receive(sending(1), sending(2));
    expect(pictures(".camera-large")).toHaveLength(1);
    expect(page.shared.largeCamera.clear()).toBe(true);
    expect(page.shared.largeCamera.clear()).toBe(false);
    await settled();
    expect(page.root.querySelector(".camera-large")).toBeNull();
  });
});
