import type { Page } from "@playwright/test";

/** A PNG resembling a field from above, drawn by the browser: rows, a path, a round edge. */
export async function fieldPicture(page: Page): Promise<Buffer> {
  const url = await page.evaluate(() => {
    const canvas = document.createElement("canvas");
    canvas.width = 520;
    canvas.height = 520;
    const pen = canvas.getContext("2d");
    if (pen === null) throw new Error("No 2D canvas available.");
    pen.arc(260, 260, 258, 0, 2 * Math.PI);
    pen.clip();
    for (let row = 0; row < 52; row += 1) {
      pen.fillStyle = row % 2 === 0 ? "#6f8450" : "#7d8f58";
      pen.fillRect(0, row * 10, 520, 10);
    }
    pen.fillStyle = "#b9a27c";
    pen.fillRect(300, 0, 24, 520);
    return canvas.toDataURL("image/png");
  });
  return Buffer.from(url.split(",")[1] ?? "", "base64");
}
