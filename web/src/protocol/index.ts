/**
 * API types under short names. `schema.d.ts` is generated from `openapi.json` by
 * `npm run check`, or alone by `npm run generate`.
 */
import type { components } from "./schema";

type Schemas = components["schemas"];

export type AccessView = Schemas["AccessView"];
export type StationState = Schemas["StationState"];
export type ReplayMark = Schemas["ReplayMark"];
export type ReplayMarksView = Schemas["ReplayMarksView"];
export type ReplayTransport = Partial<Schemas["ReplayTransport"]>;
export type ReplayView = Schemas["ReplayView"];
export type StationView = Schemas["StationView"];
export type StopLatchView = Schemas["StopLatchView"];
export type SiteView = Schemas["SiteView"];
export type VehicleView = Schemas["VehicleView"];
export type AppFactsView = Schemas["AppFactsView"];
export type LinkFiguresView = Schemas["LinkFiguresView"];
export type WaitingAppView = Schemas["WaitingAppView"];
export type LinkView = Schemas["LinkView"];
export type CommandView = Schemas["CommandView"];
export type PhaseView = Schemas["PhaseView"];
export type AlarmView = Schemas["AlarmView"];
export type GroundImageView = Schemas["GroundImageView"];
export type AreaView = Schemas["AreaView"];
export type PadView = Schemas["PadView"];
export type HazardView = Schemas["HazardView"];
export type LeaseView = Schemas["LeaseView"];
export type AuthorityView = Schemas["AuthorityView"];
export type SteeringView = Schemas["SteeringView"];
export type FailsafeCellView = Schemas["FailsafeCellView"];
export type FailsafeRowView = Schemas["FailsafeRowView"];
export type PreflightView = Schemas["PreflightView"];
export type CheckView = Schemas["CheckView"];
export type FleetReturnView = Schemas["FleetReturnView"];
export type ImagerMotionView =
  | Schemas["SideStepView"]
  | Schemas["MoveUpwindView"]
  | Schemas["ImagerReliefView"];
export type ImagerReliefView = Schemas["ImagerReliefView"];
export type SideStepView = Schemas["SideStepView"];
export type MoveUpwindView = Schemas["MoveUpwindView"];
export type LightSensorView = Schemas["LightSensorView"];
export type LightSensorsView = Schemas["LightSensorsView"];
export type LightSharesView = Schemas["LightSharesView"];
export type ReturningView = Schemas["ReturningView"];
export type ShadeLineView = Schemas["ShadeLineView"];
export type ForecastView = Schemas["ForecastView"];
export type SunAtView = Schemas["SunAtView"];
export type UpwindPlaceView = Schemas["UpwindPlaceView"];
export type UpwindView = Schemas["UpwindView"];
export type SurveyView = Schemas["SurveyView"];
export type SurveyLightView = Schemas["SurveyLightView"];
export type SurveyingView = Schemas["SurveyingView"];
export type FlownRegionView = Schemas["FlownRegionView"];
export type FlownRegionsView = Schemas["FlownRegionsView"];
export type SurveyAgainRequest = Schemas["SurveyAgainRequest"];
export type SurveyRequest = Schemas["SurveyRequest"];
export type SurveyResponse = Schemas["SurveyResponse"];
export type SurveyEstimateView = Schemas["SurveyEstimateView"];
export type PlanAircraftView = Schemas["PlanAircraftView"];
export type PlanFormatView = Schemas["PlanFormatView"];
export type PlanExportsView = Schemas["PlanExportsView"];
export type SurveyCameraView = Schemas["SurveyCameraView"];
export type SurveyPaths = Schemas["SurveyPaths"];
export type TemporaryZoneView = Schemas["TemporaryZoneView"];
export type TemporaryZoneRequest = Schemas["TemporaryZoneRequest"];
export type TemporaryZoneResponse = Schemas["TemporaryZoneResponse"];
export type DrawnFeatureView = Schemas["DrawnFeatureView"];
export type SiteDrawingView = Schemas["SiteDrawingView"];
export type SiteDrawingRequest = Schemas["SiteDrawingRequest"];
export type SiteDrawingResponse = Schemas["SiteDrawingResponse"];
export type CalibrationRequest = Schemas["CalibrationRequest"];
export type CalibrationView = Schemas["CalibrationView"];
export type ControlPointView = Schemas["ControlPointView"];
export type FrozenFrameView = Schemas["FrozenFrameView"];
export type SiteVehiclesRequest = Schemas["SiteVehiclesRequest"];
export type SiteVehiclesResponse = Schemas["SiteVehiclesResponse"];
export type SiteVehiclesView = Schemas["SiteVehiclesView"];
export type SiteVehicleView = Schemas["SiteVehicleView"];
export type ImportedView = Schemas["ImportedView"];
export type ImportedFeatureView = Schemas["ImportedFeatureView"];
export type TimelineView = Schemas["TimelineView"];
export type TimelineEntryView = Schemas["TimelineEntryView"];
export type BaseMapView = Schemas["BaseMapView"];
export type BaseMapsView = Schemas["BaseMapsView"];
export type FlightView = Schemas["FlightView"];
export type FlightFiguresView = Schemas["FlightFiguresView"];
export type PhotosView = Schemas["PhotosView"];
export type PhotoJobView = Schemas["PhotoJobView"];
export type PhotoStepView = Schemas["PhotoStepView"];
export type PhotoRequest = Schemas["PhotoRequest"];
export type CameraClockView = Schemas["CameraClockView"];
export type ActionResponse = Schemas["ActionResponse"];
export type OrderRequest = Schemas["OrderRequest"];
export type OrderResponse = Schemas["OrderResponse"];
export type OrderResult = Schemas["OrderResult"];

export type LayerName = DrawnFeatureView["layer"];
export type Staleness = VehicleView["staleness"];
export type Phase = CommandView["phase"];
export type Severity = AlarmView["severity"];
export type Order = OrderRequest["order"];
export type AuthorityHolder = AuthorityView["holder"];
export type Role = AccessView["role"];
export type ZoneKind = TemporaryZoneView["kind"];
export type {
  Connection,
  FlightFile,
  NamedOrder,
  NewSurvey,
  NewZone,
  Outcome,
  PhotoFile,
  Picture,
  TimelineFilter,
  TimelineSubject,
} from "./requests";
