#pragma once

#include "core/pipeline/stage.h"

namespace mocurate {

/// Inputs: role "run" (run summary JSON), "dataset", "metrics", "fit_error", "evidence" and "fit" of the clips to draw
/// -> one self-contained HTML page.
Expected<StageOutcome> ReportStage(const StageRequest& request);

/// One fitted clip (roles "evidence", "fit", "depth") -> a PNG. Options {"kind": clip | overlay | cloud}: stills of the
/// clip, the body over its first depth view, or the bones inside the fused cloud, at the middle frame.
Expected<StageOutcome> PictureStage(const StageRequest& request);

/// One fitted clip (roles "evidence", "fit", "depth") -> an HTML page about it.
Expected<StageOutcome> ClipPageStage(const StageRequest& request);

/// The same -> an H.264 video (MP4). It has a library and program of its own (report_video, mocurate-video), because
/// video coders load some 200 libraries. Error kMissingOnHost without an encoder.
Expected<StageOutcome> ClipVideoStage(const StageRequest& request);

/// Sets of motions (role "motions", named after their source; role "body": a skin to draw them with) -> SVG or PNG.
Expected<StageOutcome> MotionPictureStage(const StageRequest& request);

/// Numbers (the first input, as of PlotsOf) -> SVG of diagrams.
Expected<StageOutcome> PlotStage(const StageRequest& request);

/// Sets of motions as for MotionPictureStage -> an H.264 video, all rows side by side (report_video).
Expected<StageOutcome> MotionVideoStage(const StageRequest& request);

/// What the runner must know of each stage; versions are in options.cpp.
StageDeclaration MotionPictureDeclaration();
StageDeclaration MotionVideoDeclaration();
StageDeclaration PlotDeclaration();
StageDeclaration ClipPageDeclaration();
StageDeclaration ClipVideoDeclaration();
StageDeclaration ReportDeclaration();
StageDeclaration ReviewDeclaration();
StageDeclaration AnnotateDeclaration();
StageDeclaration SurveyDeclaration();
StageDeclaration PictureDeclaration();

}  // namespace mocurate
