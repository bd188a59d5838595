import { createSignal, Show } from "solid-js";
import { afterEach, describe, expect, it, vi } from "vitest";
import type { FlownRegionView, PhotoJobView, PhotoStepView } from "../../protocol";
import { flownRegion } from "../../testing/fakeField";
import { photoJob } from "../../testing/fakeFlights";
import { station, vehicle } from "../../testing/fakeState";
import { find, findButton, type RenderedPage, renderPage, settled } from "../../testing/renderPage";
import { offsetText } from "../../text/photos";
import { PhotosPanel } from "./PhotosPanel";

let page: RenderedPage;
afterEach(() => page?.dispose());

const NAME = "flight-20250620T160412Z";
const FLIGHT = { name: NAME, size_bytes: 1, changed_at_unix_ms: 0, is_recording: false };

async function show(job: PhotoJobView | null, ...flown: FlownRegionView[]) {
  const [isOpen, setOpen] = createSignal(false);
  const panel = () => (
    <Show when={isOpen()}>
      <PhotosPanel />
    </Show>
  );
  page = renderPage(panel, station([vehicle(1)]));
  page.showFlown(...flown);
  page.showFlights([{ ...FLIGHT, name: "ground-20250620T170000Z" }, FLIGHT], "none");
  page.showPhotos(job);
  setOpen(true);
  await settled();
}

const words = (step: PhotoStepView["name"]) =>
  find(page.root, `[data-testid=photo-${step}]`).textContent;

function type(selector: string, value: string) {
  const field = find<HTMLInputElement>(page.root, selector);
  field.value = value;
  field.dispatchEvent(new Event("input", { bubbles: true }));
}

describe("the form", () => {
  it("starts a job on a flight and the folders of its photos", async () => {
    await show(null);
    const options = [...page.root.querySelectorAll("option")];
    expect(options.map(({ textContent }) => textContent)).toEqual(["2025-06-20 16:04"]);
    expect(findButton(page.root, "Start").disabled).toBe(true);
    type("textarea", " /media/a/DCIM \n\n/media/b");
    type("[name=clock_offset_s]", "-18000.5");
    find(page.root, "form").dispatchEvent(new Event("submit", { cancelable: true }));
    expect(page.requests).toEqual([
      {
        startedPhotos: {
          flight: NAME,
          folders: ["/media/a/DCIM", "/media/b"],
          clock_offset_s: -18000.5,
          field_deg: null,
        },
      },
    ]);
  });

  it("asks for the path of a dropped folder, of which a browser is given the name", async () => {
    await show(null);
    const drop = (uris: string) => {
      const event = new Event("drop", { cancelable: true });
      const files = [{ name: "DCIM" }];
      Object.assign(event, { dataTransfer: { files, getData: () => uris } });
      find(page.root, "form").dispatchEvent(event);
    };
    drop("");
    expect(page.root.textContent).toContain("only the name of a dropped folder: DCIM. Paste");
    drop("file:///media/my%20card\r\n");
    expect(find<HTMLTextAreaElement>(page.root, "textarea").value).toBe("/media/my card");
  });
});

describe("a job", () => {
  it("is followed while it runs, and can be cancelled", async () => {
    const running = { state: "running", doing: "tagging", share: 0.456 } as const;
    await show(photoJob({ ...running, steps: photoJob().steps.map(runningAt("tags")) }));
    expect(words("clock")).toContain(
      "CAM-1, 48 photos of Drone 1: −5 h 00 min 37.6 s, 95 % within",
    );
    expect(words("tags")).toContain("tagging, 45\u00a0%");
    expect(page.root.querySelector("form")).toBeNull();
    findButton(page.root, "Cancel").click();
    expect(page.requests).toContainEqual({ cancelled: "photos" });
    await settled();
    page.showPhotos(photoJob());
    page.clock.advance(1_000);
    await settled();
    expect(words("tags")).toContain("12 of 48 photos in sun · 4 mixed, 30 shaded, 2 unknown");
    expect(words("mosaic")).toContain("25\u00a0% of 4.0\u00a0ha in sun, 50\u00a0cm a pixel");
    expect(find<HTMLImageElement>(page.root, "img").src).toMatch(/^blob:/);
    expect(page.clock.pending).toBe(0);
  });

  it("keeps the steps before a failed one, whose sentence names fields of the panel", async () => {
    const problem = "the drone hardly moved; state it with --clock-offset";
    const steps = photoJob().steps.map((step) =>
      step.name === "mosaic" ? { ...step, state: "failed" as const, problem } : step,
    );
    await show(photoJob({ state: "failed", steps, files: ["tags.csv"], mosaic: null }));
    expect(words("mosaic")).toContain("state it with Camera: Clock offset, s");
    find(page.root, "[data-testid=photo-tags] [aria-label=OK]");
    find(page.root, "[data-testid=photo-mosaic] [aria-label=Error]");
    expect(findButton(page.root, "Start again").disabled).toBe(true);
    const click = vi.spyOn(HTMLAnchorElement.prototype, "click").mockImplementation(() => {});
    findButton(page.root, "Tags CSV").click();
    await settled();
    expect(click).toHaveBeenCalledOnce();
    click.mockRestore();
    expect(page.requests).toEqual([{ photoFile: "tags.csv" }]);
  });

  it("has its gaps planned on the rows of the region flown last", async () => {
    const south = flownRegion({ gaps_m2: 700 });
    const north = flownRegion({ region: "north", gaps_m2: 0 });
    await show(photoJob(), south, { ...south, id: "older" }, north);
    expect(words("gaps")).toContain("0.7\u00a0ha in 2 places");
    findButton(page.root, "Fly the gaps").click();
    await settled();
    expect(page.requests).toContainEqual({
      surveyAgain: { id: south.id, since: null, all_again: false, gaps: true },
    });
    expect(words("gaps")).toContain("start it in the panel Survey");
    expect(page.shared.panels.isOpen("survey")).toBe(true);
  });
});

function runningAt(name: PhotoStepView["name"]) {
  let isBefore = true;
  return (step: PhotoStepView): PhotoStepView => {
    if (step.name === name) isBefore = false;
    const state = isBefore ? "done" : step.name === name ? "running" : "waiting";
    return { ...step, state };
  };
}

it("an offset has its sign, hours, minutes and seconds", () => {
  expect(offsetText(0)).toBe("+0 h 00 min 00.0 s");
  expect(offsetText(-18_037.64)).toBe("−5 h 00 min 37.6 s");
  expect(offsetText(3_599.98)).toBe("+1 h 00 min 00.0 s");
});
