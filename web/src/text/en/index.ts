import * as detail from "./detail";
import * as fleet from "./fleet";
import * as flown from "./flown";
import * as light from "./light";
import * as map from "./map";
import * as newSite from "./newSite";
import * as orders from "./orders";
import * as page from "./page";
import * as photos from "./photos";
import * as rehearsal from "./rehearsal";
import * as site from "./site";
import * as station from "./station";

/** The console's words in English, by room. */
export const english = {
  ...page,
  ...fleet,
  ...orders,
  ...detail,
  ...map,
  ...light,
  ...flown,
  ...photos,
  ...site,
  ...newSite,
  ...rehearsal,
  ...station,
};
