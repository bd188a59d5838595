import type {
  NewSurvey,
  SurveyAgainRequest,
  SurveyPaths,
  SurveyRequest,
  SurveyResponse,
} from "../protocol";
import { answered, CHANGE, PLANNING, READ, type StationHttp } from "./stationHttp";

/** An aircraft that a .kmz names, and its camera where it has none of its own. */
export interface NamedAircraft {
  readonly aircraft: string;
  readonly payload: string | null;
}

export type SurveyRequests = ReturnType<typeof surveyRequests>;

/** `stationNowMs`: an order to move that arrives long after it was given is refused. */
export function surveyRequests(http: StationHttp, stationNowMs: () => number | null) {
  const { client } = http;
  return {
    /** Plans a survey; nothing moves. */
    plan: (survey: NewSurvey) => {
      // Omitted fields have defaults at the station; the generated type cannot express that.
      const body = survey as SurveyRequest;
      return answered(PLANNING, (signal) => client.POST("/api/surveys", { body, signal }), asPairs);
    },
    /** The regions that were surveyed, in this run or another one. */
    flownRegions: () => answered(READ, (signal) => client.GET("/api/flown-regions", { signal })),
    /** Plans what is left of a flown region, or all of it, on its rows; nothing moves. */
    again: (body: SurveyAgainRequest) =>
      answered(PLANNING, (signal) => client.POST("/api/surveys/again", { body, signal }), asPairs),
    /** Starts a survey with these vehicles and gives guidance control of them. */
    start: (survey_id: number, serials: readonly string[], takeoff: boolean) => {
      const body = { serials: [...serials], takeoff, given_at_unix_ms: stationNowMs() };
      const options = { params: { path: { survey_id } }, body };
      return answered(
        CHANGE,
        (signal) => client.POST("/api/surveys/{survey_id}/start", { ...options, signal }),
        asPairs,
      );
    },
    stop: (survey_id: number, command: "pause" | "abort") => {
      const params = { path: { survey_id, command } };
      return answered(
        CHANGE,
        (signal) => client.POST("/api/surveys/{survey_id}/{command}", { params, signal }),
        asPairs,
      );
    },
    /** What a planned survey will take with these vehicles; without any, with one drone. */
    estimate: (survey_id: number, serials: readonly string[]) => {
      const params = { path: { survey_id }, query: { serial: [...serials] } };
      return answered(READ, (signal) =>
        client.GET("/api/surveys/{survey_id}/estimate", { params, signal }),
      );
    },
    /** What a survey would take with these vehicles, without planning it. */
    estimateDraft: (survey: NewSurvey, serials: readonly string[]) => {
      const params = { query: { serial: [...serials] } };
      const body = survey as SurveyRequest;
      return answered(PLANNING, (signal) =>
        client.POST("/api/surveys/estimate", { params, body, signal }),
      );
    },
    /** In which formats the flights of these vehicles can be downloaded, for other programs. */
    exports: (survey_id: number, serials: readonly string[], model: NamedAircraft | null) => {
      const params = { path: { survey_id }, query: { serial: [...serials], ...model } };
      return answered(READ, (signal) =>
        client.GET("/api/surveys/{survey_id}/exports", { params, signal }),
      );
    },
    /** The flights in one format; several files come as an archive. */
    planFile: (
      survey_id: number,
      kind: string,
      serials: readonly string[],
      model: NamedAircraft | null,
    ) => {
      const query = new URLSearchParams(serials.map((serial) => ["serial", serial]));
      for (const [key, value] of Object.entries(model ?? {})) {
        if (value !== null) query.set(key, value);
      }
      return http.picture(`/api/surveys/${survey_id}/plan.${kind}?${query}`);
    },
    /** The survey cameras that a plan may name. */
    cameras: () => answered(READ, (signal) => client.GET("/api/cameras", { signal })),
    paths: (survey_id: number) => {
      const params = { path: { survey_id } };
      return answered(
        READ,
        (signal) => client.GET("/api/surveys/{survey_id}/paths", { params, signal }),
        (data) => data as SurveyPaths,
      );
    },
    cells: (id: number, number: number) =>
      http.picture(`/api/surveys/${id}/cells.png?id=${number}`),
  };
}

/** openapi-fetch widens pairs to lists; the station sends pairs. */
function asPairs(data: unknown): SurveyResponse {
  return data as SurveyResponse;
}
