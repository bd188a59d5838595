import { beforeEach, describe, expect, it } from "vitest";
import { inPairs, keepToken, pastedToken, takeLogin } from "./login";

class FakeHistory {
  url: string | null = null;
  replaceState(_data: unknown, _unused: string, url?: string | URL | null) {
    this.url = String(url);
  }
}

const at = (hash: string) => ({ hash, pathname: "/", search: "?x=1" });

describe("the login of a page", () => {
  beforeEach(() => sessionStorage.clear());

  it("moves the token from the address to the tab's storage", () => {
    const history = new FakeHistory();
    const given = takeLogin(at("#token=s3cret&fingerprint=ABCD"), history, sessionStorage);
    expect(given).toEqual({ token: "s3cret", fingerprint: "ABCD" });
    expect(history.url).toBe("/?x=1");
    const again = new FakeHistory();
    expect(takeLogin(at(""), again, sessionStorage).token).toBe("s3cret");
    expect(again.url).toBeNull();
  });

  it("keeps a token until logged out", () => {
    keepToken("other", sessionStorage);
    expect(takeLogin(at(""), new FakeHistory(), sessionStorage).token).toBe("other");
    keepToken(null, sessionStorage);
    expect(takeLogin(at(""), new FakeHistory(), sessionStorage).token).toBeNull();
  });

  it("reads a pasted token or address", () => {
    expect(pastedToken("  abc-1_2 ")).toBe("abc-1_2");
    expect(pastedToken("https://192.0.2.5:8443/#token=abc&fingerprint=AB")).toBe("abc");
    for (const text of ["", "two words", "https://192.0.2.5:8443/", "https://x/#token=", "ü"]) {
      expect(pastedToken(text)).toBeNull();
    }
  });

  it("shows a fingerprint as browsers do", () => {
    expect(inPairs("abcd01")).toBe("AB:CD:01");
    expect(inPairs("AB:CD:01")).toBe("AB:CD:01");
  });
});
