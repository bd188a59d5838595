import type { Page } from "@playwright/test";

/**
 * The share of the map's pixels, 0 to 1, that differ from its most frequent colour: near 0 for a blank
 * map, a few hundredths with lines only, large with an image.
 */
export async function drawnShare(page: Page): Promise<number> {
  const picture = await page.locator(".maplibregl-canvas").screenshot({
    // The panels float over it and are in a picture of its place.
    style:
      ".page > :not(.map), .maplibregl-marker, .craft, .craft-label, .map-moving { visibility: hidden !important; }",
  });
  return page.evaluate(async (base64) => {
    const bytes = Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
    const bitmap = await createImageBitmap(new Blob([bytes], { type: "image/png" }));
    const canvas = new OffscreenCanvas(bitmap.width, bitmap.height);
    const pen = canvas.getContext("2d");
    if (pen === null) throw new Error("No 2D canvas available.");
    pen.drawImage(bitmap, 0, 0);
    const { data } = pen.getImageData(0, 0, bitmap.width, bitmap.height);
    const counts = new Map<number, number>();
    for (let at = 0; at < data.length; at += 4) {
      const colour = ((data[at] ?? 0) << 16) | ((data[at + 1] ?? 0) << 8) | (data[at + 2] ?? 0);
      counts.set(colour, (counts.get(colour) ?? 0) + 1);
    }
    return 1 - Math.max(...counts.values()) / (data.length / 4);
  }, picture.toString("base64"));
}
